// query/labelling/shares.h — how much of an assignment comes from one clip, and from one patch.
#pragma once

#include <cstdint>
#include <string>

#include "query/labelling/assignment.h"

namespace freshet::query {

/// Of the pieces of an assignment, 0..1: which part of them the most used clip, and the most used patch (its
/// clip, variant and place), has.
struct LargestShares {
  double clip = 0, patch = 0;
  std::uint32_t most_used = 0;  // index into Assignment::clips of that clip; the first of equal ones
};
LargestShares largest_shares(const Assignment& assignment);

/// From here on a clip's faults are the animation's: a surf that turns back turns all of it.
inline constexpr double kClipShareWarned = 0.6;
/// From here on a patch is seen as a stamp.
inline constexpr double kPatchShareWarned = 0.1;

/// The class that most pieces come from, and their part of all, 0..1; of equal ones the first by name.
struct LargestClass {
  std::string name;
  double share = 1;
};
LargestClass largest_class(const Assignment& assignment);

/// "largest share of a clip 65 %, of a patch 2.3 %", for a person.
std::string to_string(const LargestShares& shares);
/// What is wrong with them and what helps, a sentence without a full stop; empty: nothing. Few pieces, below
/// twenty, may well come from one clip.
std::string shares_warning(const Assignment& assignment, const LargestShares& shares);

}  // namespace freshet::query
