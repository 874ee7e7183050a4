// studio/ways/live_layers.h — a picture's layers, moving while they are drawn.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "media/picture/picture.h"
#include "studio/drawing/document.h"
#include "studio/ways/way_file.h"
#include "synth/scene/rendering/scene_animation.h"

namespace freshet::studio {

/// What the scene's own way would make (scene_way.cc), small and soon: cut layers and their sprites, which take the
/// longest, are kept until what they are cut by changes. One thread at a time.
class LiveLayers {
 public:
  /// Where its files lie, and the film goes.
  struct Places {
    std::filesystem::path project;
    std::function<void(const std::string& folder, const std::vector<WayFile>& files)>
        write;  // into ways/FOLDER
    /// Before the first frame: size of all, how many, how fast, and which of the scene comes first.
    std::function<void(cv::Size size, int frames, double fps, int first)> begin;
    std::function<void(const cv::Mat& frame)> add;  // CV_8UC3
  };

  /// Makes all frames, from `first` on and round. Layers of patches stand still: their film takes too long. With
  /// footage frames are made from 0 on.
  /// picture   CV_8UC3, the document's. Always the same one.
  /// Throws    Error{kUsage} where what was drawn is too little; as parse_scene, read_marks, cut_scene, SceneAnimation;
  ///           Error{kCancelled}.
  void render(const Document& document, const cv::Mat& picture, int first, const Places& places,
              const Job& job);

 private:
  media::Still still_;  // reduced; empty before the first time
  std::string cut_by_;  // what pixels_ follow from
  std::vector<synth::scene::LayerPixels> pixels_;
  synth::scene::KeptSprites sprites_;  // of these
};

}  // namespace freshet::studio
