#include "synth/animate/motion/carrying_field.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "platform/smoothstep.h"
#include "platform/vectors.h"

namespace freshet::synth::animate {
namespace {

constexpr double kMaxTurnScale = 4;  // fluctuations are scaled by at most this, before what mixing lost
constexpr float kMinTurnScale =
    0.25;  // and by at least this, where the patches have no mean motion to speak of
constexpr double kSlowFraction = 0.2;  // of the mean speed: slower places have no direction of their own
constexpr double kSmoothing_px = 16;   // the turn is smooth, where strokes meet slow places
constexpr double kHardly = 1e-6;       // (px/s)^2: a variance below is none
constexpr double kMixedOver_px = 32;   // sigma, over which what mixing takes is told
constexpr float kStands = 0.2f, kIsAsked = 1;  // px/s; a stroke of speed 0 asks for .1
constexpr int kMeasured = 64;                  // frames that means and limits are measured on
// Frames kept: some more than one batch goes on by, and more as far as they fit into this.
constexpr std::size_t kMinKept = 24, kKeptBytes = 32 << 20;

float length(const cv::Vec2f& v) { return std::hypot(v[0], v[1]); }

/// Fluctuations about the assigned mean, turned, bounded, and added to the mean that is asked. Pairs.
/// together  faster_together: by what the patches do as a whole no place gains
/// regained  part of the turn, >= 1
FRESHET_WIDE void fluctuate(const float* assigned, const float* turn, const float* regained, float together,
                            const float* mean, const float* limit, int n, float* v) {
  for (int x = 0; x < n; ++x) {
    const float as = 1 + together * (1 - 1 / regained[x]);
    const float a = v[2 * x] - as * assigned[2 * x], b = v[2 * x + 1] - as * assigned[2 * x + 1];
    const float du = a * turn[2 * x] - b * turn[2 * x + 1], dv = a * turn[2 * x + 1] + b * turn[2 * x];
    const double u = du, w = dv;
    const auto size = static_cast<float>(std::sqrt(u * u + w * w));
    const float less = size > limit[x] ? limit[x] / size : 1.0f;
    v[2 * x] = mean[2 * x] + du * less;
    v[2 * x + 1] = mean[2 * x + 1] + dv * less;
  }
}

double mean_speed(const cv::Mat& field) {
  double sum = 0;
  for (int y = 0; y < field.rows; ++y)
    for (int x = 0; x < field.cols; ++x) sum += length(field.at<cv::Vec2f>(y, x));
  return sum / static_cast<double>(field.total());
}

/// Of fields, how much they differ from their mean: CV_32F, mean of the squares.
cv::Mat variance_about(const cv::Mat& mean, const std::vector<cv::Mat>& fields) {
  cv::Mat out = cv::Mat::zeros(mean.size(), CV_32F);
  for (const cv::Mat& field : fields)
    for (int y = 0; y < mean.rows; ++y)
      for (int x = 0; x < mean.cols; ++x) {
        const cv::Vec2f d = field.at<cv::Vec2f>(y, x) - mean.at<cv::Vec2f>(y, x);
        out.at<float>(y, x) += d.dot(d) / static_cast<float>(fields.size());
      }
  return out;
}

/// By how much a field goes faster than the mean as a whole, of 1: -1 where all stands for a frame.
double faster_together(const cv::Mat& field, const cv::Mat& mean) {
  double along = 0, power = 0;
  for (int y = 0; y < mean.rows; ++y)
    for (int x = 0; x < mean.cols; ++x) {
      const cv::Vec2f& of_mean = mean.at<cv::Vec2f>(y, x);
      along += field.at<cv::Vec2f>(y, x).dot(of_mean);
      power += of_mean.dot(of_mean);
    }
  return power > 0 ? along / power - 1 : 0;
}

/// Deviations of patches' own motion over those of their mixture, around each place: 1 .. most. own, mixed: variances.
/// together: what of both is done together, which mixing keeps.
cv::Mat lost_by_mixing(const cv::Mat& own, const cv::Mat& mixed, const cv::Mat& together, int step,
                       double most) {
  const double sigma = kMixedOver_px / step;
  const auto around = [&](const cv::Mat& variance) {
    cv::Mat out;
    cv::GaussianBlur(variance - together, out, {}, sigma, sigma, cv::BORDER_REPLICATE);
    return cv::Mat(cv::max(out, kHardly));
  };
  cv::Mat out;
  cv::sqrt(around(own) / around(mixed), out);
  return cv::min(cv::max(out, 1.0), most);
}

/// CarryingOptions::least_scale where anything is asked but to stand. asked: px/s.
cv::Mat least_scales(const cv::Mat& asked, int step, double least) {
  cv::Mat out(asked.size(), CV_32F), around;
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x)
      out.at<float>(y, x) =
          static_cast<float>(least) * smoothstep(kStands, kIsAsked, length(asked.at<cv::Vec2f>(y, x)));
  cv::GaussianBlur(out, around, {}, kSmoothing_px / step, kSmoothing_px / step, cv::BORDER_REPLICATE);
  return cv::min(out, around);
}

/// The complex number that turns and scales the assigned mean to the asked one, smoothed over slow places.
/// least  CV_32F: below this scale fluctuations go as they are assigned instead
cv::Mat turn_between(const cv::Mat& assigned, const cv::Mat& asked, int step, const cv::Mat& least) {
  const double sigma = kSmoothing_px / step;
  const auto slow = static_cast<float>(kSlowFraction * mean_speed(assigned));
  cv::Mat sum(assigned.size(), CV_32FC2), mass(assigned.size(), CV_32F);
  for (int y = 0; y < assigned.rows; ++y)
    for (int x = 0; x < assigned.cols; ++x) {
      const cv::Vec2f a = assigned.at<cv::Vec2f>(y, x), b = asked.at<cv::Vec2f>(y, x);
      const float speed = length(a);
      // asked = turn * assigned; weighted by the assigned power, so that slow places follow fast ones.
      const float power = speed * speed + slow * slow;
      sum.at<cv::Vec2f>(y, x) = cv::Vec2f(a[0] * b[0] + a[1] * b[1], a[0] * b[1] - a[1] * b[0]);
      mass.at<float>(y, x) = std::max(power, 1e-12f);
    }
  cv::GaussianBlur(sum, sum, {}, sigma, sigma, cv::BORDER_REPLICATE);
  cv::GaussianBlur(mass, mass, {}, sigma, sigma, cv::BORDER_REPLICATE);
  for (int y = 0; y < sum.rows; ++y)
    for (int x = 0; x < sum.cols; ++x) {
      cv::Vec2f turn = sum.at<cv::Vec2f>(y, x) / mass.at<float>(y, x);
      const float scale = length(turn);
      // Where patches that go are asked to stand, nothing is left of what they do.
      const bool goes = mass.at<float>(y, x) >= 2 * slow * slow;
      const float wanted = std::clamp(scale, goes ? 0.0f : kMinTurnScale, static_cast<float>(kMaxTurnScale));
      turn = scale > 1e-6f ? cv::Vec2f(turn * (wanted / scale)) : cv::Vec2f(wanted, 0);
      turn[0] += std::max(least.at<float>(y, x) - wanted, 0.0f);
      sum.at<cv::Vec2f>(y, x) = turn;
    }
  return sum;
}

}  // namespace

