#include "vision/textureness.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"

namespace freshet::vision {
namespace {

constexpr int kStripRows = 64;  // fixed, so that threads change nothing
constexpr int kMultiple = 4;    // a frame's sides must halve twice

// Sizes of the four sums: how many times each is halved.
constexpr std::array<int, kTextureLevels> kHalvings{0, 1, 1, 2};

// Strips of a filter read beyond themselves in the parent picture: the result is that of one call.
void blur(const cv::Mat& picture, double variance, cv::Mat& blurred) {
  blurred.create(picture.size(), CV_32F);
  const double sigma = std::sqrt(variance);
  const int side = 2 * static_cast<int>(std::ceil(3.5 * sigma)) + 1;
  oneapi::tbb::parallel_for(0, (picture.rows + kStripRows - 1) / kStripRows, [&](int strip) {
    const cv::Range rows(strip * kStripRows, std::min(picture.rows, (strip + 1) * kStripRows));
    cv::Mat out = blurred.rowRange(rows);
    cv::GaussianBlur(picture.rowRange(rows), out, {side, side}, sigma, sigma, cv::BORDER_REFLECT);
  });
}

void halve(const cv::Mat& picture, cv::Mat& half) {
  cv::resize(picture, half, {picture.cols / 2, picture.rows / 2}, 0, 0, cv::INTER_AREA);
}

void add_difference(const cv::Mat& a, const cv::Mat& b, cv::Mat& sum) {
  oneapi::tbb::parallel_for(0, (sum.rows + kStripRows - 1) / kStripRows, [&](int strip) {
    for (int y = strip * kStripRows; y < std::min(sum.rows, (strip + 1) * kStripRows); ++y) {
      const float *pa = a.ptr<float>(y), *pb = b.ptr<float>(y);
      float* to = sum.ptr<float>(y);
      for (int x = 0; x < sum.cols; ++x) to[x] += std::abs(pa[x] - pb[x]);
    }
  });
}

}  // namespace

struct TexturenessAccumulator::Impl {
  cv::Size source, scaled;
  float cell_of_source;                                 // px
  int cell;                                             // px of the scaled frame
  std::array<cv::Mat, kTextureLevels> sums;             // |difference of Gaussians|
  cv::Mat reduced, extended, frame, halved, quartered;  // one frame's
  cv::Mat g1, g2_full, g2, g4, g8, g8_quarter,
      g16;  // its Gaussians, named by sigma in px of the scaled frame
  int frames = 0;
};

TexturenessAccumulator::TexturenessAccumulator(cv::Size source, float scale, int cell)
    : impl_(std::make_unique<Impl>()) {
  if (source.width < 1 || source.height < 1 || !(scale > 0 && scale <= 16) || cell < 1) {
    throw Error(ErrorKind::kUsage, "textureness",
                "a frame, a scale in 0..16 and cells of at least 1 px expected");
  }
  Impl& s = *impl_;
  s.source = source;
  s.scaled = {std::max(1, cvRound(source.width * static_cast<double>(scale))),
              std::max(1, cvRound(source.height * static_cast<double>(scale)))};
  s.cell = cell;
  s.cell_of_source = static_cast<float>(cell) / scale;
  const cv::Size size((s.scaled.width + kMultiple - 1) / kMultiple * kMultiple,
                      (s.scaled.height + kMultiple - 1) / kMultiple * kMultiple);
  for (int level = 0; level < kTextureLevels; ++level) {
    s.sums[level] = cv::Mat::zeros(size.height >> kHalvings[level], size.width >> kHalvings[level], CV_32F);
  }
}

TexturenessAccumulator::~TexturenessAccumulator() = default;

void TexturenessAccumulator::add(const cv::Mat& luma) {
  Impl& s = *impl_;
  if (luma.type() != CV_8UC1 || luma.size() != s.source) {
    throw Error(ErrorKind::kUsage, "textureness",
                "an 8-bit plane of " + std::to_string(s.source.width) + " x " +
                    std::to_string(s.source.height) + " px expected");
  }
  const cv::Mat* scaled = &luma;
  if (s.scaled != s.source) {
    cv::resize(luma, s.reduced, s.scaled, 0, 0,
               s.scaled.width < s.source.width ? cv::INTER_AREA : cv::INTER_LINEAR);
    scaled = &s.reduced;
  }
  const cv::Size whole = s.sums[0].size();
  cv::copyMakeBorder(*scaled, s.extended, 0, whole.height - scaled->rows, 0, whole.width - scaled->cols,
                     cv::BORDER_REFLECT);
  s.extended.convertTo(s.frame, CV_32F, 1.0 / 255);

  // Variances add up, and are written in px^2 of the picture at hand. A mean of 2 x 2 pixels adds 1/4 px^2
  // and then makes the pixel's area four.
  blur(s.frame, 1, s.g1);
  blur(s.g1, 4 - 1, s.g2_full);
  add_difference(s.g1, s.g2_full, s.sums[0]);

  halve(s.g1, s.halved);  // sigma^2 = (1 + 1/4) / 4
  blur(s.halved, 1 - 1.25 / 4, s.g2);
  blur(s.g2, 4 - 1, s.g4);
  blur(s.g4, 16 - 4, s.g8);
  add_difference(s.g2, s.g4, s.sums[1]);
  add_difference(s.g4, s.g8, s.sums[2]);

  halve(s.g4, s.quartered);  // sigma^2 = (4 + 1/4) / 4
  blur(s.quartered, 4 - 4.25 / 4, s.g8_quarter);
  blur(s.g8_quarter, 16 - 4, s.g16);
  add_difference(s.g8_quarter, s.g16, s.sums[3]);
  ++s.frames;
}

CellMap TexturenessAccumulator::finish() {
  const Impl& s = *impl_;
  if (s.frames == 0)
    throw Error(ErrorKind::kInput, "textureness", "no frames to measure", "Use a longer clip");
  CellMap cells;
  cells.cell = s.cell_of_source;
  cells.rows = (s.scaled.height + s.cell - 1) / s.cell;
  cells.columns = (s.scaled.width + s.cell - 1) / s.cell;
  cells.channels = kTextureLevels;
  cells.values.resize(static_cast<std::size_t>(cells.rows) * cells.columns * kTextureLevels);
  cv::Mat full, integral;
  for (int level = 0; level < kTextureLevels; ++level) {
    cv::resize(s.sums[level], full, s.sums[0].size(), 0, 0, cv::INTER_NEAREST);
    cv::integral(full, integral, CV_64F);
    for (int row = 0; row < cells.rows; ++row) {
      const int top = row * s.cell, bottom = std::min(s.scaled.height, top + s.cell);
      for (int column = 0; column < cells.columns; ++column) {
        const int left = column * s.cell, right = std::min(s.scaled.width, left + s.cell);
        const double sum = integral.at<double>(bottom, right) - integral.at<double>(top, right) -
                           integral.at<double>(bottom, left) + integral.at<double>(top, left);
        const double fraction = 1.0 / (static_cast<double>(bottom - top) * (right - left) * s.frames);
        cells.values[(static_cast<std::size_t>(row) * cells.columns + column) * kTextureLevels + level] =
            static_cast<float>(std::max(0.0, sum * fraction));
      }
    }
  }
  return cells;
}

}  // namespace freshet::vision
