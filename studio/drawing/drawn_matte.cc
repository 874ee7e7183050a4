#include "studio/drawing/drawn_matte.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "synth/matte/marks.h"
#include "synth/matte/matte.h"

namespace freshet::studio {
namespace {

namespace matte = synth::matte;

constexpr int kDraftPixels = 60'000;
constexpr int kShift = 4;  // of fixed point, in which OpenCV draws between pixels

/// Pixel centres have whole coordinates there, corners have them here.
cv::Point fixed(const cv::Point2f& point) {
  return {cvRound((point.x - 0.5f) * (1 << kShift)), cvRound((point.y - 0.5f) * (1 << kShift))};
}

void draw(const Drawn& line, cv::Mat& on, int value, int kind) {
  std::vector<cv::Point> points;
  for (const cv::Point2f& point : line.points) points.push_back(fixed(point));
  if (line.is_area) {
    cv::fillPoly(on, std::vector<std::vector<cv::Point>>{points}, value, kind, kShift);
    return;
  }
  const int width = std::clamp(cvRound(line.width), 1, 32767);
  if (points.size() == 1)
    cv::circle(on, points[0], width << (kShift - 1), value, cv::FILLED, kind, kShift);
  else
    cv::polylines(on, points, false, value, width, kind, kShift);
}

matte::Marks marks_of(const Document& document, cv::Size size) {
  matte::Marks marks(size, CV_8U, cv::Scalar(matte::kUnknown));
  for (const Drawn& line : document.scribbles)
    draw(line, marks, line.adds ? matte::kFluid : matte::kBackground, cv::LINE_8);
  return marks;
}

matte::MadeMatte from_scribbles(const Document& document, const cv::Mat& picture, Care care,
                                std::stop_token stop) {
  matte::MatteOptions options;
  options.edge.edge = matte::parse_edge(document.edge);
  if (care == Care::kFull)
    return matte::make_matte(picture, marks_of(document, picture.size()), options, "scribbles", stop);
  options.edge.edge = matte::Edge::kGuided;
  const double scale = std::min(1.0, std::sqrt(kDraftPixels / static_cast<double>(picture.total())));
  const cv::Size size(std::max(1, cvRound(picture.cols * scale)), std::max(1, cvRound(picture.rows * scale)));
  cv::Mat small, marks;
  cv::resize(picture, small, size, 0, 0, cv::INTER_AREA);
  cv::resize(marks_of(document, picture.size()), marks, size, 0, 0, cv::INTER_NEAREST);
  matte::MadeMatte made = matte::make_matte(small, marks, options, "scribbles", stop);
  cv::resize(made.alpha, made.alpha, picture.size(), 0, 0, cv::INTER_LINEAR);
  return made;
}

}  // namespace

void paint(const std::vector<Drawn>& lines, cv::Mat& matte) {
  for (const Drawn& line : lines) draw(line, matte, line.adds ? 255 : 0, cv::LINE_AA);
}

std::optional<DrawnMatte> draw_matte(const Document& document, const cv::Mat& picture, const cv::Mat& alpha,
                                     const cv::Mat& given, Care care, std::stop_token stop) {
  DrawnMatte drawn;
  const auto is_fluid = [](const Drawn& line) { return line.adds; };
  const bool painted = std::any_of(document.paint.begin(), document.paint.end(), is_fluid);
  switch (document.matte_base) {
    case MatteBase::kAlpha:
      drawn.alpha = alpha.clone();
      break;
    case MatteBase::kWhole:
    case MatteBase::kFile:
      drawn.alpha = given.clone();
      break;
    case MatteBase::kScribbles:
      if (std::any_of(document.scribbles.begin(), document.scribbles.end(), is_fluid)) {
        matte::MadeMatte made = from_scribbles(document, picture, care, stop);
        drawn = {.alpha = made.alpha, .notices = made.notices};
      }
      break;
  }
  if (drawn.alpha.empty()) {
    if (!painted) return std::nullopt;
    drawn.alpha = cv::Mat::zeros(picture.size(), CV_8U);
  }
  paint(document.paint, drawn.alpha);
  media::settle_dark(drawn.alpha);
  if (cv::countNonZero(drawn.alpha) == 0)
    throw Error(ErrorKind::kInput, "matte", "nothing of the picture is fluid", "Scribble on what flows");
  return drawn;
}

cv::Mat draw_held(const Document& document, cv::Size picture) {
  cv::Mat held = cv::Mat::zeros(picture, CV_8U);
  paint(document.held, held);
  media::settle_dark(held);
  if (cv::countNonZero(held) == 0) return {};
  return held;
}

cv::Mat draw_tempo(const Document& document, cv::Size picture) {
  if (document.tempo.empty()) return {};
  constexpr double kAsFilmed = 128, kOctaveUp = 127, kOctaveDown = 128;  // synth/animate/placement/retiming.h
  cv::Mat grey(picture, CV_8U, cv::Scalar(kAsFilmed));
  for (const DrawnTempo& line : document.tempo) {
    const double octaves = std::log2(line.factor);
    const int value = cvRound(kAsFilmed + octaves * (octaves < 0 ? kOctaveDown : kOctaveUp));
    draw({.points = line.points, .width = line.width, .adds = true, .is_area = false}, grey, value,
         cv::LINE_AA);
  }
  cv::Mat map;
  cv::cvtColor(grey, map, cv::COLOR_GRAY2BGR);
  return map;
}

}  // namespace freshet::studio
