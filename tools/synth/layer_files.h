// tools/synth/layer_files.h — the layers of a scene, each alone and with alpha, in files.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "media/picture/passes.h"
#include "media/video/picture_sink.h"
#include "synth/scene/rendering/layer_frames.h"
#include "synth/scene/rendering/scene_animation.h"
#include "synth/scene/scene.h"

namespace freshet::tools {

/// A file or sequence for each layer where {layer} stands in the name, in any format with alpha. Else one EXR a frame:
/// the film first, then a part for each layer, nearest first, with its motion to the next frame.
class LayerFiles {
 public:
  /// name   empty: nothing is written. first_number   of sequences.
  /// Throws Error{kUsage} for a name that says no layer, or whose format has no alpha; what check_frames_output throws.
  LayerFiles(const std::string& name, const synth::scene::Scene& scene, cv::Size size,
             std::int64_t first_number);
  /// The frame that was rendered last.
  void write(synth::scene::SceneAnimation& animation);
  void finish();
  /// What is asked of layers that bring frames of their own.
  synth::scene::FrameWork work() const {
    return parts_.empty() ? synth::scene::FrameWork::kFrames : synth::scene::FrameWork::kFramesAndMotion;
  }
  const std::vector<std::string>& files() const { return files_; }

 private:
  void write_parts(synth::scene::SceneAnimation& animation);

  std::optional<media::Layers> layers_;
  std::vector<std::string> names_;                          // of layers
  std::vector<std::unique_ptr<media::PictureSink>> sinks_;  // one a layer; none where all go into one file
  std::string parts_;                                       // pattern of that file, or its name
  std::int64_t number_ = 0;                                 // of the next
  std::vector<std::string> files_;
  cv::Mat layer_, alpha_;
};

}  // namespace freshet::tools
