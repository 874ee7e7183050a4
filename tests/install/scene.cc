// A picture's layers under one wind.   scene SCENE.toml VIDEO
#include <freshet/error.h>
#include <freshet/picture.h>
#include <freshet/ways/scene.h>

#include <iostream>

int main(int argc, char** argv) try {
  if (argc != 3) return 2;
  freshet::SceneFilm film(argv[1]);
  freshet::VideoWriter video(argv[2], film.size(), {.frames = film.frames(), .fps = film.fps()});
  for (cv::Mat frame; film.next(frame);) video.write(frame);
  video.finish();
  std::cout << film.frames() << " frames of " << film.size().width << " x " << film.size().height << ", "
            << film.layers().size() << " layers\n";
} catch (const freshet::Error& fault) {
  std::cerr << fault.what() << '\n';
  return 1;
}
