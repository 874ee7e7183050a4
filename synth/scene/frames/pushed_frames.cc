#include "synth/scene/frames/pushed_frames.h"

#include <cstddef>
#include <utility>

namespace freshet::synth::scene {
namespace {

constexpr std::size_t kAhead = 3;

}  // namespace

PushedFrames::PushedFrames(Make make, FrameWork work) {
  thread_ = std::jthread([this, make = std::move(make), work] {
    try {
      Sinks sinks{.frame = [this](const cv::Mat& frame) { push(frame); }, .motion = {}};
      if (work == FrameWork::kFramesAndMotion)
        sinks.motion = [this](const cv::Mat& motion) {
          const std::scoped_lock lock(mutex_);
          motions_.push_back(motion.clone());
        };
      make(sinks);
    } catch (...) {
      const std::scoped_lock lock(mutex_);
      fault_ = std::current_exception();
    }
    const std::scoped_lock lock(mutex_);
    done_ = true;
    changed_.notify_all();
  });
}

PushedFrames::~PushedFrames() {
  {
    const std::scoped_lock lock(mutex_);
    left_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

const cv::Mat& PushedFrames::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !waiting_.empty() || done_; });
  if (!waiting_.empty()) {
    frame_ = waiting_.front();
    waiting_.pop_front();
    if (!motions_.empty()) {
      motion_ = motions_.front();
      motions_.pop_front();
    }
    changed_.notify_all();
    return frame_;
  }
  if (fault_) std::rethrow_exception(fault_);
  return frame_;  // the last one stays
}

void PushedFrames::push(const cv::Mat& frame) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return waiting_.size() < kAhead || left_; });
  if (left_) throw Left{};  // nobody waits for more: the maker ends
  waiting_.push_back(frame.clone());
  changed_.notify_all();
}

}  // namespace freshet::synth::scene
