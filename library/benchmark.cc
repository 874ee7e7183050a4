#include "freshet/benchmark.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>

#include "freshet/error.h"
#include "library/opencv_threads.h"
#include "library/states.h"
#include "query/benchmark/benchmark_pieces.h"
#include "query/benchmark/measured_indexes.h"
#include "query/benchmark/search_benchmark.h"
#include "query/index/dense_histogram.h"
#include "query/index/exact_index.h"
#include "stored/store_settings.h"
#include "stored/stored_codebook.h"

namespace freshet {
namespace {

cv::Mat histograms(std::span<const query::PieceQuery> queries, int word_count) {
  const std::size_t bins = query::histogram_bins(word_count);
  cv::Mat all(static_cast<int>(queries.size()), static_cast<int>(bins), CV_8U);
  for (std::size_t i = 0; i < queries.size(); ++i)
    query::fill_histogram(queries[i], word_count, {all.ptr(static_cast<int>(i)), bins});
  return all;
}

/// Hands pieces to a caller's index as vectors, on the calling thread.
class CallersIndex final : public query::CandidateIndex {
 public:
  CallersIndex(const OwnIndex& own, const query::SearchSpace& space)
      : own_(own),
        space_(space),
        patches_(static_cast<int>(space.words.size()),
                 static_cast<int>(query::histogram_bins(space.word_count)), CV_8U) {
    const std::vector<unsigned char> dense = query::dense_histograms(space.words, space.word_count);
    std::memcpy(patches_.data, dense.data(), dense.size());
    own_.build(patches_);
  }

  std::size_t rows() const override { return space_.words.size(); }

  std::vector<std::vector<query::ScoredPatch>> search(
      std::span<const query::PieceQuery> queries, std::size_t k,
      const query::SearchFilter& search_filter) const override {
    const bool all = search_filter.rows == nullptr && search_filter.windows.empty();
    std::vector<std::vector<query::ScoredPatch>> answers;
    if (all) {
      const cv::Mat found = ask(histograms(queries, space_.word_count), std::min(k, rows()));
      for (std::size_t i = 0; i < queries.size(); ++i) {
        answers.push_back(scored(found.row(static_cast<int>(i)), queries[i]));
        std::sort(answers[i].begin(), answers[i].end(), query::better);
      }
      return answers;
    }
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const cv::Mat question = histograms(queries.subspan(i, 1), space_.word_count);
      answers.push_back(query::search_widening(rows(), k, search_filter, i, [&](std::size_t count) {
        return scored(ask(question, count), queries[i]);
      }));
    }
    return answers;
  }

 private:
  cv::Mat ask(const cv::Mat& questions, std::size_t k) const {
    const cv::Mat found = own_.search(questions, static_cast<int>(k));
    if (found.type() != CV_32S || found.rows != questions.rows)
      throw Error(ErrorKind::kUsage, own_.name,
                  "its search must give whole numbers of 32 bits, a row for each question");
    return found;
  }

  std::vector<query::ScoredPatch> scored(const cv::Mat& found, const query::PieceQuery& question) const {
    std::vector<query::ScoredPatch> patches;
    for (int i = 0; i < found.cols; ++i) {
      const int row = found.at<int>(0, i);
      if (row == -1) continue;
      if (row < 0 || static_cast<std::size_t>(row) >= rows())
        throw Error(ErrorKind::kUsage, own_.name,
                    "its search names row " + std::to_string(row) + " of " + std::to_string(rows()));
      const int score = vision::intersection(question.words, space_.words[static_cast<std::size_t>(row)],
                                             space_.word_count, &question.mask);
      patches.push_back({static_cast<stored::Row>(row), static_cast<std::uint32_t>(score)});
    }
    return patches;
  }

  const OwnIndex& own_;
  query::SearchSpace space_;
  cv::Mat patches_;
};

std::vector<query::BenchmarkPicture> asked_pictures(std::span<const BenchmarkPicture> pictures) {
  std::vector<query::BenchmarkPicture> asked;
  for (const BenchmarkPicture& picture : pictures) {
    check_picture(picture.bgr, picture.matte);
    asked.push_back(
        {picture.name, picture.bgr,
         picture.matte.empty() ? cv::Mat(picture.bgr.size(), CV_8U, cv::Scalar(255)) : picture.matte});
  }
  return asked;
}

// Without an index: the benchmark brings its own.
query::SearchBase base_of(const store::Snapshot& snapshot) {
  query::SearchBase base;
  base.settings = stored::settings_of(snapshot);
  base.codebook = stored::read_codebook(snapshot);
  base.table = stored::read_patch_table(snapshot);
  return base;
}

float l1(const cv::Mat& a, const cv::Mat& b) {
  return static_cast<float>(query::l1_distance(a.data, b.data, static_cast<std::size_t>(a.cols)));
}

}  // namespace

