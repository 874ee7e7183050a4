// query/labelling/labelling.h — a picture in, the patches that will animate it out.
#pragma once

#include <stop_token>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "query/costs/guide_costs.h"
#include "query/costs/pairwise.h"
#include "query/costs/reuse.h"
#include "query/index/search_base.h"
#include "query/labelling/assignment.h"
#include "query/labelling/labelling_memo.h"
#include "query/mrf/minimizer.h"
#include "query/search/candidates.h"
#include "query/search/target.h"
#include "store/store.h"

namespace freshet::query {

struct LabelOptions {
  /// The picture's sides are divided by this before it is cut into pieces (picture_scale.h).
  double piece_scale = 1;
  TargetOptions target{};
  CandidateOptions candidates{};
  MotionGuide guide{};  // empty: any motion
  HintSearch hint_search = HintSearch::kWide;
  GuideCosts guide_costs{};
  ReuseCosts reuse{};
  PairwiseOptions costs{};
  Minimizer minimizer = Minimizer::kTrwS;
  int max_iterations = 100;  // of the minimizer
};

/// Seconds, wall clock.
struct LabelSeconds {
  double cut = 0, search = 0, costs = 0, minimize = 0;
};

/// What a search for candidates found. Borrows the base that it searched, which must stay where it is.
struct CandidateSearch {
  const SearchBase* base = nullptr;
  cv::Size picture;        // px, as it was given
  double piece_scale = 1;  // target, its pieces and all motion are those of the picture reduced by this
  Target target;
  Filtered filtered;
  Candidates candidates;
  LabelSeconds seconds;

  const stored::PatchTable& table() const { return base->table; }
};

/// The first half: pieces and their candidates.
/// picture   CV_8UC3 BGR. matte   CV_8U of its size, 255 where the fluid is.
/// progress  called from the calling thread before each stage ("describing the picture", "searching
///           candidates"); may be empty.
/// memo      what earlier labellings have left, and where this one leaves its own; may be null. It changes
///           the time that is taken, and nothing else.
/// Throws    as its stages, and Error{kCancelled}.
CandidateSearch search_candidates(const store::Snapshot& snapshot, const SearchBase& base,
                                  const cv::Mat& picture, const cv::Mat& matte, const LabelOptions& options,
                                  const ProgressFunction& progress = {}, std::stop_token stop = {},
                                  LabellingMemo* memo = nullptr);
CandidateSearch search_candidates(const store::Snapshot&, const SearchBase&&, const cv::Mat&, const cv::Mat&,
                                  const LabelOptions&, const ProgressFunction& = {}, std::stop_token = {},
                                  LabellingMemo* = nullptr) = delete;

struct Labelling {
  Assignment assignment;
  Labels labels;               // of each piece, its candidate's place among them
  std::vector<float> margins;  // how sure each is (mrf.h)
  CandidateSearch search;
  LabelSeconds seconds;
  int iterations = 0;
};

/// The second half: chooses among each piece's candidates, Eq. 4 of Okabe et al. 2011. The same labels for any
/// number of threads.
/// search    kept in the answer: move it in where it is not needed any more.
/// options   of which costs, guide_costs, minimizer and max_iterations are read; as many labellings with others
///           as one likes may follow one search.
/// progress  as above: "comparing neighbours", "choosing patches".
/// memo      as above, of the same base.
Labelling label(const store::Snapshot& snapshot, CandidateSearch search, const LabelOptions& options = {},
                const ProgressFunction& progress = {}, std::stop_token stop = {},
                LabellingMemo* memo = nullptr);

/// Both halves.
Labelling label(const store::Snapshot& snapshot, const SearchBase& base, const cv::Mat& picture,
                const cv::Mat& matte, const LabelOptions& options = {}, const ProgressFunction& progress = {},
                std::stop_token stop = {}, LabellingMemo* memo = nullptr);
Labelling label(const store::Snapshot&, const SearchBase&&, const cv::Mat&, const cv::Mat&,
                const LabelOptions& = {}, const ProgressFunction& = {}, std::stop_token = {},
                LabellingMemo* = nullptr) = delete;

/// The assignment that labels mean. Clips in order of their first piece.
Assignment make_assignment(const store::Snapshot& snapshot, const CandidateSearch& search,
                           const Labels& labels);
/// The same with how it came about.
Assignment make_assignment(const store::Snapshot& snapshot, const CandidateSearch& search,
                           const Solution& solution, Minimizer minimizer, CostForm form);

}  // namespace freshet::query