CarryingField::CarryingField(std::shared_ptr<const MotionSequence> sequence, const cv::Mat& asked, int frames,
                             double fps, int step, bool loop, const CarryingOptions& options)
    : sequence_(std::move(sequence)), frames_(frames), step_(step), loop_(loop), fps_(fps) {
  const cv::Size size((asked.cols + step - 1) / step, (asked.rows + step - 1) / step);
  cv::resize(asked, mean_, size, 0, 0, cv::INTER_AREA);

  const std::size_t fit = kKeptBytes / (static_cast<std::size_t>(size.area()) * sizeof(cv::Vec2f));
  kept_.assign(std::clamp<std::size_t>(fit, kMinKept, std::max(kMinKept, static_cast<std::size_t>(frames))),
               {-1, cv::Mat()});

  // What is measured on an even selection of frames.
  const int measured = std::min(frames, kMeasured);
  std::vector<cv::Mat> fields(measured);
  oneapi::tbb::parallel_for(0, measured,
                            [&](int i) { fields[i] = sequence_->at(i * frames / measured, step_, size); });
  assigned_ = cv::Mat::zeros(size, CV_32FC2);
  for (const cv::Mat& field : fields) assigned_ += field;
  assigned_ /= measured;
  double uneven = 0;
  for (const cv::Mat& field : fields) {
    const double faster = faster_together(field, assigned_);
    uneven += faster * faster / measured;
  }
  cv::Mat together(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const cv::Vec2f mean = assigned_.at<cv::Vec2f>(y, x);
      together.at<float>(y, x) = static_cast<float>(uneven) * mean.dot(mean);
    }
  const cv::Mat mixed = variance_about(assigned_, fields);
  regained_ =
      lost_by_mixing(sequence_->own_variance(step_, size), mixed, together, step_, options.max_regain);
  const cv::Mat least = least_scales(mean_, step, options.least_scale);
  turn_ = turn_between(assigned_, mean_, step, least) * (options.variation / fps);
  mean_ /= fps;
  cv::Mat power(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      cv::Vec2f& turn = turn_.at<cv::Vec2f>(y, x);
      const float regained = regained_.at<float>(y, x), as_one = together.at<float>(y, x);
      power.at<float>(y, x) =
          turn.dot(turn) * (regained * regained * std::max(mixed.at<float>(y, x) - as_one, 0.0f) + as_one);
      turn *= regained;
    }
  activity_.create(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const cv::Vec2f mean = mean_.at<cv::Vec2f>(y, x);
      activity_.at<float>(y, x) = std::sqrt(mean.dot(mean) + power.at<float>(y, x));
    }
  cv::sqrt(power, limit_);
  limit_ *= options.max_deviation;
  if (options.max_of_asked > 0)
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const float usual =
            std::max(length(mean_.at<cv::Vec2f>(y, x)),
                     least.at<float>(y, x) * length(assigned_.at<cv::Vec2f>(y, x)) / static_cast<float>(fps));
        float& limit = limit_.at<float>(y, x);
        limit = std::min(limit, static_cast<float>(options.max_of_asked) * usual);
      }

  // Frames whose flow failed as a whole.
  std::vector<double> speed(frames);
  oneapi::tbb::parallel_for(0, frames, [&](int i) {
    speed[i] = mean_speed(sequence_->at(i, 4 * step_, {(size.width + 3) / 4, (size.height + 3) / 4}));
  });
  std::vector<double> sorted = speed;
  std::nth_element(sorted.begin(), sorted.begin() + frames / 2, sorted.end());
  const double most = options.max_jump * sorted[frames / 2];
  stands_for_.resize(frames);
  stands_after_.resize(frames);
  fraction_.assign(frames, 0);
  for (int i = 0; i < frames; ++i) stands_for_[i] = stands_after_[i] = i;
  for (int i = 0; i < frames; ++i) {
    if (speed[i] <= most) continue;
    int before = i - 1, after = i + 1;
    while (before >= 0 && speed[before] > most) --before;
    while (after < frames && speed[after] > most) ++after;
    if (before < 0 && after >= frames) break;
    stands_for_[i] = before < 0 ? after : before;
    stands_after_[i] = after >= frames ? before : after;
    if (before >= 0 && after < frames)
      fraction_[i] = static_cast<float>(i - before) / static_cast<float>(after - before);
  }
}

