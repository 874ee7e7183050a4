#include "hints/stroke_field.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <Eigen/Dense>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "vision/look/horizon.h"

namespace freshet::hints {
namespace {

constexpr double kStep = 6;               // px between samples of a stroke
constexpr double kTangent = 6;            // px to either side, over which a direction is taken
constexpr double kClash = 12;             // px within which strokes that run against each other are told of
constexpr double kClashCosine = -0.7071;  // of 135 degrees
constexpr std::size_t kMaxSamples = 600, kMaxFine = 20000;
constexpr float kLeastSeen = 1;      // of a stroke drawn at the horizon or above it
constexpr int kCell = 8;             // px of the picture to a node of the coarse field
constexpr double kCancelled = 1e-4;  // length of the interpolated vector below which it has no direction

struct Sample {
  cv::Point2d at;     // px
  cv::Vec2d way;      // unit vector
  double speed = -1;  // px/s; negative: not said
  std::size_t stroke = 0;
};

// The part of a segment inside a box, as parameters; from > to when there is none.
std::pair<double, double> part_inside(cv::Point2d a, cv::Point2d b, const cv::Rect2d& box) {
  double from = 0, to = 1;
  const auto cut = [&](double start, double way, double low, double high) {
    if (way == 0) {
      if (start < low || start > high) to = -1;
      return;
    }
    const double first = (low - start) / way, second = (high - start) / way;
    from = std::max(from, std::min(first, second));
    to = std::min(to, std::max(first, second));
  };
  cut(a.x, b.x - a.x, box.x, box.x + box.width);
  cut(a.y, b.y - a.y, box.y, box.y + box.height);
  return {from, to};
}

// A stroke as a function of the way along it.
class Course {
 public:
  explicit Course(const std::vector<cv::Point2f>& points) {
    for (const cv::Point2f& point : points) {
      const cv::Point2d next(point);
      const double way = points_.empty() ? 0 : cv::norm(next - points_.back());
      if (!points_.empty() && way == 0) continue;
      along_.push_back(along_.empty() ? 0 : along_.back() + way);
      points_.push_back(next);
    }
  }
  double length() const { return along_.empty() ? 0 : along_.back(); }
  std::size_t segments() const { return points_.size() < 2 ? 0 : points_.size() - 1; }
  cv::Point2d start_of(std::size_t segment) const { return points_[segment]; }
  cv::Point2d end_of(std::size_t segment) const { return points_[segment + 1]; }
  double along(std::size_t segment) const { return along_[segment]; }

  cv::Point2d at(double way) const {
    way = std::clamp(way, 0.0, length());
    const auto above = std::upper_bound(along_.begin(), along_.end(), way);
    const std::size_t next = std::clamp<std::size_t>(above - along_.begin(), 1, points_.size() - 1);
    const double fraction = (way - along_[next - 1]) / (along_[next] - along_[next - 1]);
    return points_[next - 1] + (points_[next] - points_[next - 1]) * fraction;
  }
  // Over a stretch, so that a shaking hand's jags and the hook of a lifted pen do not count.
  cv::Vec2d way_at(double way) const {
    for (double reach = kTangent; reach < 64 * kTangent; reach *= 2) {
      const cv::Point2d chord = at(way + reach) - at(way - reach);
      const double found = cv::norm(chord);
      if (found > 1e-6) return {chord.x / found, chord.y / found};
    }
    return {0, 0};
  }

