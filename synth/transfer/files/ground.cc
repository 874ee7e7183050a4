#include "synth/transfer/files/ground.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::transfer {
namespace {

constexpr int kMax = 65535;
constexpr float kGlowEnds = 0.03f;  // brightness: black of footage is not quite 0
constexpr double kGap = 0.02;       // of the height: half of what is closed between filaments

cv::Mat brightest(const cv::Mat& bgra) {
  cv::Mat out(bgra.size(), CV_16U);
  for (int y = 0; y < bgra.rows; ++y) {
    const auto* from = bgra.ptr<cv::Vec4w>(y);
    auto* to = out.ptr<std::uint16_t>(y);
    for (int x = 0; x < bgra.cols; ++x) to[x] = std::max({from[x][0], from[x][1], from[x][2]});
  }
  return out;
}

cv::Mat body_of(const cv::Mat& light, float body_begins) {
  const int gap = std::max(1, static_cast<int>(std::lround(kGap * light.rows)));
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * gap + 1, 2 * gap + 1});
  cv::Mat body;
  cv::morphologyEx(light, body, cv::MORPH_CLOSE, disc);
  for (int y = 0; y < body.rows; ++y) {
    auto* row = body.ptr<std::uint16_t>(y);
    for (int x = 0; x < body.cols; ++x) {
      const float at =
          std::clamp((static_cast<float>(row[x]) / kMax - kGlowEnds) / (body_begins - kGlowEnds), 0.0f, 1.0f);
      row[x] = static_cast<std::uint16_t>(std::lround(at * at * (3 - 2 * at) * kMax));
    }
  }
  return body;
}

/// What is seen of a picture with an alpha of its own, on the ground. Opaque.
void lay_on_ground(cv::Mat& bgra, bool black) {
  const std::int64_t ground = black ? 0 : kMax;
  for (int y = 0; y < bgra.rows; ++y) {
    auto* to = bgra.ptr<cv::Vec4w>(y);
    for (int x = 0; x < bgra.cols; ++x) {
      const std::int64_t alpha = to[x][3];
      for (int c = 0; c < 3; ++c)
        to[x][c] = static_cast<std::uint16_t>((alpha * to[x][c] + (kMax - alpha) * ground + kMax / 2) / kMax);
      to[x][3] = kMax;
    }
  }
}

void divide(cv::Vec4w& at, int alpha, bool black) {
  for (int c = 0; c < 3; ++c) {
    const int light = black ? at[c] : kMax - at[c];
    const auto full = alpha > 0 ? static_cast<int>((std::int64_t{light} * kMax + alpha / 2) / alpha) : 0;
    at[c] = static_cast<std::uint16_t>(black ? full : kMax - full);
  }
  at[3] = static_cast<std::uint16_t>(alpha);
}

}  // namespace

void take_off_ground(cv::Mat& bgra, Ground ground, const cv::Mat& mask, double body_begins) {
  if (ground == Ground::kNone) return;
  const bool black = ground == Ground::kBlack;
  lay_on_ground(bgra, black);
  if (!black) cv::bitwise_not(bgra, bgra);
  const cv::Mat light = brightest(bgra);
  cv::Mat alpha = light;
  if (!mask.empty())
    cv::max(light, mask, alpha);
  else if (black)
    cv::max(light, body_of(light, static_cast<float>(body_begins)), alpha);
  if (!black) cv::bitwise_not(bgra, bgra);
  for (int y = 0; y < bgra.rows; ++y) {
    auto* to = bgra.ptr<cv::Vec4w>(y);
    for (int x = 0; x < bgra.cols; ++x) divide(to[x], alpha.at<std::uint16_t>(y, x), black);
  }
}

cv::Mat light_alone(const cv::Mat& bgra) {
  cv::Mat out(bgra.size(), CV_32FC4);
  for (int y = 0; y < bgra.rows; ++y) {
    const auto* from = bgra.ptr<cv::Vec4f>(y);
    auto* to = out.ptr<cv::Vec4f>(y);
    for (int x = 0; x < bgra.cols; ++x) {
      const float most = std::max({from[x][0], from[x][1], from[x][2]});
      for (int c = 0; c < 3; ++c) to[x][c] = most > 0 ? from[x][c] / most : 0.0f;
      to[x][3] = most * from[x][3];
    }
  }
  return out;
}

}  // namespace freshet::synth::transfer
