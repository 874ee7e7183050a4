#include "synth/animate/still/standing_layout.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "synth/animate/still/base_image.h"
#include "vision/dot.h"
#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

// All lengths are of a level's own samples: a band has a wavelength of some four of them.
constexpr double kDrawnOut = 24;   // over which a band is averaged along the flow
constexpr double kWavelength = 4;  //
constexpr double kNear = 1.5;      // sigma of a band's own magnitude
constexpr double kWide_px = 28;    // and of that around it, px of the picture
constexpr float kStandsOut = 1.5f,
                kOutright = 2.7f;    // times the magnitude around it: begins to stand, stands
constexpr float kMostOut = 3.5f;     // deviations: stronger texture is cut off
constexpr float kFaint = 4e-4f;      // luma: the magnitude of what is flat
constexpr double kLevel_px = 32;     // sigma, px of the picture: of what is coarser texture has nothing
constexpr int kLevelFrom = 3;        // bands that hold some of it where the fluid is narrow
constexpr double kLeastRest = 0.25;  // of the texture's own variance, where what stands leaves less
// Over which an edge goes on, around which it stands out, and the sigma it is found with.
constexpr double kEdgeLength_px = 32, kEdgeAround_px = 28, kEdgeBlur_px = 3;
constexpr float kEdgeFrom = 1.5f,
                kEdgeSure = 2.5f;  // times the usual gradient along the flow: begins to be one, is one

/// A Gaussian mean of what lies within the matte.
cv::Mat mean_within(const cv::Mat& values, const cv::Mat& within, double sigma) {
  cv::Mat sum, mass;
  cv::GaussianBlur(values.mul(within), sum, {}, sigma, sigma, cv::BORDER_REPLICATE);
  cv::GaussianBlur(within, mass, {}, sigma, sigma, cv::BORDER_REPLICATE);
  return sum / cv::max(mass, 1e-3);
}

cv::Mat magnitude_of(const cv::Mat& band, const cv::Mat& within, double sigma) {
  cv::Mat out;
  cv::sqrt(mean_within(band.mul(band), within, sigma), out);
  return out + kFaint;
}

/// 0 below `from`, 1 above `to`, straight between.
cv::Mat ramp(const cv::Mat& values, float from, float to) {
  return cv::min(cv::max((values - from) / (to - from), 0), 1);
}

double mean_square(const cv::Mat& band, const cv::Mat& within) {
  return vision::dot(band.mul(band), within) / std::max(cv::sum(within)[0], 1.0);
}

/// Edges that lie across the flow and stand out of what is usual around them: brinks, ledges, rims. Texture has steep
/// places too, but they do not go on across the flow.
cv::Mat edges_across(const cv::Mat& luma, const cv::Mat& matte, const LayoutMotion& motion) {
  const cv::Mat& direction = motion.direction;
  const double length = kEdgeLength_px / motion.step, blur = kEdgeBlur_px / motion.step;
  cv::Mat coarse, within, x, y, way[2], across;
  cv::resize(luma, coarse, direction.size(), 0, 0, cv::INTER_AREA);
  cv::resize(matte, within, direction.size(), 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(coarse, coarse, {}, blur, blur, cv::BORDER_REPLICATE);
  cv::Sobel(coarse, x, CV_32F, 1, 0);
  cv::Sobel(coarse, y, CV_32F, 0, 1);
  cv::split(direction, way);
  const cv::Mat steep = x.mul(way[0]) + y.mul(way[1]);
  cv::merge(std::vector<cv::Mat>{-way[1], way[0]}, across);
  const cv::Mat goes_on =
      base_image(steep, within, across * length, {.shutter_s = 1, .max_length_px = length, .gaussian_s = 0});
  const cv::Mat usual = mean_within(cv::abs(steep), within, kEdgeAround_px / motion.step) + kFaint;
  cv::Mat edges = ramp(cv::abs(goes_on) / usual, kEdgeFrom, kEdgeSure), out;
  cv::dilate(edges, out, cv::Mat());
  return out;
}

/// Of a band, what is drawn out along the flow, in the share of its variance that stands: all of it, and of the rest a
/// part, where more stands than is drawn out.
cv::Mat drawn_out(const cv::Mat& band, const cv::Mat& within, const cv::Mat& direction, double share) {
  const cv::Mat along = base_image(band, within, direction * kDrawnOut,
                                   {.shutter_s = 1, .max_length_px = kDrawnOut, .gaussian_s = 0});
  const double all = mean_square(band, within), drawn = mean_square(along, within);
  if (all <= 0) return cv::Mat::zeros(band.size(), CV_32F);
  if (share * all <= drawn) return along * std::sqrt(share * all / drawn);
  const double of_rest = (share * all - drawn) / std::max(all - drawn, 1e-12);
  return along + (band - along) * std::clamp(of_rest, 0.0, 1.0);
}

}  // namespace

