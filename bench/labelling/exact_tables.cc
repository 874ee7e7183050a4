#include "bench/labelling/exact_tables.h"

#include <fmt/format.h>

#include "bench/harness/machine.h"
#include "bench/labelling/reference_cost.h"
#include "freshet/error.h"
#include "query/costs/pairwise_parts.h"
#include "query/costs/stored_features.h"
#include "query/labelling/labelling.h"
#include "stored/store_settings.h"

namespace freshet::bench {
namespace {

using nlohmann::json;

/// The same patches, where another store has them.
stored::PatchTable in_store(const store::Snapshot& there, const store::Snapshot& here,
                            const stored::PatchTable& table) {
  stored::PatchTable moved;
  moved.variant = table.variant;
  moved.clip = table.clip;
  moved.x = table.x;
  moved.y = table.y;
  for (const store::ClipId id : table.clips) {
    const store::ClipRecord& record = here.clip(id);
    const auto found = there.find_source(record.source_hash);
    if (!found) throw Error(ErrorKind::kNotFound, record.name, "is not in the pooled store");
    moved.clips.push_back(*found);
  }
  return moved;
}

struct Tables {
  query::Mrf mrf;
  double seconds = 0, cpu_seconds = 0;
};

/// query::build_mrf in as much memory as is given.
Tables build_tables(const query::CandidateSearch& search, const query::FeatureShape& shape,
                    const query::PairwiseOptions& options, const query::FeatureSource& source,
                    std::size_t memory_bytes) {
  const double wall = wall_seconds(), cpu = process_seconds();
  Tables tables{query::unconnected_field(search.target, search.candidates)};
  query::Mrf& mrf = tables.mrf;
  query::PartsWanted wanted;
  wanted.memory_bytes = memory_bytes;
  query::visit_parts(search.target, search.candidates, shape, options.form, source, wanted,
                     {[&](std::uint32_t piece, const query::PieceParts& parts) {
                        query::add_votes(parts, options,
                                         {mrf.unary.data() + mrf.first_unary[piece], mrf.label_count[piece]});
                      },
                      [&](std::size_t edge, const query::EdgeParts& parts) {
                        query::weigh(parts, options, {mrf.table(mrf.edges[edge]), parts.motion.size()});
                      }});
  tables.seconds = wall_seconds() - wall;
  tables.cpu_seconds = process_seconds() - cpu;
  return tables;
}

/// The default weights; those of all bands together weigh as the default eight do.
query::PairwiseOptions costs_of(const query::FeatureShape& shape) {
  query::PairwiseOptions options;
  options.sigma *= 8.0 / shape.bands;
  return options;
}

}  // namespace

json measure_exact(const store::Snapshot& pooled, const store::Snapshot& exact,
                   const PictureArgument& picture, std::size_t memory_bytes) {
  const query::SearchBase base = query::open_search(exact);
  const query::CandidateSearch search =
      query::search_candidates(exact, base, picture.picture, picture.matte, {});
  const vision::Settings pooled_settings = stored::settings_of(pooled);
  if (base.settings.variants() != pooled_settings.variants())
    throw Error(ErrorKind::kUsage, "the exact store", "has other variants than the pooled one");
  const query::FeatureShape shape = query::feature_shape(base.settings),
                            pooled_shape = query::feature_shape(pooled_settings);
  const stored::PatchTable table = in_store(pooled, exact, base.table);
  const query::StoredFeatures exact_features(exact, base.settings, base.table),
      pooled_features(pooled, pooled_settings, table);
  const query::PartsWanted usual;
  const Tables coarse = build_tables(search, pooled_shape, costs_of(pooled_shape), pooled_features.source(),
                                     usual.memory_bytes);
  const Tables fine = build_tables(search, shape, costs_of(shape), exact_features.source(), memory_bytes);
  const TableError error = check_tables(fine.mrf, search, shape, costs_of(shape), exact_features.source());
  const query::Solution best = query::minimize(fine.mrf, query::Minimizer::kTrwS),
                        chosen = query::minimize(coarse.mrf, query::Minimizer::kTrwS);
  const double loss = query::energy(fine.mrf, chosen.labels) / best.energy - 1;
  fmt::print(
      "\n{}, {} x {}: {} pieces, {} edges; tables of cells of {} px, {} bands: {:.2f} s, {:.2f} s of CPU; of "
      "{} px, {} bands, in {} MB: {:.2f} s, {:.2f} s of CPU, error {:.1e}\n  energy {:.3f}, bound {:.3f}; of "
      "the labels that the first tables choose {:.3f} % more\n",
      picture.name, picture.picture.cols, picture.picture.rows, search.target.size(),
      search.target.edges.size(), pooled_settings.spectrum.cell, pooled_shape.bands, coarse.seconds,
      coarse.cpu_seconds, base.settings.spectrum.cell, shape.bands, memory_bytes >> 20, fine.seconds,
      fine.cpu_seconds, error.relative, best.energy, best.lower_bound, 100 * loss);
  return {{"picture", picture.name},
          {"width", picture.picture.cols},
          {"height", picture.picture.rows},
          {"pieces", search.target.size()},
          {"edges", search.target.edges.size()},
          {"pooled_seconds", coarse.seconds},
          {"pooled_cpu_seconds", coarse.cpu_seconds},
          {"exact_seconds", fine.seconds},
          {"exact_cpu_seconds", fine.cpu_seconds},
          {"looks_mb", memory_bytes >> 20},
          {"peak_mb", static_cast<double>(peak_bytes()) / 1e6},
          {"greatest_relative_error", error.relative},
          {"energy", best.energy},
          {"lower_bound", best.lower_bound},
          {"loss_of_pooled_labels", loss},
          {"right", error.relative <= kErrorAllowed}};
}

}  // namespace freshet::bench