std::string benchmark(const Store& store, const OwnIndex& own, std::span<const BenchmarkPicture> pictures,
                      const BenchmarkOptions& options, const Job& job) {
  const OneOpenCvThread one;
  const store::Snapshot& snapshot = store.impl().snapshot;
  query::SearchBase base = base_of(snapshot);
  const std::vector<query::MeasuredIndex> indexes = {
      query::measured_exact(),
      query::measured_scan(),
      {.name = own.name,
       .what = "the caller's",
       .build = [&own](const query::SearchSpace& space) -> query::BuiltIndex {
         return {std::make_shared<CallersIndex>(own, space), {{"as it is", [] {}}}};
       }}};
  const query::SearchReport report = query::benchmark_search(
      snapshot, base, asked_pictures(pictures), indexes,
      {.rows = options.rows,
       .pieces = options.pieces,
       .build_limit_s = options.build_limit_s,
       .setting_limit_s = options.setting_limit_s,
       .label = options.label,
       .filters = options.filters},
      [&](const std::string& what) {
        if (job.progress) job.progress({what, 0, 0});
      },
      job.stop);
  if (report.wrong > 0)
    throw Error(ErrorKind::kDamaged, store.path().string(),
                std::to_string(report.wrong) + " of " + std::to_string(report.checked) +
                    " exact answers are not those of brute force");
  return query::to_json(report).dump(1, ' ', false, nlohmann::json::error_handler_t::replace);
}

SearchProblem search_problem(const Store& store, int k, std::span<const BenchmarkPicture> pictures,
                             const BenchmarkOptions& options) {
  check_count(k);
  const OneOpenCvThread one;
  const store::Snapshot& snapshot = store.impl().snapshot;
  const query::SearchBase base = base_of(snapshot);
  const int words = base.codebook.words;
  const query::BenchmarkPieces asked =
      query::benchmark_pieces(snapshot, base, asked_pictures(pictures), options.pieces, options.rows);
  const vision::OwnWordMaps maps = vision::rows_of(base.table.words, asked.rows);
  std::vector<query::PieceQuery> patches;
  for (std::size_t i = 0; i < maps.size(); ++i) patches.push_back(query::whole_query(maps[i]));
  const auto exact = query::ExactIndex(maps, words).search(asked.queries, static_cast<std::size_t>(k));
  SearchProblem problem{.patches = histograms(patches, words),
                        .questions = histograms(asked.queries, words),
                        .neighbours = cv::Mat(static_cast<int>(exact.size()), k, CV_32S, cv::Scalar(-1)),
                        .distances = cv::Mat(static_cast<int>(exact.size()), k, CV_32F,
                                             cv::Scalar(std::numeric_limits<float>::infinity()))};
  for (int i = 0; i < problem.neighbours.rows; ++i)
    for (int j = 0; j < static_cast<int>(exact[static_cast<std::size_t>(i)].size()); ++j) {
      const int row = static_cast<int>(exact[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)].row);
      problem.neighbours.at<int>(i, j) = row;
      problem.distances.at<float>(i, j) = l1(problem.questions.row(i), problem.patches.row(row));
    }
  return problem;
}

double recall(const SearchProblem& problem, const cv::Mat& found, int k) {
  const int questions = problem.questions.rows;
  if (problem.patches.type() != CV_8U || problem.questions.type() != CV_8U ||
      problem.patches.cols != problem.questions.cols || problem.distances.type() != CV_32F ||
      problem.distances.rows != questions || found.type() != CV_32S || found.rows != questions || k < 1 ||
      k > problem.distances.cols || k > found.cols)
    throw Error(ErrorKind::kUsage, "recall",
                "patches and questions CV_8U of as many bins, distances CV_32F and answers CV_32S with a row "
                "for each "
                "question and at least k columns are expected");
  double sum = 0;
  for (int i = 0; i < questions; ++i) {
    std::vector<int> rows(found.ptr<int>(i), found.ptr<int>(i) + k);
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    int there = k;
    while (there > 0 && !std::isfinite(problem.distances.at<float>(i, there - 1))) --there;
    if (there == 0) {
      sum += 1;
      continue;
    }
    const float farthest = problem.distances.at<float>(i, there - 1);
    const auto good = std::count_if(rows.begin(), rows.end(), [&](int row) {
      return row >= 0 && row < problem.patches.rows &&
             l1(problem.questions.row(i), problem.patches.row(row)) <= farthest;
    });
    sum += static_cast<double>(std::min<std::ptrdiff_t>(good, there)) / there;
  }
  return sum / std::max(1, questions);
}

}  // namespace freshet
