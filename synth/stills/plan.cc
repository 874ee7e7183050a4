#include "synth/stills/plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "synth/stills/between/flow_pair.h"
#include "synth/stills/region_split.h"
#include "synth/stills/still_set.h"

namespace freshet::synth::stills {
namespace {

constexpr int kDirectionSide = 200;  // px, longer side of the copies on which directions are found

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

/// Mean directions of flow between any two stills, by part: vectors of length 1, or 0 where nothing goes
/// anywhere.
class Directions {
 public:
  Directions(const std::vector<cv::Mat>& stills, const std::vector<Region>& parts) : of_(parts.size()) {
    const std::vector<cv::Mat> small = reduced(stills, kDirectionSide);
    const int n = static_cast<int>(small.size());
    std::vector<cv::Mat> masks(parts.size());
    for (std::size_t k = 0; k < parts.size(); ++k) {
      cv::resize(parts[k].mask, masks[k], small[0].size(), 0, 0, cv::INTER_NEAREST);
      of_[k] = Square<cv::Vec2d>(n, {0, 0});
    }
    oneapi::tbb::parallel_for(0, n, [&](int i) {
      for (int j = 0; j < i; ++j) {
        const FlowPair flow = flow_between(small[j], small[i]);
        for (std::size_t k = 0; k < parts.size(); ++k) {
          of_[k](j, i) = unit(cv::mean(flow.forth, masks[k]));
          of_[k](i, j) = unit(cv::mean(flow.back, masks[k]));
        }
      }
    });
  }
  const cv::Vec2d& of(std::size_t part, int from, int to) const { return of_[part](from, to); }

 private:
  static cv::Vec2d unit(const cv::Scalar& mean) {
    constexpr double kNowhere = .05;  // px
    const double length = std::hypot(mean[0], mean[1]);
    return length * FlowPair::kUnit < kNowhere ? cv::Vec2d(0, 0)
                                               : cv::Vec2d(mean[0] / length, mean[1] / length);
  }
  std::vector<Square<cv::Vec2d>> of_;
};

class Planner {
 public:
  Planner(const std::vector<cv::Mat>& small, const std::vector<std::string>& names,
          const PlanOptions& options, const Job& job)
      : small_(small),
        looked_at_(reduced(small, options.side)),
        names_(names),
        options_(options),
        job_(job) {}

  Plan run(const std::vector<Region>& regions) {
    plan_.standing = middle_still(still_distances(looked_at_, {}, 2));
    check_names(regions);
    std::size_t done = 0;
    for (Region region : regions) {
      if (job_.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "stills", "stopped");
      if (job_.progress) job_.progress({"finding orders", done++, regions.size()});
      const RegionEdits edits = edits_of(options_.edits, region);
      if (edits.kind) region.kind = *edits.kind;
      if (region.kind == RegionKind::kStanding) continue;
      const int parts = region.kind == RegionKind::kSlow ? 1 : edits.split.value_or(options_.split);
      const std::vector<Region> split =
          parts > 1 ? split_region(region, small_, {.parts = parts}) : std::vector{region};
      if (split.size() == 1)
        plan_.regions.push_back(plan_region(region, {}));
      else
        plan_parts(split);
      if (parts > 1 && static_cast<int>(split.size()) < parts)
        plan_.notices.push_back(
            fmt::format("region {}: cut into {} parts; the calm lines in it do not give {}", region.name,
                        split.size(), parts));
    }
    return std::move(plan_);
  }

 private:
  void check_names(const std::vector<Region>& regions) const {
    std::string known;
    for (const Region& region : regions) known += (known.empty() ? "" : ", ") + region.name;
    for (const RegionEdits& edits : options_.edits) {
      const bool found =
          edits.region == "*" || std::any_of(regions.begin(), regions.end(), [&](const Region& region) {
            return edits.region == region.name || edits.region.starts_with(region.name + ".");
          });
      if (!found)
        throw Error(ErrorKind::kInput, "region " + edits.region, "there is no region of this name",
                    "There are " + known);
    }
  }

