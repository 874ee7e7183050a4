// synth/animate/carried/renewal.h — what comes anew: the patches' innovations, in the share of the picture's contrast
// that is theirs.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/animate/blend/blend.h"
#include "synth/animate/clips/clip_layer.h"
#include "synth/animate/frames/pieces_canvas.h"
#include "synth/animate/motion/carried_detail.h"

namespace freshet::synth::animate {

struct RenewalOptions {
  /// Of what comes anew in the patches from frame to frame, how much does so in the picture, 0..1.
  double share = 1;
  /// An innovation is not amplified by more: what is fainter is coding noise.
  double max_gain = 4;
  /// Of what has come anew; > 0. Real fountains, brooks and fires lose a fifth to two fifths of all detail from a frame
  /// to the next, beside what lives on. With .05 s in place of lives as long as the carried picture's (.1 to 1 s), six
  /// clips came from 5.3 to 4.7 dB of the footage's spectrum, contrast and structure as before.
  double half_life_s = 0.05;
};

/// Innovations go into a Blender piece by piece, scaled to the still's contrast; merged, they are carried on along the
/// motion until they have died away; shown, they get their share of what the frame has where they lie.
///
/// The share is the patches' own. Where a part x of detail of power P dies away as innovations do here, by k from frame
/// to frame, and the rest goes along, the frame less the mean of its neighbours, brought to it, has (3/2 - 2 k + k^2 /
/// 2) x P.
class Renewal {
 public:
  static constexpr int kLevels = 4;  // of the canvas, which has half the picture's size

  /// luma     of the picture, CV_32F, 0..1.
  /// fps      of the animation.
  /// blender  takes the innovations; outlives this, as `canvas` does.
  Renewal(const Placement& placement, const PiecesCanvas& canvas, const cv::Mat& luma, Blender& blender,
          double fps, const RenewalOptions& options);

  /// How much comes anew in a clip's patches; what they bring from now on is scaled to it. samples: output frames by
  /// which it is judged.
  void measure(ClipLayer& layer, std::span<const int> samples);
  /// After every clip's measure(), before what follows: shares of levels, and of places.
  void settle();

  /// Of a band's variance, what comes anew, all pieces together.
  double share(std::size_t level) const { return shares_[std::min(level, shares_.size() - 1)]; }
  /// The same of the whole picture's bands, between those of the canvas; nothing of what is finer.
  double share_of_picture(int level) const;
  /// Of all detail's variance.
  double overall() const { return overall_; }
  /// The canvas, CV_32F: how much more than all pieces together a place renews, >= 0; times any level's share < 1.
  const cv::Mat& places() const { return places_; }

  /// The next frame's, all threads. displacement: from the frame before, every `step` px. fresh: of the blender.
  cv::Mat advance(const cv::Mat& displacement, int step, const cv::Mat& fresh);
  /// How much is renewed where, for show(). where: on the canvas, >= 0.
  static std::vector<cv::Mat> counts_of(const cv::Mat& where);
  /// What is shown of a frame's detail, changed in place: where there is detail in `luma` (the frame's, the picture's
  /// size). What lies smooth between edges stays smooth. begun: of its share, 0..1. Safe from many threads.
  void show(cv::Mat& detail, const cv::Mat& luma, double begun, std::span<const cv::Mat> counts) const;

 private:
  std::vector<double> anew_of(const ClipLayer::DetailPower& power) const;

  const Placement& placement_;
  const PiecesCanvas& canvas_;
  Blender& blender_;
  RenewalOptions options_;
  double kept_ = 0;                         // from one frame to the next
  std::vector<std::vector<double>> power_;  // of the still, by patch, band
  std::vector<std::vector<double>> anew_;   // of the patches, 0..1, by patch, band
  std::vector<double> shares_{0};           // by band
  double overall_ = 0;
  cv::Mat places_;
  CarriedDetail carried_;
};

}  // namespace freshet::synth::animate
