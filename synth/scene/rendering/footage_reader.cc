#include "synth/scene/rendering/footage_reader.h"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/bgra.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"

namespace freshet::synth::scene {
namespace {

constexpr int kTallest = 65536;  // px

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

FootageReader::FootageReader(const std::filesystem::path& file, int width) : file_(file), width_(width) {
  if (media::is_pattern(file))
    pictures_ = media::list_pattern(file).files;
  else if (std::filesystem::is_directory(file))
    pictures_ = media::list_folder(file).files;
  else
    reader_.emplace(file), ahead_ = reader_->next();
}

bool FootageReader::at_end() { return reader_ ? !ahead_ : picture_ == pictures_.size(); }

const cv::Mat& FootageReader::next() {
  const cv::Size before = frame_.size();
  if (reader_) {
    if (!ahead_) {
      reader_.emplace(file_);
      ahead_ = reader_->next();
    }
    if (!ahead_)
      throw Error(ErrorKind::kInput, file_.string(), "no frame of it can be decoded", "Check the file");
    const cv::Mat& frame = taken(media::to_bgra(*ahead_), 255);
    ahead_ = reader_->next();
    return frame;
  }
  if (picture_ == pictures_.size()) picture_ = 0;
  const cv::Mat& frame = taken(media::read_deep_picture(pictures_[picture_]).values, 65535);
  if (!before.empty() && before != frame_.size())
    throw Error(ErrorKind::kInput, pictures_[picture_].string(),
                fmt::format("it has {} x {} px, the frames before it {} x {}", frame_.cols, frame_.rows,
                            before.width, before.height),
                "Give frames of one size");
  ++picture_;
  return frame;
}

const cv::Mat& FootageReader::taken(const cv::Mat& bgra, double white) {
  premultiply(bgra, white, frame_);
  if (width_ == 0 || width_ == frame_.cols) return frame_;
  const cv::Size size(width_, std::max(1, cvRound(1.0 * frame_.rows * width_ / frame_.cols)));
  if (size.height > kTallest)
    throw Error(ErrorKind::kInput, file_.string(),
                fmt::format("{} px wide it would be {} px high", size.width, size.height),
                "Ask for a smaller width");
  // Of colours times alpha: what is transparent gives no colour to an edge.
  cv::resize(frame_, sized_, size, 0, 0, width_ < frame_.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
  return sized_;
}

}  // namespace freshet::synth::scene
