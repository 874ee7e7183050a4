// What `--hold auto` holds of pictures whose mattes are at hand, and by which figures: what holds.py measures and
// learns from.

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "bench/harness/arguments.h"
#include "media/picture/picture.h"
#include "vision/look/standing.h"

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kStill = "_still.png";

/// Figure after figure, float32; then the frame, as one more.
void write_figures(const fs::path& path, const cv::Mat& picture, const cv::Mat& matte) {
  std::vector<cv::Mat> figures = freshet::vision::standing_figures(picture, matte);
  cv::Mat frame;
  freshet::vision::own_frame(picture).convertTo(frame, CV_32F);
  figures.push_back(frame);
  std::ofstream out(path, std::ios::binary);
  for (const cv::Mat& figure : figures)
    out.write(reinterpret_cast<const char*>(figure.ptr()),
              static_cast<std::streamsize>(figure.total() * figure.elemSize()));
}

}  // namespace

int main(int argc, char** argv) try {
  std::string mattes, out;
  bool figures = false;
  freshet::bench::Arguments app{"Guesses what stands in each MATTES/NAME_matte.png of MATTES/NAME_still.png"};
  app.option("mattes", mattes).required().existing_folder();
  app.option("out", out, "Gets NAME_hold.png").required();
  app.flag("--figures", figures, "NAME.figures too, to learn from: of stills of 640 px");
  app.parse(argc, argv);
  fs::create_directories(out);
  for (const fs::directory_entry& entry : fs::directory_iterator(mattes)) {
    const std::string file = entry.path().filename();
    if (!file.ends_with(kStill)) continue;
    const std::string name = file.substr(0, file.size() - kStill.size());
    const cv::Mat picture = freshet::media::read_picture(entry.path()).bgr;
    const cv::Mat matte =
        freshet::media::read_matte(fs::path(mattes) / (name + "_matte.png"), picture.size()).alpha;
    const cv::Mat held = freshet::vision::what_stands(picture, matte);
    if (!cv::imwrite(fs::path(out) / (name + "_hold.png"), held))
      throw std::runtime_error(out + ": cannot be written");
    if (figures) write_figures(fs::path(out) / (name + ".figures"), picture, matte);
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "bench_holds: {}\n", error.what());
  return 1;
}
