// tests/synth/animate/forms/burnt_film.h — the burning picture animated with a clip, and what every way of it promises.
#pragma once

#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "synth/animate/animate.h"
#include "tests/synth/animate/forms/burning.h"

namespace freshet::synth::animate {

inline const BurningPicture kPicture;

/// The clip's patches all over the picture.
inline Placement placed(store::ClipId clip) {
  Placement placement{.side = 48, .stride = 24, .patches = {}};
  for (int y = 0; y + 48 <= 160; y += 24)
    for (int x = 0; x + 48 <= 192; x += 24)
      placement.patches.push_back(
          {.piece = {x, y}, .clip = clip, .variant = {}, .patch = {x % 96, y % 60}, .speed = 1});
  return placement;
}

struct Made {
  std::vector<cv::Mat> frames;
  AnimateReport report;
};

inline Made made_with(const FlowingStore& store, const AnimateOptions& options, const cv::Mat& matte) {
  Made made;
  made.report = animate(store.snapshot(), store.settings(), kPicture.draw(), matte, placed(store.id()),
                        options, [&](const cv::Mat& frame) { made.frames.push_back(frame.clone()); });
  return made;
}

inline double apart(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF); }

/// Frames from 7 to `until`, made alone by one thread, are those of the whole film.
inline void expect_same_for_any_threads_and_range(const FlowingStore& store, AnimateOptions options,
                                                  int until, const cv::Mat& matte) {
  const Made whole = made_with(store, options, matte);
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  options.from = 7;
  options.until = until;
  const Made part = made_with(store, options, matte);
  ASSERT_EQ(part.frames.size(), static_cast<std::size_t>(until - 7));
  for (std::size_t i = 0; i < part.frames.size(); ++i)
    EXPECT_EQ(apart(part.frames[i], whole.frames[7 + i]), 0) << i;
}

}  // namespace freshet::synth::animate
