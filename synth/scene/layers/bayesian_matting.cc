#include "synth/scene/layers/bayesian_matting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "synth/scene/layers/unmix.h"

namespace freshet::synth::scene {
namespace {

constexpr float kSure = 0.98f;  // of a given alpha from which on the picture's colour is the foreground's
constexpr std::size_t kMostSamples = 480;
constexpr float kLeastWeight = 1e-4f;

// A pixel's sides: how far each may be drawn from it.
enum Side : int { kFront = 0, kBehind = 1 };

/// The work on one picture. Pixels that are done are read, those of the contour in hand are written.
class Matter {
 public:
  Matter(const cv::Mat& picture, const MattingOptions& options)
      : picture_(picture), options_(options), falloff_(2 * options.max_window_px + 1) {
    for (std::size_t i = 0; i < falloff_.size(); ++i) {
      const double d = static_cast<double>(i) - options.max_window_px;
      falloff_[i] = static_cast<float>(std::exp(-d * d / (2 * options.falloff_px * options.falloff_px)));
    }
  }

  /// trimap as in bayesian_matting; alpha given, or empty.
  Matting solve(const cv::Mat& trimap, const cv::Mat& given);

 private:
  struct Scratch {
    std::vector<WeighedColour> samples;
    std::vector<ColourCluster> front, behind;
    std::vector<Unmixed> pairs;
  };
  void gather(cv::Point at, Side side, std::vector<WeighedColour>& samples) const;
  void clusters_of(cv::Point at, Side side, Scratch& scratch, std::vector<ColourCluster>& clusters) const;
  void solve_pixel(cv::Point at, Scratch& scratch);
  void smooth(const cv::Mat& trimap);
  std::vector<cv::Point> next_contour(const std::vector<cv::Point>& last);

