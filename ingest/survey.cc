#include "ingest/survey.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "ingest/aside.h"
#include "media/frame/frame.h"

namespace freshet::ingest {
namespace {

constexpr int kSlab = 16;        // frames decoded at a time
constexpr int kMostReasons = 8;  // of pieces, where nothing is fit

// Of a cut between two frames of a camera that moves.
constexpr float kMinChange = 0.03f, kMinDecorrelation = 0.5f;
constexpr double kMinLost = 0.9;  // of the points that were followed

struct Take {
  int first = 0, last = 0;
  CameraMotion camera;
  std::vector<CameraWindow> windows;  // frames count from the take's first
};

std::string seconds(const Span& span) { return fmt::format("{:.2f} to {:.2f} s", span.from_s, span.to_s); }

}  // namespace

int Survey::fit() const { return static_cast<int>(std::ranges::count_if(pieces, &Piece::fit)); }

std::string part_name(const std::string& name, const Span& span) {
  return fmt::format("{}@{:.3f}-{:.3f}", name, span.from_s, span.to_s);
}

struct Surveyor::Impl {
  cv::Size source;
  bool steady;
  cv::Size working;
  double fps, diagonal;
  ScreeningLimits limits;
  ChangeMeter meter;
  std::deque<cv::Mat> waiting;  // frames whose take is not known yet
  int measured = 0;             // frames that a take has got
  std::vector<double> times_s;
  std::vector<FrameChange> changes;
  std::optional<CameraTracker> tracker;
  std::vector<Take> takes;

  Impl(cv::Size source_, double fps_, const ScreeningLimits& limits_, bool steady_)
      : source(source_),
        steady(steady_),
        working(screening_size(source)),
        fps(fps_),
        diagonal(std::hypot(working.width, working.height)),
        limits(limits_),
        meter(working) {}

  /// A camera that shakes or pans changes so much from frame to frame that a cut does not stand out; what it shows goes
  /// from frame to frame all the same.
  bool shows_another_scene(int frame) {
    const FrameChange& change = changes[frame - 1];
    return change.difference >= kMinChange && change.decorrelation >= kMinDecorrelation &&
           tracker->lost(waiting.front()) >= kMinLost;
  }

  bool begins_take(int frame) {
    const double gap_s = times_s[frame] - times_s[frame - 1];
    return is_cut(changes, frame - 1) || (gap_s > limits.max_gap_s && gap_s * fps > 3) ||
           shows_another_scene(frame);
  }

  void end_take() {
    if (takes.empty()) return;
    Take& take = takes.back();
    take.last = measured;
    take.camera = tracker->finish();
    take.windows = tracker->windows();
  }

  /// The frame that waits longest: all changes that tell a cut there are known.
  void measure() {
    if (measured == 0 || begins_take(measured)) {
      end_take();
      takes.push_back({.first = measured, .last = 0, .camera = {}, .windows = {}});
      tracker.emplace(working, fps);
    }
    tracker->add(waiting.front());
    waiting.pop_front();
    ++measured;
  }

  Span span(int first, int last) const {
    const int n = static_cast<int>(times_s.size());
    // A frame before a gap is shown for as long as the one before it, not through the gap.
    const bool followed = last < n && times_s[last] - times_s[last - 1] <= limits.max_gap_s;
    const double after_s =
        times_s[last - 1] + (last - first > 1 ? times_s[last - 1] - times_s[last - 2] : 1 / fps);
    return {first, last, times_s[first], followed ? times_s[last] : after_s};
  }

  Verdict verdict_on(int first, int last, const CameraMotion& camera) const {
    Screening screening;
    screening.frames = last - first;
    screening.camera = camera;
    const std::span<const FrameChange> all(changes);
    screening.duplicated_fraction = duplicated_fraction(all.subspan(first, last - first - 1));
    screening.timing = timing_of(std::span(times_s).subspan(first, last - first));
    return judge(screening, limits);
  }

  /// Windows first..last - 1 of a take, as frames of the film. The rest after the last window goes with it.
  std::pair<int, int> frames_of(const Take& take, std::size_t first, std::size_t last) const {
    return {take.first + take.windows[first].first,
            last == take.windows.size() ? take.last : take.first + take.windows[last - 1].last};
  }

  bool stands(const Take& take, std::size_t first, std::size_t last) const {
    const std::span<const CameraWindow> run = std::span(take.windows).subspan(first, last - first);
    const CameraMotion motion = motion_of(run, diagonal);
    return run.front().referenced && run.back().referenced && motion.reference_fraction() >= 0.5 &&
           motion.shake <= limits.max_shake;
  }

