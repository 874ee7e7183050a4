// bench/kind/kind.cc — is the class of a fluid told from its look, of a scene that was not learned from?
//
//   bench_kind FOOTAGE OUTLINES [--weights vision/look/kind_weights.h] [--pictures] [--json FILE]
//
// Reads the stills and frames that OUTLINES (bench/kind/outlines.txt) speaks of, learns a multinomial logistic
// regression of the figures of their look, each scene left out in turn, and prints what is told of it: by class, how
// many are told what, how many are sure, and of the sure how many are right. A file is a scene, and so are all
// simulated clips of a name, which teach but are counted apart. A line of OUTLINES counts 1, its frames and
// the ways its matte, light and colour are varied share it; what is printed is of the frames as they are. The eight
// clips that set no constant (docs/measurements/measures.md) are never learned from and are reported apart.
// --weights writes what is learned from all others. --pictures lists each still.

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/harness/arguments.h"
#include "bench/harness/machine.h"
#include "bench/kind/logistic.h"
#include "bench/kind/outlines.h"
#include "freshet/error.h"
#include "vision/look/fluid_kind.h"

namespace {

using namespace freshet;

constexpr int kSide = 640;  // px
constexpr std::array kSetNothing{"water/waves_aerial_foam", "water/waterfall_gorge",
                                 "water/wave_barrel_60fps", "fire/debris_fire",
                                 "fire/flame_bowl_topdown", "smoke/steam_fill_white",
                                 "clouds/clouds_sun_dark",  "clouds/clouds_layers_horizon"};

struct Sample {
  std::size_t line = 0;
  bool plain = false;                                // as it is, not varied
  double weight = 0, plain_weight = 0, seconds = 0;  // seconds: of processor time, for the look
  vision::FluidLook look{};
};

cv::Mat disc(double share) {
  const int side = 2 * cvRound(share * kSide) + 1;
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side});
}
cv::Mat toned(const cv::Mat& still, double gamma) {
  cv::Mat table(1, 256, CV_8U), out;
  for (int i = 0; i < 256; ++i)
    table.at<std::uint8_t>(i) = cv::saturate_cast<std::uint8_t>(255 * std::pow(i / 255., gamma));
  cv::LUT(still, table, out);
  return out;
}

/// As it is, first; then a matte drawn loosely and tightly, a picture cut to the fluid, halves of the fluid, more and
/// less light, and half of the colour.
std::vector<bench::Still> varied(const cv::Mat& still, const cv::Mat& matte) {
  std::vector<bench::Still> all{{still, matte}};
  const int fluid = cv::countNonZero(matte);
  if (fluid == 0) return all;
  cv::Mat loose, tight;
  cv::dilate(matte, loose, disc(.03));
  cv::erode(matte, tight, disc(.02));
  all.push_back({still, loose});
  if (cv::countNonZero(tight) > .3 * fluid) all.push_back({still, tight});

  const cv::Rect box = cv::boundingRect(matte);
  const cv::Point margin(box.width / 4, box.height / 4);
  const cv::Rect around = cv::Rect(box.tl() - margin, box.br() + margin) & cv::Rect({0, 0}, matte.size());
  all.push_back({still(around), matte(around)});

  int middle = box.x;  // half of the fluid lies to its left
  for (int left = 0; middle < box.br().x && 2 * left < fluid; ++middle)
    left += cv::countNonZero(matte.col(middle));
  for (const bool left : {true, false}) {
    cv::Mat half = matte.clone();
    half.colRange(left ? middle : 0, left ? half.cols : middle).setTo(0);
    if (cv::countNonZero(half) > 0) all.push_back({still, half});
  }
  all.push_back({toned(still, 1.4), matte});
  all.push_back({toned(still, .72), matte});
  cv::Mat grey, pale;
  cv::cvtColor(still, grey, cv::COLOR_BGR2GRAY);
  cv::cvtColor(grey, grey, cv::COLOR_GRAY2BGR);
  cv::addWeighted(still, .5, grey, .5, 0, pale);
  all.push_back({pale, matte});
  return all;
}

std::vector<Sample> read_samples(const std::vector<bench::Outlined>& lines, const std::string& footage) {
  std::vector<std::vector<Sample>> of(lines.size());
  oneapi::tbb::parallel_for(std::size_t{0}, lines.size(), [&](std::size_t line) {
    const std::vector<bench::Still> stills = bench::stills_of(lines[line], footage, kSide);
    for (const bench::Still& still : stills) {
      bool plain = true;
      for (const bench::Still& v : varied(still.picture, still.matte)) {
        const double began = bench::thread_seconds();
        const vision::FluidLook look = vision::fluid_look(v.picture, v.matte);
        of[line].push_back({.line = line,
                            .plain = plain,
                            .plain_weight = plain ? 1. / static_cast<double>(stills.size()) : 0,
                            .seconds = bench::thread_seconds() - began,
                            .look = look});
        plain = false;
      }
    }
    for (Sample& sample : of[line]) sample.weight = 1. / static_cast<double>(of[line].size());
  });
  std::vector<Sample> samples;
  for (const std::vector<Sample>& some : of) samples.insert(samples.end(), some.begin(), some.end());
  return samples;
}

