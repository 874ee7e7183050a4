// bench/animation/animation.cc — do the renderer's choices keep contrast, level and liveliness, and what do they cost?
//
//   bench_animation STORE CLASS:DIRECTION:PICTURE[:MATTE]... [--json FILE]
//
// Each picture is labelled once, then rendered (48 frames) with the defaults, and by the paper's method with one choice
// changed at a time. Measured inside the matte: contrast by pyramid level against the picture's own (log2 of the ratio of
// mean magnitudes; 0 is right), flicker (standard deviation of the mean level over frames, in grey levels),
// step (mean level of the animation less the picture's), dead (fraction of pixels whose deviation over time
// is below one grey level), seam (mean temporal difference across the borders of pieces over that elsewhere;
// 1 is invisible), and frames per second.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/harness/machine.h"
#include "bench/harness/picture_argument.h"
#include "freshet/error.h"
#include "query/labelling/labelling.h"
#include "stored/store_settings.h"
#include "synth/animate/animate.h"
#include "synth/animate/method_settings.h"
#include "synth/animate/placement/assigned.h"
#include "vision/pyramid.h"

namespace {

using namespace freshet;

constexpr int kLevels = 3, kFrames = 48;

struct Choice {
  std::string name;
  synth::animate::AnimateOptions options;
};

/// The defaults, and the paper's rendering with one setting changed at a time.
std::vector<Choice> choices() {
  synth::animate::AnimateOptions options;
  options.frames = kFrames;
  std::vector<Choice> all{{"carried", options}};
  synth::animate::method_setting("method").set(options.method, "paper");
  all.push_back({"matching by sequence, low band shared", options});
  for (const auto& [name, value] : std::vector<std::pair<std::string, std::string>>{{"blend", "paper"},
                                                                                    {"low-band", "keep"},
                                                                                    {"low-band", "remove"},
                                                                                    {"matching", "none"},
                                                                                    {"matching", "frame"}}) {
    all.push_back({"--" + name + " " + value, options});
    synth::animate::method_setting(name).set(all.back().options.method, value);
  }
  return all;
}

double masked_mean(const cv::Mat& values, const cv::Mat& mask) { return cv::mean(values, mask)[0]; }

/// What one rendering showed.
struct Shown {
  std::vector<double> contrast = std::vector<double>(kLevels, 0.0);
  double flicker = 0, step = 0, dead = 0, seam = 0, seconds = 0;
};

/// Takes the frames one by one: luma statistics inside the matte.
class Watcher {
 public:
  Watcher(const cv::Mat& picture, const cv::Mat& matte, const synth::animate::Placement& placement)
      : mask_(matte > 200),
        sum_(cv::Mat::zeros(picture.size(), CV_32F)),
        squares_(sum_.clone()),
        border_(cv::Mat::zeros(picture.size(), CV_8U)) {
    cv::cvtColor(picture, luma_, cv::COLOR_BGR2GRAY);
    luma_.convertTo(picture_, CV_32F);
    // Pieces hand over at the edges of their own squares.
    const int margin = (placement.side - placement.stride) / 2;
    for (const synth::animate::PlacedPatch& placed : placement.patches)
      for (int i = 0; i < placement.stride; ++i)
        for (const cv::Point edge : {cv::Point(margin, margin + i), cv::Point(margin + i, margin)}) {
          const cv::Point p = placed.piece + edge;
          if (cv::Rect({}, picture.size()).contains(p)) border_.at<std::uint8_t>(p) = 255;
        }
    const std::vector<double> own = energies(picture_);
    own_.assign(own.begin(), own.end());
    energy_.assign(kLevels, 0.0);
  }

  void add(const cv::Mat& frame) {
    cv::Mat now;
    cv::cvtColor(frame, luma_, cv::COLOR_BGR2GRAY);
    luma_.convertTo(now, CV_32F);
    const std::vector<double> found = energies(now);
    for (int level = 0; level < kLevels; ++level) energy_[level] += found[level];
    levels_.push_back(masked_mean(now, mask_));
    sum_ += now;
    squares_ += now.mul(now);
    if (!last_.empty()) {
      // A seam shows as a jump of the change from one pixel to the next.
      cv::Mat change = now - last_, across, down;
      cv::Mat kernel = (cv::Mat_<float>(1, 2) << -1, 1);
      cv::filter2D(change, across, CV_32F, kernel, {1, 0});
      cv::filter2D(change, down, CV_32F, kernel.t(), {0, 1});
      const cv::Mat jump = cv::abs(across) + cv::abs(down);
      at_border_ += masked_mean(jump, mask_ & border_);
      elsewhere_ += masked_mean(jump, mask_ & ~border_);
    }
    last_ = now;
  }

  Shown result() const {
    Shown shown;
    const double n = static_cast<double>(levels_.size());
    for (int level = 0; level < kLevels; ++level)
      shown.contrast[level] = std::log2(energy_[level] / n / own_[level]);
    double mean = 0, variance = 0;
    for (double level : levels_) mean += level / n;
    for (double level : levels_) variance += (level - mean) * (level - mean) / n;
    shown.flicker = std::sqrt(variance);
    shown.step = mean - masked_mean(picture_, mask_);
    const cv::Mat average = sum_ / n;
    cv::Mat deviation;
    cv::sqrt(cv::max(squares_ / n - average.mul(average), 0), deviation);
    shown.dead = masked_mean(deviation < 1, mask_) / 255;
    shown.seam = at_border_ / elsewhere_;
    return shown;
  }

