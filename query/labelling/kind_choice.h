// query/labelling/kind_choice.h — the class of clips that a picture is animated with, where nobody says one: by its
// look.
#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "query/index/search_base.h"
#include "query/search/candidates.h"
#include "query/search/motion_guide.h"
#include "store/store.h"
#include "vision/look/fluid_kind.h"

namespace freshet::query {

struct KindChoice {
  vision::FluidKind look;
  std::string taken{};  // the class taken by its look and way; empty: none was
  /// For a person: what was taken or why nothing was, and the option that overrules it. Empty: a class was said, or
  /// the store has one alone.
  std::string words{};
};

/// Narrows `candidates` to the class that the picture looks most like, where they say no class and the store has clips
/// of it that pass their conditions; an unsure look too, for it is mostly right (docs/measurements/critic.md), and
/// mixed classes share no motion. They are mixed only where the store lacks it, or for kAnyClass. Where the look is
/// unsure and one way is asked, its probabilities are weighed by how many of each class go so: no cloud goes upright.
/// picture, matte, guide   as search_candidates takes them.
/// Throws           as search_candidates, for conditions that nothing passes; as check_guide.
KindChoice choose_kind(const store::Snapshot& snapshot, const SearchBase& base, const cv::Mat& picture,
                       const cv::Mat& matte, const MotionGuide& guide, CandidateOptions& candidates);

}  // namespace freshet::query
