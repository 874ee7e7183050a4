#include "synth/tour/film.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/frame/file_format.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"
#include "synth/scene/frames/footage_frames.h"

namespace freshet::synth::tour {
namespace {

constexpr int kMostFrames = 10'000'000;
constexpr double kJump = 1.5;  // times what changes from frame to frame: more is a cut

bool reads_as_still(const std::filesystem::path& path) {
  return !media::is_pattern(path) && !std::filesystem::is_directory(path) && media::looks_like_picture(path);
}

}  // namespace

FilmEnd parse_film_end(const std::string& name) {
  if (name == "repeat") return FilmEnd::kRepeat;
  if (name == "ping-pong") return FilmEnd::kPingPong;
  if (name == "hold") return FilmEnd::kHold;
  throw Error(ErrorKind::kUsage, "film end " + name, "a film does not end so",
              "Choose repeat, ping-pong or hold");
}

struct Film::Length {
  int frames = 0;
  bool comes_round = false;
};

Film::Film(const std::filesystem::path& path) : path_(path) {
  if (reads_as_still(path)) {
    const media::Still still = media::read_still(path);
    notices_ = still.notices;
    deep_ = !still.deep.empty();
    first_ = media::coded_picture(still);
    return;
  }
  reader_ = std::make_unique<media::VideoReader>(path);
  const media::VideoInfo& info = reader_->info();
  fps_ = static_cast<double>(info.fps_num) / static_cast<double>(info.fps_den);
  if (!(fps_ > 0 && fps_ < 1e4)) fps_ = 25;
  const double claimed = info.claimed_frames > 0 ? static_cast<double>(info.claimed_frames)
                                                 : std::round(info.claimed_duration_s * fps_);
  claimed_ = claimed >= 1 && claimed < kMostFrames ? static_cast<int>(claimed) : 0;
  const std::optional<media::Frame> frame = reader_->next();
  if (!frame)
    throw Error(ErrorKind::kInput, path.string(), "no frame of it can be decoded", "Check the file");
  media::to_bgr(*frame).convertTo(first_, CV_32F, 1 / 255.0);
}

int Film::frames() {
  if (is_still()) return 1;
  if (claimed_ == 0) claimed_ = read_through(kMostFrames, nullptr, 0, {}).frames;
  return claimed_;
}

Film::Length Film::read_through(int most, std::vector<cv::Mat>* kept, std::size_t memory_bytes,
                                std::stop_token stop) {
  media::VideoReader reader(path_);
  Length length;
  cv::Mat first, before;
  double steps = 0;
  for (; length.frames < most; ++length.frames) {
    if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, "tour", "stopped");
    const std::optional<media::Frame> next = reader.next();
    if (!next) break;
    const cv::Mat frame = media::to_bgr(*next);
    if (kept != nullptr) {
      if ((kept->size() + 1) * frame.total() * 3 > memory_bytes)
        throw Error(
            ErrorKind::kInput, path_.string(),
            fmt::format("{} frames of it do not fit into {} MB, and who goes backwards needs them all",
                        kept->size() + 1, memory_bytes >> 20),
            "Add --memory, or let it end otherwise: --film-end repeat");
      kept->push_back(frame);
    }
    if (length.frames == 0) first = frame;
    if (!before.empty()) steps += cv::norm(frame, before, cv::NORM_L1);
    before = frame;
  }
  if (length.frames == 0)
    throw Error(ErrorKind::kInput, path_.string(), "no frame of it can be decoded", "Check the file");
  length.comes_round = length.frames > 1 && length.frames < most &&
                       cv::norm(before, first, cv::NORM_L1) <= kJump * steps / (length.frames - 1);
  if (length.frames < most && !reader.complaint().empty()) notices_.push_back(reader.complaint());
  return length;
}

void Film::play(int frames, double fps, FilmEnd end, std::size_t memory_bytes, std::stop_token stop) {
  tour_fps_ = fps;
  end_ = end;
  if (is_still()) return;
  const int needed = static_cast<int>((frames - 1) * fps_ / fps + 1e-6) + 1;
  courses_ = {needed};
  if (needed > 1 && (claimed_ < needed || end == FilmEnd::kPingPong)) {
    const Length length =
        read_through(needed + 1, end == FilmEnd::kPingPong ? &kept_ : nullptr, memory_bytes, stop);
    if (end == FilmEnd::kRepeat) {
      const scene::FootageCourse course =
          scene::footage_course(needed, false, length.frames, length.comes_round);
      fade_ = course.fade;
      courses_ = course.lengths;
    }
  }
  reader_ = std::make_unique<media::VideoReader>(path_);
}

void Film::decode_next() {
  std::optional<media::Frame> next = reader_->next();
  if (!next && end_ == FilmEnd::kRepeat) {  // it comes round
    reader_ = std::make_unique<media::VideoReader>(path_);
    next = reader_->next();
  }
  if (next)
    frame_ = media::to_bgr(*next);
  else
    over_ = true;
}

void Film::step() {
  ++film_frame_;
  if (!kept_.empty()) {
    const int last = static_cast<int>(kept_.size()) - 1, turn = last > 0 ? film_frame_ % (2 * last) : 0;
    frame_ = kept_[static_cast<std::size_t>(turn <= last ? turn : 2 * last - turn)];
    return;
  }
  if (place_ == courses_[course_] && course_ + 1 < courses_.size()) {
    before_ = std::exchange(reader_, std::make_unique<media::VideoReader>(path_));
    ++course_;
    place_ = 0;
  }
  decode_next();
  if (place_ < fade_ && before_ != nullptr)
    if (const std::optional<media::Frame> old = before_->next()) {
      const double share = (place_ + 1.0) / (fade_ + 1);
      cv::addWeighted(frame_, share, media::to_bgr(*old), 1 - share, 0, frame_);
    }
  ++place_;
}

const cv::Mat* Film::next() {
  if (is_still()) return nullptr;
  const int wanted = static_cast<int>(tour_frame_++ * fps_ / tour_fps_ + 1e-6);
  if (wanted == film_frame_) return nullptr;
  while (film_frame_ < wanted && !over_) step();
  return over_ && frame_.empty() ? nullptr : &frame_;
}

}  // namespace freshet::synth::tour
