#include "synth/flowlines/ladder.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "synth/flowlines/jumps/fading.h"

namespace freshet::synth::flowlines {
namespace {

constexpr int kReduced = 4;
constexpr int kTaps = 1;  // sheared frames to either side that a comparison looks at
constexpr std::array<double, 2 * kTaps + 1> kBinomial{0.25, 0.5, 0.25};
constexpr int kReach = 3;              // frames from the rung within which a block may go over
constexpr int kBlock = 10;             // px of reduced frames
constexpr int kTrial = 400;            // frames of an order that is tried
constexpr std::size_t kTogether = 16;  // blocks whose differences are held at a time

static_assert(kLeastMargin >= kReach + kTaps);

/// Some of the stream's places of reduced frames, with their arrivals.
struct Places {
  std::vector<int> at;  // index into a reduced frame
  std::vector<float> arrival;
};

/// By block of the picture: each goes over when it likes.
std::vector<Places> blocks_of(const Stream& stream, const cv::Mat& where, cv::Size reduced) {
  cv::Mat inside, arrival;
  cv::resize(where, inside, reduced, 0, 0, cv::INTER_NEAREST);
  cv::resize(stream.arrival, arrival, reduced, 0, 0, cv::INTER_NEAREST);
  const int across = (reduced.width + kBlock - 1) / kBlock, down = (reduced.height + kBlock - 1) / kBlock;
  std::vector<Places> blocks(static_cast<std::size_t>(across * down));
  for (int y = 0; y < reduced.height; ++y)
    for (int x = 0; x < reduced.width; ++x)
      if (inside.at<std::uint8_t>(y, x) != 0) {
        Places& block = blocks[static_cast<std::size_t>(y / kBlock * across + x / kBlock)];
        block.at.push_back(y * reduced.width + x);
        block.arrival.push_back(arrival.at<float>(y, x));
      }
  std::erase_if(blocks, [](const Places& block) { return block.at.empty(); });
  return blocks;
}

/// Frame e of the sheared clip: a row of the stream's places.
cv::Mat sheared(const std::vector<cv::Mat>& frames, const Places& places, int entry) {
  cv::Mat row(1, static_cast<int>(places.at.size()), CV_8UC3);
  const int last = static_cast<int>(frames.size()) - 1;
  for (int i = 0; i < row.cols; ++i) {
    const int frame = std::clamp(entry + cvRound(places.arrival[static_cast<std::size_t>(i)]), 0, last);
    row.at<cv::Vec3b>(i) =
        frames[static_cast<std::size_t>(frame)].at<cv::Vec3b>(places.at[static_cast<std::size_t>(i)]);
  }
  return row;
}

/// Squared differences of all sheared frames in a block: kReach + kTaps before the first entry, as many after the last.
cv::Mat differences(const std::vector<cv::Mat>& frames, const Places& block, int first, int rows) {
  std::vector<cv::Mat> shown;
  for (int i = 0; i < rows; ++i) shown.push_back(sheared(frames, block, first - kReach - kTaps + i));
  cv::Mat out(rows, rows, CV_32F, cv::Scalar(0));
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < i; ++j)
      out.at<float>(i, j) = out.at<float>(j, i) = static_cast<float>(
          cv::norm(shown[static_cast<std::size_t>(i)], shown[static_cast<std::size_t>(j)], cv::NORM_L2SQR));
  return out;
}

/// Adds what a block's going over behind entry a costs when it does so in the best of the frames around the rung.
void add_block(const cv::Mat& differences, int a, cv::Mat& cost) {
  for (int b = 0; b < cost.cols; ++b) {
    double least = 1e30;
    for (int d = 0; d <= 2 * kReach; ++d) {
      double sum = 0;
      for (int k = 0; k <= 2 * kTaps; ++k)
        sum += kBinomial[static_cast<std::size_t>(k)] *
               static_cast<double>(differences.at<float>(a + d + k, b + d + k));
      least = std::min(least, sum);
    }
    cost.at<double>(a, b) += least;
  }
}

/// Of all blocks, some at a time: added up in order, the same for any number of threads.
cv::Mat summed(const std::vector<cv::Mat>& frames, const std::vector<Places>& blocks, int first,
               int entries) {
  const int rows = entries + 1 + 2 * (kReach + kTaps);
  cv::Mat sum(entries + 1, entries, CV_64F, cv::Scalar(0));
  std::array<cv::Mat, kTogether> differing;
  for (std::size_t from = 0; from < blocks.size(); from += kTogether) {
    const std::size_t count = std::min(kTogether, blocks.size() - from);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      differing[i] = differences(frames, blocks[from + i], first, rows);
    });
    tbb::parallel_for(0, sum.rows, [&](int a) {
      for (std::size_t i = 0; i < count; ++i) add_block(differing[i], a, sum);
    });
  }
  return sum;
}

