#include "synth/animate/clips/detail_life.h"

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "media/frame/layout_json.h"
#include "store/store.h"

namespace freshet::synth::animate {
namespace {

/// A clip of noise that goes 2 px to the right in every frame and keeps `kept` of itself: the rest comes anew.
/// Detail then keeps kept^n of its correlation after n frames.
double half_life_of(double kept) {
  constexpr int kWidth = 320, kHeight = 160, kFrames = 40, kFps = 25;
  std::string name = (std::filesystem::temp_directory_path() / "freshet-life-XXXXXX").string();
  const std::filesystem::path folder = mkdtemp(name.data());
  store::Store store = store::Store::create(folder / "a.store", "{}");
  store::ClipWriter writer = store.add_clip();
  const store::PlaneShape frame_plane{kWidth, kHeight, 1}, flow_plane{kWidth, kHeight, 2};
  writer.begin_stream(store::Stream::kFrames, std::vector{frame_plane});
  writer.begin_stream(store::Stream::kFlow, std::vector(2, flow_plane));
  cv::RNG random(5);
  cv::Mat state(kHeight, kWidth, CV_32F), fresh(kHeight, kWidth, CV_32F), moved, bytes;
  random.fill(state, cv::RNG::NORMAL, 0, 30);
  const cv::Mat u(kHeight, kWidth, CV_16S, cv::Scalar(2 * 64)), v(kHeight, kWidth, CV_16S, cv::Scalar(0));
  const auto view = [](const cv::Mat& plane) {
    return store::PlaneView{reinterpret_cast<const std::byte*>(plane.data),
                            static_cast<std::ptrdiff_t>(plane.step)};
  };
  std::vector<double> times;
  for (int i = 0; i < kFrames; ++i) {
    state.convertTo(bytes, CV_8U, 1, 128);
    writer.append(store::Stream::kFrames, std::vector{view(bytes)});
    times.push_back(i / static_cast<double>(kFps));
    if (i + 1 < kFrames) writer.append(store::Stream::kFlow, std::vector{view(u), view(v)});
    random.fill(fresh, cv::RNG::NORMAL, 0, 30);
    moved = fresh.clone();
    cv::Mat inside = moved.colRange(2, kWidth);
    cv::addWeighted(state.colRange(0, kWidth - 2), kept, fresh.colRange(2, kWidth),
                    std::sqrt(1 - kept * kept), 0, inside);
    moved.copyTo(state);
  }
  writer.column<double>("frame.time", times);
  store::ClipRecord record;
  record.name = "noise.mkv", record.class_name = "water", record.source_hash = "hash";
  record.pixel_format = "gray";
  record.width = kWidth, record.height = kHeight, record.fps_num = kFps;
  const media::PixelLayout layout{.format = "gray", .width = kWidth, .height = kHeight, .range = 2};
  record.metadata = R"({"layout": )" + media::to_json(layout) + "}";
  const store::ClipId id = writer.commit(record);
  const double life = detail_half_life_s(store.snapshot(), id);
  std::filesystem::remove_all(folder);
  return life;
}

TEST(DetailLife, IsTheTimeInWhichHalfOfTheCorrelationIsLost) {
  for (const double kept : {0.8, 0.93})
    EXPECT_NEAR(half_life_of(kept), std::log(0.5) / std::log(kept) / 25, 0.02) << kept;
}

TEST(DetailLife, BeyondWhatIsFollowedTheFallGoesOn) {
  EXPECT_NEAR(half_life_of(0.985), std::log(0.5) / std::log(0.985) / 25, 0.3);
  EXPECT_EQ(half_life_of(1), 6);
}

}  // namespace
}  // namespace freshet::synth::animate
