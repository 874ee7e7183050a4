// FAISS takes floats. Its flat index and its graph search by L1 in all bins, as they stand. Its inverted file
// throws at a search by L1 (1.7.3), and L2 of counts is another neighbourhood. So FAISS's k-means and
// quantizer make the lists, by L2 of the roots of counts (Hellinger, close to L1) projected to 256
// dimensions, and what is in the lists that a query comes to is compared by L1 of all bins, in bytes, which
// is more than its floats could.

#include "query/benchmark/measured_index.h"

#ifdef FRESHET_HAS_FAISS
#include <faiss/Clustering.h>
#include <faiss/IndexFlat.h>
#include <faiss/IndexHNSW.h>
#include <faiss/VectorTransform.h>
#include <omp.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "freshet/error.h"
#include "query/index/dense_histogram.h"
#endif

namespace freshet::query {

#ifdef FRESHET_HAS_FAISS
namespace {

constexpr int kProjected = 256;  // dimensions
constexpr int kLinks = 16, kThoroughness = 100;
constexpr std::size_t kBlock = 1024;  // rows added at a time

// FAISS spreads work by OpenMP. Queries are spread by TBB here, as for every other index.
class OneThread {
 public:
  OneThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;
  ~OneThread() { omp_set_num_threads(before_); }

 private:
  int before_;
};

template <class Work>
auto of_faiss(Work&& work) {
  const OneThread one;
  try {
    return work();
  } catch (const std::exception& error) {
    throw Error(ErrorKind::kIo, "FAISS", error.what());
  }
}

// Blocks of vectors, each made by `fill(row, to)`.
template <class Fill>
void add_rows(faiss::Index& index, std::size_t rows, Fill&& fill) {
  const auto size = static_cast<std::size_t>(index.d);
  std::vector<float> block;
  for (std::size_t first = 0; first < rows; first += kBlock) {
    const std::size_t count = std::min(kBlock, rows - first);
    block.resize(count * size);
    for (std::size_t i = 0; i < count; ++i) fill(first + i, std::span(block).subspan(i * size, size));
    index.add(static_cast<faiss::Index::idx_t>(count), block.data());
  }
}

struct Found {
  std::vector<float> distances;
  std::vector<faiss::Index::idx_t> rows;  // -1: none
};

Found ask(const faiss::Index& index, const std::vector<float>& query, std::size_t count) {
  Found found{std::vector<float>(count), std::vector<faiss::Index::idx_t>(count)};
  index.search(1, query.data(), static_cast<faiss::Index::idx_t>(count), found.distances.data(),
               found.rows.data());
  return found;
}

/// A FAISS index by L1 over all bins.
template <class Index>
class AllBins final : public CandidateIndex {
 public:
  template <class... Arguments>
  explicit AllBins(const SearchSpace& space, Arguments... arguments)
      : word_count_(space.word_count),
        index_(static_cast<int>(histogram_bins(space.word_count)), arguments..., faiss::METRIC_L1) {}

  Index& faiss_index() { return index_; }
  void add(vision::WordMaps words) {
    std::vector<unsigned char> bytes(histogram_bins(word_count_));
    add_rows(index_, words.size(), [&](std::size_t row, std::span<float> to) {
      fill_histogram(whole_query(words[row]), word_count_, bytes);
      std::copy(bytes.begin(), bytes.end(), to.begin());
    });
  }
  std::size_t rows() const override { return static_cast<std::size_t>(index_.ntotal); }

  std::vector<std::vector<ScoredPatch>> search(std::span<const PieceQuery> queries, std::size_t k,
                                               const SearchFilter& search_filter) const override {
    return search_each(queries, [&](const PieceQuery& query, std::size_t number) {
      std::vector<unsigned char> bytes(histogram_bins(word_count_));
      fill_histogram(query, word_count_, bytes);
      const std::vector<float> asked(bytes.begin(), bytes.end());
      const int query_max_score = max_score(query);
      return search_widening(rows(), k, search_filter, number, [&](std::size_t count) {
        const Found found = of_faiss([&] { return ask(index_, asked, count); });
        std::vector<ScoredPatch> scored_patches;
        for (std::size_t i = 0; i < count; ++i)
          if (found.rows[i] >= 0)
            scored_patches.push_back(
                {static_cast<stored::Row>(found.rows[i]),
                 score_of(query_max_score, static_cast<std::uint32_t>(found.distances[i]))});
        return scored_patches;
      });
    });
  }