int kind_of(const std::string& name) {
  for (std::size_t kind = 0; kind < vision::kFluidKinds.size(); ++kind)
    if (name == vision::kFluidKinds[kind]) return static_cast<int>(kind);
  throw Error(ErrorKind::kUsage, name, "no class of fluid");
}

bool sets_nothing(const bench::Outlined& line) {
  return std::ranges::any_of(kSetNothing,
                             [&](const char* name) { return line.file.find(name) != std::string::npos; });
}
bool teaches(const bench::Outlined& line) { return line.classes.size() == 1 && !sets_nothing(line); }

Eigen::VectorXd figures_of(const vision::FluidLook& look) {
  return Eigen::Map<const Eigen::VectorXf>(look.data(), static_cast<Eigen::Index>(look.size()))
      .cast<double>();
}

/// From all that teach but those of `without`, a file.
bench::Logistic learned(const std::vector<bench::Outlined>& lines, const std::vector<Sample>& samples,
                        const std::string& without) {
  std::vector<const Sample*> used;
  for (const Sample& sample : samples)
    if (teaches(lines[sample.line]) && lines[sample.line].scene() != without) used.push_back(&sample);
  if (used.empty()) throw Error(ErrorKind::kUsage, without, "nothing is left to learn from");
  bench::Learned rows{
      Eigen::MatrixXd(used.size(), vision::kLookFigures.size()), {}, Eigen::VectorXd(used.size())};
  for (std::size_t i = 0; i < used.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    rows.figures.row(row) = figures_of(used[i]->look).transpose();
    rows.classes.push_back(kind_of(lines[used[i]->line].classes[0]));
    rows.weights(row) = used[i]->weight;
  }
  return bench::learn(
      rows, {.classes = static_cast<int>(vision::kFluidKinds.size()), .farthest = vision::kFarthest});
}

vision::FluidKind told(const bench::Logistic& by, const vision::FluidLook& look) {
  const Eigen::VectorXd shares = by.shares(figures_of(look));
  vision::FluidKind kind;
  for (std::size_t k = 0; k < kind.share.size(); ++k) {
    kind.share[k] = shares(static_cast<Eigen::Index>(k));
    if (kind.share[k] > kind.share[static_cast<std::size_t>(kind.best)]) kind.best = static_cast<int>(k);
  }
  return kind;
}