StandingLayout::StandingLayout(const FluidPlanes& planes, const cv::Mat& matte, const LayoutMotion& motion,
                               std::span<const double> shares)
    : edges_(edges_across(planes.luma, matte, motion)) {
  const int levels = static_cast<int>(shares.size());
  vision::laplacian_pyramid(planes.luma, levels, stands_);
  std::vector<cv::Mat> goes(stands_.size());
  magnitude_.resize(static_cast<std::size_t>(levels));
  inside_.resize(magnitude_.size());
  oneapi::tbb::parallel_for(0, levels, [&](int level) {
    const auto at = static_cast<std::size_t>(level);
    const cv::Mat band = stands_[at];
    cv::Mat direction, edge, stays;
    cv::resize(matte, inside_[at], band.size(), 0, 0, cv::INTER_AREA);
    const cv::Mat within = inside_[at];
    cv::resize(motion.direction, direction, band.size(), 0, 0, cv::INTER_LINEAR);
    cv::resize(edges_, edge, band.size(), 0, 0, cv::INTER_LINEAR);
    // A band shows an edge half a wavelength to both sides.
    cv::dilate(edge, edge, cv::Mat::ones(5, 5, CV_8U));
    // Fluid that has not gone half a wavelength while a copy shows would only boil.
    cv::Mat gone = motion.travel / (kWavelength / 2 * (1 << level));
    gone = cv::min(gone.mul(gone), 1);
    cv::resize(1 - gone, stays, band.size(), 0, 0, cv::INTER_LINEAR);

    cv::Mat still = drawn_out(band, within, direction, shares[at]);
    cv::Mat rest = band - still;
    const double wide = std::max(kWide_px / (1 << level), 2 * kNear);
    const cv::Mat out = magnitude_of(rest, within, kNear) / magnitude_of(rest, within, wide);
    const cv::Mat stands = cv::max(cv::max(ramp(out, kStandsOut, kOutright), edge), stays);
    const cv::Mat standing = stands.mul(rest);
    still += standing;
    rest -= standing;
    // Both together have the band's own variance, wherever copies meet what stands.
    const cv::Mat local = magnitude_of(rest, within, 2 * kNear);
    cv::Mat missing = mean_within(band.mul(band) - still.mul(still), within, 2 * kNear), all;
    cv::sqrt(cv::max(missing, kLeastRest * local.mul(local)), all);
    goes[at] = cv::max(cv::min(rest / local, kMostOut), -kMostOut);
    const double mean = std::sqrt(mean_square(all, within));
    goes[at] *= mean / std::max(std::sqrt(mean_square(goes[at], within)), 1e-6);
    stands_[at] = still;
    magnitude_[at] = all / std::max(mean, static_cast<double>(kFaint));
  });
  goes.back() = cv::Mat::zeros(stands_.back().size(), CV_32F);
  std::vector<double> wanted(magnitude_.size());
  for (std::size_t level = 0; level < wanted.size(); ++level)
    wanted[level] = mean_square(goes[level], inside_[level]);
  texture_ = vision::collapse(std::move(goes));
  // A sum of bands falls into bands that are not quite those.
  std::vector<cv::Mat> found;
  vision::laplacian_pyramid(texture_, levels, found);
  for (std::size_t level = 0; level < wanted.size(); ++level)
    magnitude_[level] *=
        std::sqrt(wanted[level] / std::max(mean_square(found[level], inside_[level]), 1e-12));
}

void StandingLayout::lay(cv::Mat& texture, int level) const {
  const auto at = static_cast<std::size_t>(level);
  if (level >= kLevelFrom) texture -= mean_within(texture, inside_[at], kLevel_px / (1 << level));
  texture += stands_[at];
}

}  // namespace freshet::synth::animate
