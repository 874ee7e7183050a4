#include "synth/matte/soft_edge.h"

#include <algorithm>
#include <cmath>

#include <opencv2/alphamat.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc/edge_filter.hpp>

#include "freshet/error.h"

namespace freshet::synth::matte {
namespace {

constexpr std::uint8_t kUnsure = 128;
constexpr std::uint8_t kFaint = 8;  // what is below stands still wherever a matte is read: it is nothing
constexpr int kMinUnsure = 64;      // information flow looks for 20 neighbours among them

// Where the band is, with room for what lies beside it.
cv::Rect around(const cv::Mat& trimap, int room) {
  const cv::Rect band = cv::boundingRect(trimap == kUnsure);
  return cv::Rect(band.x - room, band.y - room, band.width + 2 * room, band.height + 2 * room) &
         cv::Rect({}, trimap.size());
}

cv::Mat guided(const cv::Mat& picture, const cv::Mat& alpha, int radius, double eps) {
  cv::Mat guide, out;
  picture.convertTo(guide, CV_32F, 1 / 255.0);
  cv::ximgproc::guidedFilter(guide, alpha, out, radius, eps);
  return out;
}

cv::Mat information_flow(const cv::Mat& picture, const cv::Mat& trimap, int max_pixels) {
  const double scale =
      std::min(1.0, std::sqrt(static_cast<double>(max_pixels) / static_cast<double>(picture.total())));
  const cv::Size size(std::max(1, cvRound(picture.cols * scale)), std::max(1, cvRound(picture.rows * scale)));
  cv::Mat small = picture.clone(), small_trimap = trimap.clone();  // it writes into the trimap
  if (size != picture.size()) {
    cv::resize(picture, small, size, 0, 0, cv::INTER_AREA);
    cv::resize(trimap, small_trimap, size, 0, 0, cv::INTER_NEAREST);
  }
  cv::Mat flowed, alpha;
  cv::alphamat::infoFlow(small, small_trimap, flowed);
  flowed.convertTo(alpha, CV_32F, 1 / 255.0);
  if (size == picture.size()) return alpha;
  cv::resize(alpha, alpha, picture.size(), 0, 0, cv::INTER_LINEAR);
  return guided(picture, alpha, std::max(1, cvRound(1.5 / scale)), 1e-5);
}

}  // namespace

Edge parse_edge(const std::string& name) {
  for (const Edge edge : {Edge::kNone, Edge::kGuided, Edge::kInformationFlow})
    if (name == to_string(edge)) return edge;
  throw Error(ErrorKind::kUsage, "--edge " + name, "unknown", "One of none, guided, information-flow");
}

const char* to_string(Edge edge) {
  switch (edge) {
    case Edge::kNone:
      return "none";
    case Edge::kGuided:
      return "guided";
    case Edge::kInformationFlow:
      return "information-flow";
  }
  return "";
}

double band_width(const EdgeOptions& options, cv::Size size) {
  if (options.width_px > 0) return options.width_px;
  return (options.edge == Edge::kInformationFlow ? 0.08 : 0.02) * std::max(size.width, size.height);
}

cv::Mat trimap_of(const cv::Mat& region, const Marks& marks, double width_px) {
  cv::Mat to_background, to_fluid;
  cv::distanceTransform(region, to_background, cv::DIST_L2, 5);
  cv::distanceTransform(~region, to_fluid, cv::DIST_L2, 5);
  cv::Mat trimap = region.clone();
  trimap.setTo(kUnsure, (to_background <= width_px / 2) & (to_fluid <= width_px / 2));
  trimap.setTo(255, marks == kFluid);
  trimap.setTo(0, marks == kBackground);
  return trimap;
}

cv::Mat soft_edge(const cv::Mat& picture, const cv::Mat& region, const Marks& marks,
                  const EdgeOptions& options) {
  const int covered = cv::countNonZero(region);
  if (options.edge == Edge::kNone || covered == 0 || covered == static_cast<int>(region.total()))
    return region.clone();
  const double width = band_width(options, picture.size());
  const cv::Mat trimap = trimap_of(region, marks, width);
  const int unsure = cv::countNonZero(trimap == kUnsure);
  if (unsure == 0) return region.clone();
  const int radius = std::max(1, cvRound(width * options.guided_radius));
  const cv::Rect part = around(trimap, std::max(2 * radius, cvRound(width)));

  cv::Mat alpha;
  if (options.edge == Edge::kInformationFlow && unsure >= kMinUnsure) {
    alpha = information_flow(picture(part), trimap(part), options.max_pixels);
  } else {
    cv::Mat step;
    region(part).convertTo(step, CV_32F, 1 / 255.0);
    alpha = guided(picture(part), step, radius, options.guided_eps);
  }
  cv::Mat bytes, out = trimap.clone();
  alpha.convertTo(bytes, CV_8U, 255);
  bytes.setTo(0, bytes < kFaint);
  bytes.copyTo(out(part), trimap(part) == kUnsure);
  return out;
}

}  // namespace freshet::synth::matte
