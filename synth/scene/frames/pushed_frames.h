// synth/scene/frames/pushed_frames.h — a layer whose frames are made beside the rendering.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include <opencv2/core.hpp>

#include "synth/scene/rendering/layer_frames.h"

namespace freshet::synth::scene {

/// Frames that a function pushes, pulled one by one: it runs in a thread of its own, and waits where it is three frames
/// ahead. The last frame stays.
class PushedFrames : public LayerFrames {
 public:
  /// Where a maker leaves what it makes, each in the order of the frames, from any thread.
  struct Sinks {
    std::function<void(const cv::Mat&)> frame;  // of the picture's size, as LayerFrames has them
    std::function<void(const cv::Mat&)>
        motion;  // of a frame, before it comes itself; empty: none is asked for
  };
  using Make = std::function<void(const Sinks&)>;
  /// make   what it throws is thrown by next(). It may leave no motion at all: then none is known.
  explicit PushedFrames(Make make, FrameWork work = FrameWork::kFrames);
  /// Ends the maker with its next frame.
  ~PushedFrames() override;

  const cv::Mat& next() override;
  std::optional<cv::Mat> motion() override { return motion_; }
  cv::Point at() const override { return {0, 0}; }

 private:
  struct Left {};
  void push(const cv::Mat& frame);

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<cv::Mat> waiting_, motions_;
  cv::Mat frame_;
  std::optional<cv::Mat> motion_;
  std::exception_ptr fault_;
  bool done_ = false, left_ = false;
  std::jthread thread_;
};

}  // namespace freshet::synth::scene
