#include "synth/scene/kinds/kind_keys.h"

#include <fmt/format.h>

namespace freshet::synth::scene {

std::vector<Line> lines_of(Section& section, const std::string& key) {
  std::vector<Line> lines;
  for (const std::vector<double>& row : section.rows(key, 4, {-kFarPx, kFarPx}))
    lines.push_back({{row[0], row[1]}, {row[2], row[3]}});
  return lines;
}

std::optional<Line> line_of(Section& section, const std::string& key) {
  const std::vector<Line> lines = lines_of(section, key);
  if (lines.empty()) return {};
  if (lines.size() > 1) section.refuse(key, fmt::format("one line is expected, not {}", lines.size()));
  return lines[0];
}

cv::Point place_of(Section& section, const std::string& key) {
  Vec2 at{};
  section.read(key, at, {-1e5, 1e5});
  return {cvRound(at.x), cvRound(at.y)};
}

}  // namespace freshet::synth::scene
