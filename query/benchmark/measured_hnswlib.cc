#include "query/benchmark/measured_index.h"

#ifdef FRESHET_HAS_HNSWLIB
#include <hnswlib/hnswlib.h>

#include <fmt/format.h>

#include "freshet/error.h"
#include "query/index/dense_histogram.h"
#endif

namespace freshet::query {

#ifdef FRESHET_HAS_HNSWLIB
namespace {

// L1 of dense bytes, as wide as the machine's vectors are.
class Space final : public hnswlib::SpaceInterface<int> {
 public:
  explicit Space(std::size_t bins) : bins_(bins) {}
  std::size_t get_data_size() override { return bins_; }
  hnswlib::DISTFUNC<int> get_dist_func() override {
    return [](const void* a, const void* b, const void* bins) {
      return static_cast<int>(l1_distance(static_cast<const unsigned char*>(a),
                                          static_cast<const unsigned char*>(b),
                                          *static_cast<const std::size_t*>(bins)));
    };
  }
  void* get_dist_func_param() override { return &bins_; }

 private:
  std::size_t bins_;
};

class Graph final : public CandidateIndex {
 public:
  static constexpr std::size_t kLinks = 16, kThoroughness = 100, kSeed = 100;

  explicit Graph(const SearchSpace& space)
      : word_count_(space.word_count),
        space_(histogram_bins(space.word_count)),
        graph_(&space_, std::max<std::size_t>(1, space.words.size()), kLinks, kThoroughness, kSeed) {
    std::vector<unsigned char> histogram(histogram_bins(word_count_));
    try {
      for (std::size_t row = 0; row < space.words.size(); ++row) {
        fill_histogram(whole_query(space.words[row]), word_count_, histogram);
        graph_.addPoint(histogram.data(), row);
      }
    } catch (const std::exception& error) {
      throw Error(ErrorKind::kIo, "hnswlib", error.what());
    }
  }

  void set_ef(std::size_t ef) { graph_.setEf(ef); }
  std::size_t rows() const override { return graph_.cur_element_count; }

  std::vector<std::vector<ScoredPatch>> search(std::span<const PieceQuery> queries, std::size_t k,
                                               const SearchFilter& search_filter) const override {
    return search_each(queries, [&](const PieceQuery& query, std::size_t number) {
      std::vector<unsigned char> histogram(histogram_bins(word_count_));
      fill_histogram(query, word_count_, histogram);
      const int query_max_score = max_score(query);
      return search_widening(rows(), k, search_filter, number, [&](std::size_t count) {
        auto found = graph_.searchKnn(histogram.data(), count);
        std::vector<ScoredPatch> scored_patches;
        for (; !found.empty(); found.pop())
          scored_patches.push_back(
              {static_cast<stored::Row>(found.top().second),
               score_of(query_max_score, static_cast<std::uint32_t>(found.top().first))});
        return scored_patches;
      });
    });
  }

 private:
  int word_count_;
  Space space_;
  hnswlib::HierarchicalNSW<int> graph_;
};

BuiltIndex build(const SearchSpace& space) {
  const auto graph = std::make_shared<Graph>(space);
  BuiltIndex built{graph, {}};
  for (const std::size_t ef : {100, 150, 200, 400, 800})
    built.settings.push_back({fmt::format("ef {}", ef), [graph, ef] { graph->set_ef(ef); }});
  return built;
}

}  // namespace
#endif

MeasuredIndex measured_hnswlib() {
  MeasuredIndex measured{.name = "hnswlib",
                         .what = "graph of 16 links, efConstruction 100, L1 of dense bytes",
                         .package = "libhnswlib-dev"};
#ifdef FRESHET_HAS_HNSWLIB
  measured.build = build;
#endif
  return measured;
}

}  // namespace freshet::query
