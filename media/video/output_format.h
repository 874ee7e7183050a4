// media/video/output_format.h — what a name stands for when frames are written to it, and what it holds of them.
#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

#include "media/frame/file_format.h"
#include "media/picture/passes.h"

namespace freshet::media {

/// A row of the table, and what becomes of the frames.
class OutputFormat {
 public:
  enum class Form { kPicture, kSequence, kFilm };

  OutputFormat(const FileFormat& file, Form form) : file_(&file), form_(form) {}

  Form form() const { return form_; }
  Coding coding() const { return file_->coding; }
  bool alpha() const { return file_->alpha; }
  bool holds(Depth depth) const { return file_->depths.has(depth); }
  /// Whether its samples are linear light, colours times alpha.
  bool light() const { return holds(Depth::kHalf); }
  /// What it holds in words: "ProRes 4444 has 10 bits".
  std::string depths_text() const;
  int max_side() const { return file_->max_side; }
  /// Samples that lose least in it. bits   of H.264, VideoWriterOptions.
  Samples samples(int bits = 8) const;

 private:
  const FileFormat* file_;
  Form form_;
};

/// A pattern is a sequence, a single frame with a picture's ending that picture, all else a film.
/// frames   0: more than one.
/// Throws   Error{kUsage} where the ending names nothing that is written.
OutputFormat output_format(const std::filesystem::path& path, int frames = 0);

/// A picture as a file of this format takes it: 16 bits brought to 8, or sRGB code to linear light, where it must be.
/// picture   CV_8U or CV_16U of sRGB code, 3 or 4 channels, alpha straight; or CV_32F of linear light, which no other
///           format than one of light takes: it is returned as it is.
/// bits      of H.264, VideoWriterOptions.
cv::Mat as_held(const cv::Mat& picture, const OutputFormat& format, int bits = 8);

}  // namespace freshet::media
