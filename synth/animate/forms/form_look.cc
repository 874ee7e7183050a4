#include "synth/animate/forms/form_look.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "synth/animate/forms/light_level.h"
#include "synth/animate/still/colour_model.h"

namespace freshet::synth::animate {
namespace {

constexpr float kFaint = 0.08f;             // of the brightest: below it is glow, and goes in proportion
constexpr std::size_t kLeastSamples = 150;  // px that a height needs for a map of its own
constexpr int kQuantiles = 32;
constexpr double kMostGain = 2.5;
constexpr double kSmooth = 5;  // steps

}  // namespace

float brightest(std::vector<float> levels) {
  if (levels.empty()) return 0;
  const auto at = levels.begin() + static_cast<std::ptrdiff_t>(levels.size() * 99 / 100);
  std::nth_element(levels.begin(), at, levels.end());
  return *at;
}

LevelMaps::LevelMaps(const cv::Mat& still, std::span<const cv::Mat> forms, double top, double bed)
    : top_(top), bed_(std::max(bed, top + 1)) {
  // By height, and of all of them together, last.
  std::array<std::vector<float>, kHeights + 1> wanted, given;
  const auto collect = [&](const cv::Mat& level, auto& into) {
    for (int y = 0; y < level.rows; ++y) {
      const double place = std::clamp((y - top_) / (bed_ - top_), 0.0, 1.0) * kHeights;
      const int height = std::min(kHeights - 1, static_cast<int>(place));
      for (int x = 0; x < level.cols; ++x) {
        const float at = level.at<float>(y, x);
        if (at <= 0.02f) continue;
        into[height].push_back(at);
        into[kHeights].push_back(at);
      }
    }
  };
  collect(still, wanted);
  for (const cv::Mat& form : forms) collect(form, given);
  const float still_top = brightest(wanted[kHeights]), form_top = brightest(given[kHeights]);
  const auto map_of = [&](std::vector<float> to, std::vector<float> from) -> std::optional<Map> {
    std::erase_if(to, [&](float at) { return at < kFaint * still_top; });
    std::erase_if(from, [&](float at) { return at < kFaint * form_top; });
    if (to.size() < kLeastSamples || from.size() < kLeastSamples) return std::nullopt;
    std::sort(to.begin(), to.end());
    std::sort(from.begin(), from.end());
    cv::Mat line(1, kSteps + 1, CV_32F);
    std::vector<std::pair<float, float>> nodes{{0.0f, 0.0f}, {kFaint * form_top, kFaint * still_top}};
    for (int q = 1; q <= kQuantiles; ++q) {
      const auto of = [&](const std::vector<float>& sorted) {
        return sorted[std::min(sorted.size() - 1, sorted.size() * static_cast<std::size_t>(q) / kQuantiles)];
      };
      if (of(from) > nodes.back().first + 1e-4f)
        nodes.emplace_back(of(from), std::max(of(to), nodes.back().second));
    }
    const float proportion = to[to.size() * 9 / 10] / from[from.size() * 9 / 10];
    std::size_t node = 0;
    for (int i = 0; i <= kSteps; ++i) {
      const float x = static_cast<float>(i) / kSteps;
      while (node + 1 < nodes.size() && nodes[node + 1].first < x) ++node;
      float y = nodes.back().second;
      if (node + 1 < nodes.size()) {
        const auto& [x0, y0] = nodes[node];
        const auto& [x1, y1] = nodes[node + 1];
        y = y0 + (x - x0) / (x1 - x0) * (y1 - y0);
      }
      // Half of it in proportion: what flames have of light and dark inside them is their own.
      const float even = std::min(1.0f, x * proportion);
      line.at<float>(i) = std::min(0.5f * (y + even), static_cast<float>(kMostGain) * x);
    }
    cv::GaussianBlur(line, line, {0, 1}, kSmooth, 0, cv::BORDER_REPLICATE);
    Map map;
    for (int i = 0; i <= kSteps; ++i)
      map[i] = line.at<float>(i) * std::min(1.0f, static_cast<float>(i) / static_cast<float>(2 * kSmooth));
    return map;
  };
  Map same;
  for (int i = 0; i <= kSteps; ++i) same[i] = static_cast<float>(i) / kSteps;
  const Map all = map_of(wanted[kHeights], given[kHeights]).value_or(same);
  for (int height = 0; height < kHeights; ++height) {
    maps_[height] = all;
    // Half of it: a form is not to change its brightness too much as it goes up.
    if (const std::optional<Map> own = map_of(wanted[height], given[height]))
      for (int i = 0; i <= kSteps; ++i) maps_[height][i] = 0.5f * (all[i] + (*own)[i]);
  }
}

void LevelMaps::apply(cv::Mat& level) const {
  Map map;
  for (int y = 0; y < level.rows; ++y) {
    const double place = std::clamp((y - top_) / (bed_ - top_) * kHeights - 0.5, 0.0, kHeights - 1.0);
    const int above = std::min(kHeights - 2, static_cast<int>(place));
    const auto share = static_cast<float>(place - above);
    for (int i = 0; i <= kSteps; ++i)
      map[i] = maps_[above][i] + share * (maps_[above + 1][i] - maps_[above][i]);
    auto* row = level.ptr<float>(y);
    for (int x = 0; x < level.cols; ++x) {
      const float at = std::clamp(row[x], 0.0f, 1.0f) * kSteps;
      const int below = std::min(kSteps - 1, static_cast<int>(at));
      row[x] = map[below] + (at - static_cast<float>(below)) * (map[below + 1] - map[below]);
    }
  }
}

namespace {

/// Of the level's variance, what is finer than some 4 px.
double fineness(const cv::Mat& level) {
  cv::Mat coarse;
  cv::GaussianBlur(level, coarse, {}, 1.5);
  const double fine = cv::norm(level - coarse, cv::NORM_L2SQR), all = cv::norm(level, cv::NORM_L2SQR);
  return all > 0 ? fine / all : 0;
}

}  // namespace

double softness(const cv::Mat& still, std::span<const cv::Mat> forms) {
  const double wanted = fineness(still);
  if (wanted <= 0) return 0;
  for (const double sigma : {0.0, 0.4, 0.6, 0.8, 1.0, 1.3, 1.6, 2.0, 2.5}) {
    double given = 0;
    for (const cv::Mat& form : forms) {
      cv::Mat soft;
      if (sigma > 0)
        cv::GaussianBlur(form, soft, {}, sigma);
      else
        soft = form;
      given += fineness(soft) / static_cast<double>(forms.size());
    }
    if (given <= wanted) return sigma;
  }
  return 2.5;
}

LightColours::LightColours(const cv::Mat& light, const cv::Mat& level) {
  cv::Mat count = cv::Mat::zeros(1, kSteps + 1, CV_64F), sums = cv::Mat::zeros(1, kSteps + 1, CV_64FC3);
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x) {
      const float at = level.at<float>(y, x);
      if (at <= 0.02f) continue;
      const cv::Vec3f l = light.at<cv::Vec3f>(y, x);
      const float luma = luma_of(l);
      const int step = std::clamp(cvRound(kSteps * level_of(luma)), 0, kSteps);
      // A pixel that is half flame tells half of its colour.
      const double weight = at / std::max(level_of(luma), 0.02f);
      count.at<double>(step) += weight;
      sums.at<cv::Vec3d>(step) += weight * cv::Vec3d(l);
    }
  constexpr double kSmooth = 4;
  cv::GaussianBlur(count, count, {0, 1}, kSmooth, 0, cv::BORDER_CONSTANT);
  cv::GaussianBlur(sums, sums, {0, 1}, kSmooth, 0, cv::BORDER_CONSTANT);
  const double least = 1e-4 * cv::sum(count)[0] + 1e-9;
  std::vector<int> known;
  for (int step = 0; step <= kSteps; ++step)
    if (count.at<double>(step) > least) known.push_back(step);
  for (int step = 0; step <= kSteps + 1 && !known.empty(); ++step) {
    const int nearest = *std::min_element(
        known.begin(), known.end(), [step](int a, int b) { return std::abs(a - step) < std::abs(b - step); });
    const cv::Vec3d colour = sums.at<cv::Vec3d>(nearest) / count.at<double>(nearest);
    const double luma = kBlueLuma * colour[0] + kGreenLuma * colour[1] + kRedLuma * colour[2];
    const double wanted = light_of(std::min(1.0f, static_cast<float>(step) / kSteps));
    colours_[step] = cv::Vec3f(colour * (luma > 0 ? wanted / luma : 0.0));
  }
}

}  // namespace freshet::synth::animate
