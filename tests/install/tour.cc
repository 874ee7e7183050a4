// A camera through a film.   tour FILM VIDEO
#include <freshet/error.h>
#include <freshet/picture.h>
#include <freshet/ways/tour.h>

#include <iostream>

int main(int argc, char** argv) try {
  if (argc != 3) return 2;
  freshet::Tour tour(argv[1], {.move = "orbit", .horizon = 40, .frames = 8});
  freshet::VideoWriter video(argv[2], tour.size(), {.frames = tour.frames(), .fps = tour.fps()});
  for (freshet::TourFrame frame; tour.next(frame);) video.write(frame.picture);
  video.finish();
  std::cout << tour.frames() << " frames of " << tour.size().width << " x " << tour.size().height << '\n';
} catch (const freshet::Error& fault) {
  std::cerr << fault.what() << '\n';
  return 1;
}
