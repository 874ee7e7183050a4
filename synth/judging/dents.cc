#include "synth/judging/dents.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::judging {
namespace {

constexpr int kBand = 6;             // px
constexpr double kStraight = 0.5;    // px, root mean square beside the line
constexpr double kContrast = 12;     // grey levels
constexpr std::size_t kFewest = 10;  // px of outline in a cell

/// A cell's part of a straight border.
struct Border {
  cv::Point cell;
  std::vector<cv::Point> inside;  // the band's pixels
  double limit = 0;               // grey levels: half way between both sides
  bool brighter = false;          // what lies beyond
  int length = 0;                 // px of outline
  int already = 0;                // of the band, what is so in the still
};

bool is_straight(const std::vector<cv::Point>& outline) {
  cv::Vec4f line;
  cv::fitLine(outline, line, cv::DIST_L2, 0, 0.01, 0.01);
  double squares = 0;
  for (const cv::Point& p : outline) {
    const double beside = line[0] * (p.y - line[3]) - line[1] * (p.x - line[2]);
    squares += beside * beside;
  }
  return std::sqrt(squares / static_cast<double>(outline.size())) <= kStraight;
}

int beyond_of(const Border& border, const cv::Mat& luma) {
  int count = 0;
  for (const cv::Point& p : border.inside)
    count += (luma.at<std::uint8_t>(p) > border.limit) == border.brighter;
  return count;
}

std::vector<Border> straight_borders(const Evidence& film) {
  const cv::Size size = film.size(), cells = cells_of(size);
  const cv::Mat& fluid = film.fluid();
  cv::Mat depth, height;  // distances to the border, from inside and from outside
  cv::distanceTransform(fluid, depth, cv::DIST_L2, 5);
  cv::distanceTransform(~fluid, height, cv::DIST_L2, 5);
  std::vector<Border> borders;
  for (int cy = 0; cy < cells.height; ++cy)
    for (int cx = 0; cx < cells.width; ++cx) {
      const cv::Point low(cx * size.width / cells.width, cy * size.height / cells.height);
      const cv::Point high((cx + 1) * size.width / cells.width, (cy + 1) * size.height / cells.height);
      std::vector<cv::Point> outline;
      // A picture's own edge is no border: distances are of what is inside the picture alone.
      for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; ++x)
          if (fluid.at<std::uint8_t>(y, x) != 0 && depth.at<float>(y, x) < 1.2F) outline.emplace_back(x, y);
      if (outline.size() < kFewest || !is_straight(outline)) continue;
      Border border{.cell = {cx, cy}, .inside = {}};
      border.length = static_cast<int>(outline.size());
      const cv::Rect around =
          cv::Rect(low - cv::Point(kBand, kBand), high + cv::Point(kBand, kBand)) & cv::Rect({0, 0}, size);
      double in = 0, out = 0;
      int outside = 0;
      for (int y = around.y; y < around.br().y; ++y)
        for (int x = around.x; x < around.br().x; ++x) {
          const double luma = film.still_luma().at<std::uint8_t>(y, x);
          const double from_in = depth.at<float>(y, x), from_out = height.at<float>(y, x);
          if (from_in > 1 && from_in <= kBand + 1) {  // not the mixed pixels of the border itself
            border.inside.emplace_back(x, y);
            in += luma;
          } else if (from_out > 1 && from_out <= kBand + 1) {
            out += luma;
            ++outside;
          }
        }
      if (border.inside.empty() || outside == 0) continue;
      in /= static_cast<double>(border.inside.size());
      out /= outside;
      if (std::abs(in - out) < kContrast) continue;
      border.limit = (in + out) / 2;
      border.brighter = out > in;
      border.already = beyond_of(border, film.still_luma());
      borders.push_back(std::move(border));
    }
  return borders;
}

}  // namespace

Reading dents(const Evidence& film) {
  const std::vector<Border> borders = straight_borders(film);
  if (borders.empty()) return {};
  const std::size_t frames = film.luma().size();
  cv::Mat deep(static_cast<int>(frames), static_cast<int>(borders.size()), CV_32F);  // px
  oneapi::tbb::parallel_for(std::size_t{0}, frames, [&](std::size_t i) {
    for (std::size_t b = 0; b < borders.size(); ++b) {
      const int more = std::max(0, beyond_of(borders[b], film.luma()[i]) - borders[b].already);
      deep.at<float>(static_cast<int>(i), static_cast<int>(b)) =
          static_cast<float>(more) * kBand / static_cast<float>(borders[b].inside.size());
    }
  });
  Reading reading{.value = cv::mean(deep)[0], .map = {}};
  for (int span = 0; span < kSpans; ++span) {
    cv::Mat map(cells_of(film.size()), CV_32F, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
    for (std::size_t b = 0; b < borders.size(); ++b) {
      double sum = 0;
      int count = 0;
      for (std::size_t i = 0; i < frames; ++i)
        if (span_of(static_cast<int>(i), film.count()) == span) {
          sum += deep.at<float>(static_cast<int>(i), static_cast<int>(b));
          ++count;
        }
      if (count > 0) map.at<float>(borders[b].cell) = static_cast<float>(sum / count);
    }
    reading.map.push_back(map);
  }
  return reading;
}

}  // namespace freshet::synth::judging
