#include "query/labelling/labelling_memo.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "query/costs/pairwise_parts.h"

namespace freshet::query {
namespace {

// What a hash is of, so that equal bytes of different meaning differ.
enum class Kind : std::uint8_t { kIdentity, kFilter, kRows, kAnswer, kStrength, kTable, kSolution };

cache::KeyHash hash_of(Kind kind) {
  cache::KeyHash hash;
  hash.add(kind);
  return hash;
}

// Values of one type after another, and back; reading beyond the end fails.
class Bytes {
 public:
  template <class T>
  void put(std::span<const T> values) {
    const auto bytes = std::as_bytes(values);
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  template <class T>
  void put(const T& value) {
    put(std::span<const T>(&value, 1));
  }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

class Reading {
 public:
  explicit Reading(std::span<const std::byte> bytes) : left_(bytes) {}
  template <class T>
  bool get(std::span<T> values) {
    if (left_.size() < values.size_bytes()) return false;
    std::memcpy(values.data(), left_.data(), values.size_bytes());
    left_ = left_.subspan(values.size_bytes());
    return true;
  }
  template <class T>
  bool get(T& value) {
    return get(std::span<T>(&value, 1));
  }
  std::size_t left() const { return left_.size(); }

 private:
  std::span<const std::byte> left_;
};

// Field by field, so that a weight that is added to its struct and not to the hash does not compile.
void add_table_weights(const PairwiseOptions& options, cache::KeyHash& hash) {
  const auto& [form, lambda, sigma, rho, vote] = options;  // the vote is of pieces, not of edges
  hash.add(form);
  for (const double weight : {lambda, sigma, rho}) hash.add(weight);
}
void add_weights(const PairwiseOptions& options, cache::KeyHash& hash) {
  add_table_weights(options, hash);
  hash.add(options.vote);
}
void add_weights(const GuideCosts& costs, cache::KeyHash& hash) {
  const auto& [direction, speed, unsteady] = costs;
  for (const double weight : {direction, speed, unsteady}) hash.add(weight);
}
void add_weights(const ReuseCosts& costs, cache::KeyHash& hash) {
  const auto& [overlap, crowd] = costs;
  for (const double weight : {overlap, crowd}) hash.add(weight);
}

constexpr int kMaxOpenings = 100;

std::vector<std::byte> bytes_of(const PieceAnswer& answer) {
  Bytes bytes;
  bytes.put(static_cast<std::int32_t>(answer.opened));
  for (const ScoredPatch& scored : answer.scored_patches) {
    bytes.put(scored.row);
    bytes.put(scored.score);
  }
  return {bytes.bytes().begin(), bytes.bytes().end()};
}

// Nothing when the bytes cannot be an answer: never trusted, whatever their hash.
std::optional<PieceAnswer> answer_of(std::span<const std::byte> bytes, std::size_t k, std::size_t rows,
                                     int max_score) {
  Reading reading(bytes);
  std::int32_t opened = 0;
  if (!reading.get(opened) || opened < 0 || opened > kMaxOpenings || reading.left() % 8 != 0)
    return std::nullopt;
  PieceAnswer answer;
  answer.opened = opened;
  answer.scored_patches.resize(reading.left() / 8);
  if (answer.scored_patches.empty() || answer.scored_patches.size() > k) return std::nullopt;
  for (ScoredPatch& scored : answer.scored_patches) {
    if (!reading.get(scored.row) || !reading.get(scored.score)) return std::nullopt;
    if (scored.row >= rows || scored.score > static_cast<std::uint32_t>(max_score)) return std::nullopt;
  }
  if (!std::is_sorted(answer.scored_patches.begin(), answer.scored_patches.end(), better))
    return std::nullopt;
  return answer;
}

// That costs are what costs can be.
bool are_costs(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(),
                     [](float value) { return value >= 0 && std::isfinite(value); });
}

}  // namespace

std::string to_string(const Reuse& reuse) {
  if (reuse.labels) return "the whole labelling reused";
  return fmt::format("{} of {} pieces' candidates and {} of {} edges reused", reuse.reused_pieces,
                     reuse.pieces, reuse.reused_edges, reuse.edges);
}

LabellingMemo::LabellingMemo(cache::ResultCache& cache, const store::Snapshot& snapshot,
                             const SearchBase& base)
    : cache_(cache), base_(base) {
  cache::KeyHash hash = hash_of(Kind::kIdentity);
  hash.add(snapshot.settings());
  hash.add(base.codebook.words);
  hash.add(std::span<const float>(base.codebook.centres));
  for (const store::ClipId clip : base.table.clips) {
    const store::ClipRecord& record = snapshot.clip(clip);
    hash.add(record.name);
    hash.add(record.source_hash);
    hash.add(record.metadata);  // how its cells lie
  }
  const stored::PatchTable& table = base.table;
  hash.add(std::span<const stored::Row>(table.first_row));
  hash.add(std::span<const std::uint8_t>(table.variant));
  hash.add(std::span<const std::uint16_t>(table.x));
  hash.add(std::span<const std::uint16_t>(table.y));
  hash.add(std::span<const float>(table.mean_u));
  hash.add(std::span<const float>(table.mean_v));
  hash.add(table.words.bytes());
  identity_ = hash.key();
}

Candidates LabellingMemo::find_candidates(const Target& target, const cv::Mat& matte, std::size_t k,
                                          const RowFilter& filter, const MotionGuide& guide) {
  reuse_ = {};
  reuse_.pieces = target.size();
  reuse_.edges = target.edges.size();
  if (!base_.is_exact)
    return query::find_candidates(*base_.index, base_.table, target, matte, k, filter, guide);
  cache::KeyHash filtered = hash_of(Kind::kFilter);
  filtered.add(filter.bit_words());
  const cache::Key rows = filtered.key();
  std::vector<PieceMotion> asked;
  if (!guide.empty()) asked = asked_motion(guide, target, matte);
  std::vector<cache::Key> keys;
  std::vector<std::optional<PieceAnswer>> answers(target.size());
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    const PieceQuery& query = target.queries[piece];
    cache::KeyHash hash = hash_of(Kind::kAnswer);
    hash.add(identity_);
    hash.add(rows);
    hash.add(std::uint64_t{k});
    hash.add(std::span<const vision::Word>(query.words));
    hash.add(std::span<const std::uint8_t>(query.mask));
    // Every window that may be asked, one after another, up to the one that asks nothing.
    for (int steps = 0; !asked.empty() && steps < kMaxOpenings; ++steps) {
      const MotionWindow window = window_of(asked[piece], guide, steps);
      if (window.is_any()) break;
      const auto& [u, v, min_cosine, min_speed, max_speed] = window;
      for (const float value : {u, v, min_cosine, min_speed, max_speed}) hash.add(value);
    }
    keys.push_back(hash.key());
    if (const auto bytes = cache_.find(keys.back()))
      answers[piece] = answer_of(*bytes, k, base_.table.size(), max_score(query));
    reuse_.reused_pieces += answers[piece].has_value();
  }
  std::vector<bool> known;
  for (const auto& answer : answers) known.push_back(answer.has_value());
  Candidates candidates =
      query::find_candidates(*base_.index, base_.table, target, matte, k, filter, guide, &answers);
  for (std::size_t piece = 0; piece < target.size(); ++piece)
    if (!known[piece]) cache_.keep(keys[piece], bytes_of(*answers[piece]));
  return candidates;
}

cache::Key LabellingMemo::key_of_candidates(std::span<const stored::Row> rows) const {
  cache::KeyHash hash = hash_of(Kind::kRows);
  hash.add(identity_);
  hash.add(rows);
  return hash.key();
}

Mrf LabellingMemo::build_mrf(const Target& target, const Candidates& candidates, const FeatureShape& shape,
                             const PairwiseOptions& options, const FeatureSource& source,
                             std::stop_token stop) {
  check_weights(options);
  Mrf mrf = unconnected_field(target, candidates);
  if (shape.overlap == 0 || options.lambda == 0) return mrf;
  std::vector<cache::Key> rows_of, strength_of, table_of;
  PartsWanted wanted{std::vector<bool>(target.size()), std::vector<bool>(target.edges.size())};
  const auto unary_of = [&](std::size_t piece) {
    return std::span(mrf.unary).subspan(mrf.first_unary[piece], mrf.label_count[piece]);
  };
  std::vector<float> strength;
  const auto vote = [&](std::size_t piece, std::span<const float> values) {
    const std::size_t count = mrf.label_count[piece];
    add_votes({values.first(count), values.subspan(count)}, options, unary_of(piece));
  };
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    rows_of.push_back(key_of_candidates(candidates.rows_of(piece)));
    cache::KeyHash hash = hash_of(Kind::kStrength);
    hash.add(rows_of.back());
    hash.add(options.form);
    strength_of.push_back(hash.key());
    if (options.vote == 0) continue;
    wanted.pieces[piece] = true;
    const auto bytes = cache_.find(strength_of.back());
    if (!bytes || bytes->size() != 2 * sizeof(float) * mrf.label_count[piece]) continue;
    strength.resize(2 * mrf.label_count[piece]);
    std::memcpy(strength.data(), bytes->data(), bytes->size());
    if (!are_costs(strength)) continue;
    vote(piece, strength);
    wanted.pieces[piece] = false;
  }
  for (std::size_t e = 0; e < target.edges.size(); ++e) {
    const auto [p, q] = target.edges[e];
    cache::KeyHash hash = hash_of(Kind::kTable);
    hash.add(rows_of[p]);
    hash.add(rows_of[q]);
    hash.add(target.places[p].y == target.places[q].y);
    add_table_weights(options, hash);
    table_of.push_back(hash.key());
    wanted.edges[e] = true;
    const std::span<PairCost> table(mrf.table(mrf.edges[e]),
                                    std::size_t{mrf.label_count[p]} * mrf.label_count[q]);
    const auto bytes = cache_.find(table_of.back());
    if (!bytes || bytes->size() != table.size_bytes()) continue;
    std::memcpy(table.data(), bytes->data(), bytes->size());  // any bits are a cost
    wanted.edges[e] = false;
    ++reuse_.reused_edges;
  }
  const PartsSink sink{[&](std::uint32_t piece, const PieceParts& parts) {
                         Bytes bytes;
                         bytes.put(parts.motion);
                         bytes.put(parts.dynamics);
                         cache_.keep(strength_of[piece], bytes.bytes());
                         add_votes(parts, options, unary_of(piece));
                       },
                       [&](std::size_t edge, const EdgeParts& parts) {
                         const std::span<PairCost> table(mrf.table(mrf.edges[edge]), parts.motion.size());
                         weigh(parts, options, table);
                         cache_.keep(table_of[edge], std::as_bytes(table));
                       }};
  visit_parts(target, candidates, shape, options.form, source, wanted, sink, stop);
  return mrf;
}

