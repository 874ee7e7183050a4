// synth/animate/forms/tongues.h — flames of one tongue each, as a candle's, and how such a flame moves as a whole.
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/animate/forms/clip_forms.h"

namespace freshet::synth::animate {

/// How a tongue stands at a moment, of its own height: its axis goes aside by lean * up + bow * up^2, where `up` is 0
/// at its foot and 1 at its tip; it is `stretch` times as high as usual.
struct Sway {
  double lean = 0, bow = 0, stretch = 1;
};

struct Tongue {
  cv::Rect box;   // px: as far as it may sway
  cv::Mat share;  // CV_32F, 0..1, of the box: of the picture's light, what is this tongue's
  double foot = 0,
         height = 0;  // px: the row that it stands on, from the box's top, and how far above it ends
};

/// Flames that are smooth, upright and of one piece: of what is lighter than .1, .2, .35, .5 or .7, a part that, less
/// what is thin (a rim that crosses it), fills kSolid of its convex hull, is kSlender times as long as wide, has no
/// texture inside, and a tenth of all light. Each has its own glow too, as far as it is wide, or halfway to what else
/// burns. Cost: some passes over the picture for each part.
/// level  CV_32F, 0..1, of the picture.
std::vector<Tongue> tongues_of(const cv::Mat& level);
inline constexpr double kSolid = 0.85, kSlender = 1.45;

/// What tongues have of all light, 0..1, less what they light below their foot: what shines there, in their box, as
/// smoothly as they do (wax, the ground).
/// level  CV_32F, 0..1, of the picture.
double share_of_light(const std::vector<Tongue>& tongues, const cv::Mat& level);

/// The light of a tongue that sways.
/// light    CV_32F of any channels, of the box: what is the tongue's.
/// Returns  of its size and type; where nothing comes from, 0.
cv::Mat swayed(const cv::Mat& light, const Tongue& tongue, const Sway& sway);

/// How one clip's flame swayed. Beyond its end it goes back as it came.
struct TongueCourse {
  store::ClipId clip{};
  double fps = 25;          // sways a second
  std::vector<Sway> sways;  // by frame
  double tongue = 0;        // of the clip's frames, 0..1, those with a flame of one tongue
  Sway at(double seconds) const;
  /// Of its height a second: how far lean, bow and stretch change from frame to frame, together.
  double unrest() const;
  /// Heights a second: how fast its body goes, mean over frames and between foot and tip.
  double speed() const;
};

/// As one flame sways tells little of how much another does: the same course, its sways so much wider or narrower that
/// it is, by octaves, halfway as restless as flames usually are. Within the bounds of course_of.
TongueCourse halfway_to_usual(TongueCourse course);
inline constexpr double kUsualUnrest = 0.9;  // heights a second: two candles' geometric mean (.26 and 3.3)

/// The same course, its sways scaled until speed() is this, heights a second, 0 and more; within the bounds of
/// course_of, beyond which one in twenty may be cut off. Faster than that the course is gone through more quickly, up
/// to kQuickest times. A course at rest is returned as it is.
TongueCourse as_fast_as(TongueCourse course, double speed);
inline constexpr double kQuickest = 2;  // four times loses a third of the way between frames of a film

/// Of the clip's largest flame, frame by frame, about its median: axis by least squares over rows, by their light;
/// height where all but a fortieth of it is below. Leans are cut off at kMostSway, heights at .6 and 1.6.
/// None where nothing shines.
std::optional<TongueCourse> course_of(const ClipForms& forms);
inline constexpr double kMostSway = 0.35;

}  // namespace freshet::synth::animate
