#include "studio/clip_strip.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/frame.h"
#include "query/stored/clip_frames.h"

namespace freshet::studio {
namespace {

constexpr std::uint32_t kSlab = 16;  // frames that a store decodes together
constexpr double kShown = 2;         // s

/// What `small` makes of evenly spread frames, side by side.
cv::Mat strip_of(const store::Snapshot& snapshot, store::ClipId clip,
                 const std::function<cv::Mat(const cv::Mat&)>& small) {
  const query::ClipFrames frames(snapshot, clip);
  const store::ClipRecord& record = snapshot.clip(clip);
  const double fps =
      static_cast<double>(record.fps_num) / static_cast<double>(std::max<std::uint64_t>(1, record.fps_den));
  const auto shown = static_cast<std::uint32_t>(
      std::clamp(kShown * fps, 1.0, static_cast<double>(std::max(1u, frames.size()))));
  const std::uint32_t count = std::min<std::uint32_t>(kStripFrames, shown);
  std::vector<cv::Mat> parts;
  std::vector<media::Frame> slab;
  std::uint32_t first = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t frame = i * shown / count;
    if (slab.empty() || frame >= first + slab.size()) {
      first = frame / kSlab * kSlab;
      slab = frames.read(first, std::min(kSlab, frames.size() - first));
    }
    parts.push_back(small(media::to_bgr(slab[frame - first])));
  }
  cv::Mat strip;
  cv::hconcat(parts, strip);
  return strip;
}

}  // namespace

cv::Mat clip_strip(const store::Snapshot& snapshot, store::ClipId clip, int width) {
  return strip_of(snapshot, clip, [width](const cv::Mat& frame) {
    const double scale = std::min(1.0, static_cast<double>(width) / frame.cols);
    cv::Mat small;
    cv::resize(frame, small,
               {std::max(1, cvRound(frame.cols * scale)), std::max(1, cvRound(frame.rows * scale))}, 0, 0,
               cv::INTER_AREA);
    return small;
  });
}

cv::Mat patch_strip(const store::Snapshot& snapshot, store::ClipId clip, const vision::Variant& variant,
                    const cv::Rect& patch, int side) {
  const store::ClipRecord& record = snapshot.clip(clip);
  const cv::Size source(static_cast<int>(record.width), static_cast<int>(record.height));
  const cv::Size frame = vision::variant_frame(source, variant).size;
  if ((patch & cv::Rect({}, frame)) != patch || patch.empty())
    throw Error(ErrorKind::kInput, record.name, "the patch lies outside of its frame");
  return strip_of(snapshot, clip, [&](const cv::Mat& picture) {
    cv::Mat shown;
    cv::resize(vision::warp_to_variant(picture, variant)(patch), shown, {side, side}, 0, 0, cv::INTER_LINEAR);
    return shown;
  });
}

std::array<cv::Point2d, 4> patch_in_clip(const store::ClipRecord& clip, const vision::Variant& variant,
                                         const cv::Rect& patch) {
  const cv::Size source(static_cast<int>(clip.width), static_cast<int>(clip.height));
  const cv::Matx23d to_source = vision::variant_frame(source, variant).source_from_variant;
  const std::array<cv::Point2d, 4> corners{{{patch.x - 0.5, patch.y - 0.5},
                                            {patch.x + patch.width - 0.5, patch.y - 0.5},
                                            {patch.x + patch.width - 0.5, patch.y + patch.height - 0.5},
                                            {patch.x - 0.5, patch.y + patch.height - 0.5}}};
  std::array<cv::Point2d, 4> places;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const cv::Vec2d at = to_source * cv::Vec3d(corners[i].x, corners[i].y, 1);
    places[i] = {(at[0] + 0.5) / source.width, (at[1] + 0.5) / source.height};
  }
  return places;
}

std::string encoded(const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, 90});
  return {bytes.begin(), bytes.end()};
}

}  // namespace freshet::studio
