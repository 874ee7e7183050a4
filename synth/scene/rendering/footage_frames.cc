#include "synth/scene/rendering/footage_frames.h"

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/frame/bgra.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"

namespace freshet::synth::scene {
namespace {

/// Straight alpha of any depth to colours times alpha.
void premultiply(const cv::Mat& bgra, double white, cv::Mat& out) {
  bgra.convertTo(out, CV_32F, 1 / white);
  for (int y = 0; y < out.rows; ++y) {
    auto* row = out.ptr<cv::Vec4f>(y);
    for (int x = 0; x < out.cols; ++x)
      for (int c = 0; c < 3; ++c) row[x][c] *= row[x][3];
  }
}

}  // namespace

FootageFrames::FootageFrames(const std::filesystem::path& file, cv::Point at) : file_(file), at_(at) {
  if (media::is_pattern(file))
    pictures_ = media::list_pattern(file).files;
  else if (std::filesystem::is_directory(file))
    pictures_ = media::list_folder(file).files;
  else
    reader_.emplace(file);
}

const cv::Mat& FootageFrames::next() {
  const cv::Size before = frame_.size();
  if (reader_) {
    std::optional<media::Frame> frame = reader_->next();
    if (!frame) {
      reader_.emplace(file_);
      frame = reader_->next();
    }
    if (!frame)
      throw Error(ErrorKind::kInput, file_.string(), "no frame of it can be decoded", "Check the file");
    premultiply(media::to_bgra(*frame), 255, frame_);
  } else {
    premultiply(media::read_deep_picture(pictures_[picture_]).values, 65535, frame_);
    if (!before.empty() && before != frame_.size())
      throw Error(ErrorKind::kInput, pictures_[picture_].string(),
                  fmt::format("it has {} x {} px, the frames before it {} x {}", frame_.cols, frame_.rows,
                              before.width, before.height),
                  "Give frames of one size");
    picture_ = (picture_ + 1) % pictures_.size();
  }
  return frame_;
}

}  // namespace freshet::synth::scene
