// studio/drawing/sweep.h — settings of an animation that are tried beside each other.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace freshet::studio {

class Fields;

/// One setting, and what it is to be. All values are different.
///   "speed"     numbers, .05..20: "0.5"
///   "class"     classes of the store; "": any
///   "outline"   "still", "moving"
///   "lines"     "with", "without": what was drawn of the flow
struct SweepAxis {
  std::string setting = "speed";
  std::vector<std::string> values;
  bool operator==(const SweepAxis&) const = default;
};

/// All combinations of the values are animated.
struct Sweep {
  std::vector<SweepAxis> axes;  // of different settings; at most kMostAxes
  bool full = false;            // as long as the animation; else kShortSweep frames at most
  bool operator==(const Sweep&) const = default;
};

inline constexpr std::size_t kMostAxes = 2, kMostValues = 64;
inline constexpr std::size_t kMostSwept = 16;  // animations that are made
inline constexpr int kShortSweep = 48;

/// How many animations it is.
std::size_t swept(const Sweep& sweep);

/// Checks everything, as document_from_json says.
Sweep read_sweep(const Fields& fields);
nlohmann::json sweep_json(const Sweep& sweep);

}  // namespace freshet::studio
