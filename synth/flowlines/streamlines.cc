#include "synth/flowlines/streamlines.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::flowlines {
namespace {

constexpr float kStep = 1;  // px
constexpr int kMaxSteps = 20000;

/// Points of lines by squares of one spacing, for "is any nearer than".
class NearPoints {
 public:
  NearPoints(cv::Size size, float side)
      : side_(side),
        columns_(static_cast<int>(static_cast<float>(size.width) / side) + 1),
        rows_(static_cast<int>(static_cast<float>(size.height) / side) + 1),
        squares_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

  void add(const std::vector<cv::Point2f>& points) {
    for (const cv::Point2f& point : points) squares_[square(point)].push_back(point);
  }
  bool any_within(cv::Point2f of, float distance) const {
    const int cx = column(of), cy = row(of);
    for (int y = std::max(0, cy - 1); y <= std::min(rows_ - 1, cy + 1); ++y)
      for (int x = std::max(0, cx - 1); x <= std::min(columns_ - 1, cx + 1); ++x)
        for (const cv::Point2f& point : squares_[index(x, y)]) {
          const cv::Point2f way = point - of;
          if (way.dot(way) < distance * distance) return true;
        }
    return false;
  }

 private:
  int column(cv::Point2f p) const { return std::clamp(static_cast<int>(p.x / side_), 0, columns_ - 1); }
  int row(cv::Point2f p) const { return std::clamp(static_cast<int>(p.y / side_), 0, rows_ - 1); }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
  }
  std::size_t square(cv::Point2f p) const { return index(column(p), row(p)); }

  float side_;
  int columns_, rows_;
  std::vector<std::vector<cv::Point2f>> squares_;
};

class Tracer {
 public:
  Tracer(const cv::Mat& field, const cv::Mat& matte, const StreamlineOptions& options)
      : field_(field),
        matte_(matte),
        gap_(static_cast<float>(options.spacing_px * options.min_gap)),
        near_(field.size(), static_cast<float>(options.spacing_px)) {}

  bool inside(cv::Point2f p) const {
    const int x = cvRound(p.x), y = cvRound(p.y);
    return x >= 0 && y >= 0 && x < matte_.cols && y < matte_.rows && matte_.at<std::uint8_t>(y, x) > 127;
  }
  bool is_free(cv::Point2f p, float distance) const { return inside(p) && !near_.any_within(p, distance); }
  void keep(const std::vector<cv::Point2f>& line) { near_.add(line); }

  std::vector<cv::Point2f> through(cv::Point2f seed) const {
    std::vector<cv::Point2f> back = walk(seed, -1), line(back.rbegin(), back.rend());
    line.push_back(seed);
    const std::vector<cv::Point2f> on = walk(seed, 1);
    line.insert(line.end(), on.begin(), on.end());
    return line;
  }

 private:
  cv::Point2f direction(cv::Point2f p) const {
    const int x = std::clamp(static_cast<int>(p.x), 0, field_.cols - 2);
    const int y = std::clamp(static_cast<int>(p.y), 0, field_.rows - 2);
    const float fx = std::clamp(p.x - static_cast<float>(x), 0.0f, 1.0f);
    const float fy = std::clamp(p.y - static_cast<float>(y), 0.0f, 1.0f);
    const cv::Vec2f top = field_.at<cv::Vec2f>(y, x) * (1 - fx) + field_.at<cv::Vec2f>(y, x + 1) * fx;
    const cv::Vec2f low = field_.at<cv::Vec2f>(y + 1, x) * (1 - fx) + field_.at<cv::Vec2f>(y + 1, x + 1) * fx;
    const cv::Vec2f v = top * (1 - fy) + low * fy;
    const auto length = static_cast<float>(cv::norm(v));
    return length > 1e-6f ? cv::Point2f(v[0] / length, v[1] / length) : cv::Point2f(0, 0);
  }
  std::vector<cv::Point2f> walk(cv::Point2f from, float sign) const {
    std::vector<cv::Point2f> line;
    cv::Point2f p = from;
    for (int i = 0; i < kMaxSteps; ++i) {
      const cv::Point2f half = direction(p) * (0.5f * kStep * sign);
      const cv::Point2f way = direction(p + half) * (kStep * sign);  // Runge-Kutta of second order
      if (way == cv::Point2f(0, 0)) break;
      p += way;
      if (!is_free(p, gap_)) break;
      // A closed or spiralling line comes back to itself: every spacing's length it looks back at its own.
      if (line.size() > 4 * static_cast<std::size_t>(gap_) + 8 && comes_back(line, p)) break;
      line.push_back(p);
    }
    return line;
  }
  bool comes_back(const std::vector<cv::Point2f>& line, cv::Point2f p) const {
    const std::size_t until = line.size() - 3 * static_cast<std::size_t>(gap_) - 4;
    for (std::size_t i = 0; i < until; i += 2) {
      const cv::Point2f way = line[i] - p;
      if (way.dot(way) < gap_ * gap_) return true;
    }
    return false;
  }

