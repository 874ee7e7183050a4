// synth/animate/frames/renderer.h — what makes the frames of an animation, a few at a time.
#pragma once

#include <cstddef>
#include <span>

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// One method of making frames; make_frames() calls it. A method is a struct of options and a function
/// make_renderer(Animation&, const StillPart&, const its options&), which does all that is done once; its options are
/// one more alternative of AnimateOptions::method.
///
/// Calls come from one thread, but for step() and finish(). For each batch of frames: read(), then for its frames in
/// groups of some eight prepare(), then step() and finish() for each of the group that is wanted. `outputs` are output
/// frames, ascending but for a loop that begins with another frame than 0; all come once.
class Renderer {
 public:
  virtual ~Renderer() = default;

  /// Frames of one read(), as the memory allows: 1 .. all.
  virtual int batch() const = 0;
  /// The frame that the animation begins with; those before it come last. Of a loop; else 0.
  virtual int first() const { return 0; }
  /// Velocity in an output frame: CV_32FC2, px/s, the picture's size. Asked for where the outline moves.
  virtual cv::Mat motion(int output) const = 0;
  /// Where what an output frame shows goes until the next: CV_32FC2, px, the picture's size; whatever lies beside the
  /// matte. Asked for after prepare(), where motion is written (FrameOptions::motion_sink). From many threads.
  virtual cv::Mat step(int output) const = 0;

  /// Reads what these frames need of the clips.
  virtual void read(std::span<const int> outputs) = 0;
  /// What goes on from frame to frame, and what else finish() needs.
  /// mattes   of these frames, CV_32F 0..1.
  /// passed   so many of them, the first, are not wanted: nobody calls finish() for them.
  virtual void prepare(std::span<const int> outputs, std::span<const cv::Mat> mattes, std::size_t passed) = 0;
  /// One frame, in FrameOptions::form. From many threads.
  virtual cv::Mat finish(int output, const cv::Mat& matte) = 0;
};

}  // namespace freshet::synth::animate