 private:
  std::vector<cv::Point2d> points_;
  std::vector<double> along_;
};

cv::Rect2d surroundings(cv::Size picture) {
  return {-picture.width / 4.0, -picture.height / 4.0, picture.width * 1.5, picture.height * 1.5};
}

std::vector<Sample> sampled(const std::vector<Stroke>& strokes, cv::Size picture) {
  const cv::Rect2d box = surroundings(picture);
  std::vector<Course> courses;
  double inside = 0;
  for (const Stroke& stroke : strokes) {
    const Course& course = courses.emplace_back(stroke.points);
    for (std::size_t s = 0; s < course.segments(); ++s) {
      const auto [from, to] = part_inside(course.start_of(s), course.end_of(s), box);
      if (from < to) inside += (to - from) * cv::norm(course.end_of(s) - course.start_of(s));
    }
  }
  const double step = std::max(kStep, inside / static_cast<double>(kMaxFine));
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < courses.size(); ++i) {
    const Course& course = courses[i];
    // Samples lie in the middles of equal parts: a short stroke has one.
    const double parts = std::max(1.0, std::round(course.length() / step)), own = course.length() / parts;
    for (std::size_t s = 0; s < course.segments(); ++s) {
      const double length = cv::norm(course.end_of(s) - course.start_of(s));
      const auto [from, to] = part_inside(course.start_of(s), course.end_of(s), box);
      if (from > to) continue;
      const double begin = course.along(s) + from * length, end = course.along(s) + to * length;
      for (double part = std::max(0.0, std::ceil(begin / own - 0.5)); part < parts; ++part) {
        const double way = (part + 0.5) * own;
        if (way >= end && !(s + 1 == course.segments() && way <= end)) break;
        const cv::Vec2d tangent = course.way_at(way);
        if (tangent == cv::Vec2d(0, 0)) continue;
        samples.push_back(
            {course.at(way), tangent, speed_at(strokes[i], way / course.length()).value_or(-1.0f), i});
      }
    }
  }
  return samples;
}

/// Of the first strokes that run against each other; empty: none do.
std::string clash(const std::vector<Sample>& samples, const std::vector<Stroke>& strokes) {
  const auto name = [&](std::size_t i) {
    return strokes[i].name.empty() ? fmt::format("stroke {}", i + 1) : strokes[i].name;
  };
  std::map<std::pair<int, int>, std::vector<std::size_t>> cells;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Sample& sample = samples[i];
    const int column = static_cast<int>(std::floor(sample.at.x / kClash)),
              row = static_cast<int>(std::floor(sample.at.y / kClash));
    for (int y = row - 1; y <= row + 1; ++y)
      for (int x = column - 1; x <= column + 1; ++x) {
        const auto found = cells.find({x, y});
        if (found == cells.end()) continue;
        for (const std::size_t j : found->second) {
          const Sample& other = samples[j];
          if (cv::norm(sample.at - other.at) >= kClash || sample.way.dot(other.way) >= kClashCosine) continue;
          return fmt::format(
              "{} at ({:.0f}, {:.0f}): between them the flow stands",
              sample.stroke == other.stroke
                  ? name(sample.stroke) + " runs against itself"
                  : fmt::format("{} and {} run against each other", name(other.stroke), name(sample.stroke)),
              sample.at.x, sample.at.y);
        }
      }
    cells[{column, row}].push_back(i);
  }
  return {};
}

// Samples of a cell made one, in cells that grow until few enough are left.
std::vector<Sample> thinned(std::vector<Sample> samples) {
  for (double cell = kStep; samples.size() > kMaxSamples; cell *= 1.5) {
    std::map<std::pair<int, int>, std::vector<Sample>> cells;
    for (const Sample& sample : samples)
      cells[{static_cast<int>(std::floor(sample.at.x / cell)),
             static_cast<int>(std::floor(sample.at.y / cell))}]
          .push_back(sample);
    std::vector<Sample> fewer;
    for (const auto& [place, members] : cells) {
      Sample mean = members[0];
      mean.at = {};
      mean.way = {};
      double log_speed = 0;
      int speeds = 0;
      for (const Sample& member : members) {
        mean.at += member.at / static_cast<double>(members.size());
        mean.way += member.way;
        if (member.speed < 0) continue;
        log_speed += std::log(std::max(member.speed, 0.1));
        ++speeds;
      }
      const double length = cv::norm(mean.way);
      if (length < 1e-6) continue;
      mean.way /= length;
      mean.speed = speeds > 0 ? std::exp(log_speed / speeds) : -1;
      fewer.push_back(mean);
    }
    samples = std::move(fewer);
  }
  return samples;
}

// Radial functions through values at samples: some channels at once.
class Interpolation {
 public:
  Interpolation(const std::vector<Sample>& samples, const Eigen::MatrixXd& values, cv::Size picture,
                const StrokeFieldOptions& options)
      : kernel_(options.kernel), unit_(std::hypot(picture.width, picture.height)) {
    for (const Sample& sample : samples) centres_.push_back(sample.at / unit_);
    const auto count = static_cast<Eigen::Index>(samples.size());
    // A plane where there are enough samples to hold one; it may still be undetermined, and LU with full
    // pivots then takes the flattest.
    planes_ = kernel_ == RadialKernel::kThinPlate && count >= 3 ? 3 : 1;
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count + planes_, count + planes_);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index j = 0; j < count; ++j) matrix(i, j) = radial(centres_[i], centres_[j]);
      // The kernels are positive definite where weights sum to zero: the ridge has their sign.
      matrix(i, i) += options.smoothing;
      const double plane[3] = {1, centres_[i].x, centres_[i].y};
      for (Eigen::Index p = 0; p < planes_; ++p) matrix(i, count + p) = matrix(count + p, i) = plane[p];
    }
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count + planes_, values.cols());
    right.topRows(count) = values;
    weights_ = planes_ == 1 ? Eigen::MatrixXd(matrix.partialPivLu().solve(right))
                            : Eigen::MatrixXd(matrix.completeOrthogonalDecomposition().solve(right));
  }
  void at(cv::Point2d place, double* values) const {
    const cv::Point2d p = place / unit_;
    const auto count = static_cast<Eigen::Index>(centres_.size());
    const double plane[3] = {1, p.x, p.y};
    for (Eigen::Index c = 0; c < weights_.cols(); ++c) {
      values[c] = 0;
      for (Eigen::Index k = 0; k < planes_; ++k) values[c] += plane[k] * weights_(count + k, c);
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      const double r = radial(p, centres_[i]);
      for (Eigen::Index c = 0; c < weights_.cols(); ++c) values[c] += r * weights_(i, c);
    }
  }

 private:
  double radial(cv::Point2d a, cv::Point2d b) const {
    const double square = (a - b).ddot(a - b);
    switch (kernel_) {
      case RadialKernel::kMultiquadric:
        return -std::sqrt(square + 0.02 * 0.02);
      case RadialKernel::kThinPlate:
        return square > 0 ? 0.5 * square * std::log(square) : 0;
      case RadialKernel::kGaussian:
        return std::exp(-square / (2 * 0.1 * 0.1));
    }
    return 0;
  }
  RadialKernel kernel_;
  double unit_;  // px: the picture's diagonal, so that all sizes of a picture give the same field
  std::vector<cv::Point2d> centres_;
  Eigen::Index planes_ = 1;
  Eigen::MatrixXd weights_;
};