  /// Each part goes by the neighbour with which it shares most border, of those that are done.
  void plan_parts(const std::vector<Region>& parts) {
    std::vector<std::vector<double>> borders(parts.size(), std::vector<double>(parts.size(), 0));
    for (std::size_t i = 0; i < parts.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        borders[i][j] = borders[j][i] = common_border(parts[i].mask, parts[j].mask);
    const ProcessingOrder best = best_processing_order(borders);
    const Directions directions(looked_at_, parts);
    std::map<int, std::size_t> planned;  // by part, its place among the plan's regions
    for (const int part : best.order) {
      StepCost extra;
      const int reference = best.reference[part];
      std::vector<int> followed;
      if (reference >= 0) followed = plan_.regions[planned.at(reference)].sequence;
      if (!followed.empty())
        extra = [&](int from, int to, int n) {
          const auto last = static_cast<int>(followed.size()) - 2;
          if (last < 0) return 0.0;
          const int at = std::min(n, last);
          return cv::norm(directions.of(static_cast<std::size_t>(part), from, to) -
                          directions.of(static_cast<std::size_t>(reference), followed[at], followed[at + 1]));
        };
      planned[part] = plan_.regions.size();
      plan_.regions.push_back(plan_region(parts[part], extra));
      if (reference >= 0) plan_.regions.back().reference = parts[reference].name;
    }
  }

  GraphOptions graph_options(const RegionEdits& edits) const {
    GraphOptions graph = options_.graph;
    for (const auto& cut : edits.cut)
      graph.cut.emplace_back(still_named(cut[0], names_, "cut"), still_named(cut[1], names_, "cut"));
    for (const auto& order : edits.order)
      for (std::size_t k = 0; k + 1 < order.size(); ++k)
        graph.join.emplace_back(still_named(order[k], names_, "order"),
                                still_named(order[k + 1], names_, "order"));
    return graph;
  }

  TimingOptions timing_of(const Region& region, const RegionEdits& edits) const {
    TimingOptions timing = options_.timing;
    if (region.kind == RegionKind::kSlow) timing.step_s = options_.slow_step_s;
    timing.step_s = edits.step_s.value_or(timing.step_s);
    timing.speed *= edits.speed.value_or(1);
    timing.slow_turns = edits.slow_turns.value_or(timing.slow_turns);
    if (options_.loop) timing.exactly_s = options_.seconds;
    return timing;
  }

  std::vector<int> sequence_of(const PlannedRegion& region, const RegionEdits& edits, double step_s,
                               const StepCost& direction) const {
    if (!edits.sequence.empty()) {
      std::vector<int> given;
      for (const std::string& name : edits.sequence) given.push_back(still_named(name, names_, "sequence"));
      if (options_.loop && given.front() != given.back()) given.push_back(given.front());
      return given;
    }
    SamplingOptions sampling = options_.sampling;
    sampling.sigma = edits.sigma.value_or(sampling.sigma);
    sampling.irregularity = edits.irregularity.value_or(sampling.irregularity);
    sampling.loop = options_.loop;
    // By the name: that one region is edited leaves the others as they were.
    for (const char letter : region.region.name)
      sampling.seed = sampling.seed * 131 + static_cast<unsigned char>(letter);
    const double steps = options_.seconds / step_s;
    // Steps differ in length; what is too many is not shown.
    sampling.steps = std::max(2, static_cast<int>(std::lround(options_.loop ? steps : 1.8 * steps + 2)));
    StepCost extra;
    if (direction) {
      const double lambda = options_.follow * region.graph.mean_edge_weight;
      extra = [&direction, lambda](int from, int to, int n) { return lambda * direction(from, to, n); };
    }
    return sample_sequence(region.graph, region.paths, sampling, extra);
  }

  PlannedRegion plan_region(const Region& region, const StepCost& direction) {
    const RegionEdits edits = edits_of(options_.edits, region);
    cv::Mat mask;
    cv::resize(region.mask, mask, looked_at_[0].size(), 0, 0, cv::INTER_AREA);
    Square<double> rms = still_distances(looked_at_, mask > 127, options_.blur_px);
    StillGraph graph = make_graph(rms, graph_options(edits));
    if (graph.parts() > 1)
      plan_.notices.push_back(fmt::format(
          "region {}: its graph falls into {} parts, and {} of {} stills are shown. Raise --cut-above, add "
          "an order to the --edits, or take more stills in between",
          region.name, graph.parts(), std::count(graph.part.begin(), graph.part.end(), 0), graph.count()));
    std::vector<Path> paths = edited_paths(extremal_paths(graph), edits, names_);
    if (paths.empty())
      throw Error(ErrorKind::kInput, "region " + region.name, "no path is left",
                  "Refuse fewer paths, cut fewer edges, or give an order");
    PlannedRegion planned{.region = region,
                          .rms = std::move(rms),
                          .graph = std::move(graph),
                          .paths = std::move(paths),
                          .sequence = {},
                          .timeline = Timeline({0}, Square<double>(1)),
                          .reference = {},
                          .front = {}};
    const TimingOptions timing = timing_of(region, edits);
    planned.sequence = sequence_of(planned, edits, timing.step_s / timing.speed, direction);
    planned.timeline = Timeline(planned.sequence, planned.rms, timing);
    return planned;
  }

  const std::vector<cv::Mat>& small_;
  std::vector<cv::Mat> looked_at_;
  const std::vector<std::string>& names_;
  const PlanOptions& options_;
  const Job& job_;
  Plan plan_;
};

}  // namespace

Plan make_plan(const std::vector<cv::Mat>& small, const std::vector<std::string>& names,
               const std::vector<Region>& regions, const PlanOptions& options, const Job& job) {
  return Planner(small, names, options, job).run(regions);
}

}  // namespace freshet::synth::stills
