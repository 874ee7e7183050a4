// include/freshet/ways/stills.h — a moving scene from some stills of it (Lin et al. 2007).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"

namespace freshet {

struct StillsOptions {
  /// Length, s, 0.04 to 3600.
  double seconds = 8;
  /// Frames per second, 1 to 240; of a preview 12.5 at most.
  double fps = 25;
  /// The last frame runs into the first without a seam.
  bool loop = false;
  /// Small and fast: 480 px.
  bool preview = false;
  /// "auto": hand-held stills are detected, aligned and cropped; "tripod": unchanged; "hand": aligned and levelled.
  std::string camera = "auto";
  /// Exposure and white balance matched: "on", "off", or "auto" (of hand-held stills).
  std::string level = "auto";
  /// Regions that move independently: an SVG drawn over a still, or a picture of masks. Empty, with the next two:
  /// proposed from what varies.
  std::filesystem::path regions{};
  /// Picture of a still's size: white or green on each thing that moves, black or red on what stands still.
  std::filesystem::path scribbles{};
  /// The whole picture is one region.
  bool one_region = false;
  /// Parts of each region that follow their neighbours loosely, 1 to 8.
  int split = 1;
  /// TOML that refuses or turns paths, sets orders and speeds, and pins where something went;
  /// `freshet synth stills --keys` explains it.
  std::filesystem::path edits{};
  /// Mean time between stills, s, 0.04 to 60.
  double step_s = 0.5;
  /// Speed factor, 0.05 to 20.
  double speed = 1;
  /// Freedom to leave the paths, 0.0001 to 100.
  double sigma = 0.1;
  /// Probability that motion turns within a path, 0 to 1.
  double irregularity = 0.2;
  /// Another seed, another sequence.
  std::uint64_t seed = 1;
  /// px, longer side at which flow between stills is computed, 64 to 8192.
  int flow_side = 960;
};

/// A part of the scene that goes through the stills in an order of its own.
struct StillsRegion {
  std::string name;
  std::string kind;                   // "independent" or "slow"
  std::vector<std::string> sequence;  // file names, as they are shown
};

/// Stills ordered into a film. Same stills and options, same bytes, for any number of threads.
///
///   StillsFilm film("harbour", {.loop = true});
///   film.render([&](const cv::Mat& frame) { video.write(frame); });
class StillsFilm {
 public:
  /// folder   2 to 200 pictures of one size, at least 64 px a side, in any order.
  /// Reads, aligns, finds regions and orders. The stills are held: 3 bytes a pixel, 6 of 16 bits.
  /// Throws   Error{kInput} naming the file and the remedy: no folder, too few stills, unlike sizes, stills that fit
  ///          nowhere, nothing that moves, regions or edits that do not fit; Error{kUsage}: options out of range or
  ///          that do not go together; Error{kCancelled}.
  explicit StillsFilm(const std::filesystem::path& folder, const StillsOptions& options = {},
                      const Job& job = {});
  StillsFilm(const StillsFilm&) = delete;
  StillsFilm& operator=(const StillsFilm&) = delete;
  ~StillsFilm();

  cv::Size size() const;
  int frames() const;
  double fps() const;
  const std::vector<StillsRegion>& regions() const;
  /// For a person: what was left out, aligned, proposed.
  const std::vector<std::string>& notices() const;
  /// Hands every frame to `sink`, in order, valid during the call: CV_8UC3 BGR, or CV_16UC3 where a still has 16 bits.
  /// As often as wanted, also from several threads. Throws Error{kCancelled}, and what the sink throws.
  void render(const std::function<void(const cv::Mat& frame)>& sink, const Job& job = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet
