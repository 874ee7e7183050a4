// synth/animate/renewal.h — what comes anew: the patches' innovations, in the share of the picture's contrast that
// is theirs.
#pragma once

#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/animate/blend/blend.h"
#include "synth/animate/clips/clip_layer.h"
#include "synth/animate/motion/carried_detail.h"
#include "synth/animate/pieces_canvas.h"

namespace freshet::synth::animate {

struct RenewalOptions {
  /// Of each band's variance, how much comes anew, 0..1; the rest is the picture's own. Of the finest band a third of
  /// that, of the next two thirds: what flow does not explain of the finest detail is mostly the clip's noise, and with
  /// .4 of all bands rapids looked like sandpaper.
  double share = 0.25;
  /// An innovation is not amplified by more: what is fainter is coding noise.
  double max_gain = 4;
  /// Of what has come anew; > 0. Real fountains, brooks and fires lose a fifth to two fifths of all detail from a frame to
  /// the next, beside what lives on. With .05 s in place of lives as long as the carried picture's (.1 to 1 s), six clips
  /// came from 5.3 to 4.7 dB of the footage's spectrum, contrast and structure as before: a rain puddle from 9.7 to 6.9,
  /// smoke before a light from 4.0 to 3.5; a cumulus went from 3.6 to 3.9, and a fast chimney from 3.0 to 4.9.
  double half_life_s = 0.05;
  double fps = 25;
};

/// Innovations go into a Blender piece by piece, scaled to the still's contrast; merged, they are carried on along the
/// motion until they have died away; shown, they get their share of what the frame has where they lie.
class Renewal {
 public:
  static constexpr int kLevels = 5;

  /// luma     of the picture, CV_32F, 0..1.
  /// blender  takes the innovations; outlives this, as `canvas` does.
  Renewal(const Placement& placement, const PiecesCanvas& canvas, const cv::Mat& luma, Blender& blender,
          const RenewalOptions& options);

  /// What a clip's patches bring from now on is scaled. samples: output frames by which its power is judged.
  void scale(ClipLayer& layer, std::span<const int> samples);
  /// Of a band's variance, what comes anew.
  double share(std::size_t level) const;
  /// The next frame's, all threads. displacement: from the frame before, every `step` px. fresh: of the blender.
  cv::Mat advance(const cv::Mat& displacement, int step, const cv::Mat& fresh);
  /// What is shown of a frame's detail, changed in place: where there is detail in `luma` (the frame's, the picture's
  /// size). What lies smooth between edges stays smooth. where: on the canvas, 0..1. Safe from many threads.
  void show(cv::Mat& detail, const cv::Mat& luma, std::span<const double> shares, const cv::Mat& where) const;

 private:
  const PiecesCanvas& canvas_;
  Blender& blender_;
  RenewalOptions options_;
  double kept_ = 0;                         // from one frame to the next
  std::vector<std::vector<double>> power_;  // of the still, by patch, band
  CarriedDetail carried_;
};

}  // namespace freshet::synth::animate
