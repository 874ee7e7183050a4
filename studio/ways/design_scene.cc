#include "studio/ways/design_scene.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace freshet::studio {
namespace {

constexpr double kWindStrength = 0.6;  // of the difference that is made up per second

/// What the fluids differ in: they are those of the presets plume, firepit and waterfall-pool.
struct FluidText {
  const char* name;
  const char* head;    // beside size, frames, fps and the tables of the fluid and its look
  const char* source;  // keys of each emitter
};
constexpr FluidText kFluids[] = {
    {"smoke", R"(steps = 2
warm_up = 2.0
[fluid]
buoyancy = 1.6
top_speed = 0.75
vorticity = 1.2
dissipation = 0.15
cooling = 0.2
[look]
opacity = 3.0
)",
     "softness = 0.02\nvelocity = [0.0, -0.45]\nheat = 1.0\njitter = 0.7\nlump = 0.05\n"},
    {"fire", R"(steps = 3
warm_up = 1.5
[fluid]
buoyancy = 4.5
top_speed = 1.3
vorticity = 0.5
burning = 0.5
still_air = 1.5
cooling = 0.5
[look]
opacity = 4.0
thin = [0.8, 0.16, 0.02]
dense = [1.0, 0.62, 0.2]
glow = 1.0
)",
     "softness = 0.02\nrate = 1.3\nvelocity = [0.0, -0.5]\nheat = 1.0\nexpansion = 2.5\njitter = 1.0\nlump = "
     "0.06\n"},
    {"water", R"(steps = 4
warm_up = 2.0
[fluid]
gravity = 1.5
weight = 30
vorticity = 0.3
burning = 0.25
drag = 0.5
still_air = 1.0
[look]
opacity = 3.0
thin = [0.2, 0.32, 0.42]
dense = [0.8, 0.84, 0.95]
)",
     "softness = 0.01\nvelocity = [0.0, 0.5]\njitter = 0.5\nlump = 0.05\n"},
};

const FluidText& fluid_of(const Design& design) {
  const auto* const found = std::find_if(std::begin(kFluids), std::end(kFluids),
                                         [&](const FluidText& each) { return each.name == design.fluid; });
  return found == std::end(kFluids) ? kFluids[0] : *found;
}

std::string place(const cv::Point2f& point, cv::Size picture) {
  return fmt::format("[{:.4f}, {:.4f}]", point.x / static_cast<float>(picture.width),
                     point.y / static_cast<float>(picture.height));
}

/// The shapes of a line or an area: the keys of one table each.
std::vector<std::string> shapes_of(const Drawn& drawn, cv::Size picture) {
  const double width = drawn.width / picture.height;
  if (drawn.is_area) {
    std::vector<std::string> corners;
    for (const cv::Point2f& point : drawn.points) corners.push_back(place(point, picture));
    return {fmt::format("shape = \"polygon\"\ncorners = [{}]\n", fmt::join(corners, ", "))};
  }
  if (drawn.points.size() == 1)
    return {fmt::format("shape = \"disc\"\nposition = {}\nradius = {:.4f}\n", place(drawn.points[0], picture),
                        width / 2)};
  std::vector<std::string> shapes;
  for (std::size_t i = 1; i < drawn.points.size(); ++i)
    shapes.push_back(fmt::format("shape = \"line\"\nstart = {}\nend = {}\nwidth = {:.4f}\n",
                                 place(drawn.points[i - 1], picture), place(drawn.points[i], picture),
                                 width));
  return shapes;
}

}  // namespace

std::string design_scene(const Design& design, cv::Size picture, cv::Size size) {
  const FluidText& fluid = fluid_of(design);
  std::string toml = fmt::format("size = [{}, {}]\nframes = {}\nfps = 25\ngrid = 160\n{}", size.width,
                                 size.height, design.frames, fluid.head);
  for (const Drawn& drawn : design.sources)
    for (const std::string& shape : shapes_of(drawn, picture))
      toml += drawn.adds ? "[[emitter]]\n" + shape + fluid.source : "[[obstacle]]\n" + shape;
  for (const DrawnStroke& wind : design.winds) {
    const cv::Point2f way = (wind.points.back() - wind.points.front()) / static_cast<float>(picture.height);
    toml += fmt::format("[[force]]\nkind = \"wind\"\nvelocity = [{:.4f}, {:.4f}]\nstrength = {}\n", way.x,
                        way.y, kWindStrength);
  }
  return toml + "[[force]]\nkind = \"turbulence\"\nsize = 0.15\nstrength = 0.8\n";
}

}  // namespace freshet::studio
