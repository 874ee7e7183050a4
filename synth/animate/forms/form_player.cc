#include "synth/animate/forms/form_player.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include <opencv2/imgproc.hpp>

#include "stored/clip_loop.h"
#include "synth/animate/forms/light_level.h"

namespace freshet::synth::animate {
namespace {

constexpr std::uint32_t kDarkOf = 20;  // frames that the clip's ground is found from
constexpr double kTaper = 0.08;        // of the form's height, at the sides of its rectangle
constexpr double kOwnPace = 0.1;       // rates that differ by no more play frame by frame

std::vector<double> times_of(const store::Snapshot& snapshot, store::ClipId clip) {
  return snapshot.column<double>(clip, "frame.time");
}

double interval_of(const std::vector<double>& times) {
  return times.size() > 1 ? (times.back() - times.front()) / static_cast<double>(times.size() - 1) : 0.04;
}

/// Frames between frames are made of two, and soft: a clip of nearly the animation's rate plays frame by frame.
double speed_of(double interval, const FormPlaying& playing) {
  const double frame = interval * playing.fps;
  return std::abs(frame / playing.speed - 1) <= kOwnPace ? frame : playing.speed;
}

std::vector<playing::Moment> moments_of(const store::Snapshot& snapshot, store::ClipId clip,
                                        std::uint32_t first, const FormPlaying& playing) {
  const std::vector<double> times = times_of(snapshot, clip);
  const double interval = interval_of(times), speed = speed_of(interval, playing);
  const int before = static_cast<int>(std::lround((times[first] - times.front()) * playing.fps / speed));
  std::vector<playing::Moment> moments =
      playing::timeline(times, interval, stored::loop_rule(snapshot, clip), snapshot.clip(clip).name,
                        {.frames = before + playing.frames + 1, .fps = playing.fps, .speed = speed});
  moments.erase(moments.begin(), moments.begin() + before);
  return moments;
}

/// By px: 0 inside, 1 at the sides of a rectangle.
cv::Mat taper(cv::Size size, double width) {
  cv::Mat gone(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double near = std::min({x + 0.5, size.width - x - 0.5, y + 0.5, size.height - y - 0.5}) / width;
      gone.at<float>(y, x) = static_cast<float>(std::clamp(1 - near, 0.0, 1.0));
    }
  return gone;
}

cv::Rect rounded(const cv::Rect2d& rect) {
  const cv::Point corner(cvRound(rect.x), cvRound(rect.y));
  return {corner, cv::Point(std::max(corner.x + 2, cvRound(rect.x + rect.width)),
                            std::max(corner.y + 2, cvRound(rect.y + rect.height)))};
}

}  // namespace

bool plays(const store::Snapshot& snapshot, store::ClipId clip, std::uint32_t first,
           const FormPlaying& playing) {
  const std::vector<double> times = times_of(snapshot, clip);
  const double interval = interval_of(times);
  if ((playing.frames + 1) * speed_of(interval, playing) / playing.fps <= times.back() - times[first])
    return true;
  return stored::loop_rule(snapshot, clip).has_value();
}

FormPlayer::FormPlayer(const store::Snapshot& snapshot, store::ClipId clip, int flow_step,
                       const ChosenForm& form, const FormPlaying& playing, stored::DecodedTiles* tiles)
    : from_(form.from),
      rect_(rounded(form.to)),
      mirrored_(form.mirrored),
      moments_(moments_of(snapshot, clip, form.first, playing)),
      last_flow_(std::max(1u, snapshot.clip(clip).flow.frames) - 1),
      luma_(snapshot, clip, ClipLuma::Size::kWhole, std::span(&from_, 1), flow_step, tiles) {
  const std::uint32_t count = snapshot.clip(clip).frame_count, samples = std::min(count, kDarkOf);
  std::vector<std::uint32_t> at;
  for (std::uint32_t i = 0; i < samples; ++i) at.push_back(i * count / samples);
  luma_.load(at);
  std::vector<cv::Mat> frames;
  for (const std::uint32_t frame : at) {
    cv::Mat row(1, from_.width, CV_32F), plane(from_.size(), CV_8U);
    for (int y = 0; y < from_.height; ++y) {
      luma_.row(frame, from_.x, from_.y + y, from_.width, row.ptr<float>());
      row.convertTo(plane.row(y), CV_8U, 255);
    }
    frames.push_back(plane);
  }
  cv::Mat dark;
  darkest(frames).convertTo(dark, CV_32F, 1.0 / 255);
  dark_ = light_of(dark);
  gone_ = taper(rect_.size(), std::max(2.0, kTaper * form.seat.height()));
}

void FormPlayer::load(const std::vector<int>& moments) {
  std::set<std::uint32_t> frames, flows;
  for (const int i : moments) {
    playing::each_frame(moments_[i], [&](std::uint32_t frame, double) { frames.insert(frame); });
    for (int k = 0; k < moments_[i].count(); ++k)
      if (const double at = moments_[i].at[k]; at > std::floor(at))
        flows.insert(std::min(static_cast<std::uint32_t>(at), last_flow_));
  }
  luma_.load(std::vector(frames.begin(), frames.end()), std::vector(flows.begin(), flows.end()));
}

cv::Mat FormPlayer::level_at(double at) const {
  cv::Mat level(from_.size(), CV_32F);
  ClipLuma::Scratch scratch;
  std::vector<float> cell_luma(static_cast<std::size_t>(ClipLuma::kCellWidth) * ClipLuma::kCellHeight);
  const cv::Rect all({}, from_.size());
  for (int y = 0; y < all.height; y += ClipLuma::kCellHeight)
    for (int x = 0; x < all.width; x += ClipLuma::kCellWidth) {
      const cv::Rect cell = cv::Rect(x, y, ClipLuma::kCellWidth, ClipLuma::kCellHeight) & all;
      luma_.at(at, cell + from_.tl(), cell_luma.data(), scratch);
      cv::Mat(cell.size(), CV_32F, cell_luma.data()).copyTo(level(cell));
    }
  for (int y = 0; y < level.rows; ++y) {
    auto* row = level.ptr<float>(y);
    const auto* dark = dark_.ptr<float>(y);
    for (int x = 0; x < level.cols; ++x) row[x] = level_of(light_of(row[x]) - kLit * dark[x]);
  }
  cv::Mat out;
  const bool reduced = rect_.width < from_.width;
  cv::resize(level, out, rect_.size(), 0, 0, reduced ? cv::INTER_AREA : cv::INTER_CUBIC);
  if (mirrored_) cv::flip(out, out, 1);
  return out;
}

cv::Mat FormPlayer::level(int index) const {
  const playing::Moment& moment = moments_[index];
  cv::Mat level = level_at(moment.at[0]);
  if (moment.count() == 2) {
    const cv::Mat next = level_at(moment.at[1]);
    const float gone = moment.weight[1] / (moment.weight[0] + moment.weight[1]);
    for (int y = 0; y < level.rows; ++y) {
      auto* row = level.ptr<float>(y);
      const auto* other = next.ptr<float>(y);
      for (int x = 0; x < level.cols; ++x)
        row[x] = std::max(thinned(row[x], gone), thinned(other[x], 1 - gone));
    }
  }
  for (int y = 0; y < level.rows; ++y) {
    auto* row = level.ptr<float>(y);
    const auto* gone = gone_.ptr<float>(y);
    for (int x = 0; x < level.cols; ++x) row[x] = std::min(1.0f, thinned(std::max(row[x], 0.0f), gone[x]));
  }
  return level;
}

}  // namespace freshet::synth::animate
