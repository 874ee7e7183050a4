#include "synth/scene/rendering/footage_frames.h"

#include <algorithm>
#include <utility>

namespace freshet::synth::scene {
namespace {

constexpr int kFadeLeast = 4;  // frames
constexpr double kJump = 1.5;  // times what changes from frame to frame

struct Read {
  int frames = 0;
  bool comes_round = false;
};

/// Reads on until the end, or `most` frames.
Read read_through(const std::filesystem::path& file, int most) {
  FootageReader reader(file);
  Read read;
  cv::Mat first, before;
  double steps = 0;
  while (read.frames < most && (read.frames == 0 || !reader.at_end())) {
    const cv::Mat& frame = reader.next();
    if (read.frames++ == 0) first = frame.clone();
    if (!before.empty()) steps += cv::norm(frame, before, cv::NORM_L1);
    frame.copyTo(before);
  }
  const double mean = read.frames > 1 ? steps / (read.frames - 1) : 0;
  read.comes_round = reader.at_end() && cv::norm(before, first, cv::NORM_L1) <= kJump * mean;
  return read;
}

std::vector<int> split(int frames, int parts) {
  std::vector<int> lengths;
  for (int i = 0; i < parts; ++i)
    lengths.push_back(static_cast<int>(1LL * frames * (i + 1) / parts - 1LL * frames * i / parts));
  return lengths;
}

}  // namespace

FootageCourse footage_course(int scene_frames, bool loop, int footage_frames, bool comes_round) {
  const int n = footage_frames, all = scene_frames;
  if (n == 1 || (!loop && (n >= all || comes_round)) || (comes_round && all % n == 0))
    return {.lengths = {all}};
  if (comes_round) return {.lengths = {all}, .fade = std::min(kFadeMost, all / 2), .from_last = true};
  const int wanted = std::clamp(n / 4, 1, kFadeMost);
  if (!loop) {
    FootageCourse course{.lengths = {}, .fade = std::min(wanted, n - wanted)};
    for (int left = all; left > 0; left -= n - wanted) course.lengths.push_back(std::min(left, n - wanted));
    return course;
  }
  const int parts = n >= all + kFadeLeast ? 1 : (all + n - wanted - 1) / (n - wanted);
  FootageCourse course{.lengths = split(all, parts), .fade = 0, .from_last = true};
  const auto [shortest, longest] = std::minmax_element(course.lengths.begin(), course.lengths.end());
  course.fade = std::min({kFadeMost, n - *longest, *shortest - 1});
  return course;
}

FootageFrames::FootageFrames(const std::filesystem::path& file, cv::Point at, int scene_frames, bool loop,
                             int width)
    : file_(file), at_(at), width_(width) {
  const Read read = read_through(file, scene_frames + (loop ? kFadeMost : 0));
  course_ = footage_course(scene_frames, loop, read.frames, read.comes_round);
  playing_ = std::make_unique<FootageReader>(file_, width_);
  if (!course_.from_last) return;
  before_ = std::make_unique<FootageReader>(file_, width_);
  for (int i = 0; i < course_.lengths.back(); ++i) before_->next();
}

const cv::Mat& FootageFrames::next() {
  if (place_ == course_.lengths[which_]) {
    before_ = std::exchange(playing_, std::make_unique<FootageReader>(file_, width_));
    which_ = (which_ + 1) % course_.lengths.size();
    place_ = 0;
  }
  playing_->next().copyTo(frame_);
  if (place_ < course_.fade && before_ != nullptr) {
    const double share = (place_ + 1.0) / (course_.fade + 1);
    cv::addWeighted(frame_, share, before_->next(), 1 - share, 0, frame_);
  }
  ++place_;
  return frame_;
}

}  // namespace freshet::synth::scene
