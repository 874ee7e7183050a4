#include "synth/scene/rendering/cyclic_texture.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "synth/sampling/pull_push.h"
#include "synth/scene/layers/exemplar_fill.h"

namespace freshet::synth::scene {
namespace {

constexpr int kReduced = 960;        // px, the longer side at which is searched
constexpr double kJoinShare = 0.04;  // of the picture's width
constexpr int kRim = 10;             // reduced px
constexpr float kSmallStep = 0.08f;  // sRGB code
constexpr float kWholly = 0.999f;    // of a reduced pixel's area, to be known
constexpr FillOptions kFill{.patch_px = 9, .search_px = 110};

/// The period with the gap in its middle: filling knows no ends that join.
struct Rolled {
  cv::Mat colour;  // CV_32FC3, 0 where it is not known
  cv::Mat known;   // CV_8U
  int split;       // the picture's column at which it begins
};

Rolled rolled(const cv::Mat& colour, const cv::Mat& known, int period) {
  const int width = colour.cols, split = width / 2, right = width - split;
  Rolled out{cv::Mat::zeros(colour.rows, period, CV_32FC3), cv::Mat::zeros(colour.rows, period, CV_8U),
             split};
  const auto place = [&](const cv::Mat& from, cv::Mat& to) {
    from.colRange(split, width).copyTo(to.colRange(0, right));
    from.colRange(0, split).copyTo(to.colRange(period - split, period));
  };
  place(known, out.known);
  cv::Mat whole(out.colour.size(), CV_32FC3, cv::Scalar::all(0));
  place(colour, whole);
  whole.copyTo(out.colour, out.known);
  return out;
}

cv::Mat unrolled(const cv::Mat& of, int split) {
  const int period = of.cols;
  cv::Mat out(of.size(), of.type());
  of.colRange(period - split, period).copyTo(out.colRange(0, split));
  of.colRange(0, period - split).copyTo(out.colRange(split, period));
  return out;
}

/// Where each reduced pixel's copy comes from, reduced px; (-1, -1): from nowhere.
cv::Mat reduced_sources(const Rolled& canvas, cv::Size reduced) {
  cv::Mat weight, colour, share;
  canvas.known.convertTo(weight, CV_32F, 1 / 255.0);
  cv::resize(weight, share, reduced, 0, 0, cv::INTER_AREA);
  cv::resize(canvas.colour, colour, reduced, 0, 0, cv::INTER_AREA);
  for (int y = 0; y < colour.rows; ++y)
    for (int x = 0; x < colour.cols; ++x)
      colour.at<cv::Vec3f>(y, x) *= 1 / std::max(share.at<float>(y, x), 1e-6f);
  const cv::Mat known = share > kWholly;
  // Rims are continued and not copied: a frame's last column, or a rim of what stood before the sky, would be copied
  // beside itself again and again.
  cv::Mat source;
  cv::erode(known, source, cv::Mat::ones(1, 2 * kRim + 1, CV_8U));
  if (cv::countNonZero(source) < cv::countNonZero(known) / 4) source = known;
  return exemplar_fill(colour, {.known = known, .target = ~known, .source = source}, kFill).source;
}

/// Copies at full size, mixed over one reduced pixel.
/// standing   CV_32F, 1 where something is known or was copied.
void copy_from(const cv::Mat& source, Rolled& canvas, cv::Mat& standing) {
  const float across = static_cast<float>(canvas.colour.cols) / static_cast<float>(source.cols),
              down = static_cast<float>(canvas.colour.rows) / static_cast<float>(source.rows);
  canvas.known.convertTo(standing, CV_32F, 1 / 255.0);
  const cv::Mat picture = canvas.colour.clone();
  const cv::Rect whole({}, picture.size()), reduced({}, source.size());
  const auto fill = [&](int x, int y) {
    const float sx = (static_cast<float>(x) + 0.5f) / across - 0.5f,
                sy = (static_cast<float>(y) + 0.5f) / down - 0.5f;
    const int left = static_cast<int>(std::floor(sx)), top = static_cast<int>(std::floor(sy));
    cv::Vec3f sum(0, 0, 0);
    float weights = 0;
    for (int i = 0; i < 4; ++i) {
      const cv::Point at(left + i % 2, top + i / 2);
      if (!at.inside(reduced)) continue;
      const cv::Point from = source.at<cv::Point>(at);
      if (from.x < 0) continue;
      const cv::Point place(x + cvRound(static_cast<float>(from.x - at.x) * across),
                            y + cvRound(static_cast<float>(from.y - at.y) * down));
      if (!place.inside(whole) || canvas.known.at<std::uint8_t>(place) == 0) continue;
      const float weight =
          (1 - std::abs(sx - static_cast<float>(at.x))) * (1 - std::abs(sy - static_cast<float>(at.y)));
      sum += picture.at<cv::Vec3f>(place) * weight;
      weights += weight;
    }
    if (!(weights > 0)) return;
    canvas.colour.at<cv::Vec3f>(y, x) = sum * (1 / weights);
    standing.at<float>(y, x) = 1;
  };
  using oneapi::tbb::blocked_range;
  oneapi::tbb::parallel_for(blocked_range<int>(0, picture.rows, 8), [&](const blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y)
      for (int x = 0; x < picture.cols; ++x)
        if (canvas.known.at<std::uint8_t>(y, x) == 0) fill(x, y);
  });
}

/// Copies are like what they join, and not the same: in a smooth sky a step would be seen. What is small of it fades
/// away from the join; what is great is a cloud's edge.
/// end, first   the picture's last column and the copies' first. step   to the next.
void fade_step(cv::Mat& texture, int end, int first, int step, int join) {
  for (int y = 0; y < texture.rows; ++y) {
    auto* row = texture.ptr<cv::Vec3f>(y);
    cv::Vec3f difference = row[end] - row[first];
    for (int c = 0; c < 3; ++c) difference[c] = std::clamp(difference[c], -kSmallStep, kSmallStep);
    for (int i = 0; i < join; ++i) {
      const float t = static_cast<float>(i) / static_cast<float>(join);
      row[first + step * i] += difference * (1 - t * t * (3 - 2 * t));
    }
  }
}

}  // namespace

cv::Mat cyclic_texture(const cv::Mat& colour, const cv::Mat& known, int period) {
  Rolled canvas = rolled(colour, known, period);
  const double scale = std::min(1.0, static_cast<double>(kReduced) / std::max(period, colour.rows));
  const cv::Size reduced(std::max(1, cvRound(scale * period)), std::max(1, cvRound(scale * colour.rows)));
  cv::Mat standing;
  copy_from(reduced_sources(canvas, reduced), canvas, standing);
  cv::Mat texture = unrolled(sampling::pull_push(canvas.colour, standing), canvas.split);
  const int width = colour.cols;
  const int join = std::clamp(cvRound(kJoinShare * width), 1, std::max(1, (period - width) / 2));
  fade_step(texture, width - 1, width, 1, join);
  fade_step(texture, 0, period - 1, -1, join);
  return texture;
}

}  // namespace freshet::synth::scene
