// camera_track.h — how far the camera moved, as seen from things that keep their appearance.
//
// Fluids change while they move, solid things do not. Corner points are followed by Lucas-Kanade for a window
// of about a second. They are dropped as soon as they stop looking like what they were (normalised
// correlation with the window's first frame below 0.8). What survives is judged as a group. When most of the
// survivors agree on one similarity transform, and are spread over the frame, they are the scene, and
// their motion is the camera's.
//
// Drifting clouds survive too, but agree badly: 9 to 52 in a hundred fit one similarity to within one pixel
// per second, against 60 to 100 where a camera moves (clips: see screening.h). Clouds that creep agree
// better; where they do, what stands still is taken for the scene.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::ingest {

struct CameraMotion {
  int windows = 0;             // looked at
  int referenced_windows = 0;  // in which something solid was found
  /// Largest distance between the scene's places at any two moments, fraction of the diagonal.
  double drift = 0;
  double shake = 0;  // rms of its motion faster than about 0.4 s, fraction of the diagonal
  double reference_fraction() const {
    return windows > 0 ? static_cast<double>(referenced_windows) / windows : 0;
  }
};

/// A window, and what it tells.
struct CameraWindow {
  using Corners = std::array<cv::Point2d, 5>;  // of the scene that the first frame showed, and its centre
  int first = 0, last = 0;                     // its frames; the next window begins with its last
  bool referenced = false;                     // something solid was found
  Corners before{}, after{};                   // px; the same without reference
  double shake_squares = 0;                    // px^2, of shake_count frames
  std::size_t shake_count = 0;
  /// Of frames first to last: where each point of the first frame's scene is, if referenced.
  std::vector<cv::Matx33d> path;
};

/// What windows that follow each other tell together. diagonal   px, of the frames.
CameraMotion motion_of(std::span<const CameraWindow> windows, double diagonal);

/// Takes a clip's frames one by one. Memory: two small frames and one window of point positions, 200 bytes
/// for each window and 72 for each frame of it. Cost: about 3 ms per frame on one thread, whatever the frame's size.
class CameraTracker {
 public:
  /// size   of the frames that will be added, px; best kWorkingSide on their longer side.
  CameraTracker(cv::Size size, double fps);
  ~CameraTracker();
  CameraTracker(CameraTracker&&) noexcept;
  void add(const cv::Mat& luma);  // CV_8U
  /// Share of the points followed so far that this frame, the one to be added next, no longer shows; 0 where fewer than
  /// a dozen are left to tell. Each is looked for once, here or in add.
  double lost(const cv::Mat& luma);
  CameraMotion finish();
  /// All windows so far.
  const std::vector<CameraWindow>& windows() const;

  static constexpr int kWorkingSide = 384;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::ingest
