#include "query/index/flann_index.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <random>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "platform/vectors.h"
#include "query/index/dense_histogram.h"
#include "query/index/flann_trees.h"

// FLANN 1.9.2 shuffles by std::random_device inside its kd-trees and draws from std::rand: two builds differ,
// whatever is given to flann::seed_random, and no public parameter or override reaches either. FLANN is all
// templates, so this file has a copy of its own: compiled in namespace seeded_flann, where no other file's FLANN
// and no library's can be mistaken for it. There "std" is looked up first in the namespace below, and what FLANN
// calls std::random_device and std::rand draws from one seeded generator per thread; all else of std is as it
// was.
#define flann seeded_flann
namespace flann::std {
using namespace ::std;

inline ::std::mt19937& seeded() {
  thread_local ::std::mt19937 generator;
  return generator;
}
struct random_device {
  unsigned operator()() { return static_cast<unsigned>(seeded()()); }
};
inline int rand() { return static_cast<int>(seeded()() % (static_cast<unsigned>(RAND_MAX) + 1)); }
}  // namespace flann::std

// FLANN's headers do not include all that they use: this order works.
#include <flann/algorithms/kdtree_index.h>

#include <flann/algorithms/kmeans_index.h>

#include <flann/algorithms/hierarchical_clustering_index.h>
#undef flann
#include <oneapi/tbb/parallel_for.h>

namespace freshet::query {
namespace {

// Each lane a sum of its own, so that the loop becomes vectors of any width and gives the same bits.
constexpr std::size_t kLanes = 64;

template <class T>
[[gnu::always_inline]] inline float l1_to_centre(const unsigned char* a, const T* b, std::size_t bins) {
  T sums[kLanes] = {};
  std::size_t i = 0;
  for (; i + kLanes <= bins; i += kLanes)
    for (std::size_t j = 0; j < kLanes; ++j) sums[j] += std::abs(static_cast<T>(a[i + j]) - b[i + j]);
  for (std::size_t j = 0; i + j < bins; ++j) sums[j] += std::abs(static_cast<T>(a[i + j]) - b[i + j]);
  for (std::size_t half = kLanes / 2; half > 0; half /= 2)
    for (std::size_t j = 0; j < half; ++j) sums[j] += sums[j + half];
  return static_cast<float>(sums[0]);
}
FRESHET_WIDE float l1_to(const unsigned char* a, const float* b, std::size_t bins) {
  return l1_to_centre(a, b, bins);
}
FRESHET_WIDE float l1_to(const unsigned char* a, const double* b, std::size_t bins) {
  return l1_to_centre(a, b, bins);
}

// L1 as FLANN asks for it. flann::L1 adds floats one by one: 2.4 us for 4200 bytes, these 0.1 us; and 0.7 us
// from a patch to a centre of k-means.
struct Distance {
  using is_kdtree_distance = bool;
  using ElementType = unsigned char;
  using ResultType = float;

  float operator()(const unsigned char* a, const unsigned char* b, std::size_t bins, float = -1) const {
    return static_cast<float>(l1_distance(a, b, bins));
  }
  template <class Centre>
  float operator()(const unsigned char* a, const Centre* b, std::size_t bins, float = -1) const {
    return l1_to(a, b, bins);
  }
  template <class Centre>
  float operator()(const Centre* a, const unsigned char* b, std::size_t bins, float = -1) const {
    return l1_to(b, a, bins);
  }
  template <class A, class B>
  float accum_dist(const A& a, const B& b, int) const {
    return std::abs(static_cast<float>(a) - static_cast<float>(b));
  }
};
using Index = seeded_flann::NNIndex<Distance>;

// FLANN's fields one after another. Its own archives compress them, and believe the sizes that they read.
class FieldWriter : public seeded_flann::serialization::OutputArchive<FieldWriter> {
 public:
  template <class T>
  void save(const T& value) {
    save_binary(&value, sizeof value);
  }
  void save_binary(const void* from, std::size_t bytes) {
    const auto* first = static_cast<const std::byte*>(from);
    written.insert(written.end(), first, first + bytes);
  }
  std::vector<std::byte> written;
};

// Of bytes that fault_of_flann_trees() has walked: they are as many as FLANN asks for.
class FieldReader : public seeded_flann::serialization::InputArchive<FieldReader> {
 public:
  explicit FieldReader(std::span<const std::byte> bytes) : left_(bytes) {}
  template <class T>
  void load(T& value) {
    load_binary(&value, sizeof value);
  }
  void load_binary(void* to, std::size_t bytes) {
    if (bytes > left_.size()) throw seeded_flann::FLANNException("it ends in the midst of its trees");
    std::memcpy(to, left_.data(), bytes);
    left_ = left_.subspan(bytes);
  }

