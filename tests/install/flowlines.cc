// Endless video from a short clip.   flowlines CLIP VIDEO LINES.svg
#include <freshet/error.h>
#include <freshet/picture.h>
#include <freshet/ways/flowlines.h>

#include <iostream>

int main(int argc, char** argv) try {
  if (argc != 4) return 2;
  freshet::FlowLines film(argv[1], {.frames = 40});
  film.write_lines(argv[3]);
  freshet::VideoWriter video(argv[2], film.size(), {.frames = film.frames(), .fps = film.fps()});
  for (freshet::FlowLinesFrame frame; film.next(frame);) video.write(frame.picture);
  video.finish();
  std::cout << film.frames() << " frames along " << film.lines().size() << " lines\n";
} catch (const freshet::Error& fault) {
  std::cerr << fault.what() << '\n';
  return 1;
}
