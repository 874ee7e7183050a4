// synth/scene/kinds/kind_keys.h — how lines and places of a layer are read.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/kinds/line.h"
#include "synth/toml/keys.h"

namespace freshet::synth::scene {

inline constexpr double kFarPx = 1e6;

/// [x, y, x, y], or a list of such.
std::vector<Line> lines_of(Section& section, const std::string& key);
/// One at most.
std::optional<Line> line_of(Section& section, const std::string& key);
/// [x, y], px; (0, 0) where the key is not there.
cv::Point place_of(Section& section, const std::string& key);

}  // namespace freshet::synth::scene
