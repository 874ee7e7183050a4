// A moving scene from stills of it.   stills FOLDER VIDEO
#include <freshet/error.h>
#include <freshet/picture.h>
#include <freshet/ways/stills.h>

#include <iostream>

int main(int argc, char** argv) try {
  if (argc != 3) return 2;
  const freshet::StillsFilm film(argv[1], {.seconds = 1, .fps = 8, .one_region = true});
  freshet::VideoWriter video(argv[2], film.size(), {.frames = film.frames(), .fps = film.fps()});
  film.render([&](const cv::Mat& frame) { video.write(frame); });
  video.finish();
  std::cout << film.frames() << " frames of " << film.size().width << " x " << film.size().height << '\n';
} catch (const freshet::Error& fault) {
  std::cerr << fault.what() << '\n';
  return 1;
}
