// synth/judging/critic.h — a film judged without its truth: from the still, the matte and its frames alone.
#pragma once

#include <string>
#include <vector>

#include "synth/judging/asked_motion.h"
#include "synth/judging/evidence.h"
#include "synth/judging/reading.h"
#include "synth/judging/usual.h"

namespace freshet::synth::judging {

/// What one measure found.
struct Finding {
  Measure measure{};
  Reading reading;
  double usual = 0;  // what footage of the kind stays below; of kSpeed the nearest speed that is usual
  double fault = 0;  // 0: as footage; 1: as far beyond as a person sees (usual.h); at most kGravest
};
inline constexpr double kGravest = 5;

struct Verdict {
  std::vector<Finding> findings;  // in the order of Measure
  double faults = 0;              // their sum: 0 is as footage, less is better
  double seconds = 0;             // that judging took, on the wall's clock, reducing included
  const Finding& of(Measure measure) const { return findings[static_cast<std::size_t>(measure)]; }
  /// The one of greatest fault; null where none has any.
  const Finding* worst() const;
};

/// kind   a store's class, or empty.
/// Throws Error{kInput} for fewer than kFewestFrames frames, or a matte without fluid.
/// Cost   1 CPU second for 96 frames of 320 x 240. All threads; the same for any number.
Verdict judge(const Evidence& film, const std::string& kind = {}, const Asked& asked = {});

/// What is wrong, for a person: "the same forms come back".
const char* fault_words(const Finding& finding);
/// Where a finding is worst, for a person: "lower left, from 1.3 s on"; empty where it has no place.
std::string place_words(const Finding& finding, const Evidence& film);
/// One line: what looked worst, by how much, where, and the options that change it.
std::string verdict_words(const Verdict& verdict, const Evidence& film);

}  // namespace freshet::synth::judging
