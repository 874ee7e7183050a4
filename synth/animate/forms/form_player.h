// synth/animate/forms/form_player.h — a chosen form as it burns, moment by moment, where it lies in the picture.
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "stored/decoded_tiles.h"
#include "synth/animate/clips/clip_luma.h"
#include "synth/animate/forms/form_choice.h"
#include "synth/playing/timeline.h"

namespace freshet::synth::animate {

struct FormPlaying {
  int frames = 96;
  double fps = 25;
  double speed = 1;  // clip seconds per second of the animation
};

/// True when the clip can be played from there for so long: it is long enough, or has a loop rule.
bool plays(const store::Snapshot& snapshot, store::ClipId clip, std::uint32_t first,
           const FormPlaying& playing);

/// Moments 0 .. frames, one more than there are frames: a loop leads to it. Where the clip ends it goes on by its loop
/// rule, and one moment's flames thin out as the other's grow.
class FormPlayer {
 public:
  /// flow_step, tiles  as ClipLuma. Throws as timeline.
  FormPlayer(const store::Snapshot& snapshot, store::ClipId clip, int flow_step, const ChosenForm& form,
             const FormPlaying& playing, stored::DecodedTiles* tiles);

  /// Px of the picture, may reach beyond it.
  const cv::Rect& rect() const { return rect_; }
  /// Reads what these moments need, and lets all else go.
  void load(const std::vector<int>& moments);
  /// The level of the clip's light at a loaded moment, CV_32F, of rect(). Flames that the clip's frame cuts thin out
  /// before its sides. Safe from many threads.
  cv::Mat level(int moment) const;

 private:
  cv::Mat level_at(double at) const;

  cv::Rect from_, rect_;
  bool mirrored_ = false;
  std::vector<playing::Moment> moments_;
  std::uint32_t last_flow_ = 0;
  ClipLuma luma_;
  cv::Mat dark_, gone_;  // CV_32F: light of the clip's ground, of from_; by rect(), what level thins away
};

}  // namespace freshet::synth::animate
