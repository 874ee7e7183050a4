// tools/synth/design_folder.h — a folder that holds a designed motion: what an appearance is transferred to.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "synth/simulate/simulate.h"

namespace freshet::tools {

/// alpha/, flow/ (.flo and .exr) and emitters/, one file per frame, numbered from 0; preview.mp4; the scene;
/// and design.json, which says what the numbers mean.
class DesignFolder {
 public:
  /// Makes the folder. One that holds a design already is made afresh.
  /// Throws Error{kIo} when the folder above is missing, Error{kUsage} when it holds anything else.
  DesignFolder(const std::filesystem::path& folder, const synth::simulate::SceneOptions& options,
               const std::string& scene_text);

  std::filesystem::path preview() const { return folder_ / "preview.mp4"; }
  void write(int number, const synth::simulate::SimulatedFrame& frame);
  /// design.json, last: a folder without it is not whole.
  void finish();

 private:
  std::filesystem::path folder_;
  nlohmann::ordered_json description_;
};

/// One frame of alpha or emitters: grey PNG, 8 or 16 bits, ... by the name's ending.
void write_grey(const std::filesystem::path& pattern, int number, const cv::Mat& grey);

}  // namespace freshet::tools