cache::Key LabellingMemo::solution_key(const Target& target, const Candidates& candidates,
                                       const PairwiseOptions& options, const GuideCosts& guide_costs,
                                       const ReuseCosts& reuse, Minimizer minimizer,
                                       int max_iterations) const {
  cache::KeyHash hash = hash_of(Kind::kSolution);
  hash.add(identity_);
  for (const cv::Point place : target.places) {
    hash.add(place.x);
    hash.add(place.y);
  }
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    hash.add(candidates.rows_of(piece));
    hash.add(candidates.scores_of(piece));
    hash.add(candidates.steadiness_of(piece));
  }
  hash.add(std::uint64_t{candidates.asked.size()});
  for (const auto& [direction, speed] : candidates.asked)
    for (const float value : {direction[0], direction[1], speed}) hash.add(value);
  add_weights(options, hash);
  add_weights(guide_costs, hash);
  add_weights(reuse, hash);
  hash.add(minimizer);
  hash.add(max_iterations);
  return hash.key();
}

std::optional<Solution> LabellingMemo::find_solution(const cache::Key& key, const Target& target,
                                                     const Candidates& candidates) {
  const auto bytes = cache_.find(key);
  if (!bytes) return std::nullopt;
  Reading reading(*bytes);
  Solution solution;
  solution.labels.resize(target.size());
  solution.margins.resize(target.size());
  if (!reading.get(solution.energy) || !reading.get(solution.lower_bound) ||
      !reading.get(solution.iterations) || !reading.get(std::span(solution.labels)) ||
      !reading.get(std::span(solution.margins)) || reading.left() > 0)
    return std::nullopt;
  for (std::size_t piece = 0; piece < target.size(); ++piece)
    if (solution.labels[piece] >= candidates.counts[piece]) return std::nullopt;
  if (!std::isfinite(solution.energy) || std::isnan(solution.lower_bound)) return std::nullopt;
  reuse_.labels = true;
  reuse_.reused_edges = reuse_.edges;
  return solution;
}

void LabellingMemo::keep_solution(const cache::Key& key, const Solution& solution) {
  Bytes bytes;
  bytes.put(solution.energy);
  bytes.put(solution.lower_bound);
  bytes.put(solution.iterations);
  bytes.put(std::span<const std::uint32_t>(solution.labels));
  bytes.put(std::span<const float>(solution.margins));
  cache_.keep(key, bytes.bytes());
}

}  // namespace freshet::query
