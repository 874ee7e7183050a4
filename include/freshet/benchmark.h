// include/freshet/benchmark.h — an index of one's own for candidate search, measured beside Freshet's.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "freshet/store.h"

namespace freshet {

/// Patches and pieces are spatial pyramids: vectors of whole numbers, CV_8U, 21 cells x the store's words (4200 for
/// 200). Near is a small L1 distance.
struct OwnIndex {
  std::string name;  // of the table's row
  /// patches   N x bins, borrowed until `built` of the next index, or the benchmark's end.
  std::function<void(const cv::Mat& patches)> build;
  /// The k nearest of each question, CV_32S, questions x k: rows of `patches`, -1 for none. Rows are scored again, and
  /// may come in any order.
  std::function<cv::Mat(const cv::Mat& questions, int k)> search;
};

struct BenchmarkPicture {
  std::string name;
  cv::Mat bgr;    // CV_8UC3
  cv::Mat matte;  // CV_8U of its size, 255 where the fluid is; empty: everywhere
};

struct BenchmarkOptions {
  /// Pieces that are asked, at most.
  std::size_t pieces = 200;
  /// Patches searched among, evenly spread over the store; 0: all.
  std::size_t rows = 0;
  /// Of one core, s: for building an index, which is built of fewer patches where it would take longer; and for
  /// searching with one setting.
  double build_limit_s = 60, setting_limit_s = 5;
  /// Whether the first picture is labelled with the candidates of each index, which tells the energy lost.
  bool label = true;
  /// Whether it is measured under conditions too: one class, one direction, one clip.
  bool filters = true;
};

/// What `freshet query bench` measures, of the exact index, the scan of all patches and one's own: the JSON that
/// `freshet query bench --json` writes (docs/benchmark.md). Own functions are called on one thread.
/// pictures   empty: one clip's average image, and that clip's patches are left out.
/// Throws     Error{kNotFound} when the store has no index, Error{kUsage}, Error{kCancelled}; what own functions throw.
std::string benchmark(const Store& store, const OwnIndex& own,
                      std::span<const BenchmarkPicture> pictures = {}, const BenchmarkOptions& options = {},
                      const Job& job = {});

/// The same questions as data for other programs.
struct SearchProblem {
  cv::Mat patches;     // CV_8U, N x bins
  cv::Mat questions;   // CV_8U, Q x bins
  cv::Mat neighbours;  // CV_32S, Q x k: rows of `patches`, nearest first
  cv::Mat distances;   // CV_32F, Q x k: L1
};
/// neighbours   k of each question, by the exact index.
SearchProblem search_problem(const Store& store, int k = 100, std::span<const BenchmarkPicture> pictures = {},
                             const BenchmarkOptions& options = {});

/// Fraction of the k nearest that an answer holds, mean over questions; what lies as near as the k-th counts.
/// found    CV_32S, Q x k or wider: rows of `patches`, -1 for none.
/// Throws   Error{kUsage} when shapes or types do not fit.
double recall(const SearchProblem& problem, const cv::Mat& found, int k);

}  // namespace freshet
