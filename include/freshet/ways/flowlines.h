// include/freshet/ways/flowlines.h — endless video from a short clip, along the lines that its fluid flows on (Bhat et
// al. 2004).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "freshet/store.h"

namespace freshet {

struct FlowLinesOptions {
  /// Frames that are made, at least 1.
  int frames = 500;
  /// Frames per second, to 240; 0: the clip's.
  double fps = 0;
  /// The last frame runs into the first without a seam.
  bool loop = false;
  /// First frame of the clip that is used, and how many; 0: all that fit.
  int from = 0, input_frames = 0;
  /// Bytes for the clip's frames, 3 a pixel.
  std::size_t memory_bytes = std::size_t{1200} << 20;
  /// A clip whose camera moves is taken.
  bool moving_camera = false;

  /// SVG, drawn over the clip in the direction of the flow. Empty: found.
  std::filesystem::path lines{};
  /// A grey picture of the clip's size, white where lines are allowed. Empty: where the clip moves.
  std::filesystem::path matte{};
  /// px between lines that are found; 0: half a patch.
  double spacing_px = 0;
  /// px, side of a particle's texture; 0: 24 for 320 px of the longer side.
  double patch_px = 0;
  /// "stationary" (one speed for each place), "non-stationary" (one for each particle), or "auto": measured.
  std::string dynamics = "auto";
  /// Frames whose particles repeat (K); 0: chosen for the smallest discontinuity.
  int entries = 0;
  /// All K frames' particles again and again, as printed; else in an order that varies.
  bool in_turn = false;
  /// px, width of strands that repeat by themselves; 0: one order for all; below 0: 3 patches.
  double strand_px = -1;
  /// How two repeats meet: "feather" (averages, as printed), "contrast" (with their fine detail restored) or "cut".
  std::string blend = "cut";
  /// Another seed, another order.
  std::uint64_t seed = 1;

  /// SVG of new paths, with the ids of the lines whose texture they show. Empty: as in the clip.
  std::filesystem::path edited{};
  /// "equal" (texture keeps its size) or "stretched" (the whole line is shown).
  std::string correspondence = "equal";
  /// px, farthest apart that neighbouring edited lines are joined; 0: as their input lines are.
  double join_px = 0;
  /// What makes the edited fluid transparent: "black" (fire), "white" (smoke) or "none".
  std::string ground = "none";
  /// A picture of what lies behind removed fluid. Empty: guessed.
  std::filesystem::path background{};
  /// The edited fluid over the background alone.
  bool on_background = false;
};

struct FlowLine {
  std::string name;
  std::vector<cv::Point2f>
      points;  // px of the clip's frames, 1 px apart; (0, 0) is the middle of the first pixel
};

struct FlowLinesFrame {
  cv::Mat picture;  // CV_8UC3 BGR
  cv::Mat fluid;    // CV_32F, 0 to 1: what of it is fluid
};

/// A clip made ready. Same clip and options, same bytes, for any number of threads.
///
///   FlowLines film("fall.mp4", {.frames = 1000, .loop = true});
///   for (FlowLinesFrame frame; film.next(frame);) video.write(frame.picture);
class FlowLines {
 public:
  /// clip     A video, a folder or a pattern of pictures, of 16 frames at least.
  /// Throws   Error{kInput} naming the file or the line, and the remedy: missing, too few frames, nothing that flows,
  ///          a camera that moves, a line that runs against the flow, an edited line without one of its name;
  ///          Error{kUsage} for options out of range; Error{kCancelled}.
  /// Cost     a dense flow for each frame of the clip.
  explicit FlowLines(const std::filesystem::path& clip, const FlowLinesOptions& options = {},
                     const Job& job = {});
  /// A clip of a store. Throws also Error{kNotFound}, Error{kDamaged}.
  FlowLines(const Store& store, const std::string& clip, const FlowLinesOptions& options = {},
            const Job& job = {});
  FlowLines(const FlowLines&) = delete;
  FlowLines& operator=(const FlowLines&) = delete;
  ~FlowLines();

  cv::Size size() const;
  int frames() const;
  double fps() const;
  /// Those that are ridden, given or found.
  const std::vector<FlowLine>& lines() const;
  /// As SVG of the clip's size, to be edited and given again. Throws Error{kIo}.
  void write_lines(const std::filesystem::path& svg) const;
  /// For a person: what was left out or cut.
  const std::vector<std::string>& notices() const;
  /// Frame 0, then 1, ... false, and frame untouched, after the last. Mats of the right size and type are written in
  /// place: clone what must outlive the next call.
  bool next(FlowLinesFrame& frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet
