// studio/found_takes.h — other takes of an animation, small, for a page to choose from; and where the present one is
// worst.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "freshet/job.h"
#include "studio/frame_reel.h"
#include "studio/labelled_picture.h"

namespace freshet::studio {

inline constexpr int kTakes = 5;  // with the present one, which is the first

/// Safe from many threads.
struct FoundTakes {
  std::uint64_t number = 0;  // no others of this run have it
  std::uint64_t key = 0;     // frames_key() of what they are takes of
  std::string json;  // "number"; "takes": "name", "faults" or null, "says", "change"; "best"; "marked"
  std::vector<std::string> strips =
      {};                  // JPEG of frames side by side, of each; "" where it could not be made
  std::string worst = {};  // PNG: red where the present one is worst; "" where it has no fault
};

/// Makes each take 240 px wide, and judges it (synth/takes).
/// "change" is what a document takes over for a take: "speed", "detail_life", "layout", "flames"; times "pace" for
/// speeds of strokes, or "own_speeds".
/// Throws Error{kInput} for less than 8 frames, Error{kCancelled}.
FoundTakes find_takes(const LabelledPicture& labelled, const Document& document, const ReelScene& scene,
                      const Job& job);

}  // namespace freshet::studio
