#include "synth/flowlines/arrival.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <tbb/parallel_for.h>
#include <Eigen/Dense>
#include <opencv2/imgproc.hpp>

#include "synth/animate/sampling/pull_push.h"

namespace freshet::synth::flowlines {
namespace {

constexpr int kStride = 4;        // px along a line between places that are compared
constexpr double kReach = 1.7;    // spacings within which lines lie side by side
constexpr float kSameWay = 0.6f;  // cosine
constexpr double kWhole = 0.98;   // of a stream's places: the rest are eddies that a front would never leave

/// Two lines side by side: the first's arrival here is the second's plus `later`, if their offsets are right.
struct Neighbours {
  std::size_t a, b;
  float later;
};

std::vector<Neighbours> side_by_side(const std::vector<FlowLine>& lines, const Rides& rides, double spacing) {
  struct Sample {
    std::size_t line;
    int at;
  };
  const auto side = static_cast<float>(kReach * spacing);
  const auto cell = [&](cv::Point2f p) {
    return std::pair(static_cast<int>(std::floor(p.x / side)), static_cast<int>(std::floor(p.y / side)));
  };
  std::map<std::pair<int, int>, std::vector<Sample>> cells;
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (int s = 0; s < lines[i].samples(); s += 2)
      cells[cell(lines[i].points[static_cast<std::size_t>(s)])].push_back({i, s});
  std::vector<Neighbours> found;
  std::map<std::size_t, std::pair<float, int>> nearest;  // by line: squared distance and sample
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (int s = 0; s < lines[i].samples(); s += kStride) {
      const cv::Point2f here = lines[i].points[static_cast<std::size_t>(s)];
      const auto [cx, cy] = cell(here);
      nearest.clear();
      for (int y = cy - 1; y <= cy + 1; ++y)
        for (int x = cx - 1; x <= cx + 1; ++x) {
          const auto in = cells.find({x, y});
          if (in == cells.end()) continue;
          for (const Sample& other : in->second) {
            if (other.line <= i) continue;
            const cv::Point2f way = lines[other.line].points[static_cast<std::size_t>(other.at)] - here;
            const float squared = way.dot(way);
            if (squared > side * side) continue;
            const auto [known, is_new] = nearest.try_emplace(other.line, squared, other.at);
            if (!is_new && squared < known->second.first) known->second = {squared, other.at};
          }
        }
      for (const auto& [line, best] : nearest)
        if (tangent(lines[i], s).dot(tangent(lines[line], best.second)) > kSameWay)
          found.push_back({i, line,
                           rides.lines[line].age[static_cast<std::size_t>(best.second)] -
                               rides.lines[i].age[static_cast<std::size_t>(s)]});
    }
  return found;
}

std::size_t root(std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/// Streams by what touches; the largest first, small ones beyond the limit into the largest.
std::vector<int> grouped(const std::vector<FlowLine>& lines, const std::vector<Neighbours>& pairs,
                         int& count) {
  std::vector<std::size_t> parent(lines.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  for (const Neighbours& pair : pairs) parent[root(parent, pair.a)] = root(parent, pair.b);
  std::map<std::size_t, int> weight;
  for (std::size_t i = 0; i < lines.size(); ++i) weight[root(parent, i)] += lines[i].samples();
  std::vector<std::pair<int, std::size_t>> order;
  for (const auto& [of, samples] : weight) order.emplace_back(-samples, of);
  std::sort(order.begin(), order.end());
  count = std::min(kMaxStreams, static_cast<int>(order.size()));
  std::map<std::size_t, int> number;
  for (std::size_t i = 0; i < order.size(); ++i)
    number[order[i].second] = static_cast<int>(i) < count ? static_cast<int>(i) : 0;
  std::vector<int> out(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) out[i] = number[root(parent, i)];
  return out;
}

/// Least squares over all neighbours; a line without any keeps 0.
std::vector<float> offsets_of(std::size_t lines, const std::vector<Neighbours>& pairs) {
  const auto n = static_cast<Eigen::Index>(lines);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(n, n) * 1e-3;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (const Neighbours& pair : pairs) {
    const auto a = static_cast<Eigen::Index>(pair.a), b = static_cast<Eigen::Index>(pair.b);
    normal(a, a) += 1;
    normal(b, b) += 1;
    normal(a, b) -= 1;
    normal(b, a) -= 1;
    right(a) += pair.later;
    right(b) -= pair.later;
  }
  const Eigen::VectorXd solved = normal.ldlt().solve(right);
  std::vector<float> out(lines);
  for (std::size_t i = 0; i < lines; ++i) out[i] = static_cast<float>(solved(static_cast<Eigen::Index>(i)));
  return out;
}

/// Values at the lines' samples made a smooth field of `size`, whose px are `step` of the picture.
class Spread {
 public:
  Spread(cv::Size size, float step, double sigma)
      : sum_(size, CV_32F, cv::Scalar(0)), weight_(size, CV_32F, cv::Scalar(0)), step_(step), sigma_(sigma) {}
  void add(cv::Point2f at, float value) {
    const int x = std::clamp(static_cast<int>((at.x + 0.5f) / step_), 0, sum_.cols - 1);
    const int y = std::clamp(static_cast<int>((at.y + 0.5f) / step_), 0, sum_.rows - 1);
    sum_.at<float>(y, x) += value;
    weight_.at<float>(y, x) += 1;
  }
  cv::Mat field() {
    cv::GaussianBlur(sum_, sum_, cv::Size(), sigma_ / step_, 0, cv::BORDER_CONSTANT);
    cv::GaussianBlur(weight_, weight_, cv::Size(), sigma_ / step_, 0, cv::BORDER_CONSTANT);
    cv::Mat values, trust, out;
    cv::divide(sum_, cv::max(weight_, 1e-12f), values);
    const double enough = 0.05 * step_ / sigma_;  // a twentieth of what a line brings to its own middle
    cv::min(weight_ * (1 / enough), 1.0, trust);
    values.setTo(0, trust < 1e-3f);
    out = animate::pull_push(values, trust);
    cv::GaussianBlur(out, out, cv::Size(), sigma_ / step_);
    return out;
  }

 private:
  cv::Mat sum_, weight_;
  float step_;
  double sigma_;
};

/// To which stream each place belongs: its nearest line's.
cv::Mat nearest_stream(const std::vector<FlowLine>& lines, const std::vector<int>& of_line,
                       cv::Size picture) {
  cv::Mat background(picture, CV_8U, cv::Scalar(255)), owner(picture, CV_8U, cv::Scalar(0));
  const cv::Rect inside({0, 0}, picture);
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (const cv::Point2f& point : lines[i].points) {
      const cv::Point at(cvRound(point.x), cvRound(point.y));
      if (!inside.contains(at)) continue;
      background.at<std::uint8_t>(at) = 0;
      owner.at<std::uint8_t>(at) = static_cast<std::uint8_t>(of_line[i]);
    }
  cv::Mat distance, labels;
  cv::distanceTransform(background, distance, labels, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::map<int, std::uint8_t> stream_of;
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x)
      if (background.at<std::uint8_t>(y, x) == 0)
        stream_of[labels.at<int>(y, x)] = owner.at<std::uint8_t>(y, x);
  cv::Mat out(picture, CV_8U, cv::Scalar(0));
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x) {
      const auto found = stream_of.find(labels.at<int>(y, x));
      if (found != stream_of.end()) out.at<std::uint8_t>(y, x) = found->second;
    }
  return out;
}

float quantile(std::vector<float> values, double share) {
  const auto nth =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// A front that enters in frame `entry` is followed from each line's own entry.
cv::Mat of_entry(const std::vector<FlowLine>& lines, const Rides& rides, const Arrivals& all, int stream,
                 std::size_t entry, cv::Size cells, double sigma) {
  Spread spread(cells, Stream::kEntryStep, sigma);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (all.of_line[i] != stream) continue;
    const Ride& ride = rides.lines[i];
    const std::size_t last = ride.age_of_entry.size() - 1;
    const std::size_t enters = std::min(last, entry + static_cast<std::size_t>(std::lround(all.offset[i])));
    for (std::size_t s = 0; s < lines[i].points.size(); s += 2)
      spread.add(lines[i].points[s], all.offset[i] + ride.age_of_entry[enters][s]);
  }
  return spread.field();
}

}  // namespace

Arrivals arrivals(const std::vector<FlowLine>& lines, const Rides& rides, cv::Size picture,
                  double spacing_px) {
  Arrivals out;
  const std::vector<Neighbours> pairs = side_by_side(lines, rides, spacing_px);
  int count = 0;
  out.of_line = grouped(lines, pairs, count);
  out.offset = offsets_of(lines.size(), pairs);
  out.streams.resize(static_cast<std::size_t>(count));
  out.stream = nearest_stream(lines, out.of_line, picture);
  const double sigma = 0.6 * spacing_px;
  Spread speed(picture, 1, sigma);
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (std::size_t s = 0; s < lines[i].points.size(); ++s)
      speed.add(lines[i].points[s], rides.lines[i].speed[s]);
  out.speed = speed.field();
  for (int k = 0; k < count; ++k) {
    Stream& stream = out.streams[static_cast<std::size_t>(k)];
    float first = 1e9f;
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (out.of_line[i] == k) first = std::min(first, out.offset[i]);
    std::vector<float> reached;
    Spread spread(picture, 1, sigma);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (out.of_line[i] != k) continue;
      out.offset[i] -= first;
      for (std::size_t s = 0; s < lines[i].points.size(); ++s) {
        reached.push_back(out.offset[i] + rides.lines[i].age[s]);
        spread.add(lines[i].points[s], reached.back());
      }
    }
    stream.duration = std::max(1.0f, quantile(reached, kWhole));
    stream.arrival = cv::max(cv::min(spread.field(), stream.duration), 0.0f);
    if (rides.stationary) continue;
    const cv::Size cells((picture.width + Stream::kEntryStep - 1) / Stream::kEntryStep,
                         (picture.height + Stream::kEntryStep - 1) / Stream::kEntryStep);
    stream.arrival_of_entry.resize(rides.lines.front().age_of_entry.size());
    tbb::parallel_for(std::size_t{0}, stream.arrival_of_entry.size(), [&](std::size_t entry) {
      stream.arrival_of_entry[entry] =
          cv::max(cv::min(of_entry(lines, rides, out, k, entry, cells, sigma), stream.duration), 0.0f);
    });
  }
  return out;
}

void hasten(Stream& stream, float by) {
  stream.arrival *= by;
  for (cv::Mat& arrival : stream.arrival_of_entry) arrival *= by;
  stream.duration *= by;
}

}  // namespace freshet::synth::flowlines
