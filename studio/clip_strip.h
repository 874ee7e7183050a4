// studio/clip_strip.h — a clip, or one of its patches, as a strip of small frames that a page can play.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "vision/variant.h"

namespace freshet::studio {

inline constexpr int kStripFrames = 24;  // at most; spread evenly over the clip's first two seconds

/// Frames of clips as they are shown, kept for the next who asks. Safe from many threads.
class ClipSamples {
 public:
  explicit ClipSamples(store::Snapshot snapshot) : snapshot_(std::move(snapshot)) {}
  using Frames = std::shared_ptr<const std::vector<cv::Mat>>;  // CV_8UC3, whole
  /// Throws Error{kDamaged}.
  Frames frames(store::ClipId clip);

  static constexpr std::size_t kMostBytes = std::size_t{256} << 20;

 private:
  struct Kept {
    store::ClipId clip;
    Frames frames;
    std::size_t bytes = 0;
  };
  store::Snapshot snapshot_;
  std::mutex guard_;      // held while a clip is read: who asks for the same one waits
  std::list<Kept> kept_;  // last used first
};

/// Frames side by side, CV_8UC3: each at most `width` px wide, with the clip's shape.
cv::Mat clip_strip(const std::vector<cv::Mat>& frames, int width);

/// The same of a video's first frames, two seconds of them at most. Throws Error{kInput}.
cv::Mat clip_strip(const std::filesystem::path& video, int width);

/// The same of a patch alone, as its variant shows it: `side` px wide and high. patch   px, in the variant's frame.
cv::Mat patch_strip(const std::vector<cv::Mat>& frames, const vision::Variant& variant, const cv::Rect& patch,
                    int side);

/// Where a patch's corners lie in its clip's frame, 0..1 of its width and height; from upper left, clockwise as the
/// patch is seen.
std::array<cv::Point2d, 4> patch_in_clip(const store::ClipRecord& clip, const vision::Variant& variant,
                                         const cv::Rect& patch);

/// CV_8UC3. Throws Error{kNotFound} where the store has no clip of this name, Error{kDamaged}.
cv::Mat first_frame(const store::Snapshot& snapshot, const std::string& clip);
/// So many of its frames, spread evenly over it; all where it has fewer. Throws as first_frame.
std::vector<cv::Mat> spread_frames(const store::Snapshot& snapshot, const std::string& clip,
                                   std::size_t count);
/// Of a video's file. Throws Error{kInput}.
cv::Mat first_frame(const std::filesystem::path& video);

/// As JPEG.
std::string encoded(const cv::Mat& picture);
std::string encoded_png(const cv::Mat& picture);

}  // namespace freshet::studio
