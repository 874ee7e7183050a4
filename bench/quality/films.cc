// bench/quality/films.cc — how far is one film from another, by the measures of bench_quality?
//
//   bench_films REAL.mp4 MADE.mp4 [MADE.mp4 ...] [--matte M.png] [--json FILE]
//
// For what others have made, and to compare these measures with other implementations of them. Films are read
// whole, reduced to --width, and compared over as many frames as the shorter one has; the real one's halves
// are the ceiling.

#include <algorithm>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/harness/arguments.h"
#include "bench/quality/quality_asked.h"
#include "bench/quality/quality_footage.h"
#include "bench/quality/quality_measures.h"
#include "bench/quality/quality_report.h"
#include "freshet/error.h"
#include "media/picture/picture.h"

namespace {

using namespace freshet;

constexpr std::size_t kMinFrames = 16;

struct Compared {
  std::vector<cv::Mat> luma;
  std::vector<bench::PairMotion> motions;
  double fps = 25;
};

/// size   to which the film is brought; empty: as read.
Compared read(const std::string& path, int width, cv::Size size) {
  Compared film;
  std::vector<cv::Mat> frames = bench::read_video(path, width, &film.fps);
  if (frames.size() < kMinFrames)
    throw Error(ErrorKind::kInput, path, fmt::format("{} frames, {} expected", frames.size(), kMinFrames));
  for (cv::Mat& frame : frames)
    if (!size.empty() && frame.size() != size) cv::resize(frame, frame, size, 0, 0, cv::INTER_AREA);
  film.luma = bench::luma_of(frames);
  film.motions = bench::pair_motions(film.luma);
  return film;
}

/// Reduced and cropped as the film was.
cv::Mat matte_of(const std::string& path, cv::Size film) {
  cv::Mat grey;
  cv::cvtColor(media::read_picture(path).bgr, grey, cv::COLOR_BGR2GRAY);
  const double scale = std::max(1.0 * film.width / grey.cols, 1.0 * film.height / grey.rows);
  cv::resize(grey, grey, {}, scale, scale, cv::INTER_AREA);
  if (grey.cols - film.width >= bench::kSpectrumBlock || grey.rows - film.height >= bench::kSpectrumBlock)
    throw Error(ErrorKind::kInput, path, "not of the film's shape");
  return grey(cv::Rect({0, 0}, film)).clone();
}

int run(const std::string& real_path, const std::vector<std::string>& made_paths,
        const std::string& matte_path, int width, const std::string& json_path) {
  const Compared real = read(real_path, width, {});
  const cv::Size size = real.luma[0].size();
  bench::Region region{cv::Mat(size, CV_8U, cv::Scalar(255)), {0, 0}, 24};
  if (!matte_path.empty()) region.matte = matte_of(matte_path, size);
  const auto measured = [&](const Compared& film, std::size_t first, std::size_t count) {
    return bench::measure(std::span(film.luma).subspan(first, count),
                          std::span(film.motions).subspan(first, count - 1), film.fps, region);
  };
  const std::size_t half = real.luma.size() / 2;
  bench::Film before = measured(real, 0, half);
  const bench::Film after = measured(real, half, half);
  before.halves_apart = bench::patch_distances(before.patches, after.patches);

  std::vector<bench::Judged> judged{{.clip = real_path,
                                     .class_name = "",
                                     .method = "ceiling",
                                     .distance = bench::compare(after, before, region),
                                     .lifetime = after.lifetime}};
  for (const std::string& path : made_paths) {
    const Compared made = read(path, width, size);
    const std::size_t frames = std::min(real.luma.size(), made.luma.size());
    bench::Film truth = measured(real, 0, frames);
    truth.halves_apart = before.halves_apart;
    const bench::Film film = measured(made, 0, frames);
    judged.push_back({.clip = real_path,
                      .class_name = "",
                      .method = path,
                      .distance = bench::compare(film, truth, region),
                      .lifetime = film.lifetime});
    judged.back().distance.start = bench::detail_correlation(made.luma[0], real.luma[0], region.matte);
  }
  fmt::print("{}", bench::clip_table(judged));
  if (!json_path.empty()) std::ofstream(json_path) << bench::to_json(judged).dump(1) << '\n';
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  std::string real, matte, json;
  std::vector<std::string> made;
  int width = 640;
  bench::Arguments app("Measures how far films are from a real one");
  app.option("real", real, "What was filmed").required();
  app.option("made", made, "What was made of its first frame").required();
  app.option("--matte", matte, "Where they are compared [everywhere]");
  app.option("--width", width, "Longer side that films are reduced to, px").between(64, 8192);
  app.option("--json", json, "Figures as JSON");
  app.parse(argc, argv);
  try {
    return run(real, made, matte, width, json);
  } catch (const freshet::Error& fault) {
    fmt::print(stderr, "{}\n", fault.what());
    return 1;
  }
}
