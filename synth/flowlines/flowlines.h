// synth/flowlines/flowlines.h — endless video from a short clip, along the lines that its fluid flows on.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "synth/flowlines/clip_motion.h"
#include "synth/flowlines/edit.h"
#include "synth/flowlines/edited_view.h"
#include "synth/flowlines/footage.h"
#include "synth/flowlines/ladder.h"
#include "synth/flowlines/lines/flow_line.h"
#include "synth/flowlines/renderer.h"
#include "synth/flowlines/rides.h"

namespace freshet::synth::flowlines {

struct FlowlinesOptions {
  /// Flow lines over the clip, px of its frames; empty: found.
  std::vector<FlowLine> lines{};
  /// Where the fluid is to go, px; each named after the line that it is an edited copy of; of one name several where
  /// it moves (MovingLines). Empty: as in the clip.
  std::vector<FlowLine> edited{};
  std::string edited_name{};  // their file, for errors
  EditedViewOptions view{};   // patch_px and render are those below
  double join_px = 0;         // EditOptions
  double fps = 0;             // of the output, for lines that move; 0: the clip's
  /// CV_8U, 255 where the fluid is, of the clip's size: lines are found there. Empty: found from what moves.
  cv::Mat matte{};
  double spacing_px = 0;  // between lines that are found; 0: half a patch
  double patch_px = 0;    // side of a particle's texture; 0: 24 for 320 px of the longer side
  Dynamics dynamics = Dynamics::kMeasured;
  /// Strands of the fluid so wide, px, repeat in an order of their own; 0: all together; below 0: 3 patches.
  double strand_px = -1;
  int entries = 0;       // K; 0: chosen
  int loop_frames = 0;   // > 0: the output repeats after so many frames, without a seam
  bool in_turn = false;  // all K entries one after the other, as printed; else in an order that varies
  std::uint64_t seed = 1;
  /// Of runs where they overlap; how alike they are is measured: likeness_of.
  Mixing mixing = Mixing::kCut;
  bool moving_camera = false;  // whether a clip is taken whose camera moves
};

/// px: 24 for 320 px of the longer side.
double default_patch(cv::Size picture);

/// What was found out about a clip.
struct FlowlinesReport {
  int lines = 0, streams = 0;
  int drawn = 0, interpolated = 0;  // edited lines
  bool stationary = true;
  double gain = 0;  // Rides::gain
  double patch_px = 0, spacing_px = 0;
  int entries = 0;       // K of the largest stream
  double way = 0;        // frames that its particles take, entry to end
  double floor_px = 0;   // px a frame: rungs go no slower, and cut slower particles
  double cut_share = 0;  // of the lines' places: where that is so
  double jump_cost = 0;  // of a jump; 1: as unlike as any two moments
  double motion_s = 0, ride_s = 0, plan_s = 0, edit_s = 0;
  std::vector<std::string> notices{};  // for a person
};

/// A clip made ready; then frame after frame, without an end, in a memory that does not grow.
class Flowlines {
 public:
  /// footage   16 frames at least; kept by reference.
  /// Throws    Error{kInput} naming the clip, or the line: too few frames, nothing that flows, a camera that moves, a
  ///           line that leaves the picture or runs against the flow; Error{kUsage} for options out of range;
  ///           Error{kCancelled}.
  Flowlines(const Footage& footage, const FlowlinesOptions& options, const Job& job = {});
  ~Flowlines();
  Flowlines(const Flowlines&) = delete;
  Flowlines& operator=(const Flowlines&) = delete;

  const FlowlinesReport& report() const;
  /// The lines, px of the clip's frames.
  const std::vector<FlowLine>& lines() const;
  /// The dense edited lines of the frame last given, with the input lines that they show; none where nothing is
  /// edited.
  const std::vector<EditedLine>& edited() const;
  /// CV_8U, 255 where the clip flows.
  const cv::Mat& matte() const;
  /// CV_32F, 0..1: what of the frame last given is fluid, softly: the matte, or what the edited lines' patches cover.
  /// Valid until the next frame.
  cv::Mat fluid() const;
  /// The next frame, CV_8UC3, valid until the next call.
  const cv::Mat& next();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::synth::flowlines
