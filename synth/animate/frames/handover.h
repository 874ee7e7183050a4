// synth/animate/frames/handover.h — finished frames handed on, in order, while others are made.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include <oneapi/tbb/task_group.h>
#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// One batch is on its way at a time. One thread takes; the sink is called from another.
class Handover {
 public:
  /// sink  outlives this.
  explicit Handover(const std::function<void(const cv::Mat&)>& sink) : sink_(sink) {}
  Handover(const Handover&) = delete;
  Handover& operator=(const Handover&) = delete;
  ~Handover() {
    try {
      group_.wait();
    } catch (...) {  // what is on its way out already is said instead
    }
  }

  /// Waits until those before are handed on; throws what the sink threw.
  void take(std::vector<cv::Mat> frames) {
    wait();
    frames_ = std::move(frames);
    group_.run([this] {
      for (const cv::Mat& frame : frames_) sink_(frame);
    });
  }
  void wait() { group_.wait(); }

 private:
  const std::function<void(const cv::Mat&)>& sink_;
  std::vector<cv::Mat> frames_;
  oneapi::tbb::task_group group_;
};

}  // namespace freshet::synth::animate