 private:
  std::span<const std::byte> left_;
};

// What stands before FLANN's own fields.
struct Header {
  std::array<char, 8> magic{'F', 'R', 'S', 'H', 'F', 'L', 'N', '3'};
  std::uint32_t kind = 0;
  std::uint32_t word_count = 0;
  std::uint64_t rows = 0;
  std::uint64_t words_hash = 0;    // XXH3-64 of the word maps
  std::uint64_t payload_hash = 0;  // XXH3-64 of what follows
  std::uint64_t payload_size = 0;
  FlannTuning tuning;
  std::uint32_t zero = 0;
};
static_assert(sizeof(Header) == 64);

std::uint64_t hash_of(vision::WordMaps words) {
  return XXH3_64bits(words.bytes().data(), words.bytes().size());
}

std::string megabytes(std::size_t bytes) { return std::to_string((bytes + 999999) / 1000000) + " MB"; }

}  // namespace

FlannKind parse_flann_kind(const std::string& name) {
  for (const FlannKind kind : {FlannKind::kKdTree, FlannKind::kKMeans, FlannKind::kHierarchical}) {
    if (name == name_of(kind)) return kind;
  }
  throw Error(ErrorKind::kUsage, "FLANN index \"" + name + "\"", "no such kind",
              "Use kdtree, kmeans or hierarchical");
}

const char* name_of(FlannKind kind) {
  switch (kind) {
    case FlannKind::kKdTree:
      return "kdtree";
    case FlannKind::kKMeans:
      return "kmeans";
    case FlannKind::kHierarchical:
      return "hierarchical";
  }
  return "";
}

std::string blob_name(FlannKind kind) { return std::string("flann-") + name_of(kind); }

struct FlannIndex::Impl {
  FlannOptions options;
  int word_count = 0;
  std::size_t rows = 0, bins = 0;
  std::uint64_t words_hash = 0;
  std::vector<unsigned char> histograms;  // rows * bins
  std::unique_ptr<Index> index;           // null when there are no rows
  FlannTuning tuning;

  Impl(vision::WordMaps words, int count, const FlannOptions& chosen)
      : options(chosen), word_count(count), rows(words.size()), words_hash(hash_of(words)) {
    check_words(words, word_count);
    bins = histogram_bins(word_count);
    if (rows > options.max_bytes / bins) {
      throw Error(ErrorKind::kUsage, std::string("FLANN index ") + name_of(options.kind),
                  std::to_string(rows) + " patches need " + megabytes(rows * bins) +
                      " of histograms, more than the limit of " + megabytes(options.max_bytes),
                  "Use the exact index, which needs " + megabytes(rows * 486) + ", or raise the limit");
    }
    histograms = dense_histograms(words, word_count);
    if (rows == 0) return;
    const seeded_flann::Matrix<unsigned char> data(histograms.data(), rows, bins);
    switch (options.kind) {
      case FlannKind::kKdTree:
        index = std::make_unique<seeded_flann::KDTreeIndex<Distance>>(
            data, seeded_flann::KDTreeIndexParams(options.trees));
        break;
      case FlannKind::kKMeans:
        index = std::make_unique<seeded_flann::KMeansIndex<Distance>>(
            data, seeded_flann::KMeansIndexParams(options.branching, options.iterations));
        break;
      case FlannKind::kHierarchical:
        index = std::make_unique<seeded_flann::HierarchicalClusteringIndex<Distance>>(
            data, seeded_flann::HierarchicalClusteringIndexParams(
                      options.branching, seeded_flann::FLANN_CENTERS_RANDOM, std::max(1, options.trees / 2)));
        break;
    }
  }

  /// Takes FLANN's fields to an archive, or from one.
  template <class Archive>
  void serialise(Archive& archive) const {
    switch (options.kind) {
      case FlannKind::kKdTree:
        archive& static_cast<seeded_flann::KDTreeIndex<Distance>&>(*index);
        break;
      case FlannKind::kKMeans:
        archive& static_cast<seeded_flann::KMeansIndex<Distance>&>(*index);
        break;
      case FlannKind::kHierarchical:
        archive& static_cast<seeded_flann::HierarchicalClusteringIndex<Distance>&>(*index);
        break;
    }
  }

  /// Leaves a half-built index where it is: FLANN's destructor follows children that are not there yet.
  void abandon() { static_cast<void>(index.release()); }

  [[noreturn]] void fail(const std::string& fault) const {
    throw Error(ErrorKind::kDamaged, blob_name(options.kind), fault,
                std::string("Build it again: freshet index --rebuild --flann ") + name_of(options.kind));
  }
};

FlannIndex::FlannIndex(vision::WordMaps words, int word_count, const FlannOptions& options)
    : impl_(std::make_unique<Impl>(words, word_count, options)) {
  if (!impl_->index) return;
  const Stopwatch watch;
  seeded_flann::std::seeded().seed(options.seed);
  try {
    impl_->index->buildIndex();
  } catch (const seeded_flann::FLANNException& error) {
    throw Error(ErrorKind::kUsage, std::string("FLANN index ") + name_of(options.kind), error.what());
  } catch (const std::bad_alloc&) {
    impl_->abandon();
    throw;
  }
  impl_->tuning.build_seconds = static_cast<float>(watch.seconds());
}

FlannIndex::FlannIndex(vision::WordMaps words, int word_count, std::span<const std::byte> bytes,
                       const FlannOptions& options)
    : impl_(std::make_unique<Impl>(words, word_count, options)) {
  const Header expected;
  Header header;
  if (bytes.size() < sizeof header) impl_->fail("shorter than its header");
  std::memcpy(&header, bytes.data(), sizeof header);
  const auto payload = bytes.subspan(sizeof header);
  if (header.magic != expected.magic || header.kind != static_cast<std::uint32_t>(options.kind)) {
    impl_->fail("not an index of this kind");
  }
  if (header.payload_size != payload.size() ||
      header.payload_hash != XXH3_64bits(payload.data(), payload.size())) {
    impl_->fail("its bytes are not those that were written");
  }
  if (header.rows != impl_->rows || header.word_count != static_cast<std::uint32_t>(word_count) ||
      header.words_hash != impl_->words_hash) {
    impl_->fail("built for other patches than the store holds");
  }
  impl_->tuning = header.tuning;
  if (!impl_->index) return;
  if (const std::string fault = fault_of_flann_trees(options.kind, payload, impl_->rows, impl_->bins);
      !fault.empty())
    impl_->fail(fault);
  FieldReader reader(payload);
  try {
    impl_->serialise(reader);
  } catch (const seeded_flann::FLANNException& error) {
    impl_->fail(error.what());
  } catch (const std::bad_alloc&) {
    impl_->abandon();
    throw;
  }
}

FlannIndex::~FlannIndex() = default;

std::size_t FlannIndex::rows() const { return impl_->rows; }

const FlannTuning& FlannIndex::tuning() const { return impl_->tuning; }

void FlannIndex::set_tuning(std::uint32_t checks, float recall) {
  impl_->tuning.checks = checks;
  impl_->tuning.recall = recall;
}

void FlannIndex::set_checks(int checks) { impl_->options.checks = checks; }

std::vector<std::byte> FlannIndex::serialize() const {
  FieldWriter fields;
  if (impl_->index) {
    impl_->serialise(fields);
    // What could not be loaded again is not written.
    if (const std::string fault =
            fault_of_flann_trees(impl_->options.kind, fields.written, impl_->rows, impl_->bins);
        !fault.empty())
      throw Error(ErrorKind::kUsage, blob_name(impl_->options.kind), fault, "Use another kind of index");
  }
  Header header;
  header.kind = static_cast<std::uint32_t>(impl_->options.kind);
  header.word_count = static_cast<std::uint32_t>(impl_->word_count);
  header.rows = impl_->rows;
  header.words_hash = impl_->words_hash;
  header.payload_size = fields.written.size();
  header.tuning = impl_->tuning;
  header.payload_hash = XXH3_64bits(fields.written.data(), fields.written.size());
  std::vector<std::byte> bytes(sizeof header);
  std::memcpy(bytes.data(), &header, sizeof header);
  bytes.insert(bytes.end(), fields.written.begin(), fields.written.end());
  return bytes;
}

namespace {

// The best k admitted rows that FLANN comes upon. While it is not full FLANN looks on, whatever its checks,
// so that k come back whenever k are admitted.
class AdmittedRows final : public seeded_flann::ResultSet<float> {
 public:
  AdmittedRows(std::size_t k, const SearchFilter& search_filter, std::size_t query)
      : k_(k), search_filter_(search_filter), query_(query) {
    heap_.reserve(k);
  }
  bool full() const override { return heap_.size() == k_; }
  float worstDist() const override {
    return full() ? heap_.front().first : std::numeric_limits<float>::max();
  }
  void addPoint(float distance, std::size_t row) override {
    if (!search_filter_.admits(query_, row)) return;
    const std::pair<float, std::size_t> found(distance, row);
    if (full()) {
      if (!(found < heap_.front())) return;
      std::pop_heap(heap_.begin(), heap_.end());
      heap_.back() = found;
    } else {
      heap_.push_back(found);
    }
    std::push_heap(heap_.begin(), heap_.end());
  }
  const std::vector<std::pair<float, std::size_t>>& rows() const { return heap_; }

