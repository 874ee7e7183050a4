#include "synth/transfer/files/composite.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/frame/file_format.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"
#include "media/video/video_reader.h"

namespace freshet::synth::transfer {
namespace {

namespace fs = std::filesystem;

constexpr int kRim = 20;  // of the frame's shorter side, one part

/// The nearest code of what `blend` says.
template <class Pixel, int kMax>
void join(const cv::Mat& over, Blend blend, cv::Mat& under) {
  constexpr std::int64_t kWhole = std::int64_t{kMax} * kMax;  // L = 1
  for (int y = 0; y < over.rows; ++y) {
    const auto* from = over.ptr<Pixel>(y);
    auto* to = under.ptr<cv::Vec3b>(y);
    for (int x = 0; x < over.cols; ++x) {
      const std::int64_t alpha = from[x][3];
      for (int c = 0; c < 3; ++c) {
        const std::int64_t light = alpha * from[x][c];
        const std::int64_t kept = blend == Blend::kOver     ? kWhole - alpha * kMax
                                  : blend == Blend::kScreen ? kWhole - light
                                                            : kWhole;
        const std::int64_t sum = 255 * light + kept * to[x][c];
        to[x][c] = static_cast<std::uint8_t>(std::min<std::int64_t>(255, (sum + kWhole / 2) / kWhole));
      }
    }
  }
}

/// What is left of alpha, by px from an end of the frame.
std::vector<float> rims(int length, int rim, bool fades_at_first, bool fades_at_last) {
  std::vector<float> left(static_cast<std::size_t>(length), 1.0f);
  for (int i = 0; i < std::min(rim, length); ++i) {
    const float at = (static_cast<float>(i) + 0.5f) / static_cast<float>(rim), kept = at * at * (3 - 2 * at);
    if (fades_at_first) left[static_cast<std::size_t>(i)] *= kept;
    if (fades_at_last) left[static_cast<std::size_t>(length - 1 - i)] *= kept;
  }
  return left;
}

template <class Pixel>
void fade(const std::vector<float>& across, const std::vector<float>& down, cv::Mat& picture) {
  for (int y = 0; y < picture.rows; ++y) {
    auto* to = picture.ptr<Pixel>(y);
    for (int x = 0; x < picture.cols; ++x) {
      const float kept = across[static_cast<std::size_t>(x)] * down[static_cast<std::size_t>(y)];
      to[x][3] = static_cast<typename Pixel::value_type>(std::lround(kept * static_cast<float>(to[x][3])));
    }
  }
}

}  // namespace

cv::Mat ending_softly(const cv::Mat& over, cv::Size under, cv::Point at) {
  CV_Assert(over.type() == CV_8UC4 || over.type() == CV_16UC4);
  const int rim = std::max(1, std::min(over.cols, over.rows) / kRim);
  const auto across = rims(over.cols, rim, at.x > 0, at.x + over.cols < under.width);
  const auto down = rims(over.rows, rim, at.y > 0, at.y + over.rows < under.height);
  cv::Mat soft = over.clone();
  if (over.depth() == CV_8U)
    fade<cv::Vec4b>(across, down, soft);
  else
    fade<cv::Vec4w>(across, down, soft);
  return soft;
}

cv::Mat laid_on(const cv::Mat& over, const cv::Mat& under, Blend blend, cv::Point at) {
  CV_Assert(over.type() == CV_8UC4 || over.type() == CV_16UC4);
  cv::Mat whole = under.clone();
  const cv::Rect seen = cv::Rect(at, over.size()) & cv::Rect({0, 0}, under.size());
  if (seen.empty()) return whole;
  cv::Mat below = whole(seen);
  const cv::Mat above = over(seen - at);
  if (over.depth() == CV_8U)
    join<cv::Vec4b, 255>(above, blend, below);
  else
    join<cv::Vec4w, 65535>(above, blend, below);
  return whole;
}

struct Background::Impl {
  fs::path path;
  cv::Mat still, first;
  std::optional<media::VideoReader> moving;
};

Background::Background(const fs::path& path, int frames) : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  std::error_code fault;
  const bool sequence =
      fs::is_directory(path, fault) || (!fs::exists(path, fault) && media::is_pattern(path));
  if (!sequence && !media::looks_like_video(path)) {
    impl_->still = impl_->first = media::read_picture(path).bgr;
    return;
  }
  int count = 0;
  media::VideoReader reader(path, 0, {.upright = true});
  while (const std::optional<media::Frame> frame = reader.next())
    if (count++ == 0) impl_->first = media::to_bgr(*frame);
  if (count < frames)
    throw Error(ErrorKind::kInput, path.string(),
                fmt::format("the background has {} frames, the animation {}", count, frames),
                "Give one that is as long, or a single picture");
  impl_->moving.emplace(path);
}

Background::Background(Background&&) noexcept = default;
Background::~Background() = default;

cv::Size Background::size() const { return impl_->first.size(); }

cv::Mat Background::next() {
  if (!impl_->moving) return impl_->still;
  const std::optional<media::Frame> frame = impl_->moving->next();
  if (!frame)
    throw Error(ErrorKind::kInput, impl_->path.string(), "it changed while it was read", "Start again");
  return media::to_bgr(*frame);
}

}  // namespace freshet::synth::transfer
