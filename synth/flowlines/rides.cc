#include "synth/flowlines/rides.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"

namespace freshet::synth::flowlines {
namespace {

constexpr int kAcross = 2;  // px between a ribbon's columns

/// A line's surroundings straightened, frame by frame: a row for a sample, a column for a distance to the line.
std::vector<cv::Mat> ribbons(const std::vector<cv::Mat>& luma, const FlowLine& line, int columns) {
  cv::Mat map(line.samples(), columns, CV_32FC2);
  for (int s = 0; s < map.rows; ++s) {
    const cv::Point2f along = tangent(line, s), across(-along.y, along.x);
    for (int c = 0; c < columns; ++c) {
      const cv::Point2f place =
          line.points[static_cast<std::size_t>(s)] +
          across * (static_cast<float>(c * kAcross) - 0.5f * static_cast<float>((columns - 1) * kAcross));
      map.at<cv::Vec2f>(s, c) = cv::Vec2f(place.x, place.y);
    }
  }
  std::vector<cv::Mat> out(luma.size());
  cv::Mat mean(map.size(), CV_32F, cv::Scalar(0));
  cv::Mat shown;
  for (std::size_t f = 0; f < luma.size(); ++f) {
    cv::remap(luma[f], shown, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    shown.convertTo(out[f], CV_32F);
    mean += out[f];
  }
  mean *= 1.0 / static_cast<double>(luma.size());
  for (cv::Mat& ribbon : out) ribbon -= mean;
  return out;
}

/// The flow along the line at every sample of a frame: where the search begins.
std::vector<float> guesses(const cv::Mat& flow, const FlowLine& line) {
  std::vector<float> out(static_cast<std::size_t>(line.samples()));
  for (int s = 0; s < line.samples(); ++s) {
    const cv::Point2f at = line.points[static_cast<std::size_t>(s)];
    const int x = std::clamp(static_cast<int>(at.x) / ClipMotion::kFlowStep, 0, flow.cols - 1);
    const int y = std::clamp(static_cast<int>(at.y) / ClipMotion::kFlowStep, 0, flow.rows - 1);
    const cv::Vec2f v = flow.at<cv::Vec2f>(y, x);
    out[static_cast<std::size_t>(s)] = cv::Point2f(v[0], v[1]).dot(tangent(line, s));
  }
  return out;
}

/// Mean squared differences of a patch and its shifted selves: a row for a sample, a column for a shift. Where the
/// shifted patch leaves the line they are taken over what stays on it.
struct Costs {
  int least = 0;  // the first column's shift, px
  cv::Mat values;

  float of(int s, int k) const { return values.at<float>(s, k - least); }
  int most() const { return least + values.cols - 1; }
};

/// half: 0 the whole ribbon, -1 and 1 its two halves.
void measure(const cv::Mat& now, const cv::Mat& next, int reach, int half, Costs& costs) {
  const int rows = now.rows, columns = now.cols;
  const int from = half > 0 ? columns / 2 : 0, to = half < 0 ? columns / 2 : columns;
  std::vector<double> sum(static_cast<std::size_t>(rows) + 1);
  std::vector<int> count(static_cast<std::size_t>(rows) + 1);
  for (int k = costs.least; k <= costs.most(); ++k) {
    for (int s = 0; s < rows; ++s) {
      double difference = 0;
      const bool on_line = s + k >= 0 && s + k < rows;
      if (on_line) {
        const float* a = now.ptr<float>(s);
        const float* b = next.ptr<float>(s + k);
        for (int c = from; c < to; ++c) difference += (a[c] - b[c]) * (a[c] - b[c]);
      }
      sum[static_cast<std::size_t>(s) + 1] = sum[static_cast<std::size_t>(s)] + difference;
      count[static_cast<std::size_t>(s) + 1] = count[static_cast<std::size_t>(s)] + on_line;
    }
    for (int s = 0; s < rows; ++s) {
      const auto low = static_cast<std::size_t>(std::max(0, s - reach));
      const auto high = static_cast<std::size_t>(std::min(rows, s + reach + 1));
      const int samples = count[high] - count[low];
      // Fewer than half of a patch say nothing: such a shift is never the best.
      costs.values.at<float>(s, k - costs.least) =
          samples * 2 < static_cast<int>(high - low)
              ? std::numeric_limits<float>::max()
              : static_cast<float>((sum[high] - sum[low]) / (samples * (to - from)));
    }
  }
}

/// The best shift near a guess, to a fraction of a pixel.
float best_shift(const Costs& costs, int s, float guess, double search) {
  const int low = std::max(costs.least, static_cast<int>(std::floor(guess - search)));
  const int high = std::min(costs.most(), static_cast<int>(std::ceil(guess + search)));
  int best = std::clamp(cvRound(guess), costs.least, costs.most());
  for (int k = low; k <= high; ++k)
    if (costs.of(s, k) < costs.of(s, best)) best = k;
  if (best <= costs.least || best >= costs.most()) return static_cast<float>(best);
  const double a = costs.of(s, best - 1), b = costs.of(s, best), c = costs.of(s, best + 1);
  const double bend = a - 2 * b + c;
  if (!(bend > 0) || a > 1e30 || c > 1e30) return static_cast<float>(best);
  return static_cast<float>(best) + static_cast<float>(std::clamp(0.5 * (a - c) / bend, -0.5, 0.5));
}

/// The cost at a shift between whole pixels.
double cost_at(const Costs& costs, int s, float shift) {
  const int k = std::clamp(static_cast<int>(std::floor(shift)), costs.least, costs.most() - 1);
  const double part = std::clamp(static_cast<double>(shift) - k, 0.0, 1.0);
  return costs.of(s, k) * (1 - part) + costs.of(s, k + 1) * part;
}

void smooth(std::vector<float>& values, double sigma) {
  cv::Mat row(1, static_cast<int>(values.size()), CV_32F, values.data());
  cv::GaussianBlur(row, row, cv::Size(0, 1), sigma, 0, cv::BORDER_REPLICATE);
}

std::vector<float> ages(const std::vector<float>& speed) {
  std::vector<float> age(speed.size(), 0.0f);
  for (std::size_t s = 1; s < speed.size(); ++s) age[s] = age[s - 1] + 2 / (speed[s - 1] + speed[s]);
  return age;
}

/// One line: its speeds in every frame and all together.
class Follower {
 public:
  Follower(const std::vector<cv::Mat>& luma, const FlowLine& line, const ClipMotion& motion,
           const RideOptions& options)
      : options_(options),
        reach_(std::max(1, cvRound(options.patch_px / 2))),
        ribbons_(ribbons(luma, line, std::max(4, cvRound(options.patch_px / kAcross)))) {
    float least = 0, most = 1;
    for (const cv::Mat& flow : motion.flows) {
      guesses_.push_back(guesses(flow, line));
      for (const float guess : guesses_.back()) {
        least = std::min(least, guess);
        most = std::max(most, guess);
      }
    }
    const auto edge = static_cast<float>(options.search_px + 1);
    first_ = static_cast<int>(std::floor(std::max(least, -edge) - edge));
    shifts_ = static_cast<int>(std::ceil(most + edge)) - first_ + 1;
    samples_ = line.samples();
  }

  Ride pooled() {
    Ride ride;
    const auto n = static_cast<std::size_t>(samples_);
    Costs costs = blank(), all = blank();
    std::vector<float> guess(n, 0.0f);
    all.values.setTo(0);
    for (std::size_t f = 0; f + 1 < ribbons_.size(); ++f) {
      measure(ribbons_[f], ribbons_[f + 1], reach_, 0, costs);
      cv::min(costs.values, 1e9f, costs.values);
      all.values += costs.values;
      for (std::size_t s = 0; s < n; ++s) guess[s] += guesses_[f][s];
    }
    int against = 0;
    ride.speed.resize(n);
    for (std::size_t s = 0; s < n; ++s) {
      guess[s] /= static_cast<float>(ribbons_.size() - 1);
      against += guess[s] < 0;
      ride.speed[s] = std::max(best_shift(all, static_cast<int>(s), guess[s], options_.search_px),
                               static_cast<float>(options_.min_speed));
    }
    ride.against = against / static_cast<double>(n);
    smooth(ride.speed, 0.25 * options_.patch_px);
    ride.age = ages(ride.speed);
    return ride;
  }

  /// What is left of the squared difference with the places' speeds, and with speeds found in the other half.
  cv::Vec2d left(const Ride& ride) {
    Costs a = blank(), b = blank();
    cv::Vec2d sums(0, 0);
    for (std::size_t f = 0; f + 1 < ribbons_.size(); f += 2) {
      measure(ribbons_[f], ribbons_[f + 1], reach_, -1, a);
      measure(ribbons_[f], ribbons_[f + 1], reach_, 1, b);
      for (int s = reach_; s < samples_ - reach_; s += 4) {
        const float place = ride.speed[static_cast<std::size_t>(s)];
        const double still = cost_at(b, s, place);
        const double own = cost_at(b, s, kept(best_shift(a, s, place, options_.search_px), place));
        if (still > 1e8 || own > 1e8) continue;
        sums += cv::Vec2d(still, own);
      }
    }
    return sums;
  }

  /// Every particle from the frame in which it enters; behind the clip's last frame as the place says.
  void by_entry(Ride& ride) {
    const auto n = static_cast<std::size_t>(samples_);
    std::vector<std::vector<float>> speeds;
    Costs costs = blank();
    for (std::size_t f = 0; f + 1 < ribbons_.size(); ++f) {
      measure(ribbons_[f], ribbons_[f + 1], reach_, 0, costs);
      std::vector<float> speed(n);
      for (std::size_t s = 0; s < n; ++s)
        speed[s] =
            kept(best_shift(costs, static_cast<int>(s), ride.speed[s], options_.search_px), ride.speed[s]);
      smooth(speed, 0.25 * options_.patch_px);
      speeds.push_back(std::move(speed));
    }
    for (std::size_t entry = 0; entry < ribbons_.size(); ++entry)
      ride.age_of_entry.push_back(one_particle(speeds, ride.speed, entry));
  }

 private:
  Costs blank() const { return {first_, cv::Mat(samples_, shifts_, CV_32F)}; }
  float kept(float speed, float place) const {
    const auto ratio = static_cast<float>(options_.max_ratio);
    return std::clamp(speed, place / ratio, place * ratio);
  }
  static std::vector<float> one_particle(const std::vector<std::vector<float>>& speeds,
                                         const std::vector<float>& place, std::size_t entry) {
    std::vector<float> age(place.size(), 0.0f);
    float time = 0;  // since it entered
    for (std::size_t s = 0; s + 1 < place.size(); ++s) {
      // Within a stretch of 1 px the frame may change several times, or not for long.
      float left = 1;
      while (left > 0) {
        const auto frame = entry + static_cast<std::size_t>(time);
        const float speed = frame < speeds.size() ? speeds[frame][s] : place[s];
        const float until = std::floor(time) + 1 - time;
        const float way = std::min(left, speed * until);
        left -= way;
        if (left <= 1e-6f) {
          time += way / speed;
          break;
        }
        time = std::floor(time) + 1;
      }
      age[s + 1] = time;
    }
    return age;
  }

  RideOptions options_;
  int reach_, first_ = 0, shifts_ = 1, samples_ = 0;
  std::vector<cv::Mat> ribbons_;
  std::vector<std::vector<float>> guesses_;
};

}  // namespace

Rides follow(const std::vector<cv::Mat>& luma, const std::vector<FlowLine>& lines, const ClipMotion& motion,
             const RideOptions& options, const Job& job) {
  Rides rides;
  rides.lines.resize(lines.size());
  std::vector<cv::Vec2d> left(lines.size());
  const auto stop = [&] {
    if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "particles", "stopped");
  };
  stop();
  if (job.progress) job.progress({"following particles", 0, lines.size()});
  tbb::parallel_for(std::size_t{0}, lines.size(), [&](std::size_t i) {
    if (job.stop.stop_requested()) return;
    Follower follower(luma, lines[i], motion, options);
    rides.lines[i] = follower.pooled();
    left[i] = follower.left(rides.lines[i]);
    if (options.dynamics != Dynamics::kStationary) follower.by_entry(rides.lines[i]);
  });
  stop();
  cv::Vec2d sums(0, 0);
  for (const cv::Vec2d& of_line : left) sums += of_line;
  rides.gain = sums[0] > 0 ? 1 - sums[1] / sums[0] : 0;
  rides.stationary = options.dynamics == Dynamics::kStationary ||
                     (options.dynamics == Dynamics::kMeasured && rides.gain < options.min_gain);
  if (rides.stationary)
    for (Ride& ride : rides.lines) ride.age_of_entry.clear();
  return rides;
}

}  // namespace freshet::synth::flowlines
