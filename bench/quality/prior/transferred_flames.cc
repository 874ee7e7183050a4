#include "bench/quality/prior/transferred_flames.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "bench/quality/prior/begun_transfer.h"
#include "freshet/error.h"
#include "synth/animate/forms/form_look.h"
#include "synth/animate/forms/forms_plan.h"
#include "synth/animate/forms/light_level.h"
#include "vision/flow.h"

namespace freshet::bench {
namespace {

using namespace synth::animate;
using synth::transfer::ExemplarFrame;
using synth::transfer::TransferOptions;

constexpr int kSampled = 12;  // moments that levels are matched by
constexpr int kBatch = 16;    // frames that are decoded together
constexpr double kBrightest = 0.99,
                 kWhole = 0.5;  // from this share of the brightest on a flame hides what is behind

/// A plane where a rectangle, which may reach beyond it, shows it; 0 outside.
cv::Mat in_rect(const cv::Mat& plane, const cv::Rect& rect) {
  cv::Mat out = cv::Mat::zeros(rect.size(), plane.type());
  const cv::Rect both = rect & cv::Rect({}, plane.size());
  if (!both.empty()) plane(both).copyTo(out(both - rect.tl()));
  return out;
}

LevelMaps maps_of(const PartedStill& still, const ChosenForm& form, FormPlayer& player, int frames) {
  std::vector<int> moments;
  for (int i = 0; i < kSampled; ++i) moments.push_back(i * frames / kSampled);
  player.load(moments);
  std::vector<cv::Mat> levels(moments.size());
  oneapi::tbb::parallel_for(std::size_t{0}, levels.size(),
                            [&](std::size_t i) { levels[i] = player.level(moments[i]); });
  const cv::Rect& rect = player.rect();
  return {in_rect(still.level, rect), levels, form.seat.top - rect.y, form.seat.bed - rect.y};
}

/// The level from which on flames are opaque.
float opaque_from(const cv::Mat& level) {
  std::vector<float> shining;
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x)
      if (const float at = level.at<float>(y, x); at > 0) shining.push_back(at);
  if (shining.empty()) throw Error(ErrorKind::kInput, "the still", "it has no flames to transfer");
  const auto brightest =
      shining.begin() + static_cast<std::ptrdiff_t>(kBrightest * static_cast<double>(shining.size()));
  std::nth_element(shining.begin(), brightest, shining.end());
  return static_cast<float>(kWhole) * *brightest;
}

cv::Mat opacity_of(const cv::Mat& level, float opaque) { return cv::min(level / opaque, 1.0); }

/// Premultiplied, its colours are the levels of the light.
cv::Mat exemplar_of(const PartedStill& parted, float opaque) {
  const cv::Mat alpha = opacity_of(parted.level, opaque);
  cv::Mat bgra(alpha.size(), CV_32FC4);
  for (int y = 0; y < bgra.rows; ++y)
    for (int x = 0; x < bgra.cols; ++x) {
      const float a = alpha.at<float>(y, x);
      const cv::Vec3f light = parted.light.at<cv::Vec3f>(y, x);
      cv::Vec4f& to = bgra.at<cv::Vec4f>(y, x);
      for (int c = 0; c < 3; ++c)
        to[c] = a > 0 ? std::min(1.0f, level_of(std::max(light[c], 0.0f)) / a) : 0.0f;
      to[3] = a;
    }
  return bgra;
}

/// px from one level to the next; what is dark in both stands.
cv::Mat flow_between(const cv::Mat& from, const cv::Mat& to) {
  cv::Mat first, second;
  from.convertTo(first, CV_8U, 255);
  to.convertTo(second, CV_8U, 255);
  cv::Mat flow = vision::optical_flow(first, second);
  flow.setTo(cv::Scalar::all(0), cv::max(first, second) == 0);
  return flow;
}

/// Flames as light over the ground, in the still's matte.
cv::Mat lit(const cv::Mat& still, const cv::Mat& matte, const PartedStill& parted, const cv::Mat& bgra) {
  cv::Mat frame = still.clone();
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x) {
      const float share = static_cast<float>(matte.at<std::uint8_t>(y, x)) / 255.0f;
      if (share == 0) continue;
      const cv::Vec4f flame = bgra.at<cv::Vec4f>(y, x);
      const cv::Vec3f ground = parted.ground.at<cv::Vec3f>(y, x);
      cv::Vec3b& shown = frame.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) {
        const float code = 255 * level_of(ground[c] + light_of(flame[3] * flame[c]));
        shown[c] = cv::saturate_cast<std::uint8_t>(static_cast<float>(shown[c]) * (1 - share) + share * code);
      }
    }
  return frame;
}

}  // namespace

FlameDesign design_of_flames(const store::Snapshot& snapshot, int flow_step, const cv::Mat& picture,
                             const cv::Mat& alpha, std::span<const store::ClipId> clips, int frames,
                             double fps) {
  const FormsPlan plan = plan_forms(snapshot, flow_step, picture, alpha, clips,
                                    {.frames = frames, .fps = fps, .speed = 1}, nullptr);
  if (plan.forms.empty()) throw Error(ErrorKind::kInput, "flames of clips", plan.lack);
  FlameDesign design{.still = plan.still, .levels = {}, .clips = plan.clips, .fit = plan.fit};
  for (int t = 0; t <= frames; ++t) design.levels.push_back(cv::Mat::zeros(picture.size(), CV_32F));
  for (std::size_t f = 0; f < plan.forms.size(); ++f) {
    FormPlayer& player = *plan.players[f];
    const LevelMaps maps = maps_of(plan.still, plan.forms[f], player, frames);
    const cv::Rect& rect = player.rect();
    const cv::Rect both = rect & cv::Rect({}, picture.size());
    if (both.empty()) continue;
    for (int first = 0; first <= frames; first += kBatch) {
      std::vector<int> moments(static_cast<std::size_t>(std::min(kBatch, frames + 1 - first)));
      std::iota(moments.begin(), moments.end(), first);
      player.load(moments);
      oneapi::tbb::parallel_for(std::size_t{0}, moments.size(), [&](std::size_t i) {
        cv::Mat level = player.level(moments[i]);
        maps.apply(level);
        cv::Mat shown = design.levels[static_cast<std::size_t>(moments[i])](both);
        cv::max(shown, level(both - rect.tl()), shown);
      });
    }
  }
  return design;
}

std::vector<cv::Mat> transfer_flames(const cv::Mat& still, const cv::Mat& matte, const PartedStill& parted,
                                     std::span<const cv::Mat> levels) {
  CV_Assert(levels.size() >= 2);
  const TransferOptions options;
  const float opaque = opaque_from(parted.level);
  const cv::Mat exemplar = exemplar_of(parted, opaque);
  const std::size_t frames = levels.size() - 1;
  std::vector<cv::Mat> flow(frames);
  oneapi::tbb::parallel_for(std::size_t{0}, frames, [&](std::size_t t) {
    flow[t] = flow_between(t == 0 ? parted.level : levels[t], levels[t + 1]);
  });
  synth::transfer::Transfer transfer([&](int) { return ExemplarFrame{exemplar}; }, options);
  begin_with_still(exemplar, flow[0], options, transfer);
  std::vector<cv::Mat> made{still.clone()};
  for (std::size_t t = 1; t < frames; ++t)
    made.push_back(lit(still, matte, parted,
                       transfer.next({.alpha = opacity_of(levels[t], opaque), .flow = flow[t]}).bgra));
  return made;
}

}  // namespace freshet::bench
