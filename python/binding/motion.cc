#include <array>
#include <optional>

#include "freshet/motion.h"

#include "python/binding/binding.h"

namespace freshet::python {
namespace {

using Line = std::array<float, 4>;  // x, y, x, y

std::optional<Horizon> horizon_from(const std::optional<Line>& line) {
  if (!line) return std::nullopt;
  return Horizon{{(*line)[0], (*line)[1]}, {(*line)[2], (*line)[3]}};
}

std::optional<Line> line_of(const std::optional<Horizon>& horizon) {
  if (!horizon) return std::nullopt;
  return Line{horizon->from.x, horizon->from.y, horizon->to.x, horizon->to.y};
}

}  // namespace

void bind_motion(py::module_& module) {
  py::class_<MotionGuide>(module, "MotionGuide", "Where and how fast the fluid is to go, pixel by pixel.")
      .def(py::init([](const cv::Mat& direction, const cv::Mat& speed, double tolerance_deg,
                       double speed_ratio, double min_speed, const std::optional<Line>& horizon) {
             MotionGuide guide{direction, speed, tolerance_deg, speed_ratio, min_speed};
             guide.horizon = horizon_from(horizon);
             return guide;
           }),
           py::kw_only(), "direction"_a = py::none(), "speed"_a = py::none(),
           "tolerance_deg"_a = MotionGuide{}.tolerance_deg, "speed_ratio"_a = MotionGuide{}.speed_ratio,
           "min_speed_px_per_s"_a = MotionGuide{}.min_speed_px_per_s, "horizon"_a = py::none())
      .def_readonly(
          "direction", &MotionGuide::direction,
          "(height, width, 2), float32: unit vectors, x right, y down; (0, 0): not asked. Or empty.")
      .def_readonly("speed", &MotionGuide::speed,
                    "(height, width), float32, px/s; negative: not asked. Or empty.")
      .def_readonly("tolerance_deg", &MotionGuide::tolerance_deg, "Degrees to either side, 0 to 180.")
      .def_readonly("speed_ratio", &MotionGuide::speed_ratio,
                    "From asked / ratio to asked * ratio; at least 1.")
      .def_readonly("min_speed_px_per_s", &MotionGuide::min_speed_px_per_s,
                    "Slower patches have no direction that counts.")
      .def_property_readonly(
          "horizon", [](const MotionGuide& guide) { return line_of(guide.horizon); },
          "(x, y, x, y), px, from left to right: where a plane of water ends, towards which it goes slower. "
          "Or None.");
  module.def(
      "read_strokes",
      [](const std::filesystem::path& path, cv::Size size, const std::optional<Line>& horizon) {
        return read_strokes(path, size, nullptr, horizon_from(horizon));
      },
      "path"_a, "size"_a, "horizon"_a = py::none(),
      "The guide that lines drawn over a picture make: SVG or JSON. size: (width, height), px. horizon: of "
      "find_horizon: speeds between the lines shrink towards it.",
      Unlocked());
  module.def(
      "find_horizon",
      [](const cv::Mat& picture, const cv::Mat& matte, const std::string& class_name) {
        return line_of(find_horizon(picture, matte, class_name));
      },
      "picture"_a, "matte"_a, "class_name"_a = "",
      "(x, y, x, y), px, from left to right: the straight, level upper border of a matte of water. Or None.");
}

}  // namespace freshet::python