int CarryingField::inside(int i) const {
  if (loop_) return ((i % frames_) + frames_) % frames_;
  return std::clamp(i, 0, frames_ - 1);
}

cv::Mat CarryingField::at(int i) const {
  const int frame = inside(i);
  auto& place = kept_[static_cast<std::size_t>(frame) % kept_.size()];
  {
    const std::lock_guard lock(guard_);
    if (place.first == frame) return place.second;
  }
  cv::Mat field = made(frame);
  const std::lock_guard lock(guard_);
  place = {frame, field};
  return field;
}

cv::Mat CarryingField::made(int frame) const {
  cv::Mat field = sequence_->at(stands_for_[frame], step_, size());
  if (stands_after_[frame] != stands_for_[frame])
    cv::addWeighted(field, 1 - fraction_[frame], sequence_->at(stands_after_[frame], step_, size()),
                    fraction_[frame], 0, field);
  const auto together = static_cast<float>(faster_together(field, assigned_));
  for (int y = 0; y < field.rows; ++y)
    fluctuate(assigned_.ptr<float>(y), turn_.ptr<float>(y), regained_.ptr<float>(y), together,
              mean_.ptr<float>(y), limit_.ptr<float>(y), field.cols, field.ptr<float>(y));
  return field;
}

}  // namespace freshet::synth::animate