  const cv::Mat &field_, &matte_;
  float gap_;
  NearPoints near_;
};

/// The middle of what flows fastest and steadily: where a first line is likely to be a long one.
cv::Point first_seed(const cv::Mat& matte) {
  cv::Mat distance;
  cv::distanceTransform(matte > 127, distance, cv::DIST_L2, 3);
  cv::Point at;
  cv::minMaxLoc(distance, nullptr, nullptr, nullptr, &at);
  return at;
}

}  // namespace

cv::Mat smoothed(const cv::Mat& field, const cv::Mat& matte, double sigma_px) {
  cv::Mat weight, weights, weighted, out;
  matte.convertTo(weight, CV_32F, 1.0 / 255);
  cv::merge(std::vector<cv::Mat>{weight, weight}, weights);
  cv::GaussianBlur(field.mul(weights), weighted, cv::Size(), sigma_px);
  cv::GaussianBlur(weights, weights, cv::Size(), sigma_px);
  cv::divide(weighted, weights + cv::Scalar::all(1e-6), out);
  return out;
}

std::vector<FlowLine> evenly_spaced(const cv::Mat& field, const cv::Mat& matte,
                                    const StreamlineOptions& options) {
  std::vector<FlowLine> lines;
  Tracer tracer(field, matte, options);
  const auto spacing = static_cast<float>(options.spacing_px);
  const auto try_seed = [&](cv::Point2f seed) {
    if (static_cast<int>(lines.size()) >= options.max_lines || !tracer.is_free(seed, 0.9f * spacing)) return;
    FlowLine line = evenly(tracer.through(seed));
    if (line.points.size() < 2 || line.length() < options.min_length_px) return;
    tracer.keep(line.points);
    lines.push_back(std::move(line));
  };
  if (cv::countNonZero(matte > 127) == 0) return lines;
  try_seed(first_seed(matte));
  // Beside each line a spacing away, then wherever room is left: islands have no line beside them yet.
  std::size_t looked_at = 0;
  const auto beside_all = [&] {
    for (; looked_at < lines.size(); ++looked_at)
      for (int i = 0; i < lines[looked_at].samples(); i += 4) {
        const cv::Point2f along = tangent(lines[looked_at], i), across(-along.y, along.x);
        const cv::Point2f point = lines[looked_at].points[static_cast<std::size_t>(i)];
        try_seed(point + across * spacing);
        try_seed(point - across * spacing);
      }
  };
  beside_all();
  const int stride = std::max(1, cvRound(spacing / 2));
  for (int y = stride / 2; y < matte.rows; y += stride)
    for (int x = stride / 2; x < matte.cols; x += stride) {
      try_seed(cv::Point2f(static_cast<float>(x), static_cast<float>(y)));
      beside_all();
    }
  for (std::size_t i = 0; i < lines.size(); ++i) lines[i].name = fmt::format("l{}", i + 1);
  return lines;
}

}  // namespace freshet::synth::flowlines