/// Mean of the sums whose entries lie at least so far apart, and at most.
double mean_apart(const cv::Mat& sums, int least, int most) {
  double sum = 0;
  int pairs = 0;
  for (int a = 0; a < sums.rows; ++a)
    for (int b = 0; b < sums.cols; ++b)
      if (std::abs(a - b) >= least && std::abs(a - b) <= most) {
        sum += sums.at<double>(a, b);
        ++pairs;
      }
  return sum / std::max(1, pairs);
}

/// Costs for entries of the plan, and how many frames' changes a jump is worth.
void weigh_jumps(const cv::Mat& sums, Ladder& ladder) {
  const double unrelated = mean_apart(sums, sums.cols / 3 + 1, sums.rows), near = mean_apart(sums, 1, 1);
  sums.convertTo(ladder.cost, CV_32F, unrelated > 0 ? 1 / unrelated : 1);
  ladder.changes = near > 0 ? std::sqrt(unrelated / near) : 1;
}

/// A jump near the clip's beginning or end has fewer frames to go over in, and shows the more.
void lack_room(const Stream& stream, double fade, int frames, Ladder& ladder) {
  const double halfway = 0.5 * static_cast<double>(stream.duration);
  for (int a = 0; a < ladder.cost.rows; ++a)
    for (int b = 0; b < ladder.cost.cols; ++b) {
      const double before = ladder.first + b + halfway, after = frames - 1 - (ladder.first + a) - halfway;
      const double lacks = std::max(1.0, fade / std::max(1.0, std::min(before, after)));
      ladder.cost.at<float>(a, b) *= static_cast<float>(lacks);
    }
}

/// What an order as it would be made costs.
void try_out(Ladder& ladder, const RepeatOptions& options) {
  Repeats repeats(ladder.cost, options);
  double sum = 0;
  int jumps = 0;
  std::int64_t end = 0;
  for (; end < kTrial; ++jumps) {
    end = repeats.next().end();
    sum += repeats.jump();
  }
  ladder.per_frame = sum / static_cast<double>(end);
  ladder.jump = sum / jumps;
}

}  // namespace

Ladders::Ladders(const std::vector<cv::Mat>& frames) : small_(frames.size()) {
  const cv::Size reduced(std::max(1, frames.front().cols / kReduced),
                         std::max(1, frames.front().rows / kReduced));
  tbb::parallel_for(std::size_t{0}, frames.size(),
                    [&](std::size_t i) { cv::resize(frames[i], small_[i], reduced, 0, 0, cv::INTER_AREA); });
}

Ladder Ladders::of(const Stream& stream, const cv::Mat& where, int margin, int entries,
                   const RepeatOptions& options) const {
  const std::vector<Places> blocks = blocks_of(stream, where, small_.front().size());
  Ladder ladder{.first = margin, .cost = {}};
  weigh_jumps(blocks.empty() ? cv::Mat(entries + 1, entries, CV_64F, cv::Scalar(0))
                             : summed(small_, blocks, margin, entries),
              ladder);
  // Two rungs stay further apart than feathering is wide, as far as there is room; fluid that creeps feathers long.
  RepeatOptions repeats = options;
  repeats.fade = ladder.fade = std::min(kSlower * ladder.changes, static_cast<double>(kMostFade));
  ladder.min_run = std::max(std::clamp(entries / 3, 2, 2 * margin + 2),
                            std::min(cvRound(2 * ladder.fade) + 2, entries / 2));
  repeats.min_run = ladder.min_run;
  lack_room(stream, repeats.fade, static_cast<int>(small_.size()), ladder);
  try_out(ladder, repeats);
  return ladder;
}

}  // namespace freshet::synth::flowlines
