// synth/flowlines/edited_view.h — the fluid along edited lines, over what lies behind it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "media/frame/filmed_ground.h"
#include "synth/flowlines/edit.h"
#include "synth/flowlines/moments.h"
#include "synth/flowlines/renderer.h"

namespace freshet::synth::flowlines {

using media::Ground;

struct EditedViewOptions {
  Correspondence correspondence = Correspondence::kEqual;
  double patch_px = 24;
  /// What the fluid stands on, where it is seen through. On black alpha is the brightest channel.
  Ground ground = Ground::kNone;
  /// CV_8UC3, the frames' size: what lies behind fluid that is taken away. Empty: guessed; on a ground the darkest (or
  /// the brightest) that each place ever was, else filled in from around.
  cv::Mat background{};
  /// Everything but the edited fluid is the background, not the clip.
  bool on_background = false;
  RenderOptions render{};
};

/// Pixels that edited lines' patches cover show the clip at corresponding places: at the same arc length, or the share
/// of it, and as far across; so textures turn with the tangent. Neighbouring lines' patches overlap and are feathered:
/// a pixel's weight falls from a patch's middle to 0 at its edges. (The paper's words, "inversely proportional to its
/// distance to the edges of the overlapping region", taken literally, would be greatest at the edge, where the
/// patch ends.)
///
/// Where the clip's fluid was and no edited line leads, it is taken away; where neither was, the clip goes on.
///
/// Source  Bhat et al. 2004, Sec. 4, Fig. 4; the paper draws over the clip and takes nothing away.
class EditedView {
 public:
  /// frames    CV_8UC3; kept by reference.
  /// working   px of the picture that moments are given for.
  /// matte     CV_8U, the frames' size: what of the clip is fluid.
  /// inputs    the dense input lines, px of the frames.
  EditedView(const std::vector<cv::Mat>& frames, cv::Size working, std::vector<FlowLine> inputs,
             const cv::Mat& matte, const cv::Mat& mean, const EditedViewOptions& options);

  /// From now on the fluid goes along these lines; before the first frame, and when lines have moved. All threads.
  void lead(const std::vector<EditedLine>& lines);

  /// Draws over a frame of the endless clip, CV_8UC3. All threads; the same for any number.
  /// moments   by time (EditedLine).
  void render(std::span<const std::vector<Moment>> moments, cv::Mat& frame);
  /// CV_32F, 0..1: how far each pixel shows edited fluid.
  const cv::Mat& alpha() const { return alpha_; }

 private:
  struct Source {
    float x, y;  // px of the clip
    float weight;
    int time;
  };
  static constexpr std::size_t kMostSources = 4;  // of a pixel: the weightiest patches
  struct Place {
    std::uint32_t pixel;
    Source source;
  };
  void cover(const EditedLine& edited, std::vector<Place>& places) const;
  void add(const Place& place);
  void gather();
  void share_out(std::span<Source> of);
  void show(std::span<const std::vector<Moment>> moments, std::size_t pixel);
  float opacity(const cv::Vec3b& fluid) const;

  const std::vector<cv::Mat>* frames_;
  cv::Size working_;
  EditedViewOptions options_;
  std::vector<FlowLine> inputs_;
  cv::Mat mean_, matte_, was_, alpha_, removed_, behind_;
  cv::Mat fluid_, fluid_mean_, lost_;  // along the edited lines, of the frame; beyond them the frame's own
  DetailReturn return_detail_;
  std::vector<Source> best_;          // by pixel kMostSources, of which count_ are there
  std::vector<std::uint8_t> count_;   // by pixel
  std::vector<float> all_;            // by pixel: weight of all its sources
  std::vector<std::uint32_t> first_;  // by pixel, and one more
  std::vector<Source> sources_;
};

}  // namespace freshet::synth::flowlines
