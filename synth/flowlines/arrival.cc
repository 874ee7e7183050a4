#include "synth/flowlines/arrival.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <tbb/parallel_for.h>
#include <Eigen/Dense>
#include <opencv2/imgproc.hpp>

#include "synth/sampling/pull_push.h"

namespace freshet::synth::flowlines {
namespace {

constexpr int kStride = 4;        // px along a line between places that are compared
constexpr double kReach = 1.7;    // spacings within which lines lie side by side
constexpr float kSameWay = 0.6f;  // cosine
constexpr double kWhole = 0.98;   // of a stream's places: the rest are eddies that a front would never leave

float quantile(std::vector<float> values, double share) {
  const auto nth =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// Ages of a front that passes at once over what is slower than the floor: between .7 of it and it, gradually.
std::vector<float> floored(const std::vector<float>& age, float floor) {
  if (floor <= 0) return age;
  std::vector<float> out(age.size(), 0.0f);
  for (std::size_t s = 1; s < age.size(); ++s) {
    const float took = age[s] - age[s - 1];
    const float share = std::clamp((1 / (took * floor) - 0.7f) / 0.3f, 0.0f, 1.0f);
    out[s] = out[s - 1] + took * share * share * (3 - 2 * share);
  }
  return out;
}

std::vector<std::vector<float>> floored(const Rides& rides, float floor) {
  std::vector<std::vector<float>> out;
  for (const Ride& ride : rides.lines) out.push_back(floored(ride.age, floor));
  return out;
}

/// Where two lines lie side by side: a sample of each.
struct Beside {
  std::size_t a, b;
  std::size_t at_a, at_b;
};

std::vector<Beside> side_by_side(const std::vector<FlowLine>& lines, double spacing) {
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
  std::vector<Beside> found;
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
          found.push_back({i, line, static_cast<std::size_t>(s), static_cast<std::size_t>(best.second)});
    }
  return found;
}

/// How far across the flow a line lies from another, which is thought to go on straight: the median over its samples.
double across(const FlowLine& line, const FlowLine& from) {
  std::vector<float> distances;
  for (int s = 0; s < line.samples(); s += 2 * kStride) {
    const cv::Point2f here = line.points[static_cast<std::size_t>(s)];
    int nearest = 0;
    float least = 1e18f;
    for (int t = 0; t < from.samples(); t += kStride) {
      const cv::Point2f way = from.points[static_cast<std::size_t>(t)] - here;
      if (way.dot(way) < least) {
        least = way.dot(way);
        nearest = t;
      }
    }
    const cv::Point2f along = tangent(from, nearest);
    distances.push_back(
        std::abs((here - from.points[static_cast<std::size_t>(nearest)]).dot({-along.y, along.x})));
  }
  return static_cast<double>(quantile(distances, 0.5));
}

/// Streams: from the longest line that has none yet outwards, by what touches, up to half a width to either side. The
/// largest first; small ones, and those beyond the limit, go to the neighbour that they touch most.
std::vector<int> grouped(const std::vector<FlowLine>& lines, const std::vector<Beside>& pairs,
                         const StrandOptions& options, int& count) {
  const double reach = options.width_px > 0 ? options.width_px / 2 : 1e18;
  std::vector<std::map<std::size_t, int>> touching(lines.size());
  for (const Beside& pair : pairs) {
    ++touching[pair.a][pair.b];
    ++touching[pair.b][pair.a];
  }
  std::vector<std::size_t> longest(lines.size());
  std::iota(longest.begin(), longest.end(), std::size_t{0});
  std::stable_sort(longest.begin(), longest.end(),
                   [&](std::size_t a, std::size_t b) { return lines[a].samples() > lines[b].samples(); });
  std::vector<int> of(lines.size(), -1);
  std::vector<int> samples;  // by stream
  for (const std::size_t seed : longest) {
    if (of[seed] >= 0) continue;
    const int stream = static_cast<int>(samples.size());
    samples.push_back(0);
    std::vector<std::size_t> open{seed};
    of[seed] = stream;
    while (!open.empty()) {
      const std::size_t line = open.back();
      open.pop_back();
      samples.back() += lines[line].samples();
      for (const auto& [other, times] : touching[line])
        if (of[other] < 0 && across(lines[other], lines[seed]) <= reach) {
          of[other] = stream;
          open.push_back(other);
        }
    }
  }
  std::vector<std::pair<int, int>> order;
  for (std::size_t i = 0; i < samples.size(); ++i) order.emplace_back(-samples[i], static_cast<int>(i));
  std::sort(order.begin(), order.end());
  std::vector<int> number(samples.size(), -1);
  count = 0;
  for (const auto& [less, stream] : order)
    if (count == 0 || (count < kMaxStreams && -less >= -order.front().first / 6))
      number[static_cast<std::size_t>(stream)] = count++;
  std::vector<int> out(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    out[i] = number[static_cast<std::size_t>(of[i])];
    if (out[i] >= 0) continue;
    int most = 0;
    out[i] = 0;
    for (const auto& [other, times] : touching[i])
      if (number[static_cast<std::size_t>(of[other])] >= 0 && times > most) {
        most = times;
        out[i] = number[static_cast<std::size_t>(of[other])];
      }
  }
  return out;
}

/// Least squares over all neighbours of one stream; a line without any keeps 0.
std::vector<float> offsets_of(const std::vector<std::vector<float>>& ages, const std::vector<Beside>& pairs,
                              const std::vector<int>& of_line) {
  const std::size_t lines = ages.size();
  const auto n = static_cast<Eigen::Index>(lines);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(n, n) * 1e-3;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (const Beside& pair : pairs) {
    if (of_line[pair.a] != of_line[pair.b]) continue;
    const auto a = static_cast<Eigen::Index>(pair.a), b = static_cast<Eigen::Index>(pair.b);
    normal(a, a) += 1;
    normal(b, b) += 1;
    normal(a, b) -= 1;
    normal(b, a) -= 1;
    const auto later = static_cast<double>(ages[pair.b][pair.at_b] - ages[pair.a][pair.at_a]);
    right(a) += later;
    right(b) -= later;
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
    out = sampling::pull_push(values, trust);
    cv::GaussianBlur(out, out, cv::Size(), sigma_ / step_);
    return out;
  }

 private:
  cv::Mat sum_, weight_;
  float step_;
  double sigma_;
};

/// To which stream each place belongs: its nearest line's; and where another's is all but as near.
void share_places(const std::vector<FlowLine>& lines, cv::Size picture, double blend, Arrivals& out) {
  out.stream = cv::Mat(picture, CV_8U, cv::Scalar(0));
  out.neighbour = cv::Mat(picture, CV_8U, cv::Scalar(0));
  out.share = cv::Mat(picture, CV_32F, cv::Scalar(0));
  cv::Mat nearest(picture, CV_32F, cv::Scalar(1e6)), second(picture, CV_32F, cv::Scalar(1e6)), distance;
  const cv::Rect inside({0, 0}, picture);
  for (std::size_t k = 0; k < out.streams.size(); ++k) {
    cv::Mat away(picture, CV_8U, cv::Scalar(255));
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (out.of_line[i] == static_cast<int>(k))
        for (const cv::Point2f& point : lines[i].points)
          if (const cv::Point at(cvRound(point.x), cvRound(point.y)); inside.contains(at))
            away.at<std::uint8_t>(at) = 0;
    cv::distanceTransform(away, distance, cv::DIST_L2, cv::DIST_MASK_5);
    const cv::Mat first = distance < nearest, then = (distance < second) & ~first;
    nearest.copyTo(second, first);
    out.stream.copyTo(out.neighbour, first);
    distance.copyTo(nearest, first);
    out.stream.setTo(static_cast<double>(k), first);
    distance.copyTo(second, then);
    out.neighbour.setTo(static_cast<double>(k), then);
  }
  out.share = cv::max(0.5 - (second - nearest) * (0.5 / blend), 0.0);
}

/// A front that enters in frame `entry` is followed from each line's own entry.
cv::Mat of_entry(const std::vector<FlowLine>& lines, const Rides& rides, const Arrivals& all, int stream,
                 std::size_t entry, cv::Size cells, double sigma, float floor) {
  Spread spread(cells, Stream::kEntryStep, sigma);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (all.of_line[i] != stream) continue;
    const Ride& ride = rides.lines[i];
    const std::size_t last = ride.age_of_entry.size() - 1;
    const std::size_t enters = std::min(last, entry + static_cast<std::size_t>(std::lround(all.offset[i])));
    const std::vector<float> age = floored(ride.age_of_entry[enters], floor);
    for (std::size_t s = 0; s < age.size(); s += 2) spread.add(lines[i].points[s], all.offset[i] + age[s]);
  }
  return spread.field();
}

/// By stream: frames until its last places are reached. Offsets are made to begin at 0.
std::vector<float> durations(const std::vector<std::vector<float>>& ages, const std::vector<int>& of_line,
                             int count, std::vector<float>& offset) {
  std::vector<float> first(static_cast<std::size_t>(count), 1e9f), out(static_cast<std::size_t>(count), 1.0f);
  for (std::size_t i = 0; i < ages.size(); ++i) {
    float& begins = first[static_cast<std::size_t>(of_line[i])];
    begins = std::min(begins, offset[i]);
  }
  std::vector<std::vector<float>> reached(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < ages.size(); ++i) {
    const auto k = static_cast<std::size_t>(of_line[i]);
    offset[i] -= first[k];
    for (const float age : ages[i]) reached[k].push_back(offset[i] + age);
  }
  for (std::size_t k = 0; k < reached.size(); ++k) out[k] = std::max(1.0f, quantile(reached[k], kWhole));
  return out;
}

}  // namespace

