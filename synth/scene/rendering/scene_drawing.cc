#include "synth/scene/rendering/scene_drawing.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "synth/scene/water/camera.h"

namespace freshet::synth::scene {
namespace {

constexpr double kTint = 0.35;
constexpr int kShift = 4;  // of the lines' fractions of a px

cv::Scalar colour_of(std::size_t layer) {
  // Hues at the golden angle: neighbours are told apart.
  cv::Mat hsv(1, 1, CV_8UC3, cv::Scalar(static_cast<double>(layer * 69 % 180), 220, 255)), bgr;
  cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
  const cv::Vec3b c = bgr.at<cv::Vec3b>(0, 0);
  return {static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])};
}

cv::Point fixed(cv::Point2d p) {
  const double most = 1e5;
  return {cvRound((std::clamp(p.x, -most, most) - 0.5) * (1 << kShift)),
          cvRound((std::clamp(p.y, -most, most) - 0.5) * (1 << kShift))};
}

void draw_line(cv::Mat& out, const Line& line, const cv::Scalar& colour, int width) {
  cv::line(out, fixed(line.from), fixed(line.to), {0, 0, 0}, width + 2, cv::LINE_AA, kShift);
  cv::line(out, fixed(line.from), fixed(line.to), colour, width, cv::LINE_AA, kShift);
}

/// Lines of equal distance, and lines away from the viewer, in steps of the camera's height, thinned out far away.
void draw_plane(cv::Mat& out, const WaterMotion& water, const cv::Scalar& colour) {
  const cv::Size size = out.size();
  const WaterCamera camera(*water.horizon, water.focal_or_usual(size), water.camera_height_m, size);
  const cv::Point2d middle(0.5 * size.width, 0.5 * size.height);
  const auto at = [&](double along, double below) { return middle + camera.upright({along, below}); };
  const double wide = size.width, deepest = std::hypot(size.width, size.height);
  double shown = 1e9;
  for (double below = deepest; below > camera.horizon() + 1; below -= 0.25) {
    const double squares = camera.row(below).forward / water.camera_height_m;
    if (std::floor(squares) <= std::floor(shown) && shown < 1e8) {
      shown = std::max(shown, squares);
      continue;
    }
    shown = squares;
    const double gap = camera.row(below).deep;
    if (water.camera_height_m / gap < 4) break;
    cv::line(out, fixed(at(-wide, below)), fixed(at(wide, below)), colour, 1, cv::LINE_AA, kShift);
  }
  const double near = camera.row(deepest).scale, far_below = camera.horizon() + 4,
               far = camera.row(far_below).scale;
  for (int i = -40; i <= 40; ++i) {
    const double side = i * water.camera_height_m;
    cv::line(out, fixed(at(side / near, deepest)), fixed(at(side / far, far_below)), colour, 1, cv::LINE_AA,
             kShift);
  }
  draw_line(out, {at(-wide, camera.horizon()), at(wide, camera.horizon())}, colour, 2);
}

void name_layer(cv::Mat& out, const std::string& name, const cv::Rect& box, const cv::Scalar& colour) {
  const double scale = std::max(0.4, out.cols / 1800.0);
  const cv::Point at(std::clamp(box.x + box.width / 2 - 20, 4, std::max(4, out.cols - 120)),
                     box.y + box.height / 2);
  cv::putText(out, name, at, cv::FONT_HERSHEY_SIMPLEX, scale, {0, 0, 0}, 4, cv::LINE_AA);
  cv::putText(out, name, at, cv::FONT_HERSHEY_SIMPLEX, scale, colour, 1, cv::LINE_AA);
}

}  // namespace

cv::Mat draw_scene(const cv::Mat& picture, const Scene& scene, std::span<const LayerPixels> pixels) {
  cv::Mat out = picture.clone();
  // From the furthest on, so that nearer tints lie above.
  for (std::size_t i = scene.layers.size(); i-- > 0;) {
    if (pixels[i].alpha.empty() || scene.layers[i].matte.kind == MatteFrom::Kind::kRest) continue;
    const cv::Scalar colour = colour_of(i);
    for (int y = 0; y < out.rows; ++y) {
      const auto* alpha = pixels[i].alpha.ptr<float>(y);
      const auto* from = picture.ptr<cv::Vec3b>(y);
      auto* to = out.ptr<cv::Vec3b>(y);
      for (int x = 0; x < out.cols; ++x)
        for (int c = 0; c < 3; ++c) {
          const double tinted = from[x][c] * (1 - kTint) + colour[c] * kTint;
          to[x][c] = cv::saturate_cast<std::uint8_t>(to[x][c] + (tinted - to[x][c]) * alpha[x]);
        }
    }
  }
  for (std::size_t i = scene.layers.size(); i-- > 0;) {
    const SceneLayer& layer = scene.layers[i];
    const cv::Scalar colour = colour_of(i);
    if (const auto* water = layer.as<WaterMotion>(); water != nullptr && water->horizon)
      draw_plane(out, *water, colour);
    if (const auto* tree = layer.as<TreeMotion>())
      for (const Line& line : tree->armatures) {
        draw_line(out, line, colour, 2);
        cv::circle(out, fixed(line.from), 5 << kShift, colour, -1, cv::LINE_AA, kShift);
        cv::arrowedLine(out, line.from, line.to, colour, 2, cv::LINE_AA, 0, 0.06);
      }
    if (layer.shadow)
      cv::arrowedLine(out, layer.shadow->from, layer.shadow->to, colour, 1, cv::LINE_AA, 0, 0.06);
    if (const auto* boat = layer.as<BoatMotion>(); boat != nullptr && boat->hull)
      draw_line(out, *boat->hull, colour, 3);
  }
  for (std::size_t i = 0; i < scene.layers.size(); ++i)
    if (!pixels[i].alpha.empty())
      name_layer(out, scene.layers[i].name, cv::boundingRect(cv::Mat(pixels[i].alpha > 0.5f)), colour_of(i));
  return out;
}

}  // namespace freshet::synth::scene
