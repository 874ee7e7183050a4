// synth/transfer/files/composite.h — a transparent picture, or light, on a background.
#pragma once

#include <filesystem>
#include <memory>

#include <opencv2/core.hpp>

#include "media/frame/blend.h"

namespace freshet::synth::transfer {

using media::Blend;

/// over     CV_8UC4 or CV_16UC4 BGRA, straight alpha; its top left corner lies at `at`, in or out of `under`.
/// under    CV_8UC3 BGR.
/// Returns  `under` with the picture on it.
cv::Mat laid_on(const cv::Mat& over, const cv::Mat& under, Blend blend = Blend::kOver, cv::Point at = {0, 0});

/// Light that ends softly: on each side of its frame that lies within the picture behind, alpha fades to 0 over the
/// last twentieth of the frame's shorter side. Flames that leave the frame would end in a straight line there.
///
/// over, at  as above. under: size of the picture behind.
cv::Mat ending_softly(const cv::Mat& over, cv::Size under, cv::Point at);

/// A background: one picture for all frames, or a folder, pattern or video of as many.
class Background {
 public:
  /// Throws Error{kInput} naming the file: unreadable, fewer frames than these.
  Background(const std::filesystem::path& path, int frames);
  Background(Background&&) noexcept;
  ~Background();
  cv::Size size() const;
  /// CV_8UC3; frames in order, each once.
  cv::Mat next();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::synth::transfer
