// A simulated clip, and its first frame as a picture and a matte.   simulate SEED VIDEO PICTURE MATTE
#include <freshet/error.h>
#include <freshet/picture.h>
#include <freshet/ways/simulate.h>

#include <cstdlib>
#include <iostream>

int main(int argc, char** argv) try {
  if (argc != 5) return 2;
  freshet::Simulation clip({.scene = "waterfall",
                            .size = cv::Size(192, 144),
                            .frames = 32,
                            .seed = std::strtoull(argv[1], nullptr, 10)});
  freshet::VideoWriter video(argv[2], clip.size(), {.frames = clip.frames(), .fps = clip.fps()});
  freshet::SimulatedFrame frame;
  for (int i = 0; clip.next(frame); ++i) {
    video.write(frame.picture);
    if (i > 0) continue;
    freshet::VideoWriter picture(argv[3], clip.size(), {.frames = 1}),
        matte(argv[4], clip.size(), {.frames = 1});
    picture.write(frame.picture);
    matte.write(frame.alpha);
    picture.finish();
    matte.finish();
  }
  video.finish();
} catch (const freshet::Error& fault) {
  std::cerr << fault.what() << '\n';
  return 1;
}
