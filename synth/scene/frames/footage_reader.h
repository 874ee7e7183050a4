// synth/scene/frames/footage_reader.h — a sequence or video with alpha or a matte, frame by frame, round and round.
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>

#include <opencv2/core.hpp>

#include "media/frame/filmed_ground.h"
#include "synth/scene/frames/film_source.h"

namespace freshet::synth::scene {

/// What frames become when they are read.
struct FootageForm {
  int width = 0;                                // px of its frames, which keep their shape; 0: as they are
  media::Ground ground = media::Ground::kNone;  // taken off (transfer::take_off_ground)
  cv::Vec3f ground_depth{};                     // how far it is from black or white (ground_depth)
  cv::Mat matte{};                 // CV_8U of the film's size: alpha is at most this; empty: none
  std::filesystem::path mattes{};  // a matte for each frame, as FilmSource, in place of that one; empty: none
  bool mattes_are_alpha = false;   // and not grey (has_transparency)
};

/// Whether any of a film's first `most` frames is not opaque: one of mattes is then read by its alpha, in every frame.
/// Throws   as FilmSource; Error{kCancelled}. Cost   decodes all up to that frame; of a video without alpha the first.
bool has_transparency(const std::filesystem::path& film, int most, const std::stop_token& stop = {});

/// Throws Error{kInput} naming both where a matte has another shape than its film (media::has_shape_of).
void expect_shape(const std::filesystem::path& matte, cv::Size size, const std::filesystem::path& film,
                  cv::Size film_size);

/// How far what a film was filmed on is from black or white, 0..1, by channel: grounds are hardly ever quite black or
/// white, and would be seen as a veil. The most frequent level within a tenth of it; 0 where that is no ground.
/// frame   of next(), opaque, with no form.
cv::Vec3f ground_depth(const cv::Mat& frame, media::Ground ground);

/// Sequences of .png keep their 16 bits; all else is taken at 8. What has no alpha, ground and matte is opaque.
class FootageReader {
 public:
  /// Throws as FilmSource.
  explicit FootageReader(const std::filesystem::path& file, FootageForm form = {});
  /// The next frame, after the last the first: CV_32FC4, sRGB code times alpha, and alpha; valid until the next call.
  /// Throws   as FilmSource; Error{kInput}: a matte of another shape than the film, or where the one ends and the
  /// other does not.
  const cv::Mat& next();
  /// Whether next() would give the first frame; of a video known once its last was asked for.
  bool at_end() const { return film_.at_end(); }
  /// Where what the last frame shows goes until the one after it in the file: vision::optical_flow of frames as they
  /// are in the file, over white where they are dark and transparent, else over black; CV_32FC2 of next()'s size, px of
  /// it. comes_round: after the last the first follows. Empty after the last else, and before the first call of next().
  /// Cost   a frame decoded twice, and its flow.
  cv::Mat motion(bool comes_round);

 private:
  /// That of the frame that was read.
  void take_matte();

  FootageForm form_;
  FilmSource film_;
  std::optional<FilmSource> mattes_;
  int place_ = 0;          // of the next frame in the film; counted with mattes alone
  cv::Mat read_;           // the last frame as it is in the file, BGRA of 8 or 16 bits
  cv::Mat frame_, sized_;  // the same as next() gives it
};

}  // namespace freshet::synth::scene