 private:
  int word_count_;
  Index index_;
};

/// FAISS's k-means lists, searched by L1 of all bins.
class InvertedFile final : public CandidateIndex {
 public:
  InvertedFile(const SearchSpace& space, std::size_t lists)
      : word_count_(space.word_count),
        rows_(space.words.size()),
        projection_(static_cast<int>(histogram_bins(space.word_count)), kProjected),
        quantizer_(kProjected),
        rows_of_(lists),
        histograms_of_(lists) {
    projection_.init(1);
    for (std::size_t count = 0; count < roots_.size(); ++count)
      roots_[count] = std::sqrt(static_cast<float>(count));
    const std::size_t bins = histogram_bins(word_count_);
    std::vector<unsigned char> bytes(bins);
    const auto projected = [&](std::size_t row, std::span<float> to) {
      fill_histogram(whole_query(space.words[row]), word_count_, bytes);
      project(bytes, to);
    };
    // As many as k-means needs.
    const std::size_t sampled = std::min(rows_, 64 * lists);
    std::vector<float> sample(sampled * kProjected), one(kProjected);
    for (std::size_t i = 0; i < sampled; ++i)
      projected(i * rows_ / sampled, std::span(sample).subspan(i * kProjected, kProjected));
    faiss::ClusteringParameters parameters;
    parameters.seed = 1;
    parameters.niter = 10;
    parameters.min_points_per_centroid = 1;  // no warning on stderr for small stores
    faiss::Clustering clustering(kProjected, static_cast<int>(lists), parameters);
    clustering.train(static_cast<faiss::Index::idx_t>(sampled), sample.data(), quantizer_);
    for (std::size_t row = 0; row < rows_; ++row) {
      projected(row, one);
      const auto list = static_cast<std::size_t>(ask(quantizer_, one, 1).rows[0]);
      rows_of_[list].push_back(static_cast<stored::Row>(row));
      histograms_of_[list].insert(histograms_of_[list].end(), bytes.begin(), bytes.end());
    }
  }

  std::size_t lists() const { return rows_of_.size(); }
  void probe(std::size_t lists) { probed_ = lists; }
  std::size_t rows() const override { return rows_; }

  std::vector<std::vector<ScoredPatch>> search(std::span<const PieceQuery> queries, std::size_t k,
                                               const SearchFilter& search_filter) const override {
    return search_each(queries, [&](const PieceQuery& query, std::size_t number) {
      const std::size_t bins = histogram_bins(word_count_);
      std::vector<unsigned char> bytes(bins);
      fill_histogram(query, word_count_, bytes);
      std::vector<float> asked(kProjected);
      project(bytes, asked);
      const int query_max_score = max_score(query);
      const Found near = of_faiss([&] { return ask(quantizer_, asked, std::min(probed_, lists())); });
      std::vector<ScoredPatch> scored_patches;
      for (const auto list : near.rows) {
        if (list < 0) continue;
        const auto& rows = rows_of_[static_cast<std::size_t>(list)];
        const unsigned char* histogram = histograms_of_[static_cast<std::size_t>(list)].data();
        for (std::size_t i = 0; i < rows.size(); ++i, histogram += bins)
          if (search_filter.admits(number, rows[i]))
            scored_patches.push_back(
                {rows[i], score_of(query_max_score, l1_distance(bytes.data(), histogram, bins))});
      }
      const std::size_t kept = std::min(k, scored_patches.size());
      std::partial_sort(scored_patches.begin(), scored_patches.begin() + static_cast<std::ptrdiff_t>(kept),
                        scored_patches.end(), better);
      scored_patches.resize(kept);
      return scored_patches;
    });
  }

