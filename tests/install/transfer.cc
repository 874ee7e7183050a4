// The look of a picture on a designed motion.   transfer DESIGN PICTURE MATTE VIDEO
#include <freshet/error.h>
#include <freshet/picture.h>
#include <freshet/ways/transfer.h>

#include <iostream>
#include <optional>

int main(int argc, char** argv) try {
  if (argc != 5) return 2;
  const std::filesystem::path design = argv[1];
  std::optional<freshet::VideoWriter> video;
  cv::Mat written;
  freshet::transfer({.alpha = design / "alpha", .flow = design / "flow"},
                    {.exemplar = argv[2], .alpha = argv[3]},
                    [&](const cv::Mat& bgra) {
                      if (!video) video.emplace(argv[4], bgra.size(), freshet::VideoOptions{});
                      bgra.convertTo(written, CV_16U, 65535);
                      video->write(written);
                    },
                    {.frames = 3});
  video.value().finish();
} catch (const freshet::Error& fault) {
  std::cerr << fault.what() << '\n';
  return 1;
}