  /// The longest run of windows within begin..end in which the camera stands. Its drift grows with its length, so
  /// the farthest end moves on with the beginning.
  std::pair<std::size_t, std::size_t> longest_standing(const Take& take, std::size_t begin,
                                                       std::size_t end) const {
    std::pair<std::size_t, std::size_t> longest{begin, begin};
    std::size_t reach = begin;
    const auto drift = [&](std::size_t first, std::size_t last) {
      return motion_of(std::span(take.windows).subspan(first, last - first), diagonal).drift;
    };
    const auto reaches = [&](std::size_t first, std::size_t last) {
      return drift(last, last + 1) <= limits.max_stretch_speed &&
             drift(first, last + 1) <= limits.max_stretch_drift;
    };
    for (std::size_t first = begin; first < end; ++first) {
      reach = std::max(reach, first);
      while (reach < end && reaches(first, reach)) ++reach;
      for (std::size_t last = reach; last > first + (longest.second - longest.first); --last)
        if (stands(take, first, last)) {
          longest = {first, last};
          break;
        }
    }
    return longest;
  }

  /// What does not stand is made steady, or left out.
  void leave_out(const Take& take, std::size_t begin, std::size_t end, std::vector<Piece>& pieces) const {
    if (begin == end) return;
    std::size_t at = begin, left = begin;  // windows from `left` on are in no piece yet
    std::vector<std::string> why;
    while (steady && at < end) {
      const SteadyRun run = steady_run(std::span(take.windows).subspan(at, end - at), working);
      const int first = take.windows[at].first,
                last = run.windows > 0 ? take.windows[at + run.windows - 1].last : first;
      if ((last - first) / fps >= limits.min_stretch_s && last - first >= limits.min_frames) {
        refuse(take, left, at, why, pieces);
        Piece piece{span(take.first + first, take.first + last), {}, {}, {}, {}, {}};
        piece.steady = steady_path(std::span(take.windows).subspan(at, run.windows), working, source);
        pieces.push_back(std::move(piece));
        why.clear();
        at = left = at + run.windows;
      } else {
        if (!run.refusal.empty()) why.push_back(run.refusal);
        ++at;
      }
    }
    refuse(take, left, end, why, pieces);
    // A rest of less than a window goes with a piece that is left out only.
    const int last = frames_of(take, begin, end).second;
    if (pieces.back().span.last < last)
      pieces.push_back({span(pieces.back().span.last, last),
                        {"too short a rest of a take that was made steady"},
                        {},
                        {},
                        {},
                        {}});
  }

  void refuse(const Take& take, std::size_t begin, std::size_t end, const std::vector<std::string>& why,
              std::vector<Piece>& pieces) const {
    if (begin == end) return;
    const auto [first, last] = frames_of(take, begin, end);
    const CameraMotion motion = motion_of(std::span(take.windows).subspan(begin, end - begin), diagonal);
    Verdict verdict = verdict_on(first, last, motion);
    if (verdict.refusals.empty()) {
      verdict.refusals.push_back(
          "the camera moves in this take, and here it does not stand still for long enough, or nothing solid "
          "shows "
          "it");
      verdict.help.push_back(kStandStill);
    }
    for (const std::string& reason : why)
      if (std::ranges::find(verdict.refusals, reason) == verdict.refusals.end())
        verdict.refusals.push_back(reason);
    pieces.push_back({span(first, last), std::move(verdict.refusals), {}, std::move(verdict.help), {}, {}});
  }

  /// The stretches of windows begin..end - 1 that are fit, and what lies between them.
  void find_stretches(const Take& take, std::size_t begin, std::size_t end,
                      std::vector<Piece>& pieces) const {
    if (begin == end) return;
    const auto [from, to] = longest_standing(take, begin, end);
    const auto [first, last] = from < to ? frames_of(take, from, to) : std::pair{0, 0};
    const double length_s = (last - first) / fps;
    if (last - first < limits.min_frames || length_s < limits.min_stretch_s ||
        !verdict_on(first, last, motion_of(std::span(take.windows).subspan(from, to - from), diagonal))
             .refusals.empty()) {
      leave_out(take, begin, end, pieces);
      return;
    }
    find_stretches(take, begin, from, pieces);
    pieces.push_back({span(first, last), {}, {}, {}, {}, {}});
    find_stretches(take, to, end, pieces);
  }