  const cv::Mat& picture_;
  const MattingOptions& options_;
  std::vector<float> falloff_;
  Matting out_;
  cv::Mat given_;
  cv::Mat done_;        // CV_8U: 0 not yet, 1 in hand, 255 done
  cv::Mat nearest_[2];  // CV_32SC2: the nearest sure pixel of either side
  bool any_[2] = {};
  cv::Mat variance_;  // CV_32F: of alpha, by its posterior
};

// Of every pixel the nearest one where `sure` is set.
cv::Mat nearest_sure(const cv::Mat& sure) {
  cv::Mat distance, label;
  cv::distanceTransform(~sure, distance, label, cv::DIST_L2, 5, cv::DIST_LABEL_PIXEL);
  std::vector<cv::Point> place(static_cast<std::size_t>(cv::countNonZero(sure)) + 1);
  for (int y = 0; y < sure.rows; ++y)
    for (int x = 0; x < sure.cols; ++x)
      if (sure.at<std::uint8_t>(y, x)) place[static_cast<std::size_t>(label.at<int>(y, x))] = {x, y};
  cv::Mat nearest(sure.size(), CV_32SC2);
  for (int y = 0; y < sure.rows; ++y)
    for (int x = 0; x < sure.cols; ++x)
      nearest.at<cv::Point>(y, x) = place[static_cast<std::size_t>(label.at<int>(y, x))];
  return nearest;
}

// Colours of one side around a pixel, in a window that grows until it holds enough.
void Matter::gather(cv::Point at, Side side, std::vector<WeighedColour>& samples) const {
  samples.clear();
  const cv::Mat& colours = side == kFront ? out_.foreground : out_.background;
  const int most = options_.max_window_px;
  // Ring by ring: each pixel is looked at once.
  for (int r = 1; r <= most && samples.size() < kMostSamples; ++r) {
    if (samples.size() >= static_cast<std::size_t>(options_.min_samples) && r > 5) break;
    for (int y = std::max(0, at.y - r); y <= std::min(picture_.rows - 1, at.y + r); ++y) {
      const bool whole = std::abs(y - at.y) == r;
      const int step = whole ? 1 : 2 * r;
      for (int x = at.x - r; x <= at.x + r; x += step) {
        if (x < 0 || x >= picture_.cols || done_.at<std::uint8_t>(y, x) != 255) continue;
        const float a = out_.alpha.at<float>(y, x), share = side == kFront ? a : 1 - a;
        // Beyond the falloff's reach all count alike: what is found there is all that there is.
        const float g = std::max(falloff_[static_cast<std::size_t>(y - at.y + most)] *
                                     falloff_[static_cast<std::size_t>(x - at.x + most)],
                                 1e-3f);
        const float weight = share * share * g;
        if (weight > kLeastWeight && share > 0.05f) samples.push_back({colours.at<cv::Vec3f>(y, x), weight});
      }
    }
  }
}

void Matter::clusters_of(cv::Point at, Side side, Scratch& scratch,
                         std::vector<ColourCluster>& clusters) const {
  gather(at, side, scratch.samples);
  if (!scratch.samples.empty()) return cluster_colours(scratch.samples, options_.clusters, clusters);
  // Nothing of this side is near. The nearest that there is; or, where the picture has none, any colour.
  const bool any = any_[side];
  const cv::Vec3f mean =
      any ? picture_.at<cv::Vec3f>(nearest_[side].at<cv::Point>(at)) : picture_.at<cv::Vec3f>(at);
  const float variance = any ? 0.01f : 0.1f;
  clusters.assign(1, {.mean = mean, .covariance = cv::Matx33f::eye() * variance, .weight = 1});
}

// Of alpha, over all pairs: wide where both sides have colours that explain the pixel.
float posterior_variance(const std::vector<Unmixed>& pairs, float least) {
  float weight = 0, mean = 0, square = 0;
  for (const Unmixed& pair : pairs)
    for (std::size_t i = 0; i < kAlphaSamples; ++i) {
      const float excess = pair.sampled[i] - least;
      if (excess > 20) continue;
      const float w = std::exp(-0.5f * excess), a = static_cast<float>(i) / (kAlphaSamples - 1);
      weight += w, mean += w * a, square += w * a * a;
    }
  if (weight <= 0) return 0;  // a minimum narrower than the samples' distance
  mean /= weight;
  return std::max(0.0f, square / weight - mean * mean);
}

cv::Vec3f bounded(cv::Vec3f colour, float top) {
  for (int c = 0; c < 3; ++c) colour[c] = std::clamp(colour[c], 0.0f, top);
  return colour;
}

void Matter::solve_pixel(cv::Point at, Scratch& scratch) {
  clusters_of(at, kFront, scratch, scratch.front);
  clusters_of(at, kBehind, scratch, scratch.behind);
  const cv::Vec3f colour = picture_.at<cv::Vec3f>(at);
  const float noise = options_.camera_sigma * options_.camera_sigma;
  Unmixed best;
  const ColourCluster *front = nullptr, *behind = nullptr;
  scratch.pairs.clear();
  for (const ColourCluster& f : scratch.front)
    for (const ColourCluster& b : scratch.behind) {
      const Unmixed found =
          given_.empty() ? unmix(f, b, colour, noise) : unmix_at(f, b, colour, noise, given_.at<float>(at));
      if (front == nullptr || found.cost < best.cost) best = found, front = &f, behind = &b;
      scratch.pairs.push_back(found);
    }
  if (given_.empty()) variance_.at<float>(at) = posterior_variance(scratch.pairs, best.cost);
  const TwoColours two = colours_at(*front, *behind, colour, noise, best.alpha);
  const float top = std::max({1.0f, colour[0], colour[1], colour[2]});
  out_.alpha.at<float>(at) = best.alpha;
  out_.foreground.at<cv::Vec3f>(at) = bounded(two.front, top);
  out_.background.at<cv::Vec3f>(at) = bounded(two.behind, top);
}

// The pixels that touch what is done, each once: those beside the last contour.
std::vector<cv::Point> Matter::next_contour(const std::vector<cv::Point>& last) {
  std::vector<cv::Point> next;
  for (const cv::Point& at : last)
    for (int y = std::max(0, at.y - 1); y <= std::min(picture_.rows - 1, at.y + 1); ++y)
      for (int x = std::max(0, at.x - 1); x <= std::min(picture_.cols - 1, at.x + 1); ++x)
        if (std::uint8_t& state = done_.at<std::uint8_t>(y, x); state == 0) {
          state = 1;
          next.emplace_back(x, y);
        }
  return next;
}

// Alpha goes over to that of neighbours of like colour, the more the less certain it is: Jacobi's steps on
// sum (alpha - found)^2 / variance + smoothing * sum likeness (alpha - neighbour's)^2.
void Matter::smooth(const cv::Mat& trimap) {
  constexpr int kSteps = 40;
  constexpr float kLeastVariance = 0.002f;
  struct Site {
    cv::Point at;
    float certainty, found, sum;
    std::array<float, 8> likeness;
  };
  static const std::array<cv::Point, 8> kAround{cv::Point(-1, -1), {0, -1}, {1, -1}, {-1, 0}, {1, 0},
                                                {-1, 1},           {0, 1},  {1, 1}};
  std::vector<Site> sites;
  const cv::Rect whole({}, picture_.size());
  const float per = -1 / (2 * options_.like_sigma * options_.like_sigma);
  for (int y = 0; y < picture_.rows; ++y)
    for (int x = 0; x < picture_.cols; ++x) {
      if (trimap.at<std::uint8_t>(y, x) == 0 || trimap.at<std::uint8_t>(y, x) == 255) continue;
      Site site{{x, y}, 1 / (variance_.at<float>(y, x) + kLeastVariance), out_.alpha.at<float>(y, x), 0, {}};
      for (std::size_t i = 0; i < 8; ++i) {
        const cv::Point n = site.at + kAround[i];
        if (!n.inside(whole)) continue;
        const cv::Vec3f d = picture_.at<cv::Vec3f>(n) - picture_.at<cv::Vec3f>(site.at);
        site.likeness[i] = options_.smoothing * std::exp(per * d.dot(d));
        site.sum += site.likeness[i];
      }
      sites.push_back(site);
    }
  cv::Mat next = out_.alpha.clone();
  for (int step = 0; step < kSteps; ++step) {
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, sites.size(), 4096),
                              [&](const auto& range) {
                                for (std::size_t s = range.begin(); s < range.end(); ++s) {
                                  const Site& site = sites[s];
                                  float sum = site.certainty * site.found;
                                  for (std::size_t i = 0; i < 8; ++i)
                                    if (site.likeness[i] > 0)
                                      sum += site.likeness[i] * out_.alpha.at<float>(site.at + kAround[i]);
                                  next.at<float>(site.at) = sum / (site.certainty + site.sum);
                                }
                              });
    std::swap(next, out_.alpha);
  }
}

