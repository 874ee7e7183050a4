// synth/animate/frames/animation.h — one animation in the making: what it is made of, what is asked of its frames, and
// how far it is.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/error.h"
#include "freshet/job.h"
#include "platform/stopwatch.h"
#include "query/search/motion_guide.h"
#include "store/store.h"
#include "stored/decoded_tiles.h"
#include "synth/animate/placement/placement.h"
#include "synth/outline/moving_outline.h"
#include "vision/settings.h"

namespace freshet::synth::animate {

/// What the sink is given. kFluid over the picture is the whole; so it is over what lies behind a moving outline
/// (behind_fluid), where that is guessed once the still that the whole begins with has gone.
enum class FrameForm {
  kWhole,  // CV_8UC3: the picture with the fluid in it
  kFluid,  // CV_32FC4: the fluid alone, its colour (1 is white) times its matte, and the matte; nothing rounded
};

/// What is asked of frames, whichever renderer makes them.
struct FrameOptions {
  int frames = 96;
  int from = 0;   // only the frames from this one on are made and handed on, the same as if all were
  int until = 0;  // only the frames before this one; 0: all
  FrameForm form = FrameForm::kWhole;
  double fps = 25;
  bool loop = false;  // the last frame is followed by the first, without a seam
  /// Frames are made in batches that fit into this, as far as the picture itself leaves room: beside the
  /// batch some 280 bytes per pixel are needed (0.26 GB at 1280 x 720, 2.3 GB at 3840 x 2160). When all
  /// frames fit, each clip is read once, else about three times.
  std::size_t memory_bytes = std::size_t{2000} << 20;
  /// What was asked of the motion (apply_guide).
  query::MotionGuide guide{};
  synth::outline::MovingOutlineOptions outline{};
  /// Of the snapshot, decoded for earlier animations; null: none are kept. It changes the time taken, and nothing else.
  std::shared_ptr<stored::DecodedTiles> tiles{};
  std::function<void(const cv::Mat&)> matte_sink{};  // each frame's matte, CV_32F 0..1
  /// Where what lies at a pixel goes until the next frame, CV_32FC2, px, the picture's size; 0 beside the matte.
  std::function<void(const cv::Mat&)> motion_sink{};

  /// The frame after the last one that is made.
  int end() const { return until > 0 ? std::min(until, frames) : frames; }
  bool moving() const { return outline.kind == synth::outline::Outline::kMoving; }
};

/// A clip whose flames are shown.
struct ShownForm {
  store::ClipId clip{};
  std::uint32_t first = 0;  // of its frames, the one that the animation begins with
  double fit = 0;           // 0..1
};

/// Where the time went, and with what.
struct AnimateReport {
  std::string method;            // carried, forms or paper: which made the frames
  bool by_itself = false;        // nobody named it: the picture is of a fire
  std::string flames;            // with forms, whose: clips or own
  std::vector<ShownForm> forms;  // of clips: one for each fire in the picture
  double forms_fit = 0;          // of all of them, 0..1
  std::string forms_lack;        // what speaks against them; for a person
  std::size_t tongues = 0;       // of own flames, those that sway in one piece,
  store::ClipId sways_as{};      // as this clip's flame did
  std::size_t clips = 0, pieces = 0;
  int batches = 1;         // of frames
  double half_life_s = 0;  // of all detail; 0: none was carried
  double renewed = 0;      // of the variance of the patches' detail, what is new in each frame, 0..1
  double decode_s = 0, blend_s = 0, base_s = 0, appearance_s = 0, render_s = 0, total_s = 0;
};

/// Views of what outlives it, and a report that grows. As animate() takes them.
struct Animation {
  const store::Snapshot& snapshot;
  const vision::Settings& settings;
  const cv::Mat &picture, &matte;
  const Placement& placement;
  const FrameOptions& options;
  const ProgressFunction& progress;
  std::stop_token stop{};
  AnimateReport report{};
  Stopwatch watch{};  // each stage takes its lap

  void tell(const char* stage, std::size_t done, std::size_t of) const {
    if (progress) progress({stage, done, of});
  }
  /// Error{kCancelled}.
  void throw_if_stopped() const {
    if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, "animate", "stopped");
  }
};

}  // namespace freshet::synth::animate
