// synth/judging/usual.h — what footage itself reads, by kind of fluid: beyond it a measure counts as a fault.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::judging {

enum class Measure {
  kRecurrence,
  kDetailLoss,
  kCombing,
  kColourDrift,
  kPulse,
  kStretch,
  kSeams,
  kDents,
  kStillness,
  kAngle,
  kAskedSpeed,
  kSpeed
};
inline constexpr int kMeasures = 12;

/// What a measure is called, and how its figure is written.
struct MeasureWords {
  Measure measure;
  const char *name, *unit;  // of programs: "comes_again"; "" for a share or a correlation
  const char* fault;        // for a person: "the same forms come back"
  const char* lack;         // the same of a reading below what is usual
  const char* remedy;       // the options that change it
};
const MeasureWords& words_of(Measure measure);

/// Classes of a store of which what is usual is known.
inline constexpr std::array<std::string_view, 4> kKinds{"water", "fire", "smoke", "clouds"};

/// Between which readings there is no fault, and how far beyond them there is a fault of 1.
struct Usual {
  double from = -1e9, until = 0, step = 1;
};
/// kind   a store's class, of kKinds; any other: the mean of these.
/// Not of kSpeed, which has a range.
Usual usual_of(Measure measure, std::string_view kind);

/// Speeds that the kind has, in longer sides of the picture per second.
struct SpeedRange {
  double slow = 0, natural = 0, fast = 0;  // quartiles of the clips
};
SpeedRange usual_speed(std::string_view kind);
/// px/s of a picture of this size. pace   "slow", "natural" or "fast".
double speed_of(std::string_view kind, std::string_view pace, cv::Size picture);

}  // namespace freshet::synth::judging
