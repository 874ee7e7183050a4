#include "tools/console/index_progress.h"

#include <fmt/format.h>

#include "tools/console/progress.h"
#include "tools/console/table.h"

namespace freshet::tools {

query::IndexReport update_index(store::Store& store, const query::IndexOptions& options,
                                const RunContext& context) {
  Progress progress;
  const query::IndexReport report = query::build_index(store, options, progress.callback(), context.stop);
  progress.finish();
  if (report.words_built)
    say(fmt::format("index: {} words from {} descriptors, {} patches of {} clips, {:.1f} s", report.words,
                    report.samples, report.patches, report.clips,
                    report.sample_s + report.train_s + report.assign_s));
  else
    say("index: up to date");
  for (const query::IndexReport::Flann& flann : report.flann_built)
    say(fmt::format("index: {} built in {:.1f} s, {}; {} checks find {:.0f}% of the best 100",
                    query::blob_name(flann.kind), flann.tuning.build_seconds,
                    bytes_text(static_cast<double>(flann.bytes)), flann.tuning.checks,
                    100 * flann.tuning.recall));
  if (report.flann_too_large)
    say("index: no FLANN index, as its histograms of so many patches would take more than 2 GiB of memory; "
        "freshet index --flann hierarchical builds one all the same");
  return report;
}

}  // namespace freshet::tools
