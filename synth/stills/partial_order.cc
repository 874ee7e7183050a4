#include "synth/stills/partial_order.h"

#include <algorithm>

namespace freshet::synth::stills {

bool is_part_of(const Path& part, const Path& whole) {
  return std::search(whole.begin(), whole.end(), part.begin(), part.end()) != whole.end();
}

Path reversed(const Path& path) { return {path.rbegin(), path.rend()}; }

std::vector<Path> without_contained(const std::vector<Path>& paths) {
  std::vector<Path> kept;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    bool contained = false;
    for (std::size_t j = 0; j < paths.size() && !contained; ++j)
      contained = j != i && (paths[j].size() > paths[i].size() || j < i) && is_part_of(paths[i], paths[j]);
    if (!contained) kept.push_back(paths[i]);
  }
  return kept;
}

std::vector<Path> extremal_paths(const StillGraph& graph) {
  std::vector<Path> paths;
  for (int from = 0; from < graph.count(); ++from) {
    if (graph.part[from] != 0) continue;
    int farthest = from;
    for (int to = 0; to < graph.count(); ++to)
      if (graph.part[to] == 0 && graph.distance(from, to) > graph.distance(from, farthest)) farthest = to;
    if (farthest == from) continue;
    paths.push_back(graph.way(from, farthest));
    paths.push_back(reversed(paths.back()));
  }
  return without_contained(paths);
}

}  // namespace freshet::synth::stills
