// The clip that looks most like each piece of a picture.   search STORE PICTURE
#include <freshet/error.h>
#include <freshet/picture.h>
#include <freshet/search.h>

#include <iostream>

int main(int argc, char** argv) try {
  if (argc != 3) return 2;
  const freshet::Store store(argv[1]);
  const freshet::Search search =
      freshet::search(store, freshet::read_picture(argv[2]).bgr, {}, {.frames = 8});
  for (std::size_t piece = 0; piece < search.pieces(); ++piece) {
    const freshet::Candidate best = search.candidates(piece).front();
    std::cout << search.area(piece) << ' ' << best.clip << ' ' << best.score << '\n';
  }
} catch (const freshet::Error& fault) {
  std::cerr << fault.what() << '\n';
  return 1;
}
