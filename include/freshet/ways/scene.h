// include/freshet/ways/scene.h — a picture's layers, all moved by one wind (Chuang et al. 2005).
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"

namespace freshet {

struct SceneOptions {
  /// The method as its paper prints it, whole; keys of the file that say otherwise are refused.
  bool as_printed = false;
  /// Frames are CV_32FC4: sRGB code times alpha, and alpha, 0 to 1; else CV_8UC3 BGR.
  bool light = false;
};

/// A scene file made ready. Same files, same bytes, for any number of threads.
///
///   SceneFilm film("lake.toml");
///   for (cv::Mat frame; film.next(frame);) video.write(frame);
class SceneFilm {
 public:
  /// scene    TOML; `freshet synth scene --keys` says what it can hold, and --init writes one to start from. Its layers
  ///          of patches are animated as search, label and animate do it; layers that give options to the program
  ///          (patches.options) are refused.
  /// Throws   Error{kInput} naming the file, the line or the layer, and the remedy; Error{kUsage} for options of the
  ///          program; Error{kNotFound} and Error{kDamaged} as search; Error{kCancelled}.
  /// Cost     cutting the layers: some seconds for each megapixel.
  explicit SceneFilm(const std::filesystem::path& scene, const SceneOptions& options = {},
                     const Job& job = {});
  SceneFilm(const SceneFilm&) = delete;
  SceneFilm& operator=(const SceneFilm&) = delete;
  ~SceneFilm();

  cv::Size size() const;
  int frames() const;
  double fps() const;
  /// Names, nearest first.
  const std::vector<std::string>& layers() const;
  /// For a person: what was guessed or left out.
  const std::vector<std::string>& notices() const;
  /// Frame 0, then 1, ... false, and frame untouched, after the last. A Mat of the right size and type is written in
  /// place: clone what must outlive the next call. Throws what a layer's maker throws.
  bool next(cv::Mat& frame);
  /// One layer of the frame that was given last, alone: CV_32FC4, sRGB code times alpha, and alpha, 0 to 1.
  /// Throws Error{kUsage} before the first frame, or for a layer that is not there.
  cv::Mat layer(std::size_t i) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet
