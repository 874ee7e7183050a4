#include "synth/animate/still/glitter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "platform/smoothstep.h"
#include "platform/vectors.h"
#include "synth/animate/still/colour_model.h"
#include "synth/sampling/widened_rows.h"
#include "vision/dot.h"

namespace freshet::synth::animate {
namespace {

constexpr double kMeant_px = 640;                  // of the longer side: what lengths are meant for
constexpr double kDetail_px = 4, kFacet_px = 0.6;  // sigmas: of detail, and before gradients
constexpr double kLeastSigma = 4;  // samples: so wide a blur is left once what is blurred wider is reduced
constexpr double kAround_px = 10;  // sigma of what a place shows
constexpr double kSparkle_px = 17, kLargest_px = 33;  // of sparkles, and of sparkles that run together
constexpr double kUsualOver_px = 14;                  // sigma of their usual strength
constexpr double kRim_px = 6;  // sigma, over which it begins: a glint by itself lay in a disc, as of glass
constexpr double kMuchFrom = 0.1, kMuchSure = 0.15;  // of all light above the ground
constexpr double kRipples = 1;                       // times the mean light above the ground beside sparkles
constexpr float kDark = 0.02f;                       // luma: a ground counts as no darker
constexpr float kCarriedPart = 0.25f;                // a carried plane holds -2..2
constexpr float kStrongest = 7;                      // times the usual, less 1
constexpr float kLeastUsual = 2e-3f;                 // luma
constexpr float kLeastAgreement = 0.5f;              // of the sum of squares of weights

/// From where on a place seems to glitter, and surely does.
struct Steps {
  float from, sure;
};
/// What says so: the deviation of detail, luma; of all gradients, those up and down; light over that of the ground.
struct Signs {
  Steps strong, level, bright;
};
// Whether anything glitters is told by places that surely do. Where it does, the fainter ones beside them are counted.
constexpr Signs kSure{{0.13f, 0.18f}, {0.66f, 0.78f}, {0.7f, 1.2f}};
constexpr Signs kBeside{{0.05f, 0.09f}, {0.55f, 0.65f}, {0.3f, 0.6f}};

/// At the resolution at which what comes out is smooth.
cv::Mat blurred(const cv::Mat& of, double sigma) {
  int factor = 1;
  while (sigma / (2 * factor) >= kLeastSigma) factor *= 2;
  cv::Mat reduced = of, smooth, out;
  if (factor > 1)
    cv::resize(of, reduced, {(of.cols + factor - 1) / factor, (of.rows + factor - 1) / factor}, 0, 0,
               cv::INTER_AREA);
  // The reduction and the way back blur as well: variances of a box and a tent.
  const double left = std::sqrt(sigma * sigma - (factor * factor - 1) / 4.0) / factor;
  cv::GaussianBlur(reduced, smooth, {}, left, left, cv::BORDER_REPLICATE);
  if (factor == 1) return smooth;
  cv::resize(smooth, out, of.size(), 0, 0, cv::INTER_LINEAR);
  return out;
}

/// Means of what lies within the matte around each place.
struct Surroundings {
  Surroundings(const cv::Mat& within, double sigma_px)
      : matte(within), sigma(sigma_px), mass(cv::max(blurred(within, sigma_px), 1e-3)) {}
  cv::Mat mean(const cv::Mat& of) const { return blurred(of.mul(matte), sigma) / mass; }

  const cv::Mat& matte;
  double sigma;
  cv::Mat mass;
};

/// What a still shows of light on water, place by place.
class Light {
 public:
  Light(const cv::Mat& luma, const cv::Mat& matte, double unit) : matte_(matte) {
    const Surroundings around(matte, kAround_px * unit);
    const cv::Mat detail = luma - blurred(luma, kDetail_px * unit), facets = blurred(luma, kFacet_px * unit);
    cv::sqrt(cv::max(around.mean(detail.mul(detail)), 0), deviation_);
    cv::Mat across, down;
    cv::Sobel(facets, across, CV_32F, 1, 0);
    cv::Sobel(facets, down, CV_32F, 0, 1);
    across = around.mean(across.mul(across));
    down = around.mean(down.mul(down));
    level_ = down / (across + down + 1e-9);
    const cv::Mat ground = ground_of(luma, kSparkle_px * unit);
    light_ = luma - ground;
    bright_ = around.mean(light_) / cv::max(around.mean(ground), kDark);
  }

  /// What lies below all that is brighter than its surroundings and smaller than `largest`, px.
  static cv::Mat ground_of(const cv::Mat& luma, double largest) {
    const int side = static_cast<int>(largest) | 1;
    cv::Mat opened;
    cv::morphologyEx(luma, opened, cv::MORPH_OPEN, cv::Mat::ones(side, side, CV_8U));
    return cv::min(luma, blurred(opened, side / 4.0));
  }

  /// How far each place shows the signs, 0..1.
  cv::Mat shows(const Signs& signs) const {
    cv::Mat out = matte_.clone();
    const auto count = [&out](const cv::Mat& values, const Steps& steps) {
      for (int y = 0; y < out.rows; ++y)
        for (int x = 0; x < out.cols; ++x)
          out.at<float>(y, x) *= smoothstep(steps.from, steps.sure, values.at<float>(y, x));
    };
    count(deviation_, signs.strong);
    count(level_, signs.level);
    count(bright_, signs.bright);
    return out;
  }
  /// Of all light above the ground, how much is there, 0..1.
  double share(const cv::Mat& where) const {
    return vision::dot(where, light_) / std::max(vision::dot(matte_, light_), 1e-6);
  }

 private:
  const cv::Mat& matte_;
  cv::Mat deviation_, level_, bright_, light_;
};

/// Of this radius, px.
cv::Mat disc(double radius) {
  const int side = 2 * static_cast<int>(std::lround(radius)) + 1;
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side});
}

/// The lightest within a disc of so many units. Reduced to px of a unit, or it would cost the fourth power of the
/// picture's side.
cv::Mat dilated(const cv::Mat& of, double radius, double unit) {
  cv::Mat out = of;
  const int block = std::max(1, static_cast<int>(std::lround(unit)));
  if (block > 1) {
    cv::dilate(of, out, cv::Mat::ones(block, block, CV_8U), {0, 0});  // of each block
    cv::resize(out, out, {}, 1.0 / block, 1.0 / block, cv::INTER_NEAREST);
  }
  cv::dilate(out, out, disc(radius * unit / block));
  if (block > 1) cv::resize(out, out, of.size(), 0, 0, cv::INTER_LINEAR);
  return out;
}

cv::Mat brightest_around(const cv::Mat& luma, double reach) {
  const int side = static_cast<int>(reach) | 1;
  cv::Mat out;
  cv::dilate(luma, out, cv::Mat::ones(side, side, CV_8U));
  return blurred(out, side / 4.0);
}

cv::Mat halved(const cv::Mat& of, cv::Size half) {
  cv::Mat out;
  cv::resize(of, out, half, 0, 0, cv::INTER_AREA);
  return out;
}

/// light: what a row of texture is of it, as far as the ground leaves room below the brightest; luma has it added.
FRESHET_WIDE void add_light(sampling::WidenedRows::Row gains, const float* texture, const float* usual,
                            const float* brightest, int n, float* luma, float* light) {
#pragma GCC ivdep
  for (int x = 0; x < n; ++x) {
    const float room = brightest[x] - luma[x], most = room > 0 ? room : 0.0f;
    const float wanted = usual[x] * (1 + gains.at(x) * texture[x]);
    const float lit = wanted > 0 ? wanted : 0.0f;
    light[x] = lit < most ? lit : most;
    luma[x] += light[x];
  }
}

}  // namespace

Glitter::Glitter(const cv::Mat& picture, const cv::Mat& luma, const cv::Mat& matte, double share) {
  const double unit = std::max(picture.cols, picture.rows) / kMeant_px;
  const Light seen(luma, matte, unit);
  const double glitters = share * smoothstep(kMuchFrom, kMuchSure, seen.share(seen.shows(kSure)));
  if (glitters <= 0) return;

  where_ = dilated(seen.shows(kBeside), 2 * kRim_px, unit);
  where_ = blurred(where_, kRim_px * unit).mul(matte, glitters);
  // Channel by channel: a white sparkle lies on green water. The ground keeps ripples as they are beside the sparkles.
  const cv::Mat beside = matte.mul(1 - where_);
  const double largest = kLargest_px * unit;
  std::vector<cv::Mat> bgr;
  cv::split(picture, bgr);
  std::vector<cv::Mat> lights;
  for (cv::Mat& channel : bgr) {
    const cv::Mat above = channel - Light::ground_of(channel, largest);
    const double ripples = kRipples * vision::dot(above, beside) / std::max(cv::sum(beside)[0], 1.0);
    lights.push_back(cv::max(above - ripples, 0).mul(where_));
    channel -= lights.back();
  }
  cv::merge(bgr, ground_);
  ground_luma_ = luma_of(ground_);
  const cv::Mat light = luma - ground_luma_;
  brightest_ = cv::max(luma, brightest_around(luma, largest));
  const Surroundings around(matte, kUsualOver_px * unit);
  usual_ = around.mean(light);
  texture_ = kCarriedPart * (cv::min(light / (usual_ + kLeastUsual), kStrongest + 1) - 1);

  // Of a plane of structure r, neighbours differ by twice its variance over r squared.
  const cv::Mat apart = light.colRange(1, light.cols) - light.colRange(0, light.cols - 1);
  const cv::Mat varies = (light - usual_).mul(where_);
  size_px_ = std::sqrt(2 * vision::dot(varies, varies) / std::max(vision::dot(apart, apart), 1e-9));

  const cv::Size half((luma.cols + 1) / 2, (luma.rows + 1) / 2);
  for (std::size_t k = 0; k < colour_.size(); ++k)
    colour_[k] = halved(around.mean(lights[2 * k] - light) / (usual_ + kLeastUsual), half);
}

void Glitter::add(const cv::Mat& texture, std::span<const CopyMap> copies, int step, cv::Mat& luma,
                  CarriedFrame* frame) const {
  cv::Mat agreement = cv::Mat::zeros(copies.front().weight.size(), CV_32F), gain;
  for (const CopyMap& copy : copies) agreement += copy.weight.mul(copy.weight);
  cv::sqrt(cv::max(agreement, kLeastAgreement), gain);
  gain = 1 / (kCarriedPart * gain);
  sampling::WidenedRows gains(gain, {gain.cols * step, gain.rows * step});
  cv::Mat light(luma.size(), CV_32F);
  for (int y = 0; y < luma.rows; ++y)
    add_light(gains.at(y), texture.ptr<float>(y), usual_.ptr<float>(y), brightest_.ptr<float>(y), luma.cols,
              luma.ptr<float>(y), light.ptr<float>(y));
  if (frame == nullptr) return;
  // The light brings its own colour, which the fluid's curve is not to give it again.
  cv::Mat brought = light * CarriedFrame::kOne;
  cv::add(frame->luma, brought, frame->luma, cv::noArray(), CV_16S);
  brought = halved(brought, frame->blue.size());
  cv::add(frame->blue, brought.mul(colour_[0]), frame->blue, cv::noArray(), CV_16S);
  cv::add(frame->red, brought.mul(colour_[1]), frame->red, cv::noArray(), CV_16S);
}

}  // namespace freshet::synth::animate
