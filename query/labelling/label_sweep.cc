#include "query/labelling/label_sweep.h"

#include <algorithm>
#include <atomic>
#include <optional>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include "freshet/error.h"
#include "query/costs/pairwise_parts.h"
#include "query/costs/stored_features.h"

namespace freshet::query {
namespace {

// What a field's parts take, in its tables: three floats for one cost.
constexpr std::size_t kTablesOfParts = 3 * sizeof(float) / sizeof(PairCost);

}  // namespace

std::vector<SweptLabelling> label_variations(const store::Snapshot& snapshot, const CandidateSearch& search,
                                             std::span<const LabelVariation> variations,
                                             const SweepOptions& options,
                                             const std::function<void(std::size_t)>& progress,
                                             std::stop_token stop) {
  for (const LabelVariation& variation : variations) check_weights(variation.costs);
  const SearchBase& base = *search.base;
  const FeatureShape shape = feature_shape(base.settings);
  std::vector<SweptLabelling> labellings(variations.size());
  std::atomic<std::size_t> done = 0;
  const auto solve = [&](std::size_t i, Mrf mrf) {
    if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, "labelling", "stopped");
    const LabelVariation& variation = variations[i];
    add_guide_costs(base.table, search.candidates, options.guide_costs, mrf);
    add_reuse_costs(snapshot, base.settings, base.table, search.target, search.candidates, options.reuse,
                    mrf);
    Solution solution = minimize_spread(base.table, search.candidates, options.reuse, variation.minimizer,
                                        variation.max_iterations, mrf);
    labellings[i] = {make_assignment(snapshot, search, solution, variation.minimizer, variation.costs.form),
                     std::move(solution.labels), solution.iterations};
    if (progress) progress(++done);
  };

  const std::size_t table = std::max<std::size_t>(1, table_bytes(search.target, search.candidates));
  const std::size_t tables = options.memory_bytes / table;
  for (const CostForm form : {CostForm::kLog, CostForm::kPower}) {
    std::vector<std::size_t> of_form;
    for (std::size_t i = 0; i < variations.size(); ++i)
      if (variations[i].costs.form == form) of_form.push_back(i);
    if (of_form.empty()) continue;
    StoredFeatures features(snapshot, base.settings, base.table);
    if (tables <= kTablesOfParts || of_form.size() == 1) {
      for (const std::size_t i : of_form)
        solve(i, build_mrf(search.target, search.candidates, shape, variations[i].costs, features.source(),
                           stop));
      continue;
    }
    const PairwiseParts parts =
        find_parts(search.target, search.candidates, shape, form, features.source(), stop);
    const std::size_t at_once = std::min(
        tables - kTablesOfParts, static_cast<std::size_t>(oneapi::tbb::this_task_arena::max_concurrency()));
    oneapi::tbb::task_arena arena(static_cast<int>(at_once));
    arena.execute([&] {
      oneapi::tbb::parallel_for(
          oneapi::tbb::blocked_range<std::size_t>(0, of_form.size(), 1),
          [&](const auto& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i)
              solve(of_form[i],
                    combine(search.target, search.candidates, parts, variations[of_form[i]].costs));
          },
          oneapi::tbb::simple_partitioner());
    });
  }
  return labellings;
}

}  // namespace freshet::query
