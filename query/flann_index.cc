#include "query/flann_index.h"

// FLANN's headers do not include all that they use: this order works.
#include <flann/algorithms/kdtree_index.h>

#include <flann/algorithms/kmeans_index.h>

#include <flann/algorithms/hierarchical_clustering_index.h>
#include <oneapi/tbb/parallel_for.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdio>
#include <cstring>

#include "freshet_error.h"

namespace freshet::query {
namespace {

using Distance = flann::L1<unsigned char>;
using Index = flann::NNIndex<Distance>;

// What stands before FLANN's own bytes. FLANN's loader ends the process on damage, so it sees only bytes
// whose hash is right and that were written for these very words.
struct Header {
  std::array<char, 8> magic{'F', 'R', 'S', 'H', 'F', 'L', 'N', '1'};
  std::uint32_t kind = 0;
  std::uint32_t word_count = 0;
  std::uint64_t rows = 0;
  std::uint64_t words_hash = 0;    // XXH3-64 of the word maps
  std::uint64_t payload_hash = 0;  // XXH3-64 of what follows
  std::uint64_t payload_size = 0;
};
static_assert(sizeof(Header) == 48);

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

std::uint64_t hash_of(std::span<const vision::WordMap> words) {
  return XXH3_64bits(words.data(), words.size_bytes());
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

  Impl(std::span<const vision::WordMap> words, int count, const FlannOptions& chosen)
      : options(chosen), word_count(count), rows(words.size()), words_hash(hash_of(words)) {
    check_words(words, word_count);
    bins = static_cast<std::size_t>(vision::kPyramidCells) * static_cast<std::size_t>(word_count);
    if (rows > options.max_bytes / bins) {
      throw Error(ErrorKind::kUsage, std::string("FLANN index ") + name_of(options.kind),
                  std::to_string(rows) + " patches need " + megabytes(rows * bins) +
                      " of histograms, more than the limit of " + megabytes(options.max_bytes),
                  "Use the exact index, which needs " + megabytes(rows * 486) + ", or raise the limit");
    }
    histograms.resize(rows * bins);
    oneapi::tbb::parallel_for(std::size_t{0}, rows, [&](std::size_t row) {
      PieceQuery whole{words[row], {}};
      whole.mask.fill(1);
      fill(whole, histograms.data() + row * bins);
    });
    if (rows == 0) return;
    const flann::Matrix<unsigned char> data(histograms.data(), rows, bins);
    switch (options.kind) {
      case FlannKind::kKdTree:
        index = std::make_unique<flann::KDTreeIndex<Distance>>(data, flann::KDTreeIndexParams(options.trees));
        break;
      case FlannKind::kKMeans:
        index = std::make_unique<flann::KMeansIndex<Distance>>(
            data, flann::KMeansIndexParams(options.branching, options.iterations));
        break;
      case FlannKind::kHierarchical:
        index = std::make_unique<flann::HierarchicalClusteringIndex<Distance>>(
            data, flann::HierarchicalClusteringIndexParams(options.branching, flann::FLANN_CENTERS_RANDOM,
                                                           std::max(1, options.trees / 2)));
        break;
    }
  }

  void fill(const PieceQuery& query, unsigned char* histogram) const {
    std::fill(histogram, histogram + bins, static_cast<unsigned char>(0));
    for (int point = 0; point < vision::kGridSide * vision::kGridSide; ++point) {
      if (query.mask[point] == 0 || query.words[point] >= word_count) continue;
      const auto cells = vision::cells_of(point % vision::kGridSide, point / vision::kGridSide);
      for (int level = 0; level < 3; ++level) {
        unsigned char& bin = histogram[cells[level] * word_count + query.words[point]];
        bin = static_cast<unsigned char>(bin + vision::kLevelWeights[level]);  // at most 81
      }
    }
  }

  [[noreturn]] void fail(const std::string& fault) const {
    throw Error(ErrorKind::kDamaged, blob_name(options.kind), fault,
                "Build it again: freshet index --rebuild");
  }
};

FlannIndex::FlannIndex(std::span<const vision::WordMap> words, int word_count, const FlannOptions& options)
    : impl_(std::make_unique<Impl>(words, word_count, options)) {
  if (!impl_->index) return;
  try {
    impl_->index->buildIndex();
  } catch (const flann::FLANNException& error) {
    throw Error(ErrorKind::kUsage, std::string("FLANN index ") + name_of(options.kind), error.what());
  }
}

FlannIndex::FlannIndex(std::span<const vision::WordMap> words, int word_count,
                       std::span<const std::byte> bytes, const FlannOptions& options)
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
  if (!impl_->index) return;
  const File file(fmemopen(const_cast<std::byte*>(payload.data()), payload.size(), "rb"));
  if (!file) impl_->fail("cannot be opened in memory");
  try {
    impl_->index->loadIndex(file.get());
  } catch (const flann::FLANNException& error) {
    impl_->fail(error.what());
  }
}

FlannIndex::~FlannIndex() = default;

std::size_t FlannIndex::rows() const { return impl_->rows; }

std::vector<std::byte> FlannIndex::serialize() const {
  char* memory = nullptr;
  std::size_t size = 0;
  const std::string where = blob_name(impl_->options.kind);
  File file(open_memstream(&memory, &size));
  if (!file) throw Error(ErrorKind::kIo, where, "no memory to write it to");
  std::unique_ptr<char, decltype(&std::free)> owner(nullptr, &std::free);
  try {
    if (impl_->index) impl_->index->saveIndex(file.get());
  } catch (const flann::FLANNException& error) {
    file.reset();
    owner.reset(memory);
    throw Error(ErrorKind::kIo, where, error.what());
  }
  const bool failed = std::ferror(file.get()) != 0 || std::fflush(file.get()) != 0;  // FLANN does not look
  file.reset();
  owner.reset(memory);
  if (failed) throw Error(ErrorKind::kIo, where, "no memory to write it to");
  Header header;
  header.kind = static_cast<std::uint32_t>(impl_->options.kind);
  header.word_count = static_cast<std::uint32_t>(impl_->word_count);
  header.rows = impl_->rows;
  header.words_hash = impl_->words_hash;
  header.payload_size = size;
  header.payload_hash = XXH3_64bits(memory, size);
  std::vector<std::byte> bytes(sizeof header + size);
  std::memcpy(bytes.data(), &header, sizeof header);
  if (size > 0) std::memcpy(bytes.data() + sizeof header, memory, size);
  return bytes;
}

std::vector<std::vector<Hit>> FlannIndex::search(std::span<const PieceQuery> queries, std::size_t k,
                                                 const Admission& admission) const {
  const Impl& impl = *impl_;
  check(admission, queries.size(), impl.rows);
  std::vector<std::vector<Hit>> answers(queries.size());
  k = std::min(k, impl.rows);  // beyond them FLANN would leave garbage
  if (k == 0) return answers;
  oneapi::tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t i) {
    // FLANN knows no conditions: ask for so many more that enough admitted rows should be among them.
    std::size_t asked = k;
    if (admission.rows != nullptr || !admission.windows.empty()) {
      std::size_t allowed = 0;
      for (std::size_t row = 0; row < impl.rows; ++row) allowed += admission.admits(i, row);
      if (allowed == 0) return;
      asked = std::min(impl.rows, (k + 16) * ((2 * impl.rows + allowed - 1) / allowed));
    }
    flann::SearchParams parameters(
        std::max(impl.options.checks, static_cast<int>(std::min<std::size_t>(asked, 1 << 30))));
    parameters.cores = 1;
    std::vector<unsigned char> histogram(impl.bins);
    impl.fill(queries[i], histogram.data());
    std::vector<std::vector<std::size_t>> rows(1);
    std::vector<std::vector<float>> distances(1);
    impl.index->knnSearch(flann::Matrix<unsigned char>(histogram.data(), 1, impl.bins), rows, distances,
                          asked, parameters);
    std::vector<Hit>& hits = answers[i];
    for (const std::size_t row : rows[0]) {
      if (row >= impl.rows || !admission.admits(i, row)) continue;
      const unsigned char* other = impl.histograms.data() + row * impl.bins;
      std::uint32_t score = 0;
      for (std::size_t bin = 0; bin < impl.bins; ++bin) score += std::min(histogram[bin], other[bin]);
      hits.push_back({static_cast<Row>(row), score});
    }
    std::sort(hits.begin(), hits.end(), better);
    hits.erase(std::unique(hits.begin(), hits.end()), hits.end());
    if (hits.size() > k) hits.resize(k);
  });
  return answers;
}

}  // namespace freshet::query
