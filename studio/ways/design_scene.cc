#include "studio/ways/design_scene.h"

#include <algorithm>
#include <sstream>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "synth/simulate/design/scene_file.h"

namespace freshet::studio {
namespace {

constexpr double kWindStrength = 0.6;  // of the difference that is made up per second

/// A fluid goes and looks as that of a preset.
struct DesignFluid {
  const char *name, *preset;
  int steps;
  double warm_up_s;
};
constexpr DesignFluid kFluids[] = {
    {"smoke", "plume", 2, 2.0}, {"fire", "firepit", 3, 1.5}, {"water", "waterfall-pool", 4, 2.0}};

const DesignFluid& fluid_of(const Design& design) {
  const auto* const found = std::find_if(std::begin(kFluids), std::end(kFluids),
                                         [&](const DesignFluid& each) { return each.name == design.fluid; });
  return found == std::end(kFluids) ? kFluids[0] : *found;
}

/// The first table of that header in a preset's text, up to the empty line behind it; without the header.
std::string table_of(const std::string& preset, const std::string& header) {
  const std::size_t begin = preset.find("\n" + header + "\n") + header.size() + 2;
  return preset.substr(begin, preset.find("\n\n", begin) + 1 - begin);
}

/// An emitter's keys but for its name and its shape, which are drawn.
std::string without_shape(const std::string& emitter) {
  static constexpr std::string_view kDrawn[] = {"name",  "shape", "position", "radius",
                                                "start", "end",   "width",    "corners"};
  std::string kept, line;
  for (std::istringstream lines(emitter); std::getline(lines, line);) {
    const std::string_view key = std::string_view(line).substr(0, line.find(' '));
    if (std::find(std::begin(kDrawn), std::end(kDrawn), key) == std::end(kDrawn)) kept += line + "\n";
  }
  return kept;
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
  const DesignFluid& fluid = fluid_of(design);
  const std::string preset = synth::simulate::preset_scene(fluid.preset);
  const std::string source = without_shape(table_of(preset, "[[emitter]]"));
  std::string toml = fmt::format(
      "size = [{}, {}]\nframes = {}\nfps = 25\ngrid = 160\nsteps = {}\nwarm_up = {}\n[fluid]\n{}[look]\n{}",
      size.width, size.height, design.frames, fluid.steps, fluid.warm_up_s, table_of(preset, "[fluid]"),
      table_of(preset, "[look]"));
  for (const Drawn& drawn : design.sources)
    for (const std::string& shape : shapes_of(drawn, picture))
      toml += drawn.adds ? "[[emitter]]\n" + shape + source : "[[obstacle]]\n" + shape;
  for (const DrawnStroke& wind : design.winds) {
    const cv::Point2f way = (wind.points.back() - wind.points.front()) / static_cast<float>(picture.height);
    toml += fmt::format("[[force]]\nkind = \"wind\"\nvelocity = [{:.4f}, {:.4f}]\nstrength = {}\n", way.x,
                        way.y, kWindStrength);
  }
  return toml + "[[force]]\nkind = \"turbulence\"\nsize = 0.15\nstrength = 0.8\n";
}

}  // namespace freshet::studio
