#include "synth/animate/carried/innovations.h"

#include <cmath>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

#include "synth/animate/frames/enlarge.h"

namespace freshet::synth::animate {
namespace {

BlendOptions blend_options(const InnovationOptions& options) {
  return {.weights = options.weights, .low_band = LowBand::kRemove};
}

}  // namespace

Innovations::Innovations(Animation& animation, const cv::Mat& luma, Resampling resampling,
                         const InnovationOptions& options)
    : animation_(animation),
      placement_(halved(animation.placement)),
      canvas_(placement_, animation.picture.size()),
      batches_(animation, placement_, resampling, ClipDetail::kInnovation, blend_options(options)),
      renewal_(placement_, canvas_, luma, batches_.blender(), animation.options.fps, options.renewal),
      levels_(placement_, animation.options.frames, options.low_band_reach) {}

void Innovations::measure(MotionSums& motion) {
  // They are carried on from frame to frame, and nothing comes back from frames behind the last wanted.
  batches_.begin(animation_.options.end(), false, [&](ClipLayer& layer, std::span<const int> kept) {
    // Before all frames are held: it needs the samples alone, and what it holds is kept for the next step.
    renewal_.measure(layer, batches_.samples());
    layer.measure(kept);
    layer.each_level([&](std::size_t patch, int output, float level) { levels_.set(patch, output, level); });
    add_motion(animation_, layer, motion);
  });
  renewal_.settle();
}

std::vector<double> Innovations::shares(int levels, double begun) const {
  std::vector<double> shares;
  for (int level = 0; level < levels; ++level) shares.push_back(begun * renewal_.share_of_picture(level));
  return shares;
}

cv::Mat Innovations::restrict_to(const cv::Mat& lively, int step) {
  cv::Mat on_canvas = canvas_.cut_samples(lively, step);
  cv::multiply(on_canvas, renewal_.places(), on_canvas);
  counts_ = Renewal::counts_of(on_canvas);
  return lively.mul(canvas_.sampled(renewal_.places(), step, lively.size()));
}

void Innovations::advance(std::span<const int> outputs, const CarryingField& field) {
  Blender& blender = batches_.blender();
  first_ = outputs.front();
  advanced_.assign(outputs.size(), {});
  oneapi::tbb::parallel_for(std::size_t{0}, outputs.size(), [&](std::size_t i) {
    advanced_[i] = blender.take_detail(batches_.slot(outputs[i]));
  });
  for (std::size_t i = 0; i < outputs.size(); ++i)
    advanced_[i] = renewal_.advance(field.at(outputs[i] - 1), field.step(), advanced_[i]);
}

void Innovations::add(int output, double begun, const cv::Mat& level, cv::Mat& luma) {
  cv::Mat field = std::move(advanced_[static_cast<std::size_t>(output - first_)]);
  renewal_.show(field, luma, begun, counts_);
  cv::scaleAdd(level, begun, field, field);
  add_level(field, luma);
}

void Innovations::add_level(const cv::Mat& level, cv::Mat& luma) const {
  add_enlarged(level, canvas_.rect(), canvas_.scale(), luma);
}

cv::Mat limited(const cv::Mat& level, double most) {
  cv::Mat out(level.size(), CV_32F);
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x)
      out.at<float>(y, x) =
          static_cast<float>(most) * std::tanh(level.at<float>(y, x) / static_cast<float>(most));
  return out;
}

}  // namespace freshet::synth::animate