 private:
  std::size_t k_;
  const SearchFilter& search_filter_;
  std::size_t query_;
  std::vector<std::pair<float, std::size_t>> heap_;  // the worst in front
};

}  // namespace

std::vector<std::vector<ScoredPatch>> FlannIndex::search(std::span<const PieceQuery> queries, std::size_t k,
                                                         const SearchFilter& search_filter) const {
  const Impl& impl = *impl_;
  check(search_filter, queries.size(), impl.rows);
  std::vector<std::vector<ScoredPatch>> answers(queries.size());
  if (k == 0 || impl.rows == 0) return answers;
  const int chosen = impl.options.checks > 0  ? impl.options.checks
                     : impl.tuning.checks > 0 ? static_cast<int>(impl.tuning.checks)
                                              : kUntunedChecks;
  oneapi::tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t i) {
    // Of rows that are not admitted the checks would be wasted: as many more.
    std::size_t allowed = impl.rows;
    if (search_filter.rows != nullptr || !search_filter.windows.empty()) {
      allowed = 0;
      for (std::size_t row = 0; row < impl.rows; ++row) allowed += search_filter.admits(i, row);
      if (allowed == 0) return;
    }
    const double fraction = static_cast<double>(allowed) / static_cast<double>(impl.rows);
    const double maximum = static_cast<double>(std::min<std::size_t>(impl.rows, 1 << 30));
    // At least k, as a result that is not full goes on until it is.
    const double checks = std::min(std::max<double>(chosen, static_cast<double>(k)) / fraction, maximum);
    const seeded_flann::SearchParams parameters(static_cast<int>(checks));
    std::vector<unsigned char> histogram(impl.bins);
    fill_histogram(queries[i], impl.word_count, histogram);
    AdmittedRows found(std::min(k, allowed), search_filter, i);
    impl.index->findNeighbors(found, histogram.data(), parameters);
    const int query_max_score = max_score(queries[i]);
    std::vector<ScoredPatch>& scored_patches = answers[i];
    for (const auto& [distance, row] : found.rows())
      scored_patches.push_back(
          {static_cast<stored::Row>(row), score_of(query_max_score, static_cast<std::uint32_t>(distance))});
    std::sort(scored_patches.begin(), scored_patches.end(), better);
  });
  return answers;
}

}  // namespace freshet::query
