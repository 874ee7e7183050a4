// synth/animate/carried/innovations.h — what the patches' pixels add to the carried picture: detail that comes anew,
// and how light a place is.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/animate/carried/renewal.h"
#include "synth/animate/carried/shared_levels.h"
#include "synth/animate/frames/animation.h"
#include "synth/animate/frames/clip_batches.h"
#include "synth/animate/frames/pieces_canvas.h"
#include "synth/animate/motion/carrying_field.h"

namespace freshet::synth::animate {

struct InnovationOptions {
  /// Where pieces overlap.
  BlendWeights weights = BlendWeights::kVariance;
  double low_band_reach = 3;  // pieces: sigma of the neighbourhood that shares how light it is (SharedLevels)
  RenewalOptions renewal{};
};

/// The clips' innovations of one animation, merged at half the picture's size and carried on from frame to frame.
class Innovations {
 public:
  /// luma   of the picture. animation and what it views outlive this.
  Innovations(Animation& animation, const cv::Mat& luma, Resampling resampling,
              const InnovationOptions& options);
  Innovations(const Innovations&) = delete;
  Innovations& operator=(const Innovations&) = delete;

  /// Measures all clips, and adds how they move. First.
  void measure(MotionSums& motion);
  /// Of all detail's variance, what comes anew in a frame, 0..1.
  double overall() const { return renewal_.overall(); }
  /// By level of the picture, the fraction of its variance that is left for them; `begun` of it, 0..1.
  std::vector<double> shares(int levels, double begun) const;
  /// Where how much may come anew: `lively` (CV_32F, 0..1, every `step` px) times what each place renews. Before
  /// frames.
  cv::Mat restrict_to(const cv::Mat& lively, int step);

  int batch() const { return batches_.batch(); }
  void read(std::span<const int> outputs) { batches_.read(outputs); }
  /// The innovations of successive frames.
  void advance(std::span<const int> outputs, const CarryingField& field);
  /// How much lighter than usual the patches are in a frame, on the canvas, luma. Safe from many threads.
  cv::Mat level(int output) const { return levels_.at(output); }
  cv::Mat level_here(int output) const { return levels_.here(output); }
  /// After measure(), before liveliest_level().
  void settle_levels() { levels_.settle(); }
  /// Of the liveliest around each place (SharedLevels). deviation: at most, luma.
  cv::Mat liveliest_level(int output, double deviation) const { return levels_.liveliest(output, deviation); }
  /// Adds a frame's detail, and this level, to its luma; once for each that was advanced to and is wanted. begun: of
  /// their share, 0..1. Safe from many threads.
  void add(int output, double begun, const cv::Mat& level, cv::Mat& luma);
  /// Adds what lies on the canvas to a picture.
  void add_level(const cv::Mat& level, cv::Mat& luma) const;

 private:
  Animation& animation_;
  const Placement placement_;  // at half the size
  const PiecesCanvas canvas_;
  ClipBatches batches_;
  Renewal renewal_;
  SharedLevels levels_;
  std::vector<cv::Mat> counts_;  // on the canvas, for Renewal::show
  std::vector<cv::Mat> advanced_;
  int first_ = 0;  // the output frame of the first of them
};

/// A picture has one light: what goes beyond `most` is a clip's flash, or a puff that crosses it. CV_32F, luma.
cv::Mat limited(const cv::Mat& level, double most);

}  // namespace freshet::synth::animate
