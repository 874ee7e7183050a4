// query/labelling.h — a picture in, the patches that will animate it out.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "query/assignment.h"
#include "query/candidates.h"
#include "query/minimizer.h"
#include "query/pairwise.h"
#include "query/patch_table.h"
#include "query/target.h"
#include "store/store.h"

namespace freshet::query {

struct LabelOptions {
  TargetOptions target{};
  CandidateOptions candidates{};
  PairwiseOptions costs{};
  Minimizer minimizer = Minimizer::kTrwS;
  int max_iterations = 100;  // of TRW-S
};

enum class LabelStage { kOpen, kCut, kSearch, kCosts, kMinimize };
const char* to_string(LabelStage stage);  // "reading the index", ...

/// Seconds, wall clock.
struct LabelSeconds {
  double open = 0, cut = 0, search = 0, costs = 0, minimize = 0;
};

/// What a search for candidates found.
struct CandidateSearch {
  PatchTable table;
  Target target;
  Filtered filtered;
  Candidates candidates;
  LabelSeconds seconds;
};

/// The first half: pieces and their candidates.
/// picture   CV_8UC3 BGR. matte   CV_8U of its size, 255 where the fluid is.
/// progress  called from the calling thread before each stage; may be empty.
/// Throws    as its stages, and Error{kCancelled}.
CandidateSearch search_candidates(const store::Snapshot& snapshot, const cv::Mat& picture,
                                  const cv::Mat& matte, const LabelOptions& options,
                                  const std::function<void(LabelStage)>& progress = {},
                                  std::stop_token stop = {});

struct Labelling {
  Assignment assignment;
  Labels labels;  // of each piece, its candidate's rank
  CandidateSearch search;
  LabelSeconds seconds;
  int iterations = 0;
};

/// Cuts the picture into pieces, finds each piece's candidates and chooses among them: Eq. 4 of Okabe et al.
/// 2011. The same labels for any number of threads.
Labelling label(const store::Snapshot& snapshot, const cv::Mat& picture, const cv::Mat& matte,
                const LabelOptions& options = {}, const std::function<void(LabelStage)>& progress = {},
                std::stop_token stop = {});

/// The assignment that labels mean. Clips in order of their first piece.
Assignment make_assignment(const store::Snapshot& snapshot, const vision::Settings& settings,
                           const CandidateSearch& search, const Labels& labels);

}  // namespace freshet::query
