// synth/scene/frames/pushed_frames.h — a layer whose frames are made beside the rendering.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include <opencv2/core.hpp>

#include "synth/scene/rendering/layer_frames.h"

namespace freshet::synth::scene {

/// Frames that a function pushes, pulled one by one: it runs in a thread of its own, and waits where it is three frames
/// ahead. The last frame stays.
class PushedFrames : public LayerFrames {
 public:
  using Sink = std::function<void(const cv::Mat&)>;
  /// make   pushes frames of the picture's size, as LayerFrames has them; what it throws is thrown by next().
  explicit PushedFrames(std::function<void(const Sink&)> make);
  /// Ends the maker with its next frame.
  ~PushedFrames() override;

  const cv::Mat& next() override;
  cv::Point at() const override { return {0, 0}; }

 private:
  struct Left {};
  void push(const cv::Mat& frame);

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<cv::Mat> waiting_;
  cv::Mat frame_;
  std::exception_ptr fault_;
  bool done_ = false, left_ = false;
  std::jthread thread_;
};

}  // namespace freshet::synth::scene
