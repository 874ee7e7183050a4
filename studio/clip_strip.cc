#include "studio/clip_strip.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/frame.h"
#include "media/video/video_reader.h"
#include "stored/clip_frames.h"

namespace freshet::studio {
namespace {

constexpr std::uint32_t kSlab = 16;  // frames that a store decodes together
constexpr double kShown = 2;         // s

std::vector<cv::Mat> read_frames(const store::Snapshot& snapshot, store::ClipId clip) {
  const stored::ClipFrames frames(snapshot, clip);
  const store::ClipRecord& record = snapshot.clip(clip);
  const double fps =
      static_cast<double>(record.fps_num) / static_cast<double>(std::max<std::uint64_t>(1, record.fps_den));
  const auto shown = static_cast<std::uint32_t>(
      std::clamp(kShown * fps, 1.0, static_cast<double>(std::max(1u, frames.size()))));
  const std::uint32_t count = std::min<std::uint32_t>(kStripFrames, shown);
  std::vector<cv::Mat> read;
  std::vector<media::Frame> slab;
  std::uint32_t first = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t frame = i * shown / count;
    if (slab.empty() || frame >= first + slab.size()) {
      first = frame / kSlab * kSlab;
      slab = frames.read(first, std::min(kSlab, frames.size() - first));
    }
    read.push_back(media::to_bgr(slab[frame - first]));
  }
  return read;
}

cv::Mat side_by_side(const std::vector<cv::Mat>& parts) {
  cv::Mat strip;
  cv::hconcat(parts, strip);
  return strip;
}

}  // namespace

ClipSamples::Frames ClipSamples::frames(store::ClipId clip) {
  const std::lock_guard lock(guard_);
  const auto known =
      std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.clip == clip; });
  if (known != kept_.end()) {
    kept_.splice(kept_.begin(), kept_, known);
    return kept_.front().frames;
  }
  Kept read{.clip = clip,
            .frames = std::make_shared<const std::vector<cv::Mat>>(read_frames(snapshot_, clip))};
  for (const cv::Mat& frame : *read.frames) read.bytes += frame.total() * frame.elemSize();
  kept_.push_front(read);
  std::size_t bytes = 0;
  for (auto kept = kept_.begin(); kept != kept_.end();) {
    bytes += kept->bytes;
    kept = bytes > kMostBytes ? kept_.erase(kept) : std::next(kept);
  }
  return read.frames;
}

cv::Mat clip_strip(const std::vector<cv::Mat>& frames, int width) {
  std::vector<cv::Mat> parts;
  for (const cv::Mat& frame : frames) {
    const double scale = std::min(1.0, static_cast<double>(width) / frame.cols);
    const cv::Size size(std::max(1, cvRound(frame.cols * scale)), std::max(1, cvRound(frame.rows * scale)));
    cv::resize(frame, parts.emplace_back(), size, 0, 0, cv::INTER_AREA);
  }
  return side_by_side(parts);
}

cv::Mat clip_strip(const std::filesystem::path& video, int width) {
  constexpr int kApart = 2;  // frames: where a rate is claimed and not kept, two seconds may be days
  media::VideoReader reader(video);
  std::vector<cv::Mat> small;
  for (int i = 0; i < kStripFrames * kApart; ++i) {
    const std::optional<media::Frame> frame = reader.next();
    if (!frame) break;
    if (i % kApart == 0) small.push_back(clip_strip({media::to_bgr(*frame)}, width));
  }
  if (small.empty()) throw Error(ErrorKind::kInput, video.filename().string(), "it has no frame");
  return side_by_side(small);
}

cv::Mat patch_strip(const std::vector<cv::Mat>& frames, const vision::Variant& variant, const cv::Rect& patch,
                    int side) {
  // Straight from the source to what is shown: a whole frame turned for each of 24 patches would be waited for.
  const cv::Matx23d to_source = vision::variant_frame(frames.at(0).size(), variant).source_from_variant;
  const double step = static_cast<double>(patch.width) / side;
  const cv::Vec2d corner = to_source * cv::Vec3d(patch.x + 0.5 * step - 0.5, patch.y + 0.5 * step - 0.5, 1);
  const cv::Matx23d from_shown(to_source(0, 0) * step, to_source(0, 1) * step, corner[0],  //
                               to_source(1, 0) * step, to_source(1, 1) * step, corner[1]);
  std::vector<cv::Mat> parts;
  for (const cv::Mat& frame : frames)
    cv::warpAffine(frame, parts.emplace_back(), from_shown, {side, side},
                   cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return side_by_side(parts);
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

cv::Mat first_frame(const store::Snapshot& snapshot, const std::string& clip) {
  const std::optional<store::ClipId> id = snapshot.find(clip);
  if (!id) throw Error(ErrorKind::kNotFound, clip, "the store has no clip of this name");
  return media::to_bgr(stored::ClipFrames(snapshot, *id).read(0, 1).at(0));
}

std::vector<cv::Mat> spread_frames(const store::Snapshot& snapshot, const std::string& clip,
                                   std::size_t count) {
  const std::optional<store::ClipId> id = snapshot.find(clip);
  if (!id) throw Error(ErrorKind::kNotFound, clip, "the store has no clip of this name");
  const stored::ClipFrames frames(snapshot, *id);
  const std::size_t all = frames.size(), wanted = std::min(all, count);
  std::vector<cv::Mat> spread;
  for (std::size_t i = 0; i < wanted; ++i)
    spread.push_back(media::to_bgr(frames.read(static_cast<std::uint32_t>(i * all / wanted))));
  return spread;
}

cv::Mat first_frame(const std::filesystem::path& video) {
  const std::optional<media::Frame> frame = media::VideoReader(video).next();
  if (!frame) throw Error(ErrorKind::kInput, video.filename().string(), "it has no frame");
  return media::to_bgr(*frame);
}

std::string encoded(const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, 90});
  return {bytes.begin(), bytes.end()};
}

std::string encoded_png(const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", picture, bytes);
  return {bytes.begin(), bytes.end()};
}

}  // namespace freshet::studio
