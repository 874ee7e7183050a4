#include "synth/stills/plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::synth::stills {
namespace {

// The still that is least unlike all others.
int middle_still(const Square<double>& rms) {
  int best = 0;
  double least = -1;
  for (int i = 0; i < rms.n; ++i) {
    double sum = 0;
    for (int j = 0; j < rms.n; ++j) sum += rms(i, j);
    if (least < 0 || sum < least) best = i, least = sum;
  }
  return best;
}

SamplingOptions sampling_of(const PlanOptions& options, const Region& region, double step_s,
                            std::uint64_t number) {
  SamplingOptions sampling = options.sampling;
  sampling.loop = options.loop;
  sampling.seed = options.sampling.seed * 1000003 + number;
  const double steps = options.seconds / step_s;
  // Steps differ in length; what is too many is not shown.
  sampling.steps = std::max(2, static_cast<int>(std::lround(options.loop ? steps : 1.8 * steps + 2)));
  (void)region;
  return sampling;
}

}  // namespace

Plan make_plan(const std::vector<cv::Mat>& small, const std::vector<Region>& regions,
               const PlanOptions& options, const Job& job) {
  Plan plan;
  plan.standing = middle_still(still_distances(small, {}, 2));
  std::size_t done = 0;
  for (const Region& region : regions) {
    if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "stills", "stopped");
    if (job.progress) job.progress({"finding orders", done++, regions.size()});
    if (region.kind == RegionKind::kStanding) continue;
    const bool slow = region.kind == RegionKind::kSlow;
    Square<double> rms = still_distances(small, region.mask);
    StillGraph graph = make_graph(rms, options.graph);
    if (graph.parts() > 1)
      plan.notices.push_back(fmt::format(
          "region {}: its graph falls into {} parts; {} of {} stills are shown. Take more stills in between, "
          "or raise "
          "--cut-above",
          region.name, graph.parts(), std::count(graph.part.begin(), graph.part.end(), 0), graph.count()));
    std::vector<Path> paths = extremal_paths(graph);
    TimingOptions timing = options.timing;
    if (slow) timing.step_s = options.slow_step_s;
    if (options.loop) timing.exactly_s = options.seconds;
    std::vector<int> sequence =
        sample_sequence(graph, paths, sampling_of(options, region, timing.step_s / timing.speed, done));
    Timeline timeline(sequence, rms, timing);
    plan.regions.push_back({.region = region,
                            .rms = std::move(rms),
                            .graph = std::move(graph),
                            .paths = std::move(paths),
                            .sequence = std::move(sequence),
                            .timeline = std::move(timeline)});
  }
  return plan;
}

}  // namespace freshet::synth::stills
