#include "synth/scene/layers/exemplar_fill.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "freshet/error.h"
#include "tests/synth/scene/layers/made_layers.h"

namespace freshet::synth::scene {
namespace {

Hole hole_of(cv::Size size, const cv::Rect& part) {
  Hole hole{cv::Mat(size, CV_8U, cv::Scalar(255)), cv::Mat::zeros(size, CV_8U), {}};
  hole.known(part).setTo(0);
  hole.target(part).setTo(255);
  hole.source = hole.known.clone();
  return hole;
}

// The same, slowly and plainly: every priority anew before each patch, every candidate pixel by pixel.
cv::Mat slow_sources(const cv::Mat& picture, const Hole& hole, const FillOptions& options) {
  const int half = options.patch_px / 2;
  const cv::Rect whole({}, picture.size());
  cv::Mat lab, known = hole.known.clone(), confidence, source(picture.size(), CV_32SC2, cv::Scalar(-1, -1));
  cv::cvtColor(picture, lab, cv::COLOR_BGR2Lab);
  cv::Mat code;
  lab.convertTo(code, CV_16S, 2.55f);
  known.convertTo(confidence, CV_32F, 1 / 255.0);
  const auto is_known = [&](cv::Point p) { return p.inside(whole) && known.at<std::uint8_t>(p) == 255; };
  for (int y = 0; y < known.rows; ++y)
    for (int x = 0; x < known.cols; ++x)
      if (is_known({x, y})) source.at<cv::Point>(y, x) = {x, y};
  while (true) {
    cv::Point first(-1, -1);
    float highest = -1, its_confidence = 0;
    for (int y = 0; y < known.rows; ++y)
      for (int x = 0; x < known.cols; ++x) {
        const cv::Point p(x, y);
        if (is_known(p) || hole.target.at<std::uint8_t>(p) == 0) continue;
        if (!is_known(p + cv::Point(1, 0)) && !is_known(p - cv::Point(1, 0)) &&
            !is_known(p + cv::Point(0, 1)) && !is_known(p - cv::Point(0, 1)))
          continue;
        float sum = 0, steepest = 0;
        cv::Point2f isophote, normal;
        for (int v = -half; v <= half; ++v)
          for (int u = -half; u <= half; ++u) {
            const cv::Point q = p + cv::Point(u, v);
            if (!is_known(q)) continue;
            sum += confidence.at<float>(q);
            const cv::Point right(1, 0), down(0, 1);
            if (!is_known(q - right) || !is_known(q + right) || !is_known(q - down) || !is_known(q + down))
              continue;
            const auto light = [&](cv::Point at) { return lab.at<cv::Vec3f>(at)[0] * 0.01f; };
            const cv::Point2f g(0.5f * (light(q + right) - light(q - right)),
                                0.5f * (light(q + down) - light(q - down)));
            if (g.dot(g) > steepest) steepest = g.dot(g), isophote = {-g.y, g.x};
          }
        for (int v = -1; v <= 1; ++v)
          for (int u = -1; u <= 1; ++u)
            if (is_known(p + cv::Point(u, v)))
              normal += cv::Point2f(static_cast<float>(u), static_cast<float>(v)) *
                        (u == 0 || v == 0 ? 2.0f : 1.0f);
        sum /= static_cast<float>(options.patch_px * options.patch_px);
        const float length = std::sqrt(normal.dot(normal));
        const float priority = sum * ((length > 0 ? std::abs(isophote.dot(normal)) / length : 0) + 1e-3f);
        if (priority > highest) highest = priority, first = p, its_confidence = sum;
      }
    if (first.x < 0) return source;
    long least = std::numeric_limits<long>::max();
    cv::Point best;
    for (int y = first.y - options.search_px; y <= first.y + options.search_px; ++y)
      for (int x = first.x - options.search_px; x <= first.x + options.search_px; ++x) {
        long sum = 0;
        bool fits = true;
        for (int v = -half; v <= half && fits; ++v)
          for (int u = -half; u <= half && fits; ++u) {
            const cv::Point from(x + u, y + v), to = first + cv::Point(u, v);
            fits = from.inside(whole) && hole.source.at<std::uint8_t>(from) == 255;
            if (!fits || !is_known(to)) continue;
            for (int c = 0; c < 3; ++c) {
              const long d = code.at<cv::Vec3s>(from)[c] - code.at<cv::Vec3s>(to)[c];
              sum += d * d;
            }
          }
        if (fits && sum < least) least = sum, best = {x, y};
      }
    cv::Mat now = known.clone();
    for (int v = -half; v <= half; ++v)
      for (int u = -half; u <= half; ++u) {
        const cv::Point to = first + cv::Point(u, v), from = best + cv::Point(u, v);
        if (!to.inside(whole) || is_known(to) || hole.target.at<std::uint8_t>(to) == 0) continue;
        source.at<cv::Point>(to) = from;
        lab.at<cv::Vec3f>(to) = lab.at<cv::Vec3f>(from);
        code.at<cv::Vec3s>(to) = code.at<cv::Vec3s>(from);
        confidence.at<float>(to) = its_confidence;
        now.at<std::uint8_t>(to) = 255;
      }
    known = now;
  }
}

TEST(ExemplarFill, IsWhatTheSlowTwinFinds) {
  const cv::Size size(48, 40);
  for (const std::uint64_t seed : {1, 2, 3}) {
    const cv::Mat picture = made_texture(size, {0.5, 0.4, 0.3}, 0.4f, seed);
    const Hole hole = hole_of(size, seed == 2 ? cv::Rect(0, 12, 14, 15) : cv::Rect(17, 13, 14, 12));
    const FillOptions options{.patch_px = seed == 3 ? 5 : 9, .search_px = 24};
    const Filled filled = exemplar_fill(picture, hole, options);
    EXPECT_EQ(cv::norm(filled.source, slow_sources(picture, hole, options), cv::NORM_INF), 0) << seed;
  }
}

TEST(ExemplarFill, CopiesWhatItSays) {
  const cv::Size size(60, 50);
  const cv::Mat picture = made_texture(size, {0.5, 0.5, 0.5}, 0.4f, 7);
  const Hole hole = hole_of(size, {20, 15, 16, 16});
  const Filled filled = exemplar_fill(picture, hole);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const cv::Point from = filled.source.at<cv::Point>(y, x);
      ASSERT_EQ(hole.known.at<std::uint8_t>(from), 255);
      ASSERT_EQ(filled.picture.at<cv::Vec3f>(y, x), picture.at<cv::Vec3f>(from));
    }
  EXPECT_EQ(cv::countNonZero(filled.filled != hole.target), 0);
}

TEST(ExemplarFill, ContinuesAnEdgeThroughTheHole) {
  cv::Mat picture(60, 60, CV_32FC3, cv::Scalar(0.8, 0.8, 0.8));
  picture.rowRange(30, 60).setTo(cv::Scalar(0.2, 0.3, 0.1));
  cv::Mat spoiled = picture.clone();
  const cv::Rect part(20, 20, 20, 20);
  spoiled(part).setTo(cv::Scalar(0, 0, 1));
  EXPECT_EQ(cv::norm(exemplar_fill(spoiled, hole_of(picture.size(), part)).picture, picture, cv::NORM_INF),
            0);
}

TEST(ExemplarFill, ContinuesALatticeThatBlurredFillingsLose) {
  cv::Mat picture(64, 64, CV_32FC3);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      picture.at<cv::Vec3f>(y, x) =
          (x / 3 + y / 3) % 2 ? cv::Vec3f(0.9f, 0.8f, 0.7f) : cv::Vec3f(0.1f, 0.2f, 0.3f);
  cv::Mat spoiled = picture.clone();
  const cv::Rect part(22, 22, 18, 18);
  spoiled(part).setTo(cv::Scalar(0, 0, 1));
  EXPECT_EQ(cv::norm(exemplar_fill(spoiled, hole_of(picture.size(), part)).picture, picture, cv::NORM_INF),
            0);
}

TEST(ExemplarFill, LooksFurtherWhereNothingIsNear) {
  const cv::Size size(80, 40);
  const cv::Mat picture = made_texture(size, {0.5, 0.5, 0.5}, 0.3f, 4);
  Hole hole = hole_of(size, {4, 10, 12, 12});
  hole.source.colRange(0, 60).setTo(0);
  const Filled filled = exemplar_fill(picture, hole, {.patch_px = 9, .search_px = 8});
  EXPECT_EQ(cv::countNonZero(filled.filled != hole.target), 0);
  // And leaves what it cannot fill.
  hole.source.setTo(0);
  EXPECT_EQ(cv::countNonZero(exemplar_fill(picture, hole, {.patch_px = 9, .search_px = 8}).filled), 0);
}

TEST(ExemplarFill, IsTheSameForAnyNumberOfThreads) {
  const cv::Size size(70, 60);
  const cv::Mat picture = made_texture(size, {0.5, 0.4, 0.6}, 0.3f, 5);
  const Hole hole = hole_of(size, {20, 20, 25, 20});
  cv::Mat one;
  {
    const oneapi::tbb::global_control single(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    one = exemplar_fill(picture, hole).source;
  }
  const oneapi::tbb::global_control several(oneapi::tbb::global_control::max_allowed_parallelism, 6);
  EXPECT_EQ(cv::norm(one, exemplar_fill(picture, hole).source, cv::NORM_INF), 0);
}

TEST(ExemplarFill, RefusesPatchesWithoutAMiddle) {
  const cv::Size size(20, 20);
  EXPECT_THROW(exemplar_fill(made_texture(size, {}, 0.1f, 1), hole_of(size, {5, 5, 3, 3}), {.patch_px = 8}),
               Error);
}

}  // namespace
}  // namespace freshet::synth::scene