// Values on a lattice of nodes every kCell px: rows x columns of CV_64FC(channels), then each pixel between
// them.
template <int channels>
cv::Mat over_picture(const Interpolation& interpolation, cv::Size picture) {
  using Values = cv::Vec<double, channels>;
  cv::Mat nodes(picture.height / kCell + 2, picture.width / kCell + 2, CV_MAKETYPE(CV_32F, channels));
  oneapi::tbb::parallel_for(0, nodes.rows, [&](int row) {
    for (int column = 0; column < nodes.cols; ++column) {
      Values values;
      interpolation.at(cv::Point2d(column * kCell, row * kCell), values.val);
      nodes.at<cv::Vec<float, channels>>(row, column) = cv::Vec<float, channels>(values);
    }
  });
  // A pixel's middle is half a pixel from its corner, where the nodes are counted from.
  const double offset = 0.5 / kCell;
  cv::Mat field;
  cv::warpAffine(nodes, field, cv::Matx23d(1.0 / kCell, 0, offset, 0, 1.0 / kCell, offset), picture,
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return field;
}

}  // namespace

StrokeField interpolate(const std::vector<Stroke>& strokes, cv::Size picture, const std::string& where,
                        const StrokeFieldOptions& options) {
  const std::vector<Sample> fine = sampled(strokes, picture);
  if (fine.empty())
    throw Error(ErrorKind::kInput, where, "no stroke in or near the picture",
                "Draw at least one line, in the direction of the flow");
  const std::vector<Sample> samples = thinned(fine);

  StrokeField field;
  field.clash = clash(fine, strokes);
  Eigen::MatrixXd ways(samples.size(), 2);
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (int c = 0; c < 2; ++c) ways(static_cast<Eigen::Index>(i), c) = samples[i].way[c];
  field.direction = over_picture<2>(Interpolation(samples, ways, picture, options), picture);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      cv::Vec2f& way = field.direction.at<cv::Vec2f>(y, x);
      const float length = std::hypot(way[0], way[1]);
      way = length > static_cast<float>(kCancelled) ? way / length : cv::Vec2f(0, 0);
    }

  std::vector<Sample> timed;
  for (const Sample& sample : samples)
    if (sample.speed >= 0) timed.push_back(sample);
  if (timed.empty()) return field;
  // Of the plane: on it the same flow is as fast far off as it is near by.
  const auto seen = [&](cv::Point2f place, cv::Vec2f way) {
    return options.horizon ? std::max(vision::seen_speed(*options.horizon, place, way, picture), kLeastSeen)
                           : 1.0f;
  };
  Eigen::MatrixXd logarithms(timed.size(), 1);
  for (std::size_t i = 0; i < timed.size(); ++i)
    logarithms(static_cast<Eigen::Index>(i), 0) =
        std::log(std::max(timed[i].speed, 0.1) / seen(cv::Point2f(timed[i].at), cv::Vec2f(timed[i].way)));
  const double low = logarithms.minCoeff(), high = logarithms.maxCoeff();
  field.speed = over_picture<1>(Interpolation(timed, logarithms, picture, options), picture);
  cv::min(cv::max(field.speed, low), high, field.speed);
  cv::exp(field.speed, field.speed);
  if (options.horizon)
    cv::multiply(field.speed, vision::seen_speeds(*options.horizon, field.direction, picture), field.speed);
  return field;
}

}  // namespace freshet::hints
