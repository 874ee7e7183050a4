#include "synth/stills/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "freshet/error.h"
#include "platform/random.h"

namespace freshet::synth::stills {
namespace {

constexpr int kDraws = 64;  // of loops

// A place of a path from which a step may be taken.
struct Place {
  int before, at, after;
  bool turn;  // the path begins here
};

std::vector<Place> places_of(const std::vector<Path>& paths) {
  std::vector<Place> places;
  for (const Path& path : paths)
    for (std::size_t k = 0; k + 1 < path.size(); ++k)
      places.push_back(
          {.before = k > 0 ? path[k - 1] : path[1], .at = path[k], .after = path[k + 1], .turn = k == 0});
  return places;
}

class Walk {
 public:
  Walk(const StillGraph& graph, const std::vector<Path>& paths, const SamplingOptions& options,
       const StepCost& extra, std::uint64_t draw)
      : graph_(graph),
        places_(places_of(paths)),
        paths_(paths),
        options_(options),
        extra_(extra),
        random_(options.seed, draw),
        chance_(places_.size()) {
    // A place that is drawn evenly lies on a long path more often than on a short one.
    const Place& start = places_[random_.below(static_cast<int>(places_.size()))];
    stills_ = {start.at, start.after};
  }

  std::vector<int> run(int steps) {
    while (static_cast<int>(stills_.size()) <= steps) step();
    stills_.resize(static_cast<std::size_t>(steps) + 1);
    return std::move(stills_);
  }

 private:
  void step() {
    const int before = stills_[stills_.size() - 2], now = stills_.back();
    weigh(before, now);
    double all = 0;
    for (const double each : chance_) all += each;
    int next = draw(all);
    // A turn is taken back as often as the person says, within reason: there may be nothing else. The way to a still
    // farther off may turn as well.
    for (int tries = 0; tries < 64 && graph_.next(now, next) == before && turns_within_path(before, now);
         ++tries) {
      if (random_.next() < options_.irregularity) break;
      next = draw(all);
    }
    const std::vector<int> way = graph_.way(now, next);
    stills_.insert(stills_.end(), way.begin() + 1, way.end());
  }

  void weigh(int before, int now) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    double sum = 0;
    int counted = 0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Place& place = places_[i];
      double penalty = graph_.distance(place.at, now);
      if (options_.order == 2) penalty += graph_.distance(place.before, before);
      if (extra_) penalty += extra_(place.at, place.after, static_cast<int>(stills_.size()) - 1);
      if (place.after == now || !std::isfinite(graph_.distance(now, place.after))) penalty = kNever;
      chance_[i] = penalty;
      if (std::isfinite(penalty)) sum += penalty, ++counted;
    }
    if (counted == 0)
      throw Error(ErrorKind::kInput, "paths", "no path leads on from a still of the sequence",
                  "Give a path through it, or cut fewer edges");
    const double scale = options_.sigma * (options_.by_sum ? sum : sum / counted);
    for (double& each : chance_) each = !std::isfinite(each) ? 0 : scale > 0 ? std::exp(-each / scale) : 1;
  }

  int draw(double all) {
    double left = all * random_.next();
    for (std::size_t i = 0; i < places_.size(); ++i)
      if ((left -= chance_[i]) < 0) return places_[i].after;
    for (std::size_t i = places_.size(); i-- > 0;)
      if (chance_[i] > 0) return places_[i].after;
    return places_.front().after;
  }

  // Whether some path goes on from here, so that turning back is no necessity.
  bool turns_within_path(int before, int now) const {
    for (const Path& path : paths_)
      for (std::size_t k = 1; k + 1 < path.size(); ++k)
        if (path[k] == now && path[k - 1] == before) return true;
    return false;
  }

  const StillGraph& graph_;
  std::vector<Place> places_;
  const std::vector<Path>& paths_;
  const SamplingOptions& options_;
  const StepCost& extra_;
  Random random_;
  std::vector<double> chance_;
  std::vector<int> stills_;
};

struct Closing {
  double cost = std::numeric_limits<double>::infinity();
  std::vector<int> stills;
};

// The walk up to a place from which the way back fits, and that way.
Closing closed(const StillGraph& graph, const std::vector<int>& walk, int steps) {
  Closing best;
  for (int last = 1; last <= steps; ++last) {
    const std::vector<int> way = graph.way(walk[last], walk[0]);
    if (way.empty()) continue;
    const int length = last + static_cast<int>(way.size()) - 1;
    const double missing = std::abs(length - steps) / static_cast<double>(steps);
    const double cost = graph.distance(walk[last], walk[0]) + 4 * missing * graph.mean_edge_weight;
    if (cost >= best.cost) continue;
    best.cost = cost;
    best.stills.assign(walk.begin(), walk.begin() + last);
    best.stills.insert(best.stills.end(), way.begin(), way.end());
  }
  return best;
}

}  // namespace

std::vector<Path> without_dead_ends(const std::vector<Path>& paths, int stills) {
  std::vector<std::set<int>> beside(static_cast<std::size_t>(stills));
  for (const Path& path : paths)
    for (std::size_t k = 0; k + 1 < path.size(); ++k) {
      beside[path[k]].insert(path[k + 1]);
      beside[path[k + 1]].insert(path[k]);
    }
  for (bool changed = true; changed;) {
    changed = false;
    for (int i = 0; i < stills; ++i) {
      if (beside[i].size() != 1) continue;
      beside[*beside[i].begin()].erase(i);
      beside[i].clear();
      changed = true;
    }
  }
  std::vector<Path> left;
  for (const Path& path : paths) {
    Path run;
    for (const int still : path) {
      if (beside[still].empty()) continue;
      run.push_back(still);
    }
    if (run.size() > 1) left.push_back(std::move(run));
  }
  left = without_contained(left);
  return left.empty() ? paths : left;
}

std::vector<int> sample_sequence(const StillGraph& graph, const std::vector<Path>& all_paths,
                                 const SamplingOptions& options, const StepCost& extra) {
  if (all_paths.empty())
    throw Error(ErrorKind::kInput, "paths", "none is left", "Refuse fewer of them, or give an order");
  const std::vector<Path> paths =
      options.avoid_dead_ends ? without_dead_ends(all_paths, graph.count()) : all_paths;
  if (!options.loop) return Walk(graph, paths, options, extra, 0).run(options.steps);
  Closing best;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    Closing found = closed(graph, Walk(graph, paths, options, extra, draw).run(options.steps), options.steps);
    if (found.cost < best.cost) best = std::move(found);
  }
  return best.stills;
}

}  // namespace freshet::synth::stills
