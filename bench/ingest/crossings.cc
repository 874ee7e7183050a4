// How much of what crosses a clip is found, and how much of a clip that nothing crosses is taken for such a thing?
//
//   bench_crossings CLIP.. [--frames N] [--but NAME]..
//
// The first N frames (120) of each clip, reduced to 480 px, as they are, and with a figure that goes through them once:
// a person (5 x 16 % of the frame), an animal (10 x 8 %), a boat (22 x 8 %), dark or light, with a coarse pattern. The
// folder of a clip is its class; --but leaves a clip out. A row a class: clips; the share of the frame that is found
// where nothing crosses; of each figure's path, the mean share that is found, and in how many clips it is more than
// 70 %; the share of the frame, off the path, that is found with it.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bench/harness/arguments.h"
#include "freshet/error.h"
#include "ingest/crossings.h"
#include "ingest/screening.h"
#include "media/frame/frame.h"
#include "media/video/video_reader.h"

namespace {

using namespace freshet;
namespace fs = std::filesystem;

constexpr int kSide = 480;  // px
constexpr double kMostly = 0.7;

struct Figure {
  const char* name;
  double width, height;  // of the frame's
};
constexpr std::array kFigures = {Figure{"person", 0.05, 0.16}, Figure{"animal", 0.10, 0.08},
                                 Figure{"boat", 0.22, 0.08}};

struct Clip {
  std::vector<cv::Mat> frames;  // CV_8U
  double fps = 25;
};

Clip read(const fs::path& file, int count) {
  media::VideoReader reader(file);
  const media::VideoInfo& info = reader.info();
  Clip clip{.frames = {}, .fps = static_cast<double>(info.fps_num) / static_cast<double>(info.fps_den)};
  while (static_cast<int>(clip.frames.size()) < count) {
    const std::optional<media::Frame> frame = reader.next();
    if (!frame) break;
    const cv::Mat luma = media::to_luma(*frame);
    cv::Mat small;
    cv::resize(luma, small, ingest::within(luma.size(), kSide), 0, 0, cv::INTER_AREA);
    clip.frames.push_back(small);
  }
  if (clip.frames.empty()) throw Error(ErrorKind::kInput, file.string(), "it has no frame", "Leave it out");
  return clip;
}

cv::Mat found_in(const Clip& clip) {
  const cv::Size size = clip.frames.front().size();
  ingest::CrossingFinder finder(size, clip.fps);
  for (const cv::Mat& frame : clip.frames) finder.add(frame);
  const cv::Mat found = finder.finish();
  return found.empty() ? cv::Mat(cv::Mat::zeros(size, CV_8U)) : found;
}

/// The clip with a figure in it. path   CV_8U, where it has been.
Clip crossed_by(const Figure& figure, const Clip& clip, std::uint64_t seed, cv::Mat& path) {
  cv::RNG random(seed);
  const cv::Size size = clip.frames.front().size();
  const cv::Size body(cvRound(figure.width * size.width), cvRound(figure.height * size.height));
  cv::Mat pattern(5, 4, CV_32F), look, mask = cv::Mat::zeros(body, CV_8U), shape;
  random.fill(pattern, cv::RNG::UNIFORM, 0, 1);
  cv::resize(pattern, look, body, 0, 0, cv::INTER_CUBIC);
  constexpr std::array kLevels = {25, 60, 200};
  look = kLevels[static_cast<std::size_t>(random.uniform(0, 3))] + 60 * (look - 0.5);
  cv::ellipse(mask, {{body.width / 2.f, body.height / 2.f}, cv::Size2f(body), 0}, 255, cv::FILLED,
              cv::LINE_AA);
  mask.convertTo(shape, CV_32F, 1 / 255.);
  const auto frames = static_cast<double>(clip.frames.size());
  const bool leftwards = random.uniform(0, 2) == 1;
  const double height = random.uniform(0.3, 0.7) * size.height;
  const double speed = (size.width + body.width) / frames * random.uniform(0.7, 1.3);

  Clip crossed{.frames = {}, .fps = clip.fps};
  path = cv::Mat::zeros(size, CV_8U);
  for (std::size_t t = 0; t < clip.frames.size(); ++t) {
    const double gone = speed * static_cast<double>(t);
    const cv::Matx23d place(1, 0, leftwards ? size.width - gone : gone - body.width, 0, 1,
                            height + 4 * std::sin(0.4 * static_cast<double>(t)));
    cv::Mat alpha, there, frame;
    cv::warpAffine(shape, alpha, place, size);
    cv::warpAffine(look, there, place, size, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    clip.frames[t].convertTo(frame, CV_32F);
    frame += alpha.mul(there - frame);
    cv::Mat drawn;
    frame.convertTo(drawn, CV_8U);
    crossed.frames.push_back(drawn);
    path |= alpha > 0.5;
  }
  return crossed;
}

struct Row {
  std::vector<double> nothing, beside;
  std::array<std::vector<double>, kFigures.size()> found;
};

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) /
         static_cast<double>(std::max<std::size_t>(1, values.size()));
}

void print(const std::string& name, const Row& row) {
  fmt::print("{:10} {:5} {:9.2f}", name, row.nothing.size(), 100 * mean(row.nothing));
  for (const std::vector<double>& found : row.found)
    fmt::print(" {:7.0f} {:5}", 100 * mean(found),
               std::ranges::count_if(found, [](double share) { return share > kMostly; }));
  fmt::print(" {:8.2f}\n", 100 * mean(row.beside));
}

void run(const std::vector<fs::path>& clips, const std::set<std::string>& but, int frames) {
  std::map<std::string, Row> rows;
  std::uint64_t seed = 1;
  for (const fs::path& file : clips) {
    if (but.contains(file.stem())) continue;
    const Clip clip = read(file, frames);
    Row &row = rows[file.parent_path().filename()], &all = rows["~all"];
    const double nothing = cv::countNonZero(found_in(clip)) / static_cast<double>(clip.frames[0].total());
    for (Row* each : {&row, &all}) each->nothing.push_back(nothing);
    for (std::size_t i = 0; i < kFigures.size(); ++i) {
      cv::Mat path, near;
      const cv::Mat found = found_in(crossed_by(kFigures[i], clip, seed++, path));
      cv::dilate(path, near, cv::Mat::ones(17, 17, CV_8U));
      for (Row* each : {&row, &all}) {
        each->found[i].push_back(cv::countNonZero(found & path) / std::max(1., 1. * cv::countNonZero(path)));
        each->beside.push_back(cv::countNonZero(found & ~near) / static_cast<double>(found.total()));
      }
    }
  }
  fmt::print("{:10} {:>5} {:>9}", "class", "clips", "nothing %");
  for (const Figure& figure : kFigures) fmt::print(" {:>5} % {:>5}", figure.name, ">70");
  fmt::print(" {:>8}\n", "beside %");
  for (const auto& [name, row] : rows) print(name == "~all" ? "all" : name, row);
}

}  // namespace

int main(int argc, char** argv) {
  bench::Arguments app{"How much of what crosses a clip is found?"};
  std::vector<fs::path> clips;
  std::set<std::string> but;
  int frames = 120;
  app.option("CLIP", clips).required();
  app.option("--frames", frames).at_least(1);
  app.option("--but", but, "Name of a clip, without its ending");
  app.parse(argc, argv);
  try {
    run(clips, but, frames);
  } catch (const Error& fault) {
    fmt::print(stderr, "bench_crossings: {}\n", fault.what());
    return 1;
  }
  return 0;
}
