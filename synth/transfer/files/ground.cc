#include "synth/transfer/files/ground.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

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

/// Each sample becomes the greatest on a disc around it, as by cv::dilate; O(pixels x rows of the disc), where OpenCV's
/// cost grows with the disc's area.
cv::Mat dilated(const cv::Mat& from, const cv::Mat& disc) {
  const int radius = disc.rows / 2, padded = from.cols + 2 * radius;
  std::vector<int> half_width;  // of each row of the disc
  for (int i = 0; i < disc.rows; ++i) half_width.push_back(cv::countNonZero(disc.row(i)) / 2);
  // level k   the greatest of 2^k samples from each one on.
  std::vector<std::vector<std::uint16_t>> levels;
  for (int width = 1; width <= disc.cols; width *= 2) levels.emplace_back(static_cast<std::size_t>(padded));
  cv::Mat to(from.size(), CV_16U, cv::Scalar(0));
  for (int y = 0; y < from.rows; ++y) {
    std::copy_n(from.ptr<std::uint16_t>(y), from.cols, levels[0].begin() + radius);
    for (std::size_t k = 1; k < levels.size(); ++k) {
      const int half = 1 << (k - 1);
      const std::uint16_t* const narrow = levels[k - 1].data();
      for (int x = 0; x + 2 * half <= padded; ++x) levels[k][x] = std::max(narrow[x], narrow[x + half]);
    }
    for (int i = 0; i < disc.rows; ++i) {
      const int row = y + i - radius, width = 2 * half_width[i] + 1;
      if (row < 0 || row >= to.rows) continue;
      const std::size_t k = static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(width))) - 1;
      const std::uint16_t* const left = levels[k].data() + radius - half_width[i];
      const std::uint16_t* const right = left + width - (1 << k);
      std::uint16_t* const at = to.ptr<std::uint16_t>(row);
      for (int x = 0; x < to.cols; ++x) at[x] = std::max({at[x], left[x], right[x]});
    }
  }
  return to;
}

cv::Mat body_of(const cv::Mat& light, float body_begins) {
  // A disc that is wider than the picture closes no other gaps.
  const int gap =
      std::clamp(static_cast<int>(std::lround(kGap * light.rows)), 1, std::max(1, light.cols / 2));
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * gap + 1, 2 * gap + 1});
  cv::Mat body = kMax - dilated(kMax - dilated(light, disc), disc);
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
