#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "freshet/error.h"
#include "freshet/search.h"
#include "library/opencv_threads.h"
#include "library/states.h"
#include "query/index/dense_histogram.h"

namespace freshet {
namespace {

using Answers = std::vector<std::vector<query::ScoredPatch>>;

void check_rows(const cv::Mat& given, int other_type, std::size_t columns, const char* what) {
  if (given.dims != 2 || (given.type() != CV_8U && given.type() != other_type) ||
      given.cols != static_cast<int>(columns))
    throw Error(ErrorKind::kUsage, what,
                (other_type == CV_16U ? "CV_8U or CV_16U with " : "CV_8U with ") + std::to_string(columns) +
                    " columns is expected");
}

std::vector<query::PieceQuery> queries_of(const cv::Mat& words) {
  constexpr std::size_t kPoints = vision::kGridSide * vision::kGridSide;
  check_rows(words, CV_16U, kPoints, "visual words");
  cv::Mat wide;
  words.convertTo(wide, CV_16U);
  std::vector<query::PieceQuery> queries;
  for (int i = 0; i < wide.rows; ++i) {
    vision::WordMap map;
    std::copy_n(wide.ptr<vision::Word>(i), kPoints, map.begin());
    queries.push_back(query::whole_query(map));
  }
  return queries;
}

PatchTable table_of(const Answers& answers, int k, std::span<const int> max_scores) {
  const auto questions = static_cast<int>(answers.size());
  PatchTable table{cv::Mat(questions, k, CV_32S, cv::Scalar(-1)), cv::Mat::zeros(questions, k, CV_32F)};
  for (int i = 0; i < questions; ++i) {
    const auto& found = answers[static_cast<std::size_t>(i)];
    for (int j = 0; j < static_cast<int>(found.size()); ++j) {
      const query::ScoredPatch& patch = found[static_cast<std::size_t>(j)];
      table.patches.at<int>(i, j) = static_cast<int>(patch.row);
      table.scores.at<float>(i, j) = static_cast<float>(patch.score) /
                                     static_cast<float>(std::max(1, max_scores[static_cast<std::size_t>(i)]));
    }
  }
  return table;
}

}  // namespace

PatchTable nearest_by_words(const Store& store, const cv::Mat& words, int k) {
  check_count(k);
  const OneOpenCvThread one;
  const std::vector<query::PieceQuery> queries = queries_of(words);
  std::vector<int> max_scores;
  for (const query::PieceQuery& query : queries) max_scores.push_back(query::max_score(query));
  const Answers answers = store.impl().search_base()->index->search(queries, static_cast<std::size_t>(k));
  return table_of(answers, k, max_scores);
}

PatchTable nearest_by_histograms(const Store& store, const cv::Mat& histograms, int k) {
  check_count(k);
  const OneOpenCvThread one;
  const auto base = store.impl().search_base();
  const std::size_t bins = query::histogram_bins(base->codebook.words);
  check_rows(histograms, CV_8U, bins, "histograms");
  const auto questions = static_cast<std::size_t>(histograms.rows);
  std::vector<int> max_scores(questions);
  for (std::size_t i = 0; i < questions; ++i) {
    const unsigned char* row = histograms.ptr(static_cast<int>(i));
    max_scores[i] = std::accumulate(row, row + bins, 0);
  }
  Answers best(questions);
  constexpr std::size_t kBlock = 4096;  // patches, 17 MB of histograms
  const vision::WordMaps words = base->table.words;
  for (std::size_t first = 0; first < words.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, words.size() - first);
    const std::vector<unsigned char> block =
        query::dense_histograms(words.subspan(first, count), base->codebook.words);
    oneapi::tbb::parallel_for(std::size_t{0}, questions, [&](std::size_t i) {
      for (std::size_t row = 0; row < count; ++row)
        best[i].push_back(
            {static_cast<stored::Row>(first + row),
             query::score_of(max_scores[i], query::l1_distance(histograms.ptr(static_cast<int>(i)),
                                                               block.data() + row * bins, bins))});
      const std::size_t kept = std::min(best[i].size(), static_cast<std::size_t>(k));
      std::partial_sort(best[i].begin(), best[i].begin() + static_cast<std::ptrdiff_t>(kept), best[i].end(),
                        query::better);
      best[i].resize(kept);
    });
  }
  return table_of(best, k, max_scores);
}

cv::Mat histograms_of(const Store& store, const cv::Mat& words) {
  const std::vector<query::PieceQuery> queries = queries_of(words);
  const int count = store.impl().search_base()->codebook.words;
  const std::size_t bins = query::histogram_bins(count);
  cv::Mat histograms(words.rows, static_cast<int>(bins), CV_8U);
  for (int i = 0; i < words.rows; ++i)
    query::fill_histogram(queries[static_cast<std::size_t>(i)], count, {histograms.ptr(i), bins});
  return histograms;
}

}  // namespace freshet
