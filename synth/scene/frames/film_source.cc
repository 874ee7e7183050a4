#include "synth/scene/frames/film_source.h"

#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"

namespace freshet::synth::scene {

FilmSource::FilmSource(std::filesystem::path file) : file_(std::move(file)) {
  if (media::is_pattern(file_))
    pictures_ = media::list_pattern(file_).files;
  else if (std::filesystem::is_directory(file_))
    pictures_ = media::list_folder(file_).files;
  else
    reader_.emplace(file_), ahead_ = reader_->next();
}

cv::Mat FilmSource::next() {
  if (reader_) {
    if (!ahead_) {
      reader_.emplace(file_);
      ahead_ = reader_->next();
    }
    if (!ahead_)
      throw Error(ErrorKind::kInput, file_.string(), "no frame of it can be decoded", "Check the file");
    cv::Mat frame = media::to_bgra(*ahead_);
    ahead_ = reader_->next();
    return frame;
  }
  if (picture_ == pictures_.size()) picture_ = 0;
  const std::filesystem::path& picture = pictures_[picture_];
  cv::Mat frame = media::read_deep_picture(picture).values;
  if (!size_.empty() && size_ != frame.size())
    throw Error(ErrorKind::kInput, picture.string(),
                fmt::format("it has {} x {} px, the frames before it {} x {}", frame.cols, frame.rows,
                            size_.width, size_.height),
                "Give frames of one size");
  size_ = frame.size();
  ++picture_;
  return frame;
}

cv::Mat FilmSource::following() const {
  return reader_ ? media::to_bgra(*ahead_) : media::read_deep_picture(pictures_[picture_]).values;
}

}  // namespace freshet::synth::scene
