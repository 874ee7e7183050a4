// What `--hold auto` holds of pictures whose mattes are at hand, and by which figures; and what a person holds who
// clicks in the studio: what holds.py measures and learns from.

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/harness/arguments.h"
#include "media/picture/picture.h"
#include "vision/look/lies_at.h"
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

constexpr std::array kClicks{0, 1, 2, 3, 5, 8, 12};  // after which it is written what is held
constexpr std::array kPlain{1.};
constexpr std::array kSizes{.25, .5, 1., 2.,
                            4.};     // times what a plain click takes: what "More" and "Less" offer
constexpr double kFluidCounts = .5;  // to one who chooses a size
constexpr int kSmallestSeen = 4;     // px

/// The largest area, not clicked in vain before, of which it is wrong whether it is held; empty: there is none.
cv::Mat largest_wrong(const cv::Mat& wrong) {
  cv::Mat labels, figures, middles;
  const int count = cv::connectedComponentsWithStats(wrong, labels, figures, middles, 8);
  int largest = 0, area = kSmallestSeen - 1;
  for (int i = 1; i < count; ++i)
    if (figures.at<int>(i, cv::CC_STAT_AREA) > area) {
      area = figures.at<int>(i, cv::CC_STAT_AREA);
      largest = i;
    }
  return largest == 0 ? cv::Mat() : labels == largest;
}

/// A person who clicks where the largest area is wrong, in its middle, takes of the sizes the one that mends most, and
/// does nothing else.
/// start   what is held before the first click. Writes PREFIX + how many clicks + ".png", and returns s of CPU a click.
double click(const cv::Mat& picture, const cv::Mat& matte, const cv::Mat& drawn, const cv::Mat& start,
             std::span<const double> sizes, const std::string& prefix) {
  const cv::Mat inside = matte > 127, stands = drawn > 127;
  cv::Mat held = (start > 127) & inside, in_vain = cv::Mat::zeros(matte.size(), CV_8U);
  std::array<std::vector<cv::Point>, 2> clicks;  // that let go, and that hold
  std::clock_t spent = 0;
  int answers = 0;
  for (int count = 0; count <= kClicks.back(); ++count) {
    if (std::ranges::find(kClicks, count) != kClicks.end() &&
        !cv::imwrite(prefix + std::to_string(count) + ".png", held))
      throw std::runtime_error(prefix + ": cannot be written");
    const cv::Mat wrong = largest_wrong((held ^ stands) & inside & ~in_vain);
    if (wrong.empty()) continue;
    const cv::Point at = freshet::vision::innermost(wrong);
    const bool holds = held.at<uchar>(at) == 0;
    cv::Mat lies;
    double most = 0;
    for (const double size : sizes) {
      const std::clock_t from = std::clock();
      const cv::Mat found = freshet::vision::what_lies_at(picture, matte, held, at, clicks.at(holds ? 0 : 1),
                                                          size * freshet::vision::kClickTakes);
      spent += std::clock() - from;
      ++answers;
      const int right = cv::countNonZero(found & (holds ? stands : ~stands)), all = cv::countNonZero(found);
      const double mends = right - kFluidCounts * (all - right);
      if (!lies.empty() && mends <= most) continue;
      most = mends;
      lies = found;
    }
    if (cv::countNonZero(lies) == 0) {
      in_vain |= wrong;
      continue;
    }
    clicks.at(holds ? 1 : 0).push_back(freshet::vision::innermost(lies));
    held.setTo(holds ? 255 : 0, lies);
  }
  return answers == 0 ? 0 : static_cast<double>(spent) / CLOCKS_PER_SEC / answers;
}

}  // namespace

int main(int argc, char** argv) try {
  std::string mattes, out, drawn;
  bool figures = false;
  freshet::bench::Arguments app{"Guesses what stands in each MATTES/NAME_matte.png of MATTES/NAME_still.png"};
  app.option("mattes", mattes).required().existing_folder();
  app.option("out", out, "Gets NAME_hold.png").required();
  app.flag("--figures", figures, "NAME.figures too, to learn from: of stills of 640 px");
  app.option("--drawn", drawn, "NAME.png: what stands; OUT gets NAME_{plain,sized}_{none,auto}_COUNT.png")
      .existing_folder();
  app.parse(argc, argv);
  fs::create_directories(out);
  double slowest = 0;
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
    if (drawn.empty()) continue;
    const cv::Mat stands = cv::imread(fs::path(drawn) / (name + ".png"), cv::IMREAD_GRAYSCALE);
    if (stands.size() != picture.size())
      throw std::runtime_error(drawn + ": no " + name + ".png of its size");
    for (const bool proposed : {false, true})
      for (const bool sized : {false, true})
        slowest = std::max(slowest,
                           click(picture, matte, stands, proposed ? held : cv::Mat::zeros(held.size(), CV_8U),
                                 sized ? std::span<const double>(kSizes) : std::span<const double>(kPlain),
                                 fs::path(out) / fmt::format("{}_{}_{}_", name, sized ? "sized" : "plain",
                                                             proposed ? "auto" : "none")));
  }
  if (!drawn.empty()) fmt::print("a click costs {:.2f} s of CPU in the slowest picture's mean\n", slowest);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "bench_holds: {}\n", error.what());
  return 1;
}
