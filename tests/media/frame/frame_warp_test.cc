#include "media/frame/frame_warp.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "tests/harness/fault.h"

namespace freshet::media {
namespace {

int sample(const Plane& plane, int x, int y) {
  const std::byte* at = plane.data + y * plane.stride + x * plane.bytes_per_sample;
  if (plane.bytes_per_sample == 1) return static_cast<int>(*at);
  std::uint16_t wide = 0;
  std::memcpy(&wide, at, 2);
  return wide;
}

/// Each sample of each plane by its place: noise, or a slope along x that is smooth from sample to sample.
Frame made(const std::string& format, bool slope) {
  PixelLayout layout;
  layout.format = format;
  layout.width = 64;
  layout.height = 48;
  Frame frame = make_frame(layout);
  for (const Plane& plane : frame.planes)
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) {
        const int most = plane.bytes_per_sample == 1 ? 255 : 1023;
        const auto value =
            static_cast<std::uint16_t>(slope ? 2 * x + y : (x * 7919 + y * 104729) % (most + 1));
        std::memcpy(plane.data + y * plane.stride + x * plane.bytes_per_sample, &value,
                    static_cast<std::size_t>(plane.bytes_per_sample));
      }
  return frame;
}

TEST(FrameWarp, WholePixelsAreACut) {
  // Interleaved chroma (nv12) has two components at each place.
  for (const auto& [format, interleaved] :
       {std::pair{"yuv420p", 1}, {"yuv420p10le", 1}, {"nv12", 2}, {"yuv444p", 1}, {"gray", 1}}) {
    const Frame frame = made(format, false);
    const Frame moved = warped(frame, {1, 0, 8, 0, 1, 6}, {40, 32});
    EXPECT_EQ(moved.layout.width, 40) << format;
    EXPECT_EQ(moved.layout.format, format);
    ASSERT_EQ(moved.planes.size(), frame.planes.size());
    for (std::size_t p = 0; p < moved.planes.size(); ++p) {
      const Plane &from = frame.planes[p], &to = moved.planes[p];
      const int halved = 64 / (p > 0 ? from.width / interleaved : from.width),
                right = 8 / halved * (p > 0 ? interleaved : 1), down = 6 / halved;
      int wrong = 0;
      for (int y = 0; y < to.height; ++y)
        for (int x = 0; x < to.width; ++x) wrong += sample(to, x, y) != sample(from, x + right, y + down);
      EXPECT_EQ(wrong, 0) << format << " plane " << p;
    }
  }
}

TEST(FrameWarp, PlanesMoveByTheSamePixels) {
  // One pixel to the right is half a sample of chroma: on a slope of 2 a sample, 2 in luma and 1 in chroma.
  for (const char* format : {"yuv420p", "yuv420p10le"}) {
    const Frame frame = made(format, true), moved = warped(frame, {1, 0, 1, 0, 1, 0}, {64, 48});
    EXPECT_EQ(sample(moved.planes[0], 30, 20), sample(frame.planes[0], 30, 20) + 2) << format;
    EXPECT_EQ(sample(moved.planes[1], 15, 10), sample(frame.planes[1], 15, 10) + 1) << format;
  }
  // Down, chroma lies centred between two rows: half a sample for one pixel, too.
  const Frame frame = made("yuv420p", true), moved = warped(frame, {1, 0, 0, 0, 1, 2}, {64, 48});
  EXPECT_EQ(sample(moved.planes[2], 15, 10), sample(frame.planes[2], 15, 11));
}

TEST(FrameWarp, LobesStayWithinTheBits) {
  Frame frame = made("yuv420p10le", false);
  const Plane& luma = frame.planes[0];
  for (int y = 0; y < luma.height; ++y)
    for (int x = 0; x < luma.width; ++x) {
      const std::uint16_t value = x < 32 ? 0 : 1023;
      std::memcpy(luma.data + y * luma.stride + 2 * x, &value, 2);
    }
  const Frame moved = warped(frame, {1, 0, 0.4, 0, 1, 0}, {64, 48});
  for (int x = 0; x < 64; ++x) EXPECT_LE(sample(moved.planes[0], x, 20), 1023) << x;
}

TEST(FrameWarp, RefusesUnevenPacking) {
  const std::string what = fault_of(ErrorKind::kInput, [] {
    warped(made("yuyv422", false), {1, 0, 0, 0, 1, 0}, {32, 32});
  });
  EXPECT_NE(what.find("yuyv422"), std::string::npos) << what;
}

}  // namespace
}  // namespace freshet::media