 private:
  void project(std::span<const unsigned char> bytes, std::span<float> to) const {
    const auto bins = static_cast<std::size_t>(projection_.d_in);
    std::vector<std::size_t> used;  // some 130 of 4200
    for (std::size_t bin = 0; bin < bins; ++bin)
      if (bytes[bin] != 0) used.push_back(bin);
    for (std::size_t d = 0; d < kProjected; ++d) {
      const float* row = projection_.A.data() + d * bins;
      float sum = 0;
      for (const std::size_t bin : used) sum += roots_[bytes[bin]] * row[bin];
      to[d] = sum;
    }
  }

  int word_count_;
  std::size_t rows_;
  faiss::RandomRotationMatrix projection_;
  std::array<float, 256> roots_{};
  faiss::IndexFlatL2 quantizer_;
  std::vector<std::vector<stored::Row>> rows_of_;  // of each list
  std::vector<std::vector<unsigned char>> histograms_of_;
  std::size_t probed_ = 1;
};

BuiltIndex build_flat(const SearchSpace& space) {
  return of_faiss([&]() -> BuiltIndex {
    const auto index = std::make_shared<AllBins<faiss::IndexFlat>>(space);
    index->add(space.words);
    return {index, {{"all rows", [] {}}}};
  });
}

BuiltIndex build_hnsw(const SearchSpace& space) {
  return of_faiss([&]() -> BuiltIndex {
    const auto index = std::make_shared<AllBins<faiss::IndexHNSWFlat>>(space, kLinks);
    index->faiss_index().hnsw.efConstruction = kThoroughness;
    index->add(space.words);
    BuiltIndex built{index, {}};
    for (const int ef : {100, 200, 400, 800})
      built.settings.push_back(
          {fmt::format("ef {}", ef), [index, ef] { index->faiss_index().hnsw.efSearch = ef; }});
    return built;
  });
}

BuiltIndex build_ivf(const SearchSpace& space) {
  return of_faiss([&]() -> BuiltIndex {
    const auto lists = std::clamp<std::size_t>(
        static_cast<std::size_t>(std::sqrt(static_cast<double>(space.words.size()))), 1, 4096);
    const auto index = std::make_shared<InvertedFile>(space, lists);
    BuiltIndex built{index, {}};
    for (std::size_t probed = 1; probed == 1 || 2 * probed <= lists; probed *= 2) {
      if (32 * probed < lists && probed > 1) continue;  // finds too little
      built.settings.push_back(
          {fmt::format("{} of {} lists", probed, lists), [index, probed] { index->probe(probed); }});
    }
    return built;
  });
}

}  // namespace
#endif

namespace {

MeasuredIndex of_package(MeasuredIndex measured,
                         [[maybe_unused]] std::function<BuiltIndex(const SearchSpace&)> build) {
  measured.package = "libfaiss-dev";
  measured.build = std::move(build);
  return measured;
}
#ifndef FRESHET_HAS_FAISS
constexpr std::nullptr_t build_flat = nullptr, build_hnsw = nullptr, build_ivf = nullptr;
#endif

}  // namespace

MeasuredIndex measured_faiss_flat() {
  return of_package({.name = "faiss-flat", .what = "IndexFlat, L1 of dense floats", .is_exact = true},
                    build_flat);
}
MeasuredIndex measured_faiss_hnsw() {
  return of_package(
      {.name = "faiss-hnsw", .what = "IndexHNSWFlat, 16 links, efConstruction 100, L1 of dense floats"},
      build_hnsw);
}
MeasuredIndex measured_faiss_ivf() {
  return of_package({.name = "faiss-ivf",
                     .what = "lists by FAISS's k-means and quantizer (L2 of roots of bins, projected to 256 "
                             "dimensions), as IndexIVFFlat cannot search by L1; in them L1 of dense bytes"},
                    build_ivf);
}

}  // namespace freshet::query
