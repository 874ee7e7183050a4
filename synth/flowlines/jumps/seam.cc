#include "synth/flowlines/jumps/seam.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::flowlines {
namespace {

constexpr int kSweeps = 3;        // over all rows, then all columns
constexpr float kBeside = 0.25f;  // weight of differences between neighbours

float length(const cv::Vec3i& colour) { return std::sqrt(static_cast<float>(colour.dot(colour))); }

/// The cost of going over at a label: the further from the front, the fewer frames are left to fade in.
float own_cost(const Meeting& meeting, int place, int label) {
  const float* difference = meeting.of(place);
  const auto reach = static_cast<float>(meeting.labels / 2), margin = reach + kFading;
  const float away = std::abs(static_cast<float>(label) - reach);
  return (difference[label] + difference[label + 1]) * margin / (margin - away);
}

/// Labels of one line of places by dynamic programming, its neighbours to both sides as they are.
class LineCut {
 public:
  LineCut(const Meeting& meeting, cv::Mat& labels)
      : meeting_(meeting),
        labels_(labels),
        count_(static_cast<std::size_t>(meeting.labels)),
        own_(count_),
        way_(count_),
        sum_(count_),
        from_(count_ * static_cast<std::size_t>(std::max(meeting.size.width, meeting.size.height))) {}

  /// `first`, then `step` on, places; neighbours are `across` away on either side, where `settled` says so.
  void solve(int first, int step, int places, int across, bool before, bool after) {
    for (int i = 0; i < places; ++i) {
      const int place = first + i * step;
      for (std::size_t d = 0; d < count_; ++d) own_[d] = own_cost(meeting_, place, static_cast<int>(d));
      if (before) add_neighbour(place, place - across);
      if (after) add_neighbour(place, place + across);
      if (i > 0) carry(place - step, place, from_.data() + static_cast<std::size_t>(i) * count_);
      for (std::size_t d = 0; d < count_; ++d) sum_[d] = own_[d] + (i > 0 ? sum_[d] : 0);
    }
    auto best = static_cast<std::size_t>(std::min_element(sum_.begin(), sum_.end()) - sum_.begin());
    for (int i = places - 1; i >= 0; --i) {
      labels_.data[first + i * step] = static_cast<std::uint8_t>(best);
      best = from_[static_cast<std::size_t>(i) * count_ + best];
    }
  }

 private:
  /// way_[d]: what two places differ by in the frames before label d. Between two labels lies the difference.
  void measure(int a, int b) {
    const float *of_a = meeting_.of(a), *of_b = meeting_.of(b);
    way_[0] = 0;
    for (std::size_t d = 1; d < count_; ++d) way_[d] = way_[d - 1] + kBeside * (of_a[d] + of_b[d]);
  }
  void add_neighbour(int place, int neighbour) {
    measure(place, neighbour);
    const float there = way_[labels_.data[neighbour]];
    for (std::size_t d = 0; d < count_; ++d) own_[d] += std::abs(way_[d] - there);
  }
  /// sum_[d]: least over the labels e before it of sum_[e] + |way_[d] - way_[e]|, by one pass in each direction.
  void carry(int before, int place, std::uint8_t* from) {
    measure(before, place);
    for (std::size_t d = 0; d < count_; ++d) from[d] = static_cast<std::uint8_t>(d);
    for (std::size_t d = 1; d < count_; ++d)
      if (const float by = sum_[d - 1] + way_[d] - way_[d - 1]; by < sum_[d]) {
        sum_[d] = by;
        from[d] = from[d - 1];
      }
    for (std::size_t d = count_ - 1; d-- > 0;)
      if (const float by = sum_[d + 1] + way_[d + 1] - way_[d]; by < sum_[d]) {
        sum_[d] = by;
        from[d] = from[d + 1];
      }
  }

  const Meeting& meeting_;
  cv::Mat& labels_;
  std::size_t count_;
  std::vector<float> own_, way_, sum_;
  std::vector<std::uint8_t> from_;
};

}  // namespace

Meeting meeting_of(const std::vector<cv::Mat>& frames, cv::Point corner, const cv::Mat& arrival, int leaves,
                   int enters, int reach) {
  Meeting meeting{.size = arrival.size(), .labels = 2 * reach + 1, .difference = {}};
  const auto row = static_cast<std::size_t>(meeting.labels + 1);
  meeting.difference.resize(arrival.total() * row);
  const int last = static_cast<int>(frames.size()) - 1;
  for (int y = 0, place = 0; y < arrival.rows; ++y)
    for (int x = 0; x < arrival.cols; ++x, ++place) {
      const auto colour = [&](int frame) {
        return cv::Vec3i(frames[static_cast<std::size_t>(std::clamp(frame, 0, last))].at<cv::Vec3b>(
            y + corner.y, x + corner.x));
      };
      const int later = cvRound(arrival.at<float>(y, x)) - reach - 1;
      float* to = meeting.difference.data() + static_cast<std::size_t>(place) * row;
      for (int d = 0; d <= meeting.labels; ++d)
        to[d] = length(colour(leaves + later + d) - colour(enters + later + d));
    }
  return meeting;
}

double cost_of(const Meeting& meeting, const cv::Mat& labels) {
  double sum = 0;
  const auto between = [&](int a, int b) {
    const int from = std::min(labels.data[a], labels.data[b]), to = std::max(labels.data[a], labels.data[b]);
    for (int d = from + 1; d <= to; ++d) sum += kBeside * (meeting.of(a)[d] + meeting.of(b)[d]);
  };
  for (int y = 0, place = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x, ++place) {
      sum += own_cost(meeting, place, labels.data[place]);
      if (x > 0) between(place - 1, place);
      if (y > 0) between(place - labels.cols, place);
    }
  return sum;
}

cv::Mat cut(const Meeting& meeting) {
  const int width = meeting.size.width, height = meeting.size.height;
  cv::Mat labels(meeting.size, CV_8U, cv::Scalar(meeting.labels / 2));
  LineCut line(meeting, labels);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (int y = 0; y < height; ++y)
      line.solve(y * width, 1, width, width, y > 0, y + 1 < height && sweep > 0);
    for (int x = 0; x < width; ++x) line.solve(x, width, height, 1, x > 0, x + 1 < width);
  }
  return labels;
}

}  // namespace freshet::synth::flowlines
