#include "synth/outline/dynamic_matte.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "freshet/error.h"
#include "synth/sampling/bilinear.h"

namespace freshet::synth::outline {
namespace {

constexpr double kNominalFps = 25;       // the rate that tau is given for
constexpr float kEdge = 1e-4f;           // below it and above 1 - it a pixel is empty or full
constexpr double kAreaTolerance = 2e-4;  // of the area
constexpr double kMaxSharpening = 3;     // more draws bright outlines around what is faint

/// Pixels of a matte that are neither empty nor full, as odds b / (1 - b) to a power; and the area of the
/// full ones.
struct Edge {
  std::vector<float*> pixel;
  std::vector<double> odds;
  double full = 0;
};

Edge edge_of(cv::Mat& matte) {
  Edge edge;
  for (int y = 0; y < matte.rows; ++y) {
    auto* b = matte.ptr<float>(y);
    for (int x = 0; x < matte.cols; ++x) {
      if (b[x] >= 1 - kEdge)
        edge.full += b[x];
      else if (b[x] > kEdge) {
        edge.pixel.push_back(b + x);
        edge.odds.push_back(b[x] / (1.0 - b[x]));
      }
    }
  }
  return edge;
}

/// sum of k o / (1 + k o): the area of the edge when all odds are multiplied by k.
double area_of(std::span<const double> odds, double k) {
  double sum = 0;
  for (const double o : odds) sum += k * o / (1 + k * o);
  return sum;
}

double softness_of(std::span<const double> odds, double k) {
  double sum = 0;
  for (const double o : odds) {
    const double b = k * o / (1 + k * o);
    sum += b * (1 - b);
  }
  return sum;
}

/// The factor on all odds that gives the edge the wanted area; the limit of the search when none does.
double factor_for(std::span<const double> odds, double wanted, double tolerance) {
  if (std::abs(area_of(odds, 1) - wanted) <= tolerance) return 1;
  double low = -60, high = 60;  // logit
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2, area = area_of(odds, std::exp(middle));
    if (std::abs(area - wanted) <= tolerance) return std::exp(middle);
    (area < wanted ? low : high) = middle;
  }
  return std::exp((low + high) / 2);
}

void apply(const Edge& edge, std::span<const double> odds, double factor) {
  for (std::size_t i = 0; i < odds.size(); ++i) {
    const double o = factor * odds[i];
    *edge.pixel[i] = std::isinf(o) ? 1.0f : static_cast<float>(o / (1 + o));
  }
}

void keep_area(cv::Mat& matte, double area) {
  const Edge edge = edge_of(matte);
  const double factor = factor_for(edge.odds, area - edge.full, kAreaTolerance * area);
  if (factor != 1) apply(edge, edge.odds, factor);
}

/// Sharpens the edges of a matte to the wanted softness, at the same area.
void sharpen(cv::Mat& matte, double area, double softness) {
  const Edge edge = edge_of(matte);
  if (softness_of(edge.odds, 1) <= softness) return;
  double low = 1, high = kMaxSharpening, factor = 1;
  std::vector<double> odds = edge.odds;
  for (int i = 0; i < 10; ++i) {
    const double power = std::sqrt(low * high);
    for (std::size_t j = 0; j < odds.size(); ++j) odds[j] = std::pow(edge.odds[j], power);
    factor = factor_for(odds, area - edge.full, kAreaTolerance * area);
    (softness_of(odds, factor) > softness ? low : high) = power;
  }
  apply(edge, odds, factor);
}

/// How much of the way upstream of each pixel lies in fluid, 0..1, over the way that a matte with this tau
/// trails behind. Where it is little, fluid enters.
cv::Mat upstream(const cv::Mat& alpha, const cv::Mat& motion, double trail_s) {
  constexpr int kSteps = 16;
  cv::Mat out(alpha.size(), CV_32F);
  oneapi::tbb::parallel_for(0, alpha.rows, [&](int y) {
    auto* to = out.ptr<float>(y);
    for (int x = 0; x < alpha.cols; ++x) {
      float px = static_cast<float>(x), py = static_cast<float>(y), sum = 0;
      for (int i = 0; i < kSteps; ++i) {
        // Clamped before they are rounded: a long trail leads further than an int reaches.
        const auto row = static_cast<int>(std::clamp(py + 0.5f, 0.0f, static_cast<float>(alpha.rows - 1)));
        const auto column = static_cast<int>(std::clamp(px + 0.5f, 0.0f, static_cast<float>(alpha.cols - 1)));
        const cv::Vec2f v = motion.at<cv::Vec2f>(row, column);
        px -= static_cast<float>(trail_s / kSteps) * v[0];
        py -= static_cast<float>(trail_s / kSteps) * v[1];
        sum += sampling::bilinear<float>(alpha, px, py);
      }
      to[x] = sum / kSteps;
    }
  });
  return out;
}

}  // namespace