 private:
  std::vector<double> energies(const cv::Mat& luma) const {
    std::vector<cv::Mat> bands;
    vision::laplacian_pyramid(luma, kLevels, bands);
    std::vector<double> out;
    for (int level = 0; level < kLevels; ++level) {
      cv::Mat mask;
      cv::resize(mask_, mask, bands[level].size(), 0, 0, cv::INTER_NEAREST);
      out.push_back(masked_mean(cv::abs(bands[level]), mask));
    }
    return out;
  }

  cv::Mat mask_, luma_, picture_, sum_, squares_, border_, last_;
  std::vector<double> own_, energy_, levels_;
  double at_border_ = 0, elsewhere_ = 0;
};

/// Mean speed of the patches that labels choose, px/s.
double mean_speed(const query::CandidateSearch& search, const query::Labels& labels) {
  double sum = 0;
  for (std::size_t piece = 0; piece < labels.size(); ++piece) {
    const stored::Row row = search.candidates.rows_of(piece)[labels[piece]];
    sum += std::hypot(search.table().mean_u[row], search.table().mean_v[row]);
  }
  return sum / static_cast<double>(labels.size());
}

int run(int argc, char** argv) {
  std::string store, json_path;
  std::vector<std::string> pictures;
  CLI::App app("Do the renderer's choices keep contrast, level and liveliness, and what do they cost?");
  app.add_option("STORE", store)->required();
  app.add_option("PICTURE", pictures, "CLASS:DIRECTION:PICTURE[:MATTE]")->required();
  app.add_option("--json", json_path, "Write the figures here");
  CLI11_PARSE(app, argc, argv);
  const bench::Machine machine = bench::this_machine();
  fmt::print("{}\n{} frames a rendering\n\n", bench::to_string(machine), kFrames);
  const store::Snapshot snapshot = store::Store::open_read(store).snapshot();
  const vision::Settings settings = stored::settings_of(snapshot);
  nlohmann::json json{
      {"machine", bench::to_json(machine)}, {"frames", kFrames}, {"rows", nlohmann::json::array()}};
  fmt::print(
      "| picture | choice | contrast, log2, fine to coarse | flicker | step | dead | seam | frames/s |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  std::vector<std::string> speeds;
  const query::SearchBase base = query::open_search(snapshot);
  for (const std::string& argument : pictures) {
    const std::size_t first = argument.find(':'), second = argument.find(':', first + 1);
    if (second == std::string::npos)
      throw Error(ErrorKind::kUsage, argument, "expected CLASS:DIRECTION:PICTURE[:MATTE]");
    const std::string direction = argument.substr(first + 1, second - first - 1);
    const bench::PictureArgument target = bench::read_picture_argument(argument.substr(second + 1));
    query::LabelOptions options;
    options.candidates.class_name = argument.substr(0, first);
    options.candidates.min_duration_s = kFrames / 25.0;
    if (!direction.empty()) options.candidates.direction_deg = query::parse_direction(direction);
    options.costs.vote = 0;
    const query::Labelling calm = query::label(snapshot, base, target.picture, target.matte, options);
    options.costs.vote = query::PairwiseOptions{}.vote;
    const query::Labelling labelling = query::label(snapshot, base, target.picture, target.matte, options);
    const query::Labels looks(labelling.labels.size(), 0);
    speeds.push_back(fmt::format("| {} | {:.1f} | {:.1f} | {:.1f} |", target.name,
                                 mean_speed(labelling.search, looks), mean_speed(calm.search, calm.labels),
                                 mean_speed(labelling.search, labelling.labels)));
    const synth::animate::Placement placement =
        synth::animate::placement_from(labelling.assignment, snapshot);
    for (const Choice& choice : choices()) {
      Watcher watcher(target.picture, target.matte, placement);
      const synth::animate::AnimateReport report =
          synth::animate::animate(snapshot, settings, target.picture, target.matte, placement, choice.options,
                                  [&](const cv::Mat& frame) { watcher.add(frame); });
      const Shown shown = watcher.result();
      fmt::print("| {} | {} | {:+.2f} {:+.2f} {:+.2f} | {:.2f} | {:+.1f} | {:.2f} | {:.2f} | {:.1f} |\n",
                 target.name, choice.name, shown.contrast[0], shown.contrast[1], shown.contrast[2],
                 shown.flicker, shown.step, shown.dead, shown.seam, kFrames / report.total_s);
      std::fflush(stdout);
      json["rows"].push_back({{"picture", target.name},
                              {"choice", choice.name},
                              {"contrast", shown.contrast},
                              {"flicker", shown.flicker},
                              {"step", shown.step},
                              {"dead", shown.dead},
                              {"seam", shown.seam},
                              {"seconds", report.total_s}});
    }
  }
  fmt::print(
      "\nMean speed of the patches chosen, px/s\n\n| picture | best likeness alone | labelled, no vote | "
      "labelled |\n| --- | --- | --- | --- |\n");
  for (const std::string& line : speeds) fmt::print("{}\n", line);
  if (!json_path.empty()) std::ofstream(json_path) << json.dump(2) << '\n';
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  try {
    return run(argc, argv);
  } catch (const freshet::Error& fault) {
    fmt::print(stderr, "{}\n", fault.what());
    return 1;
  }
}
