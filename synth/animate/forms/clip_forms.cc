#include "synth/animate/forms/clip_forms.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "stored/clip_frames.h"
#include "synth/animate/forms/light_level.h"
#include "synth/sampling/pull_push.h"

namespace freshet::synth::animate {
namespace {

constexpr std::uint32_t kSlab = 16;  // frames that are decoded together
constexpr std::size_t kDarkOf = 32;  // frames that the darkest level is found from
constexpr double kDark = 0.1;        // of them may be darker
constexpr float kNeverDark = 0.42f;  // level: embers and lit logs stay below
constexpr float kSteady = 0.1f,
                kBright = 0.93f;    // levels: what changes less, and is darker, is wax or a lit wall
constexpr std::size_t kBeats = 48;  // frames that tell how much of a clip beats as one
constexpr double kBeatsBy = 3;      // samples that make one of theirs, across and down
constexpr float kFaint = 0.1f;      // of the brightest: what of the mean is no flame

}  // namespace

cv::Mat darkest(const std::vector<cv::Mat>& frames) {
  std::vector<const cv::Mat*> of;
  const std::size_t n = std::min(frames.size(), kDarkOf);
  for (std::size_t i = 0; i < n; ++i) of.push_back(&frames[i * frames.size() / n]);
  const auto rank = static_cast<std::ptrdiff_t>(kDark * static_cast<double>(n));
  const cv::Size size = frames.front().size();
  cv::Mat dark(size, CV_8U), trust(size, CV_32F);
  oneapi::tbb::parallel_for(0, size.height, [&](int y) {
    std::vector<std::uint8_t> values(n);
    for (int x = 0; x < size.width; ++x) {
      for (std::size_t i = 0; i < n; ++i) values[i] = of[i]->at<std::uint8_t>(y, x);
      std::nth_element(values.begin(), values.begin() + rank, values.end());
      const std::uint8_t low = values[rank];
      std::nth_element(values.begin(), values.end() - 1 - rank, values.end());
      const std::uint8_t high = *(values.end() - 1 - rank);
      dark.at<std::uint8_t>(y, x) = low;
      const bool stands = high - low < 255 * kSteady && low < 255 * kBright;
      trust.at<float>(y, x) = low < 255 * kNeverDark || stands ? 1.0f : 0.0f;
    }
  });
  if (cv::countNonZero(trust) == trust.size().area()) return dark;
  cv::erode(trust, trust, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
  if (cv::countNonZero(trust) == 0) return cv::Mat::zeros(size, CV_8U);
  cv::Mat values, guess;
  dark.convertTo(values, CV_32F);
  sampling::pull_push(values, trust).convertTo(guess, CV_8U);
  return cv::min(dark, guess);
}

double beats_as_one(const std::vector<cv::Mat>& levels) {
  const std::size_t n = std::min(levels.size(), kBeats);
  cv::Mat rows, reduced;
  for (std::size_t i = 0; i < n; ++i) {
    cv::resize(levels[i * levels.size() / n], reduced, {}, 1 / kBeatsBy, 1 / kBeatsBy, cv::INTER_AREA);
    cv::Mat row;
    reduced.reshape(1, 1).convertTo(row, CV_32F);
    rows.push_back(row);
  }
  cv::Mat mean, products, shares;
  cv::reduce(rows, mean, 0, cv::REDUCE_AVG);
  for (int i = 0; i < rows.rows; ++i) rows.row(i) -= mean;
  cv::mulTransposed(rows, products, false);
  cv::eigen(products, shares);
  const double all = cv::sum(cv::max(shares, 0.0))[0];
  return all > 0 ? shares.at<float>(0) / all : 0;
}

ClipForms clip_forms(const store::Snapshot& snapshot, store::ClipId clip, std::uint32_t most) {
  const stored::ClipFrames frames(snapshot, clip);
  ClipForms forms{.clip = clip,
                  .source = {frames.layout().width, frames.layout().height},
                  .fps = static_cast<double>(snapshot.clip(clip).fps_num) /
                         static_cast<double>(snapshot.clip(clip).fps_den),
                  .by = 1,
                  .levels = {},
                  .mean = {},
                  .as_one = 0,
                  .seats = {}};
  forms.by =
      std::max(1.0, std::max(forms.source.width, forms.source.height) / static_cast<double>(kFormSamples));
  const cv::Size size(std::max(1, static_cast<int>(std::lround(forms.source.width / forms.by))),
                      std::max(1, static_cast<int>(std::lround(forms.source.height / forms.by))));
  const std::uint32_t count = std::min(frames.size(), most);
  forms.levels.resize(count);
  for (std::uint32_t first = 0; first < count; first += kSlab) {
    const std::vector<cv::Mat> slab = frames.read_luma(first, std::min(kSlab, count - first));
    oneapi::tbb::parallel_for(std::size_t{0}, slab.size(), [&](std::size_t i) {
      cv::resize(slab[i], forms.levels[first + i], size, 0, 0, cv::INTER_AREA);
    });
  }
  const cv::Mat dark = darkest(forms.levels);
  cv::Mat sum = cv::Mat::zeros(size, CV_32F);
  for (cv::Mat& level : forms.levels)
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        std::uint8_t& at = level.at<std::uint8_t>(y, x);
        const float light = light_of(at / 255.0f) - kLit * light_of(dark.at<std::uint8_t>(y, x) / 255.0f);
        sum.at<float>(y, x) += std::max(light, 0.0f);
        at = cv::saturate_cast<std::uint8_t>(255 * level_of(light));
      }
  forms.mean = level_of(sum / static_cast<double>(count));
  double brightest = 0;
  cv::minMaxLoc(forms.mean, nullptr, &brightest);
  forms.mean.setTo(0, forms.mean < kFaint * brightest);
  forms.as_one = beats_as_one(forms.levels);
  forms.seats = seats_of(forms.mean);
  if (forms.seats.size() > 1) forms.seats.push_back(together(forms.seats, size.width));
  return forms;
}

}  // namespace freshet::synth::animate
