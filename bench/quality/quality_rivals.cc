#include "bench/quality/quality_rivals.h"

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::bench {
namespace {

/// Where each pixel's own place is, CV_32FC2.
cv::Mat identity(cv::Size size) {
  cv::Mat places(size, CV_32FC2);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      places.at<cv::Vec2f>(y, x) = {static_cast<float>(x), static_cast<float>(y)};
  return places;
}

/// Sources of a copy one frame further on: `map` read where each place's fluid comes from.
cv::Mat composed(const cv::Mat& map, const cv::Mat& from) {
  cv::Mat sources;
  cv::remap(map, sources, from, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  // Beyond the picture's edge the map goes on as it is: what comes from outside stays outside.
  for (int y = 0; y < sources.rows; ++y) {
    cv::Vec2f* row = sources.ptr<cv::Vec2f>(y);
    const cv::Vec2f* at = from.ptr<cv::Vec2f>(y);
    for (int x = 0; x < sources.cols; ++x)
      for (int c = 0; c < 2; ++c) {
        const auto limit = static_cast<float>((c == 0 ? map.cols : map.rows) - 1);
        if (at[x][c] < 0) row[x][c] += at[x][c];
        if (at[x][c] > limit) row[x][c] += at[x][c] - limit;
      }
  }
  return sources;
}

/// Of a copy with these sources: what counts, 0 or 1.
cv::Mat inside(const cv::Mat& sources) {
  cv::Mat counts(sources.size(), CV_32F);
  const auto right = static_cast<float>(sources.cols - 1), bottom = static_cast<float>(sources.rows - 1);
  for (int y = 0; y < sources.rows; ++y)
    for (int x = 0; x < sources.cols; ++x) {
      const cv::Vec2f at = sources.at<cv::Vec2f>(y, x);
      counts.at<float>(y, x) = at[0] >= 0 && at[1] >= 0 && at[0] <= right && at[1] <= bottom ? 1.0f : 0.0f;
    }
  return counts;
}

}  // namespace

std::vector<cv::Mat> carry_still(const cv::Mat& still, const cv::Mat& matte, std::span<const cv::Mat> flow,
                                 int frames) {
  CV_Assert(frames >= 1 && (flow.size() == 1 || flow.size() + 1 >= static_cast<std::size_t>(frames)));
  const cv::Mat own = identity(still.size());
  cv::Mat fluid, fluid2, picture;
  matte.convertTo(fluid, CV_32F, 1.0 / 255);
  cv::merge(std::vector<cv::Mat>{fluid, fluid}, fluid2);
  still.convertTo(picture, CV_32FC3);
  const auto step = [&](int pair) {
    cv::Mat full;
    cv::resize(flow[flow.size() == 1 ? 0 : pair], full, still.size(), 0, 0, cv::INTER_LINEAR);
    return cv::Mat(full.mul(fluid2));
  };

  // Maps follow each other; what they bring is then fetched frame by frame.
  std::vector<cv::Mat> gone(frames), coming(frames);
  oneapi::tbb::parallel_for(0, 2, [&](int copy) {
    std::vector<cv::Mat>& maps = copy == 0 ? gone : coming;
    maps[copy == 0 ? 0 : frames - 1] = own;
    if (copy == 0)
      for (int i = 1; i < frames; ++i) maps[i] = composed(maps[i - 1], own - step(i - 1));
    else
      for (int i = frames - 1; i-- > 0;) maps[i] = composed(maps[i + 1], own + step(i));
  });
  std::vector<cv::Mat> made(frames);
  oneapi::tbb::parallel_for(0, frames, [&](int i) {
    const float fade = frames > 1 ? static_cast<float>(i) / static_cast<float>(frames - 1) : 0;
    cv::Mat first, second;
    cv::remap(picture, first, gone[i], cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REFLECT_101);
    cv::remap(picture, second, coming[i], cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REFLECT_101);
    const cv::Mat first_counts = inside(gone[i]), second_counts = inside(coming[i]);
    made[i] = still.clone();
    for (int y = 0; y < still.rows; ++y) {
      for (int x = 0; x < still.cols; ++x) {
        if (matte.at<std::uint8_t>(y, x) == 0) continue;
        float a = (1 - fade) * first_counts.at<float>(y, x), b = fade * second_counts.at<float>(y, x);
        if (a + b == 0) a = 1 - fade, b = fade;
        const cv::Vec3f brought = (a * first.at<cv::Vec3f>(y, x) + b * second.at<cv::Vec3f>(y, x)) / (a + b);
        const float alpha = fluid.at<float>(y, x);
        const cv::Vec3f shown = (1 - alpha) * picture.at<cv::Vec3f>(y, x) + alpha * brought;
        for (int c = 0; c < 3; ++c)
          made[i].at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<std::uint8_t>(shown[c]);
      }
    }
  });
  return made;
}

}  // namespace freshet::bench
