#include "synth/scene/frames/footage_frames.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "media/frame/file_format.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"

namespace freshet::synth::scene {
namespace {

constexpr int kFadeLeast = 4;  // frames
constexpr double kJump = 1.5;  // times what changes from frame to frame

struct Read {
  int frames = 0;
  bool comes_round = false;
  cv::Mat first{};
};

/// Reads on until the end, or `most` frames.
Read read_through(const std::filesystem::path& file, const FootageForm& form, int most,
                  const std::stop_token& stop) {
  FootageReader reader(file, {.mattes = form.mattes, .mattes_are_alpha = form.mattes_are_alpha});
  Read read;
  cv::Mat before;
  double steps = 0;
  while (read.frames < most && (read.frames == 0 || !reader.at_end())) {
    if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, file.string(), "stopped");
    const cv::Mat& frame = reader.next();
    if (read.frames++ == 0) read.first = frame.clone();
    if (!before.empty()) steps += cv::norm(frame, before, cv::NORM_L1);
    frame.copyTo(before);
  }
  const double mean = read.frames > 1 ? steps / (read.frames - 1) : 0;
  read.comes_round = reader.at_end() && cv::norm(before, read.first, cv::NORM_L1) <= kJump * mean;
  return read;
}

/// And not a picture, which lies still.
bool is_film(const std::filesystem::path& matte) {
  return media::is_pattern(matte) || std::filesystem::is_directory(matte) || (media::looks_like_video(matte));
}

/// CV_8U of the film's size.
cv::Mat matte_over(const FootageMotion& footage, cv::Size film) {
  expect_shape(footage.matte, media::read_deep_picture(footage.matte).values.size(), footage.file, film);
  return media::read_matte(footage.matte, film).alpha;
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

FootageFrames::FootageFrames(const FootageMotion& footage, int scene_frames, double fps, bool loop,
                             const std::stop_token& stop)
    : footage_(footage), round_(loop ? scene_frames : 0), since_(-start_frame(footage, fps)) {
  const int left = loop ? scene_frames : std::max(1, scene_frames + since_);
  const int most = left + (loop ? kFadeMost : 0);
  form_ = {.width = footage_.width, .ground = footage_.ground};
  if (is_film(footage_.matte))
    form_.mattes = footage_.matte, form_.mattes_are_alpha = has_transparency(footage_.matte, most, stop);
  const Read read = read_through(footage_.file, form_, most, stop);
  if (footage_.ground != media::Ground::kNone)
    form_.ground_depth = ground_depth(FootageReader(footage_.file).next(), footage_.ground);
  if (!footage_.matte.empty() && form_.mattes.empty()) form_.matte = matte_over(footage_, read.first.size());
  comes_round_ = read.frames > 1 && read.comes_round && footage_.repeats;
  if (footage_.repeats || read.frames > left)
    course_ = footage_course(left, loop, read.frames, read.comes_round);
  else
    course_.lengths = {read.frames};
  shown_ = std::accumulate(course_.lengths.begin(), course_.lengths.end(), 0);
  playing_ = reader();
  if (course_.from_last) {
    before_ = reader();
    for (int i = 0; i < course_.lengths.back(); ++i) before_->next();
  }
  if (!loop || since_ == 0) return;
  since_ += round_;
  for (int i = 0; i < std::min(since_, shown_); ++i) next_of_course();
}

std::unique_ptr<FootageReader> FootageFrames::reader() const {
  return std::make_unique<FootageReader>(footage_.file, form_);
}

const cv::Mat& FootageFrames::next() {
  const int since = since_++;
  if (since_ == round_) since_ = 0;
  if (since >= 0 && since < shown_) return next_of_course();
  leading_ = nullptr;
  static const cv::Mat kNothing;
  return kNothing;
}

std::optional<cv::Mat> FootageFrames::motion() {
  if (leading_ == nullptr) return cv::Mat();
  if (const cv::Mat found = leading_->motion(comes_round_); !found.empty()) motion_ = found;
  if (motion_.size() != frame_.size()) motion_ = cv::Mat(frame_.size(), CV_32FC2, cv::Scalar::all(0));
  return motion_;
}

const cv::Mat& FootageFrames::next_of_course() {
  if (place_ == course_.lengths[which_]) {
    before_ = std::exchange(playing_, reader());
    which_ = (which_ + 1) % course_.lengths.size();
    place_ = 0;
  }
  playing_->next().copyTo(frame_);
  leading_ = playing_.get();
  if (place_ < course_.fade && before_ != nullptr) {
    const double share = (place_ + 1.0) / (course_.fade + 1);
    if (share < 0.5) leading_ = before_.get();
    cv::addWeighted(frame_, share, before_->next(), 1 - share, 0, frame_);
  }
  ++place_;
  return frame_;
}

}  // namespace freshet::synth::scene
