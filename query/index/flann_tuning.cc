#include "query/index/flann_tuning.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "query/index/dense_histogram.h"
#include "query/index/exact_index.h"

namespace freshet::query {
namespace {

constexpr std::size_t kBest = 100;

// One query and the rows among which it is searched.
struct Question {
  PieceQuery query;
  RowFilter others;
  std::vector<ScoredPatch> exact;
};

std::vector<Question> questions_of(vision::WordMaps words, int word_count,
                                   std::span<const stored::Row> clip_rows, std::size_t count) {
  const ExactIndex exact(words, word_count);
  std::vector<Question> questions;
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<stored::Row>((2 * i + 1) * words.size() / (2 * count));
    Question question{whole_query(words[row]), RowFilter(words.size()), {}};
    const auto next = std::upper_bound(clip_rows.begin(), clip_rows.end(), row);
    if (*(next - 1) > 0 || *next < words.size()) {
      for (stored::Row own = *(next - 1); own < *next; ++own) question.others.forbid(own);
    }
    question.exact = exact.search(std::span(&question.query, 1), kBest, {.rows = &question.others})[0];
    questions.push_back(std::move(question));
  }
  return questions;
}

double recall(FlannIndex& index, const std::vector<Question>& questions, std::uint32_t checks) {
  index.set_checks(static_cast<int>(checks));
  double sum = 0;
  for (const Question& question : questions) {
    const auto found = index.search(std::span(&question.query, 1), kBest, {.rows = &question.others})[0];
    const auto good = std::count_if(found.begin(), found.end(), [&](const ScoredPatch& scored) {
      return scored.score >= question.exact.back().score;
    });
    sum += std::min(1.0, static_cast<double>(good) / static_cast<double>(question.exact.size()));
  }
  return sum / static_cast<double>(questions.size());
}

}  // namespace

void tune_flann(FlannIndex& index, vision::WordMaps words, int word_count,
                std::span<const stored::Row> clip_rows, const FlannTuningOptions& options) {
  assert(index.rows() == words.size() && !clip_rows.empty() && clip_rows.back() == words.size());
  if (words.size() == 0) return;
  const auto questions = questions_of(words, word_count, clip_rows, std::min(options.queries, words.size()));
  const auto maximum = static_cast<std::uint32_t>(std::min<std::size_t>(words.size(), 1 << 30));
  std::uint32_t checks = std::min<std::uint32_t>(64, maximum), too_few = 0;
  double reached = recall(index, questions, checks);
  while (reached < options.recall && checks < maximum) {
    too_few = checks;
    checks = static_cast<std::uint32_t>(std::min<std::uint64_t>(std::uint64_t{checks} * 2, maximum));
    reached = recall(index, questions, checks);
  }
  while (too_few > 0 && checks > too_few + std::max<std::uint32_t>(1, too_few / 5)) {
    const auto middle = static_cast<std::uint32_t>(std::sqrt(1.0 * too_few * checks));
    const double there = recall(index, questions, middle);
    if (there >= options.recall) {
      checks = middle;
      reached = there;
    } else {
      too_few = middle;
    }
  }
  index.set_checks(0);
  index.set_tuning(checks, static_cast<float>(reached));
}

}  // namespace freshet::query
