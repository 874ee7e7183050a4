// include/freshet/ways/tour.h — a camera that goes through an animated picture, frame by frame.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"

namespace freshet {

struct TourOptions {
  /// A tour file (.toml): planes, things, path. Empty: the middle row is the horizon.
  std::filesystem::path plan{};
  /// One of tour_moves(). Empty: the file's path or move; without either "in".
  std::string move{};
  /// How far the move goes, -100 to 100. Nothing, here and below: the file's.
  std::optional<double> amount{};
  /// Row of the horizon, px from above.
  std::optional<double> horizon{};
  /// Number of frames; 0: the path's, or the film's, or 4 s.
  int frames = 0;
  /// Frames per second, to 240; 0: the film's, or 25.
  double fps = 0;
  /// px; 0: the film's. One side 0: in proportion.
  cv::Size size{};
  /// Where the film is shorter: "repeat", "ping-pong" or "hold".
  std::string film_end = "repeat";
};

struct TourFrame {
  cv::Mat picture;  // CV_8UC3 BGR
  cv::Mat
      depth;  // CV_32F: along the camera's axis, in heights of the picture's camera above the floor; 1e10: the sky
};

/// Ready paths: "in", "pan", ...
std::vector<std::string> tour_moves();

/// Same film and options, same bytes, for any number of threads.
///
///   Tour tour("bay.mp4", {.move = "truck", .horizon = 200});
///   for (TourFrame frame; tour.next(frame);) video.write(frame.picture);
class Tour {
 public:
  /// film     A video, a folder or a pattern of pictures, or one picture.
  /// Throws   Error{kInput} naming the file and the remedy: missing, unreadable, no tour, a path that leaves the box of
  ///          planes or looks where the picture shows nothing, a matte of another shape; Error{kUsage}: options that
  ///          do not go together or are out of range; Error{kCancelled}.
  explicit Tour(const std::filesystem::path& film, const TourOptions& options = {}, const Job& job = {});
  Tour(const Tour&) = delete;
  Tour& operator=(const Tour&) = delete;
  ~Tour();

  cv::Size size() const;
  int frames() const;
  double fps() const;
  /// For a person: how far the view was narrowed, what was guessed.
  const std::vector<std::string>& notices() const;
  /// Frame 0, then 1, ... false, and frame untouched, after the last. Mats of the right size and type are written in
  /// place: clone what must outlive the next call. Throws Error{kInput} as the film's decoder.
  bool next(TourFrame& frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet
