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

#include <memory>

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

/// Takes a clip's frames one by one. Memory: two small frames and one window of point positions, and 80 bytes
/// for each window. Cost: about 3 ms per frame on one thread, whatever the frame's size.
class CameraTracker {
 public:
  /// size   of the frames that will be added, px; best kWorkingSide on their longer side.
  CameraTracker(cv::Size size, double fps);
  ~CameraTracker();
  CameraTracker(CameraTracker&&) noexcept;
  void add(const cv::Mat& luma);  // CV_8U
  CameraMotion finish();

  static constexpr int kWorkingSide = 384;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::ingest
