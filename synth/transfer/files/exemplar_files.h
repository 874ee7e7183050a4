// synth/transfer/files/exemplar_files.h — the look from a picture, sequence, video or stored clip.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "synth/transfer/files/design_files.h"
#include "synth/transfer/files/extent.h"
#include "synth/transfer/files/ground.h"
#include "synth/transfer/transfer.h"
#include "vision/loop_rule.h"

namespace freshet::synth::transfer {

struct ExemplarOptions {
  /// Masks in place of the exemplar's alpha: a picture for all of its frames, or a folder, pattern or video
  /// of as many; empty: none. Alpha or grey as DesignFiles has it.
  std::filesystem::path alpha = {};
  Ground ground = Ground::kNone;
  double scale = 1;                  // of its size, 0.05 to 4: patches are copied as large as they are
  double body_begins = kBodyBegins;  // of light on black, as take_off_ground says
  int patch = 5;                     // px per side, of the transfer: an exemplar has room for two each way
  double radius = 3, lower = 0.1;    // of the transfer: what is nowhere above `lower` shows no fluid
  int frames = 1;                    // of the animation
  /// Moments of a video have their ExemplarFrame::back. The first has the motion to the next, reversed.
  bool motion = false;
};

/// Frame by frame as the animation goes; where it is shorter, looped by the rules of a store's clips: from a
/// late frame to an early one like it, cross-faded as synth/playing/timeline.h says.
class ExemplarFiles {
 public:
  /// A picture, a folder or a pattern of pictures, or a video. Throws Error{kInput} naming the file: nothing
  /// there, a number is missing.
  ExemplarFiles(const std::filesystem::path& path, const ExemplarOptions& options);
  /// A clip of a store. Throws Error{kNotFound} that lists some of its clips, Error{kDamaged}.
  ExemplarFiles(const store::Snapshot& snapshot, const std::string& clip, const ExemplarOptions& options);
  ExemplarFiles(ExemplarFiles&&) noexcept;
  ~ExemplarFiles();

  /// Chooses options().scale, at most 1, so that there is not more fluid than in the design: a structure that is
  /// larger than what it shall fill is cut up, and becomes soft. An opaque exemplar keeps its size.
  /// design   a mean frame's.
  /// Throws Error{kInput} as check() does.
  void fit_scale(const Extent& design, const TransferOptions& options);

  /// Chooses options().body_begins so that as much of the fluid is interior as in the design, for light on black
  /// whose body is not given: an outline is dimmer than what it holds, and a design of little else would be too.
  void fit_body(const Extent& design, const TransferOptions& options);

  /// Reads once all that the animation will use, and finds the loop. Throws Error{kInput}: unreadable, frames
  /// of unequal size, smaller than two patches per side, one without fluid, masks of another size or
  /// number, too short for the animation and for a loop (vision::kMinLoopFrames); Error{kCancelled}.
  void check(const std::function<void(std::size_t done, std::size_t of)>& progress = {},
             const std::stop_token& stop = {});

  const ExemplarOptions& options() const;
  int frames() const;  // of its own
  cv::Size size() const;
  bool opaque() const;                           // everywhere in all frames
  std::optional<vision::LoopRule> loop() const;  // of one that is shorter than the animation
  const std::string& hash() const;
  const std::vector<std::string>& notices() const;  // for a person

  /// What the look is at frame t of the animation, CV_16UC4; the first for t < 0. The same Mat for a moment
  /// that is still remembered (the last four).
  ExemplarFrame at(int t);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Throws Error{kInput} naming the masks when they have no outline to give the exemplar's to: a design that is
/// fluid everywhere takes an opaque exemplar. Both have been checked.
void check_outline(const DesignFiles& design, const ExemplarFiles& exemplar,
                   const std::filesystem::path& masks);
/// Throws Error{kUsage} naming the exemplar where options ask for what it lacks: motion, or an outline that bends. It
/// has been checked.
void check_guides(const ExemplarFiles& exemplar, const TransferOptions& options,
                  const std::filesystem::path& path);

}  // namespace freshet::synth::transfer