std::string weights_header(const bench::Logistic& fit) {
  const auto four = [&](Eigen::Index column) {
    std::string text;
    for (Eigen::Index k = 0; k < fit.speaks_for.rows(); ++k)
      text += fmt::format("{}{:.4g}", k > 0 ? ", " : "", fit.speaks_for(k, column));
    return "{" + text + "}";
  };
  const Eigen::Index figures = fit.mean.size();
  std::string text = fmt::format(
      R"(// vision/look/kind_weights.h — made by bench_kind FOOTAGE OUTLINES --weights FILE; not edited by hand.
#pragma once

#include <array>
#include <string_view>

namespace freshet::vision {{

struct FigureWeights {{
  std::string_view figure;
  double mean, deviation;            // over what was learned from
  std::array<double, 4> speaks_for;  // water, fire, smoke, clouds; per deviation
}};

inline constexpr std::array<double, 4> kKindOffsets{};
inline constexpr std::array<FigureWeights, {}> kKindWeights{{{{
)",
      four(figures), figures);
  for (Eigen::Index i = 0; i < figures; ++i)
    text += fmt::format("    {{\"{}\", {:.4g}, {:.4g}, {}}},\n",
                        vision::kLookFigures[static_cast<std::size_t>(i)], fit.mean(i), fit.deviation(i),
                        four(i));
  return text + "}};\n\n}  // namespace freshet::vision\n";
}

/// Sums of weights.
struct Count {
  double all = 0, right = 0, sure = 0, sure_right = 0;
  std::array<double, vision::kFluidKinds.size()> as{};
  void add(const vision::FluidKind& kind, bool is_right, double weight) {
    all += weight;
    right += is_right ? weight : 0;
    as[static_cast<std::size_t>(kind.best)] += weight;
    if (!kind.sure()) return;
    sure += weight;
    sure_right += is_right ? weight : 0;
  }
};

struct Command {
  std::string footage, outlines, weights, json;
  bool pictures = false;
};

void run(const Command& command) {
  const std::vector<bench::Outlined> lines = bench::read_outlines(command.outlines);
  const std::vector<Sample> samples = read_samples(lines, command.footage);
  std::set<std::string> scenes;
  for (const bench::Outlined& line : lines)
    if (teaches(line)) scenes.insert(line.scene());
  const std::vector<std::string> left_out(scenes.begin(), scenes.end());
  std::vector<bench::Logistic> without(left_out.size());
  oneapi::tbb::parallel_for(std::size_t{0}, left_out.size(),
                            [&](std::size_t i) { without[i] = learned(lines, samples, left_out[i]); });
  const bench::Logistic whole = learned(lines, samples, "");

  std::map<std::string, Count> counts;
  nlohmann::json rows = nlohmann::json::array();
  std::string stills;
  for (const Sample& sample : samples) {
    const bench::Outlined& line = lines[sample.line];
    const std::string scene = line.scene();
    const auto at = std::ranges::lower_bound(left_out, scene);
    const bool left = at != left_out.end() && *at == scene;
    const vision::FluidKind kind =
        told(left ? without[static_cast<std::size_t>(at - left_out.begin())] : whole, sample.look);
    const bool right = std::ranges::find(line.classes, kind.name()) != line.classes.end();
    const bool counted = teaches(line) && !line.simulated();
    if (counted) counts["varied, left out"].add(kind, right, sample.weight);
    if (!sample.plain) continue;
    const double weight = sample.plain_weight;
    if (counted) {
      counts[line.classes[0]].add(kind, right, weight);
      counts["all left out"].add(kind, right, weight);
    }
    if (line.simulated()) counts["simulated, left out"].add(kind, right, weight);
    if (line.file.starts_with("pictures/") || line.file.starts_with("peers/"))
      counts["pictures"].add(kind, right, weight);
    if (sets_nothing(line)) counts["eight that set nothing"].add(kind, right, weight);
    const std::string is = fmt::format("{}", fmt::join(line.classes, "/"));
    stills += fmt::format("{:<60} {:<12} {:<7} {:.2f} {:<5} {}\n", line.file, is, kind.name(),
                          kind.sureness(), kind.sure() ? "sure" : "",
                          right         ? "right"
                          : kind.sure() ? "WRONG"
                                        : "wrong");
    rows.push_back({{"file", line.file},
                    {"is", is},
                    {"told", kind.name()},
                    {"share", kind.sureness()},
                    {"sure", kind.sure()},
                    {"right", right}});
  }
  if (command.pictures) fmt::print("{}\n", stills);

  fmt::print("{:<24}{:>8}", "is \\ told", "stills");
  for (const char* const kind : vision::kFluidKinds) fmt::print("{:>8}", kind);
  fmt::print("{:>10}{:>10}{:>22}\n", "right %", "sure %", "of the sure right %");
  std::vector<std::string> order(vision::kFluidKinds.begin(), vision::kFluidKinds.end());
  order.insert(order.end(), {"all left out", "varied, left out", "pictures", "simulated, left out",
                             "eight that set nothing"});
  for (const std::string& name : order) {
    const Count& count = counts[name];
    if (count.all == 0) continue;
    fmt::print("{:<24}{:>8.0f}", name, count.all);
    for (const double as : count.as) fmt::print("{:>8.1f}", as);
    fmt::print("{:>10.0f}{:>10.0f}{:>22}\n", 100 * count.right / count.all, 100 * count.sure / count.all,
               count.sure > 0 ? fmt::format("{:.1f}", 100 * count.sure_right / count.sure) : "-");
  }
  double seconds = 0;
  for (const Sample& sample : samples) seconds += sample.seconds;
  fmt::print("\n{:.1f} ms of processor time for the look of a still of at most {} px; {}\n",
             1e3 * seconds / static_cast<double>(samples.size()), kSide,
             bench::to_string(bench::this_machine()));
  if (!command.weights.empty()) std::ofstream(command.weights) << weights_header(whole);
  if (!command.json.empty())
    std::ofstream(command.json)
        << nlohmann::json{{"machine", bench::to_json(bench::this_machine())}, {"stills", rows}}.dump(1)
        << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  Command command;
  bench::Arguments app("Measures whether the class of a fluid is told from its look");
  app.option("FOOTAGE", command.footage, "Folder that OUTLINES names files of").required();
  app.option("OUTLINES", command.outlines, "As bench/kind/outlines.txt").required();
  app.option("--weights", command.weights, "Write the weights here, as vision/look/kind_weights.h");
  app.flag("--pictures", command.pictures, "List each still");
  app.option("--json", command.json, "Write each still's here too");
  app.parse(argc, argv);
  try {
    run(command);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
