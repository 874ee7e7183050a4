// synth/scene/frames/film_source.h — frames of a sequence or video as its files hold them, round and round.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "media/frame/bgra.h"
#include "media/video/video_reader.h"

namespace freshet::synth::scene {

class FilmSource {
 public:
  /// file   a numbered sequence (f.####.png), a folder that holds one, or a video.
  /// Throws Error{kInput} naming the file, as VideoReader and list_pattern do.
  explicit FilmSource(std::filesystem::path file);
  const std::filesystem::path& file() const { return file_; }
  /// The next frame, after the last the first: BGRA, of a sequence 16 bits, of a video 8.
  /// Throws   Error{kInput}: frames of unequal size, none that can be decoded, and as read_deep_picture.
  cv::Mat next();
  /// Whether next() would give the first frame; of a video known once its last was asked for.
  bool at_end() const { return reader_ ? !ahead_ : picture_ == pictures_.size(); }
  /// Whether its kind of file may hold alpha; of sequences always.
  bool may_have_alpha() const { return !reader_ || media::has_alpha(reader_->info().layout); }
  /// What next() would give; not at the end. Decodes it.
  cv::Mat following() const;

 private:
  std::filesystem::path file_;
  std::vector<std::filesystem::path> pictures_;  // of a sequence
  std::size_t picture_ = 0;
  cv::Size size_;  // of a picture; empty before the first
  std::optional<media::VideoReader> reader_;
  std::optional<media::Frame> ahead_;  // of the video, read and not yet given
};

}  // namespace freshet::synth::scene
