#include "media/frame/frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/filmed_ground.h"
#include "media/frame/frame_md5.h"
#include "tests/harness/fault.h"

namespace freshet::media {
namespace {

PixelLayout layout_of(const char* format, int width, int height) {
  PixelLayout layout;
  layout.format = format;
  layout.width = width;
  layout.height = height;
  return layout;
}

void fill(const Plane& plane, int value) {
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) {
      std::byte* sample = plane.data + y * plane.stride + x * plane.bytes_per_sample;
      if (plane.bytes_per_sample == 1) {
        *sample = static_cast<std::byte>(value);
      } else {
        const auto wide = static_cast<std::uint16_t>(value);
        std::memcpy(sample, &wide, 2);
      }
    }
}

Frame flat(const PixelLayout& layout, const std::vector<int>& values) {
  Frame frame = make_frame(layout);
  for (std::size_t i = 0; i < values.size(); ++i) fill(frame.planes[i], values[i]);
  return frame;
}

struct Codes {
  int y, u, v;
};

// The textbook: Y' = Kr R + Kg G + Kb B, chroma from B - Y' and R - Y', scaled to the range.
Codes encode(double r, double g, double b, double kr, double kb, bool full) {
  const double y = kr * r + (1 - kr - kb) * g + kb * b;
  const double u = (b - y) / (2 * (1 - kb)), v = (r - y) / (2 * (1 - kr));
  const double y_scale = full ? 255 : 219, c_scale = full ? 255 : 224, offset = full ? 0 : 16;
  const auto code = [](double value) { return std::min(255, static_cast<int>(std::lround(value))); };
  return {code(offset + y_scale * y), code(128 + c_scale * u), code(128 + c_scale * v)};
}

TEST(Frame, ShapesOddSizesAsFfmpegDoes) {
  const auto check = [](const char* format, std::vector<std::array<int, 3>> truth) {
    const std::vector<Plane> planes = plane_shapes(layout_of(format, 33, 17));
    ASSERT_EQ(planes.size(), truth.size()) << format;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      EXPECT_EQ(planes[i].width, truth[i][0]) << format << i;
      EXPECT_EQ(planes[i].height, truth[i][1]) << format << i;
      EXPECT_EQ(planes[i].bytes_per_sample, truth[i][2]) << format << i;
      EXPECT_EQ(planes[i].stride, truth[i][0] * truth[i][2]) << format << i;
    }
  };
  check("gray", {{33, 17, 1}});
  check("gray10le", {{33, 17, 2}});
  check("yuv420p", {{33, 17, 1}, {17, 9, 1}, {17, 9, 1}});
  check("yuv422p10le", {{33, 17, 2}, {17, 17, 2}, {17, 17, 2}});
  check("yuva420p", {{33, 17, 1}, {17, 9, 1}, {17, 9, 1}, {33, 17, 1}});
  check("nv12", {{33, 17, 1}, {34, 9, 1}});
  check("gbrp12le", {{33, 17, 2}, {33, 17, 2}, {33, 17, 2}});
  check("rgb24", {{99, 17, 1}});
  check("rgb48le", {{99, 17, 2}});
}

TEST(Frame, RefusesLayoutsWithoutPlainPlanes) {
  for (const char* format : {"pal8", "monow", "vaapi", "yuv420p10be", "no_such_format"})
    EXPECT_THROW(plane_shapes(layout_of(format, 8, 8)), Error) << format;
  EXPECT_THROW(plane_shapes(layout_of("gray", 0, 8)), Error);
  EXPECT_THROW(plane_shapes(layout_of("gray", 1 << 20, 1 << 20)), Error);
}

TEST(Frame, LumaExpandsTheRangeExactly) {
  PixelLayout layout = layout_of("yuv420p", 16, 16);
  for (const int range : {0, 1, 2}) {
    layout.range = range;
    for (int code = 0; code < 256; ++code) {
      const double luma = std::clamp(range == 2 ? code / 255.0 : (code - 16) / 219.0, 0.0, 1.0);
      const Frame frame = flat(layout, {code, 128, 128});
      EXPECT_EQ(to_luma(frame).at<std::uint8_t>(7, 9), std::lround(255 * luma));
      const cv::Mat samples(16, 16, CV_8U, frame.planes[0].data,
                            static_cast<std::size_t>(frame.planes[0].stride));
      EXPECT_NEAR(luma_from_plane(layout, samples).at<float>(3, 3), luma, 1e-6);
    }
  }
}

TEST(Frame, DeepLumaMatchesShallowLuma) {
  for (const auto& [format, shift] :
       {std::pair{"yuv420p10le", 2}, {"yuv444p12le", 4}, {"yuv420p16le", 8}, {"p010le", 8}}) {
    const PixelLayout deep = layout_of(format, 16, 16);
    ASSERT_TRUE(luma_in_plane_0(deep));
    for (const int code : {0, 16, 17, 100, 234, 235, 255}) {
      const Frame frame = flat(deep, {code << shift});
      EXPECT_EQ(to_luma(frame).at<std::uint8_t>(1, 1),
                to_luma(flat(layout_of("yuv420p", 16, 16), {code, 128, 128})).at<std::uint8_t>(1, 1))
          << format << " " << code;
      const cv::Mat samples(16, 16, CV_16U, frame.planes[0].data,
                            static_cast<std::size_t>(frame.planes[0].stride));
      EXPECT_NEAR(luma_from_plane(deep, samples).at<float>(2, 2), std::clamp((code - 16) / 219.0, 0.0, 1.0),
                  1e-6);
    }
  }
}

