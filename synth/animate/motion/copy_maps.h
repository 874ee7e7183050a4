// synth/animate/motion/copy_maps.h — where each copy of the carried picture comes from, frame by frame.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// One copy of the picture in one frame, sampled as the field.
struct CopyMap {
  /// CV_32F: how far the copy shows. The weights of a place's copies sum to 1, to less where none goes with it.
  cv::Mat weight;
  cv::Mat source;  // CV_32FC2: from a place to where the copy has it from, px
};

/// The places that copies bring, of the picture and of what lies beyond its sides.
struct CopyPlaces {
  /// CV_32FC4, sampled as the field: how deep in the fluid a place lies, 0 (outside) .. 1, and the look of its
  /// surroundings: luma, blue and red less luma.
  cv::Mat all;
  cv::Rect picture;  // samples of it that are the picture's
  cv::Mat own() const { return all(picture); }
};

struct CopyOptions {
  /// Frames from a copy to the next, >= 1: for about as long each place shows one copy, before it goes over to
  /// another (CopyMaps::interval_of).
  int interval = 12;
  /// > 0, a multiple of interval: the period of a loop.
  int loop_frames = 0;
  /// The frame in which a copy is as the picture lies a tenth to a half of this before or after the middle of its
  /// life, and may be beyond its life: else copies would show what stands in the picture at a place, and it would
  /// come again with every one of them. Frames; at least an interval is taken.
  int wander = 48;
  /// Places of a copy, but for that which is the still, are astray in that frame, across and down by this times smooth
  /// noise (-1 to 1, seldom up to 1.9) that two patches share: px, CV_32F, sampled as the field. It should change
  /// slowly, or the copy folds. Empty: nothing is; where the copy shows then, the picture comes again.
  cv::Mat astray{};
  /// A copy leaves a place to others where the motion has drawn its forms out or squeezed them to this of their size,
  /// and begins to .35 before, 0..0.65.
  double torn = 0.55;
  /// The places of a copy live up to this many intervals earlier or later than its middle, 0..1.
  double stagger = 1;
  /// Over which places live and go together, samples.
  double patch = 12;
};

/// Where copies may begin beside their own places, for a texture without a layout (StandingLayout). Sampled as the
/// field.
struct CopyStarts {
  cv::Mat direction;   // CV_32FC2: unit vectors of the mean motion, (0, 0) where nothing moves
  cv::Mat edges;       // CV_32F, 0..1: what no copy may bring
  double spread = 24;  // sigma of the displacement across and down, samples
  /// CV_32F, > 0: how large things are seen at a place, as they are towards a horizon; copies keep to their size.
  /// Empty: one size.
  cv::Mat nearness{};
};

/// Fluid that goes two ways in one place, as drops fall past a jet: copies that go the other way.
struct OtherWay {
  std::function<cv::Mat(int)> displacement;  // as CopyMaps'
  cv::Mat share;                             // CV_32F, 0..1, sampled as the field: of what shows in a place
};

/// Copies of the picture are carried along a field that changes from frame to frame: to where what the picture
/// shows in a copy's own frame has gone since, or will have come from. So fluid comes in and goes out at borders.
///
/// A place of the fluid shows one copy for most of the time and then goes over to the next: a copy weighs
/// ((1 + cos) / 2)^4 over three intervals, as two unlike copies that show at once are a double exposure. The places
/// of a copy do so at times of their own, which are carried along with it: the picture never changes over as a
/// whole, and the fluid's correlation with itself falls steadily.
///
/// Output frame 0 is the picture, and a loop goes through it: around it the weights go over to its own copy.
///
/// With `starts` every other copy begins displaced, to where the flow goes the same way and looks alike: of a few
/// displacements drawn for it the one that fits the most places. So nothing comes again. It is carried from the middle
/// of its life, both ways; looks do not bar it on its way, for texture has none.
/// Source: textures carried and regenerated, Max and Becker 1995, Neyret 2003; here along unsteady flow, both
/// ways in time, each part in its own time. Not in Okabe et al. 2011.
class CopyMaps {
 public:
  /// displacement  from output frame i to the next, any i: px of the picture, CV_32FC2 of the picture's samples in
  ///               `places`, every `step` px (CarryingField::at). Called from many threads.
  /// places        A copy that would bring rock, what lies beyond the picture (which is guessed) or what looks unlike
  ///               the place leaves it to the others, and so does one whose forms the motion has drawn out or squeezed
  ///               there: foam stays where water breaks, a pool at the foot of its fall, and a fall is no haze.
  /// other         What goes the other way; its copies begin as these, and take as much time and memory again.
  CopyMaps(std::function<cv::Mat(int)> displacement, const CopyPlaces& places, int step,
           const CopyOptions& options, std::optional<CopyStarts> starts = std::nullopt,
           std::optional<OtherWay> other = std::nullopt);
  ~CopyMaps();

  /// Makes what at() needs of output frames [first, first + count), and forgets what lies before. In ascending
  /// order. All threads. Memory: of each copy one map in 16 frames that lie before its own, and `count` and 16;
  /// 48 of the motion's.
  void prepare(int first, int count);
  /// The copies that show in a prepared frame. Safe from many threads.
  std::vector<CopyMap> at(int i) const;
  /// The output frame in which a copy is as the picture, but for what is astray.
  int own_frame(int copy) const;
  /// How far frame i is the picture itself: 1 in frame 0, falling to 0 within an interval, in a loop to both sides.
  double still(int i) const;
  /// After half_life_s half of the detail that is carried along has gone over to another copy. Frames, >= 1; in a
  /// loop its divisor that is nearest.
  static int interval_of(double half_life_s, double fps, int loop_frames);

 private:
  class HalfwayMotion;
  struct Copy {
    cv::Mat later;  // CV_32F: intervals by which a place of the picture lives later than the copy
    cv::Mat
        fits;  // CV_32F: how well a place of the picture goes with where it is displaced to; empty: it is not
    // Of frames before the copy's own, which are reached from it backwards: some, from which those between are found
    // again. By frame.
    std::map<int, cv::Mat> earlier;
    std::pair<int, cv::Mat> latest;  // the last frame from its own one on that was asked for
    std::map<int, cv::Mat> sources;  // CV_32FC2, of the prepared frames and some after them
  };
  int first_copy(int i) const;
  int last_copy(int i) const;
  int number(int copy) const;  // the same for copies a loop apart
  cv::Mat fit(cv::Point away) const;
  cv::Point start(int number, cv::Mat& fits) const;
  cv::Mat astray(int number) const;
  int middle(int copy) const { return copy * options_.interval; }
  void carry(int number, Copy& copy, int first, int end) const;
  cv::Mat suitability(const Copy& copy, const cv::Mat& source, const cv::Mat& from, cv::Mat& sound) const;
  cv::Mat timeliness(const Copy& copy, const cv::Mat& from, int age) const;

  std::unique_ptr<HalfwayMotion> motion_;
  CopyPlaces everywhere_;
  cv::Mat places_;  // the picture's
  int step_ = 1;
  CopyOptions options_;
  std::optional<CopyStarts> starts_;
  int reach_ = 1;  // frames from the middle of a copy's life to its last place's end
  std::map<int, Copy> copies_;
  std::unique_ptr<CopyMaps> other_;  // of what goes the other way; or null
  cv::Mat other_share_;
};

}  // namespace freshet::synth::animate
