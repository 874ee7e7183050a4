// synth/stills/rendering.h — the frames of an animation, at the stills' full size.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cache/result_cache.h"
#include "freshet/job.h"
#include "synth/stills/plan.h"
#include "synth/stills/still_pins.h"

namespace freshet::synth::stills {

struct RenderOptions {
  double fps = 25;
  int frames = 200;
  int flow_side = 960;            // px, the longer side of a region's box on which flow is found
  double grown_px = 3;            // of the work size: regions are grown by it
  double feather_px = 12;         // of the work size
  bool flow = true;               // false: cross-fades alone
  std::vector<PlacedPin> pins{};  // of the pictures; check_pins has let them pass
  /// Flow and pictures between stills that lie in it are not made again; may be null.
  cache::ResultCache* cache = nullptr;
};

/// Notices for a person: pins between stills that no region shows one after the other.
/// pictures   their size. Throws Error{kInput} naming the pin, the fault and the remedy: no region that moves and
///            flows holds both its ends, or it goes farther than flow can say.
std::vector<std::string> check_pins(const Plan& plan, cv::Size pictures, const RenderOptions& options);

using FrameSink = std::function<void(const cv::Mat&)>;

/// Frames 0 .. frames - 1, in order, of the stills' type, handed to the sink one by one.
/// pictures   the stills at full size. Where no region has any weight, a frame is the standing still, to the
///            bit.
/// Cost       memory beside the stills: a frame a thread, and 8 bytes a pixel of flow for each pair of
///            stills that
///            follow each other.
/// Throws     Error{kCancelled}.
void render_frames(const Plan& plan, const std::vector<cv::Mat>& pictures, const RenderOptions& options,
                   const FrameSink& sink, const Job& job = {});

}  // namespace freshet::synth::stills
