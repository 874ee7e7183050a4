// studio/ways/design_scene.h — sources, obstacles and winds that were drawn, as the scene file of `synth simulate`.
#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "studio/drawing/document.h"

namespace freshet::studio {

/// TOML, as `freshet synth simulate --keys` explains it. Lines become chains of thick lines, single points discs, areas
/// polygons; a wind is as fast as its arrow is long, per second.
/// picture   px, over which it was drawn. size   px, of what is simulated.
std::string design_scene(const Design& design, cv::Size picture, cv::Size size);

}  // namespace freshet::studio