  void judge_take(const Take& take, std::vector<Piece>& pieces) const {
    Verdict verdict = verdict_on(take.first, take.last, take.camera);
    const CameraMotion& camera = take.camera;
    const bool moves = camera.drift > limits.max_drift || camera.shake > limits.max_shake;
    if (!verdict.refusals.empty() && moves && take.last - take.first >= limits.min_frames &&
        !take.windows.empty()) {
      std::vector<Piece> found;
      find_stretches(take, 0, take.windows.size(), found);
      if (std::ranges::any_of(found, &Piece::fit)) {
        pieces.insert(pieces.end(), found.begin(), found.end());
        return;
      }
    }
    pieces.push_back({span(take.first, take.last),
                      std::move(verdict.refusals),
                      std::move(verdict.notes),
                      std::move(verdict.help),
                      {},
                      {}});
  }
};

Surveyor::Surveyor(cv::Size source, double fps, const ScreeningLimits& limits, bool steady)
    : impl_(std::make_unique<Impl>(source, fps, limits, steady)) {}
Surveyor::~Surveyor() = default;

void Surveyor::add(const cv::Mat& luma, double time_s) {
  Impl& impl = *impl_;
  cv::Mat small = luma;
  if (luma.size() != impl.working) cv::resize(luma, small, impl.working, 0, 0, cv::INTER_AREA);
  if (const auto change = impl.meter.add(small)) impl.changes.push_back(*change);
  impl.waiting.push_back(std::move(small));
  impl.times_s.push_back(time_s);
  if (impl.waiting.size() > static_cast<std::size_t>(kCutNeighbours)) impl.measure();
}

Survey Surveyor::finish() {
  Impl& impl = *impl_;
  while (!impl.waiting.empty()) impl.measure();
  impl.end_take();
  Survey survey;
  if (impl.takes.empty()) return survey;
  survey.whole = impl.span(0, impl.measured);
  survey.takes = static_cast<int>(impl.takes.size());
  std::vector<Piece> pieces;
  for (const Take& take : impl.takes) impl.judge_take(take, pieces);
  if (pieces.size() > 1 && std::ranges::none_of(pieces, &Piece::fit)) {
    // Nothing can be taken: one row, and not one for each part.
    Piece all{survey.whole, {fmt::format("{} takes, none of which is fit", survey.takes)}, {}, {}, {}, {}};
    for (std::size_t i = 0; i < std::min<std::size_t>(pieces.size(), kMostReasons); ++i) {
      for (const std::string& refusal : pieces[i].refusals)
        all.refusals.push_back(fmt::format("{}: {}", seconds(pieces[i].span), refusal));
      for (const std::string& help : pieces[i].help)
        if (std::ranges::find(all.help, help) == all.help.end()) all.help.push_back(help);
    }
    pieces = {std::move(all)};
  }
  survey.pieces = std::move(pieces);
  return survey;
}

Survey survey(media::VideoReader& reader, double fps, const ScreeningLimits& limits, bool steady,
              bool pictures, const std::string& where, const std::function<void(std::uint32_t)>& on_slab,
              const std::stop_token& stop) {
  struct Slab {
    std::vector<cv::Mat> luma;
    std::vector<double> times_s;
  };
  cv::Size size;
  std::optional<FilmLook> film_look;
  FilmTrace trace(fps);
  if (pictures) film_look.emplace(fps);
  const auto decode = [&] {
    Slab slab;
    while (slab.luma.size() < kSlab && !stop.stop_requested()) {
      const std::optional<media::Frame> frame = reader.next();
      if (!frame) break;
      const cv::Mat luma = media::to_luma(*frame);
      size = luma.size();
      cv::resize(luma, slab.luma.emplace_back(), screening_size(size), 0, 0, cv::INTER_AREA);
      if (film_look) film_look->add(*frame, slab.luma.back());
      trace.add(slab.luma.back());
      slab.times_s.push_back(frame->time_s);
    }
    return slab;
  };
  std::optional<Surveyor> surveyor;
  std::uint32_t frames = 0;
  for (Slab slab = decode(); !slab.luma.empty();) {
    if (!surveyor) surveyor.emplace(size, fps, limits, steady);
    Slab following;
    Aside decoding([&] { following = decode(); });
    for (std::size_t i = 0; i < slab.luma.size(); ++i) surveyor->add(slab.luma[i], slab.times_s[i]);
    frames += static_cast<std::uint32_t>(slab.luma.size());
    on_slab(frames);
    decoding.wait();
    slab = std::move(following);
  }
  if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, where, "stopped while it was looked at");
  if (!surveyor) return {};
  Survey result = surveyor->finish();
  result.complaint = reader.complaint();
  result.trace = std::move(trace);
  if (film_look)
    for (Piece& piece : result.pieces) piece.look = film_look->look(piece.span.first, piece.span.last);
  return result;
}

}  // namespace freshet::ingest
