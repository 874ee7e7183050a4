// tools/options/output_options.h — what of an animation goes into which files, in what form.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "media/picture/passes.h"
#include "media/picture/resized.h"
#include "media/video/output_format.h"
#include "media/video/picture_sink.h"
#include "synth/animate/frames/animation.h"
#include "tools/console/output_names.h"
#include "tools/options/target_files.h"

namespace freshet::tools {

/// The files of one animation, open: none is left where they are destroyed before finish(), but for the frames of
/// sequences.
class AnimationFiles {
 public:
  AnimationFiles() = default;
  AnimationFiles(const AnimationFiles&) = delete;
  AnimationFiles& operator=(const AnimationFiles&) = delete;

  /// The picture that is to be animated, as deep as the output asks: CV_8UC3, or CV_32FC3.
  const cv::Mat& picture() const { return picture_; }
  /// The next frame as animate() hands it on; frames outside --range are passed over. Returns it for a person to look
  /// at, CV_8UC3.
  cv::Mat write(const cv::Mat& frame);
  /// For who makes no frame before --range (FrameOptions::from): the next one is its first.
  void skip_to_range() { frame_ = matte_frame_ = motion_frame_ = numbers_.from; }
  void finish();

 private:
  friend class OutputOptions;
  void write_matte(const cv::Mat& matte);
  void write_motion(const cv::Mat& motion);
  bool wanted(std::int64_t number) const { return number >= numbers_.from && number <= numbers_.to; }

  FrameNumbers numbers_;
  std::int64_t frame_ = 0, matte_frame_ = 0, motion_frame_ = 0;  // numbers of the next ones
  cv::Size size_, matte_size_;                                   // of what is written
  media::Colours colours_ = media::Colours::kPremultiplied;      // of frames with alpha
  cv::Mat picture_;
  std::optional<media::Layers> layers_;  // nothing: frames are written as they come
  std::optional<media::PictureSink> sink_, matte_sink_;
  std::vector<std::string> motion_out_;
};

/// What is written of an animation: itself, its mattes and its motion, frame by frame.
class OutputOptions {
 public:
  /// --output, --width, --layer, --alpha, --depth, --preset, --start-number, --range, --matte-out, --motion-out,
  /// --overwrite.
  void add_to(CLI::App& command);
  /// Of these, what frames of a fluid need that is neither carried nor has a moving outline: no --layer light, no
  /// --motion-out.
  void add_fluid_to(CLI::App& command);
  /// And what any frames need: --output (which open() asks for), --depth, --preset, --start-number, --range,
  /// --overwrite.
  void add_frames_to(CLI::App& command);

  /// Opens all files, and asks the options for frames in the form that they need. Says what a codec makes of the
  /// picture's size. Throws for whatever names, forms and formats do not go together: before the work.
  /// options       with frames, fps and outline; what they are given must not outlive the files.
  std::unique_ptr<AnimationFiles> open(const TargetFiles::Loaded& loaded,
                                       synth::animate::FrameOptions& options);
  /// Gives a name without an ending the one of what is asked: the preset's, .webp for the fluid alone, .mp4.
  void add_ending();
  /// Whether browsers play the file.
  bool plays_in_browsers() const;
  std::int64_t first_number() const { return first_number_; }
  const std::string& name() const { return out_; }
  /// Whether the fluid alone is written, with its alpha.
  bool fluid_alone() const { return layer_ == "fluid"; }
  /// Of the files written, for the command's last lines.
  std::vector<std::string> files() const;

 private:
  void add_fluid_to(CLI::App& command, const std::vector<std::string>& layers, const std::string& more);
  cv::Size apply_preset(cv::Size size);
  media::Samples choose_samples(const media::OutputFormat& format, bool deep);
  FrameNumbers numbers(int frames) const;

  std::string out_, layer_ = "whole", alpha_, depth_ = "auto", preset_, range_, matte_out_;
  std::vector<std::string> motion_out_;
  std::int64_t first_number_ = 0;
  int width_ = 0;  // 0: the picture's
  media::VideoWriterOptions file_options_;
};

}  // namespace freshet::tools