TEST(Frame, GreyIsFullRangeUnlessTagged) {
  PixelLayout layout = layout_of("gray", 16, 16);
  EXPECT_EQ(to_luma(flat(layout, {77})).at<std::uint8_t>(0, 0), 77);
  EXPECT_EQ(to_bgr(flat(layout, {77})).at<cv::Vec3b>(0, 0), cv::Vec3b(77, 77, 77));
  layout.range = 1;
  EXPECT_EQ(to_luma(flat(layout, {235})).at<std::uint8_t>(0, 0), 255);
}

TEST(Frame, KnowsWherePlane0IsLuminance) {
  for (const char* format : {"yuv420p", "yuva444p10le", "nv12", "gray", "gray16le"})
    EXPECT_TRUE(luma_in_plane_0(layout_of(format, 8, 8))) << format;
  for (const char* format : {"rgb24", "gbrp", "bgra", "yuyv422", "ya8", "xyz12le"})
    EXPECT_FALSE(luma_in_plane_0(layout_of(format, 8, 8))) << format;
}

TEST(Frame, BgrHonoursMatrixAndRange) {
  struct Standard {
    int matrix, height;
    double kr, kb;
  };
  // Untagged: BT.601 below 720 rows, BT.709 from there on.
  for (const Standard& s :
       {Standard{1, 64, 0.2126, 0.0722}, Standard{6, 64, 0.299, 0.114}, Standard{9, 64, 0.2627, 0.0593},
        Standard{2, 64, 0.299, 0.114}, Standard{2, 720, 0.2126, 0.0722}}) {
    for (const bool full : {false, true}) {
      PixelLayout layout = layout_of("yuv420p", 64, s.height);
      layout.matrix = s.matrix;
      layout.range = full ? 2 : 1;
      for (const cv::Vec3b& bgr :
           {cv::Vec3b(0, 0, 255), cv::Vec3b(0, 255, 0), cv::Vec3b(255, 0, 0), cv::Vec3b(128, 128, 128),
            cv::Vec3b(255, 255, 255), cv::Vec3b(30, 90, 200)}) {
        const Codes codes = encode(bgr[2] / 255.0, bgr[1] / 255.0, bgr[0] / 255.0, s.kr, s.kb, full);
        const cv::Mat shown = to_bgr(flat(layout, {codes.y, codes.u, codes.v}));
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(shown.at<cv::Vec3b>(31, 31)[c], bgr[c], 2) << s.matrix << " " << full << " " << bgr;
      }
    }
  }
}

TEST(Frame, BgrOfRgbLayoutsIsExact) {
  Frame planar = make_frame(layout_of("gbrp", 19, 7)), packed = make_frame(layout_of("rgb24", 19, 7)),
        deep = make_frame(layout_of("rgb48le", 19, 7));
  cv::Mat truth(7, 19, CV_8UC3);
  cv::randu(truth, 0, 256);
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 19; ++x)
      for (int c = 0; c < 3; ++c) {
        const std::uint8_t value = truth.at<cv::Vec3b>(y, x)[c];
        constexpr int kPlane[] = {1, 0, 2};  // of B, G, R
        planar.planes[static_cast<std::size_t>(kPlane[c])].data[y * planar.planes[0].stride + x] =
            std::byte{value};
        packed.planes[0].data[y * packed.planes[0].stride + 3 * x + 2 - c] = std::byte{value};
        const auto wide = static_cast<std::uint16_t>(value * 257);
        std::memcpy(deep.planes[0].data + y * deep.planes[0].stride + 2 * (3 * x + 2 - c), &wide, 2);
      }
  EXPECT_EQ(cv::norm(to_bgr(planar), truth, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(to_bgr(packed), truth, cv::NORM_INF), 0);
  EXPECT_LE(cv::norm(to_bgr(deep), truth, cv::NORM_INF), 1);
  cv::Mat grey;
  cv::cvtColor(truth, grey, cv::COLOR_BGR2GRAY);  // BT.601
  EXPECT_LE(cv::norm(to_luma(packed), grey, cv::NORM_INF), 1);
}

TEST(Frame, ConversionIsTheSameOnEveryThread) {
  Frame frame = make_frame(layout_of("yuv420p", 130, 66));
  std::uint32_t state = 1;
  for (const Plane& plane : frame.planes)
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x)
        plane.data[y * plane.stride + x] =
            static_cast<std::byte>((state = state * 1664525u + 1013904223u) >> 24);
  const cv::Mat truth = to_bgr(frame);
  std::vector<cv::Mat> results(8);
  std::vector<std::thread> threads;
  for (cv::Mat& result : results) threads.emplace_back([&] { result = to_bgr(frame); });
  for (std::thread& thread : threads) thread.join();
  for (const cv::Mat& result : results) EXPECT_EQ(cv::norm(result, truth, cv::NORM_INF), 0);
}

TEST(FrameMd5, IgnoresThePaddingOfRows) {
  Frame frame = make_frame(layout_of("gray", 3, 2));
  std::memset(frame.planes[0].data, 0xEE, static_cast<std::size_t>(frame.planes[0].stride) * 2);
  const char rows[2][4] = {"abc", "def"};
  for (int y = 0; y < 2; ++y) std::memcpy(frame.planes[0].data + y * frame.planes[0].stride, rows[y], 3);
  EXPECT_EQ(frame_md5(frame), "e80b5017098950fc58aad83c8c14978e");  // printf abcdef | md5sum
}

TEST(FilmedGround, IsFoundByItsNameAndByNoOther) {
  for (const Ground ground : {Ground::kNone, Ground::kBlack, Ground::kWhite})
    EXPECT_EQ(parse_ground(ground_names()[static_cast<std::size_t>(ground)]), ground);
  EXPECT_NE(fault_of(ErrorKind::kUsage, [] { parse_ground("grey"); }).find("none, black, white"),
            std::string::npos);
}

}  // namespace
}  // namespace freshet::media
