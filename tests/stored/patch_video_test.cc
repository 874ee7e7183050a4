#include "stored/patch_video.h"

#include <gtest/gtest.h>

#include <vector>

#include <opencv2/imgproc.hpp>

#include "stored/clip_columns.h"
#include "stored/clip_frames.h"
#include "stored/clip_metadata.h"
#include "tests/harness/scratch_folder.h"
#include "vision/settings.h"

namespace freshet::stored {
namespace {

constexpr std::uint32_t kFrames = 5;

// A clip of moving noise in a layout, and the store that holds it.
struct Shot {
  ScratchFolder folder;
  store::Snapshot snapshot;
  store::ClipId clip{};

  explicit Shot(const media::PixelLayout& layout) : snapshot(made(folder, layout)) {
    clip = snapshot.clips()[0];
  }

  static store::Snapshot made(const ScratchFolder& folder, const media::PixelLayout& layout) {
    store::Store store = store::Store::create(folder.path() / "a.store", to_json(vision::Settings{}));
    store::ClipWriter writer = store.add_clip();
    cv::RNG random(7);
    const std::vector<media::Plane> shapes = media::plane_shapes(layout);
    ClipColumns columns;
    for (std::uint32_t frame = 0; frame < kFrames; ++frame) {
      std::vector<cv::Mat> planes;
      for (const media::Plane& shape : shapes) {
        cv::Mat plane(shape.height, shape.width, shape.bytes_per_sample == 1 ? CV_8U : CV_16U);
        random.fill(plane, cv::RNG::UNIFORM, 16, 235);
        cv::GaussianBlur(plane, plane, {}, 1.5);
        planes.push_back(plane);
      }
      if (frame == 0) begin_stream(writer, store::Stream::kFrames, planes);
      append(writer, store::Stream::kFrames, planes);
      columns.times_s.push_back(frame * 0.04);
    }
    write_columns(writer, columns);
    store::ClipRecord record;
    record.name = "noise";
    record.class_name = "water";
    record.source_hash = std::string(32, '1');
    record.pixel_format = layout.format;
    record.width = static_cast<std::uint32_t>(layout.width);
    record.height = static_cast<std::uint32_t>(layout.height);
    record.fps_num = 25;
    record.metadata = to_json(ClipMetadata{.layout = layout});
    writer.commit(record);
    return store.snapshot();
  }
};

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(ClipRegion, IsWhatWholeFramesShowThere) {
  // Odd sides, chroma of fewer samples, colours in one plane, 10 bits; and so tall that an untagged matrix is another
  // one.
  for (const media::PixelLayout& layout :
       {media::PixelLayout{.format = "yuv420p", .width = 151, .height = 103},
        media::PixelLayout{.format = "yuv420p", .width = 90, .height = 730},
        media::PixelLayout{.format = "yuv422p10le", .width = 120, .height = 80, .range = 1, .matrix = 1},
        media::PixelLayout{.format = "yuyv422", .width = 96, .height = 724},
        media::PixelLayout{.format = "rgb24", .width = 97, .height = 730},
        media::PixelLayout{.format = "gray", .width = 130, .height = 70}}) {
    SCOPED_TRACE(layout.format);
    const Shot shot(layout);
    const std::vector<media::Frame> frames = ClipFrames(shot.snapshot, shot.clip).read(1, 3);
    cv::RNG random(3);
    for (int i = 0; i < 12; ++i) {
      const cv::Size size(random.uniform(1, 60), random.uniform(1, 60));
      const cv::Rect region({random.uniform(0, layout.width - size.width + 1),
                             random.uniform(0, layout.height - size.height + 1)},
                            size);
      const auto bgr = read_region(shot.snapshot, shot.clip, layout, region, 1, 3, Shown::kBgr);
      const auto luma = read_region(shot.snapshot, shot.clip, layout, region, 1, 3, Shown::kLuma);
      for (std::size_t f = 0; f < frames.size(); ++f) {
        EXPECT_TRUE(same(bgr[f], media::to_bgr(frames[f])(region))) << region;
        EXPECT_TRUE(same(luma[f], media::to_luma(frames[f])(region))) << region;
      }
    }
  }
}

TEST(PatchVideo, IsWhatItsVariantShows) {
  const media::PixelLayout layout{.format = "yuv420p", .width = 192, .height = 144};
  const Shot shot(layout);
  const std::vector<media::Frame> frames = ClipFrames(shot.snapshot, shot.clip).read(0, kFrames);
  for (const vision::Variant& variant : vision::Settings{}.variants()) {
    SCOPED_TRACE(testing::Message() << variant.scale << " " << variant.rotation_deg << " " << variant.flip);
    const cv::Size size = vision::variant_frame({layout.width, layout.height}, variant).size;
    const PatchPlace place{.clip = shot.clip,
                           .variant = variant,
                           .corner = {(size.width - 48) / 2 + 1, (size.height - 48) / 2},
                           .first = 1,
                           .count = 3};
    cv::Mat video;
    read_patch(shot.snapshot, layout, place, Shown::kBgr, video);
    ASSERT_EQ(video.size[0], 3);
    for (int f = 0; f < 3; ++f) {
      const cv::Mat patch(48, 48, CV_8UC3, video.ptr(f));
      const cv::Mat shown = vision::warp_to_variant(media::to_bgr(frames[static_cast<std::size_t>(f) + 1]),
                                                    variant)(cv::Rect(place.corner, cv::Size(48, 48)));
      const bool own_pixels = variant.scale == 1 && variant.rotation_deg == 0;
      EXPECT_LE(cv::norm(patch, shown, cv::NORM_L1) / (48 * 48 * 3), own_pixels ? 0 : 4);
    }
  }
}

}  // namespace
}  // namespace freshet::stored