DynamicMatte::DynamicMatte(const cv::Mat& alpha, const cv::Mat& mean_motion, double fps,
                           const DynamicMatteOptions& options)
    : fps_(fps), keep_softness_(options.keep_softness) {
  if (!(options.tau >= 0 && options.tau <= 1))
    throw Error(ErrorKind::kUsage, "tau " + std::to_string(options.tau), "0 to 1 expected");
  if (!(fps > 0)) throw Error(ErrorKind::kUsage, "fps " + std::to_string(fps), "more than 0 expected");
  alpha_ = alpha.clone();
  state_ = alpha.clone();
  shown_ = alpha.clone();
  moved_.create(alpha.size(), CV_32F);
  area_ = cv::sum(alpha)[0];
  softness_ = area_ - alpha.dot(alpha);

  const double tau = std::pow(options.tau, kNominalFps / fps);
  keep_ = cv::Mat(alpha.size(), CV_32F, cv::Scalar(tau));
  if (options.held_foot && tau > 0 && tau < 1) {
    // A matte trails by tau / (1 - tau) frames on average; fluid near where it enters by less.
    const double trail = tau / (1 - tau);
    const cv::Mat fluid = upstream(alpha, mean_motion, trail / fps);
    for (int y = 0; y < alpha.rows; ++y)
      for (int x = 0; x < alpha.cols; ++x) {
        // Only fluid is held: empty places may always be entered. The square holds it for as long as it would
        // take to come from the foot, and lets it go soon after.
        const double fraction = fluid.at<float>(y, x), a = alpha.at<float>(y, x);
        const double own = trail * (1 - a * (1 - fraction * fraction));
        keep_.at<float>(y, x) = static_cast<float>(own / (1 + own));
      }
  }
}

void DynamicMatte::step(const cv::Mat& motion) {
  const auto dt = static_cast<float>(1 / fps_);
  oneapi::tbb::parallel_for(0, alpha_.rows, [&](int y) {
    const auto* v = motion.ptr<cv::Vec2f>(y);
    const auto* alpha = alpha_.ptr<float>(y);
    const auto* keep = keep_.ptr<float>(y);
    auto* to = moved_.ptr<float>(y);
    for (int x = 0; x < alpha_.cols; ++x) {
      if (keep[x] <= 0) {
        to[x] = alpha[x];
        continue;
      }
      // What arrives here was upstream a frame ago. Beyond the picture its edge goes on.
      const float b = sampling::bilinear<float>(state_, static_cast<float>(x) - dt * v[x][0],
                                                static_cast<float>(y) - dt * v[x][1]);
      to[x] = std::clamp(keep[x] * b + (1 - keep[x]) * alpha[x], 0.0f, 1.0f);
    }
  });
  cv::swap(state_, moved_);
  state_.copyTo(shown_);
  keep_area(shown_, area_);
  if (keep_softness_) sharpen(shown_, area_, softness_);
}

}  // namespace freshet::synth::outline