Matting Matter::solve(const cv::Mat& trimap, const cv::Mat& given) {
  given_ = given;
  const cv::Mat front = trimap == 255, behind = trimap == 0;
  done_ = front | behind;
  out_.alpha = cv::Mat(picture_.size(), CV_32F, cv::Scalar(0.5));
  out_.alpha.setTo(1, front);
  out_.alpha.setTo(0, behind);
  variance_ = cv::Mat::zeros(picture_.size(), CV_32F);
  out_.foreground = cv::Mat::zeros(picture_.size(), CV_32FC3);
  out_.background = cv::Mat::zeros(picture_.size(), CV_32FC3);
  picture_.copyTo(out_.foreground, front);
  picture_.copyTo(out_.background, behind);
  any_[kFront] = cv::countNonZero(front) > 0, any_[kBehind] = cv::countNonZero(behind) > 0;
  if (any_[kFront]) nearest_[kFront] = nearest_sure(front);
  if (any_[kBehind]) nearest_[kBehind] = nearest_sure(behind);

  // The first contour: all that is unsure beside what is sure; where nothing is sure, every pixel.
  std::vector<cv::Point> contour;
  cv::Mat beside;
  cv::dilate(done_, beside, cv::Mat::ones(3, 3, CV_8U));
  const bool sure = any_[kFront] || any_[kBehind];
  for (int y = 0; y < picture_.rows; ++y)
    for (int x = 0; x < picture_.cols; ++x)
      if (done_.at<std::uint8_t>(y, x) == 0 && (!sure || beside.at<std::uint8_t>(y, x)))
        contour.emplace_back(x, y);
  for (const cv::Point& at : contour) done_.at<std::uint8_t>(at) = 1;

  oneapi::tbb::enumerable_thread_specific<Scratch> scratches;
  while (!contour.empty()) {
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, contour.size(), 16),
                              [&](const auto& range) {
                                Scratch& scratch = scratches.local();
                                for (std::size_t i = range.begin(); i < range.end(); ++i)
                                  solve_pixel(contour[i], scratch);
                              });
    for (const cv::Point& at : contour) done_.at<std::uint8_t>(at) = 255;
    contour = next_contour(contour);
  }
  if (!given.empty())
    given.copyTo(out_.alpha);
  else if (options_.smoothing > 0)
    smooth(trimap);
  return std::move(out_);
}

}  // namespace

Matting bayesian_matting(const cv::Mat& picture, const cv::Mat& trimap, const MattingOptions& options) {
  return Matter(picture, options).solve(trimap, {});
}

Matting estimate_colours(const cv::Mat& picture, const cv::Mat& alpha, const MattingOptions& options) {
  cv::Mat trimap(alpha.size(), CV_8U, cv::Scalar(128));
  trimap.setTo(255, alpha >= kSure);
  trimap.setTo(0, alpha <= 0);
  return Matter(picture, options).solve(trimap, alpha);
}

}  // namespace freshet::synth::scene