float floor_for(const std::vector<FlowLine>& lines, const Rides& rides, const StrandOptions& strands,
                float way) {
  const std::vector<Beside> pairs = side_by_side(lines, strands.spacing_px);
  int count = 0;
  const std::vector<int> of_line = grouped(lines, pairs, strands, count);
  const auto longest = [&](float floor) {
    const std::vector<std::vector<float>> ages = floored(rides, floor);
    std::vector<float> offset = offsets_of(ages, pairs, of_line);
    const std::vector<float> all = durations(ages, of_line, count, offset);
    return *std::max_element(all.begin(), all.end());
  };
  if (longest(0) <= way) return 0;
  float low = 0.01f, high = 1000;
  for (int i = 0; i < 14; ++i) {
    const float middle = std::sqrt(low * high);
    (longest(middle) <= way ? high : low) = middle;
  }
  return high;
}

double share_below(const Rides& rides, float floor) {
  std::size_t below = 0, all = 0;
  for (const Ride& ride : rides.lines)
    for (const float speed : ride.speed) {
      below += speed < floor;
      ++all;
    }
  return all > 0 ? static_cast<double>(below) / static_cast<double>(all) : 0;
}

Arrivals arrivals(const std::vector<FlowLine>& lines, const Rides& rides, cv::Size picture,
                  const StrandOptions& strands, float floor, bool by_entry) {
  Arrivals out;
  const std::vector<Beside> pairs = side_by_side(lines, strands.spacing_px);
  const std::vector<std::vector<float>> ages = floored(rides, floor);
  int count = 0;
  out.of_line = grouped(lines, pairs, strands, count);
  out.offset = offsets_of(ages, pairs, out.of_line);
  const std::vector<float> duration = durations(ages, out.of_line, count, out.offset);
  out.streams.resize(static_cast<std::size_t>(count));
  share_places(lines, picture, strands.blend_px, out);
  const double sigma = 0.6 * strands.spacing_px;
  Spread speed(picture, 1, sigma);
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (std::size_t s = 0; s < lines[i].points.size(); ++s)
      speed.add(lines[i].points[s], rides.lines[i].speed[s]);
  out.speed = speed.field();
  for (int k = 0; k < count; ++k) {
    Stream& stream = out.streams[static_cast<std::size_t>(k)];
    stream.duration = duration[static_cast<std::size_t>(k)];
    Spread spread(picture, 1, sigma);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (out.of_line[i] != k) continue;
      for (std::size_t s = 0; s < lines[i].points.size(); ++s)
        spread.add(lines[i].points[s], out.offset[i] + ages[i][s]);
    }
    stream.arrival = cv::max(cv::min(spread.field(), stream.duration), 0.0f);
    if (rides.stationary || !by_entry) continue;
    const cv::Size cells((picture.width + Stream::kEntryStep - 1) / Stream::kEntryStep,
                         (picture.height + Stream::kEntryStep - 1) / Stream::kEntryStep);
    stream.arrival_of_entry.resize(rides.lines.front().age_of_entry.size());
    tbb::parallel_for(std::size_t{0}, stream.arrival_of_entry.size(), [&](std::size_t entry) {
      stream.arrival_of_entry[entry] =
          cv::max(cv::min(of_entry(lines, rides, out, k, entry, cells, sigma, floor), stream.duration), 0.0f);
    });
  }
  return out;
}

}  // namespace freshet::synth::flowlines
