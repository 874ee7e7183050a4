#include <fmt/format.h>

#include <limits>

#include "query/benchmark/measured_index.h"
#include "query/index/flann_index.h"

namespace freshet::query {
namespace {

BuiltIndex with_settings(std::shared_ptr<FlannIndex> index) {
  BuiltIndex built{index, {}};
  for (std::size_t checks = 128; checks < std::max<std::size_t>(index->rows(), 129); checks *= 4)
    built.settings.push_back(
        {fmt::format("checks {}", checks), [index, checks] { index->set_checks(static_cast<int>(checks)); }});
  return built;
}

MeasuredIndex measured_flann(FlannKind kind, std::string what) {
  // The benchmark itself sees to memory.
  const FlannOptions options{.kind = kind, .max_bytes = std::numeric_limits<std::size_t>::max()};
  return {.name = blob_name(kind),
          .what = std::move(what),
          .is_exact = false,
          .build =
              [options](const SearchSpace& space) {
                return with_settings(std::make_shared<FlannIndex>(space.words, space.word_count, options));
              },
          .load = [options](const SearchSpace& space,
                            const store::Snapshot& snapshot) -> std::optional<BuiltIndex> {
            const auto bytes = snapshot.blob(blob_name(options.kind));
            if (!bytes) return {};
            const auto index = std::make_shared<FlannIndex>(space.words, space.word_count, *bytes, options);
            BuiltIndex built = with_settings(index);
            built.build_seconds = index->tuning().build_seconds;
            if (index->tuning().checks > 0)
              built.settings.push_back({fmt::format("checks {}, tuned", index->tuning().checks),
                                        [index] { index->set_checks(0); }});
            return built;
          }};
}

}  // namespace

MeasuredIndex measured_flann_kdtree() {
  return measured_flann(FlannKind::kKdTree, "8 random trees, L1 of dense bytes");
}
MeasuredIndex measured_flann_kmeans() {
  return measured_flann(FlannKind::kKMeans, "branching 32, 5 iterations, L1 of dense bytes");
}
MeasuredIndex measured_flann_hierarchical() {
  return measured_flann(FlannKind::kHierarchical, "4 trees, branching 32, leaves of 100, L1 of dense bytes");
}

}  // namespace freshet::query
