#include "ingest/camera_track.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace freshet::ingest {
namespace {

// Measured on 50 clips with the camera known: see screening.h.
constexpr int kCellsAcross = 24;     // corner points: the best of each of 24 cells along the longer side
constexpr double kMinCorner = 2e-4;  // smaller eigenvalue, cv::cornerMinEigenVal, block 5
constexpr int kTemplate = 11;        // px, side of the pattern that must keep its appearance
constexpr int kMargin = kTemplate / 2 + 1;  // px from the frame's edge
constexpr double kMinCorrelation = 0.8;
constexpr double kInlier = 1.0;       // px
constexpr int kMinGroup = 12;         // points
constexpr double kMinCoherent = 0.6;  // of the survivors agree on one similarity: they are the scene
constexpr double kMinCoherentOverStatic = 0.85;  // ... where enough stands still to be the scene itself
constexpr int kMinCoherentCells = 6;             // of 4 x 4 parts of the frame that they lie in
constexpr double kMinStatic = 0.35;              // of the survivors stand still: they are, the rest floats by
constexpr int kMinStaticCells = 3;
constexpr double kShakeSpan_s = 0.2;  // motion is smoothed over so much before and after

using Corners = CameraWindow::Corners;

/// Zero-mean normalised correlation of two patterns.
class PatternCheck {
 public:
  double operator()(const cv::Mat& a, cv::Point2f at_a, const cv::Mat& b, cv::Point2f at_b) {
    cv::getRectSubPix(a, {kTemplate, kTemplate}, at_a, a_, CV_32F);
    cv::getRectSubPix(b, {kTemplate, kTemplate}, at_b, b_, CV_32F);
    a_ -= cv::mean(a_);
    b_ -= cv::mean(b_);
    return a_.dot(b_) / (std::sqrt(a_.dot(a_) * b_.dot(b_)) + 1e-3);
  }

 private:
  cv::Mat a_, b_;
};

int cells_of(const std::vector<cv::Point2f>& points, const std::vector<int>& group, cv::Size size) {
  std::array<bool, 16> taken{};
  for (const int i : group) {
    const int column = std::clamp(static_cast<int>(points[i].x * 4 / size.width), 0, 3);
    const int row = std::clamp(static_cast<int>(points[i].y * 4 / size.height), 0, 3);
    taken[row * 4 + column] = true;
  }
  return static_cast<int>(std::ranges::count(taken, true));
}

double distance(const Corners& a, const Corners& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).ddot(a[i] - b[i]);
  return std::sqrt(sum / a.size());
}

/// The similarity that takes the points of a group nearest to where they went, in the sense of least squares (Umeyama
/// 1991); points that it leaves a pixel behind are left out once. turns   false: a translation.
cv::Matx33d similarity_of(const std::vector<cv::Point2f>& from, const std::vector<cv::Point2f>& to,
                          std::vector<int> group, bool turns) {
  cv::Matx33d m = cv::Matx33d::eye();
  for (int round = 0; round < 2; ++round) {
    const double n = static_cast<double>(group.size());
    cv::Point2d mean_from, mean_to;
    for (const int i : group) {
      mean_from += cv::Point2d(from[i]) / n;
      mean_to += cv::Point2d(to[i]) / n;
    }
    double spread = 0, along = 0, across = 0;
    for (const int i : group) {
      const cv::Point2d a = cv::Point2d(from[i]) - mean_from, b = cv::Point2d(to[i]) - mean_to;
      spread += a.ddot(a);
      along += a.ddot(b);
      across += a.cross(b);
    }
    const bool known = turns && spread > 0;
    const double c = known ? along / spread : 1, s = known ? across / spread : 0;
    m = {c, -s, mean_to.x - c * mean_from.x + s * mean_from.y,
         s, c,  mean_to.y - s * mean_from.x - c * mean_from.y,
         0, 0,  1};
    std::vector<int> near;
    for (const int i : group) {
      const cv::Vec3d at = m * cv::Vec3d(from[i].x, from[i].y, 1);
      if (cv::norm(cv::Point2d(at[0], at[1]) - cv::Point2d(to[i])) < kInlier) near.push_back(i);
    }
    if (near.size() < group.size() / 2 || near.size() < 4) break;
    group = std::move(near);
  }
  return m;
}

}  // namespace

struct CameraTracker::Impl {
  cv::Size size;
  double diagonal;
  int window;      // frames
  int shake_span;  // frames

  cv::Mat reference, previous;
  std::vector<cv::Point2f> anchors, points, next;
  std::vector<uchar> found;
  std::vector<float> residual;
  std::vector<char> alive, still_alive;        // before and after the frame that was sought last
  bool sought = false;                         // the frame that is added next
  std::vector<std::vector<cv::Point2f>> path;  // of all points, a frame an entry
  PatternCheck correlation;

  CameraMotion motion;
  std::vector<Corners> places;  // where the scene's corners are after each window
  std::vector<CameraWindow> windows;
  int frames = 0;
  double shake_squares = 0;
  std::size_t shake_count = 0;

  Impl(cv::Size size_, double fps)
      : size(size_),
        diagonal(std::hypot(size_.width, size_.height)),
        window(std::clamp(static_cast<int>(std::lround(fps)), 12, 120)),
        shake_span(std::max(2, static_cast<int>(std::lround(fps * kShakeSpan_s)))) {
    const double w = size.width, h = size.height;
    places.push_back({cv::Point2d(0, 0), {w, 0}, {0, h}, {w, h}, {w / 2, h / 2}});
  }

  void begin_window(const cv::Mat& luma) {
    luma.copyTo(reference);
    anchors.clear();
    cv::Mat strength;
    cv::cornerMinEigenVal(reference, strength, 5, 3);
    const int cell = std::max(8, std::max(size.width, size.height) / kCellsAcross);
    const cv::Rect inside(kMargin, kMargin, size.width - 2 * kMargin, size.height - 2 * kMargin);
    for (int y = 0; y < size.height; y += cell) {
      for (int x = 0; x < size.width; x += cell) {
        const cv::Rect place = cv::Rect(x, y, cell, cell) & inside;
        if (place.width < 4 || place.height < 4) continue;
        double best = 0;
        cv::Point at;
        cv::minMaxLoc(strength(place), nullptr, &best, nullptr, &at);
        if (best > kMinCorner) anchors.emplace_back(cv::Point2f(place.tl() + at));
      }
    }
    points = anchors;
    alive.assign(points.size(), 1);
    path.assign(1, points);
  }

  /// Where the points are in this frame, and which still look like what they were.
  void seek(const cv::Mat& luma) {
    sought = true;
    still_alive.assign(points.size(), 0);
    if (points.empty()) return;
    cv::calcOpticalFlowPyrLK(previous, luma, points, next, found, residual, {11, 11}, 3,
                             {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 15, 0.01});
    const cv::Rect2f inside(kMargin, kMargin, static_cast<float>(size.width - 2 * kMargin),
                            static_cast<float>(size.height - 2 * kMargin));
    for (std::size_t i = 0; i < points.size(); ++i)
      still_alive[i] = alive[i] && found[i] && inside.contains(next[i]) &&
                       correlation(reference, anchors[i], luma, next[i]) >= kMinCorrelation;
  }

  void follow(const cv::Mat& luma) {
    if (!sought) seek(luma);
    sought = false;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (alive[i]) points[i] = next[i];
    alive = still_alive;
    path.push_back(points);
  }

  void end_window() {
    ++motion.windows;
    CameraWindow& record = windows.emplace_back();
    record.last = frames - 1;
    record.first = frames - static_cast<int>(path.size());
    record.before = record.after = places.back();
    std::vector<int> survivors, still, agreeing;
    std::vector<cv::Point2f> from, to;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!alive[i]) continue;
      survivors.push_back(static_cast<int>(i));
      from.push_back(anchors[i]);
      to.push_back(points[i]);
      if (cv::norm(points[i] - anchors[i]) < kInlier) still.push_back(static_cast<int>(i));
    }
    if (survivors.size() < static_cast<std::size_t>(kMinGroup)) return;

    std::vector<uchar> inlier;
    const cv::Mat similarity =
        cv::estimateAffinePartial2D(from, to, inlier, cv::RANSAC, kInlier, 500, 0.99, 10);
    for (std::size_t i = 0; !similarity.empty() && i < survivors.size(); ++i) {
      if (inlier[i]) agreeing.push_back(survivors[i]);
    }
    const auto is_scene = [&](const std::vector<int>& group, double min_fraction, int min_cells) {
      return group.size() >=
                 std::max<std::size_t>(
                     kMinGroup, static_cast<std::size_t>(std::ceil(min_fraction * survivors.size()))) &&
             cells_of(anchors, group, size) >= min_cells;
    };
    Corners place = places.back();
    bool turns = true;  // it can be told
    const bool stands = is_scene(still, kMinStatic, kMinStaticCells);
    if (is_scene(agreeing, stands ? kMinCoherentOverStatic : kMinCoherent, kMinCoherentCells)) {
      const cv::Matx23d m = similarity;
      for (cv::Point2d& p : place) p = cv::Point2d(m * cv::Vec3d(p.x, p.y, 1));
    } else if (stands) {
      // Too few or too close together for a turn to be told: their mean.
      agreeing = still;
      turns = false;
      cv::Point2d mean;
      for (const int i : still) mean += cv::Point2d(points[i] - anchors[i]);
      for (cv::Point2d& p : place) p += mean / static_cast<double>(still.size());
    } else {
      return;
    }
    ++motion.referenced_windows;
    places.push_back(place);
    record.referenced = true;
    record.after = place;
    add_shake(agreeing, record);
    for (const std::vector<cv::Point2f>& at : path)
      record.path.push_back(similarity_of(anchors, at, agreeing, turns));
  }

  /// What is left of the group's mean path when its own moving average is taken away.
  void add_shake(const std::vector<int>& group, CameraWindow& record) {
    std::vector<cv::Point2d> mean(path.size());
    for (std::size_t t = 0; t < path.size(); ++t) {
      for (const int i : group) mean[t] += cv::Point2d(path[t][i] - anchors[i]);
      mean[t] /= static_cast<double>(group.size());
    }
    const int span = shake_span, length = static_cast<int>(mean.size());
    for (int t = span; t + span < length; ++t) {
      cv::Point2d smooth;
      for (int s = t - span; s <= t + span; ++s) smooth += mean[s];
      const cv::Point2d rest = mean[t] - smooth / (2.0 * span + 1);
      shake_squares += rest.ddot(rest);
      ++shake_count;
      record.shake_squares += rest.ddot(rest);
      ++record.shake_count;
    }
  }
};

CameraTracker::CameraTracker(cv::Size size, double fps) : impl_(std::make_unique<Impl>(size, fps)) {}
CameraTracker::~CameraTracker() = default;
CameraTracker::CameraTracker(CameraTracker&&) noexcept = default;

void CameraTracker::add(const cv::Mat& luma) {
  Impl& impl = *impl_;
  CV_Assert(luma.type() == CV_8U && luma.size() == impl.size);
  ++impl.frames;
  if (impl.path.empty()) {
    impl.begin_window(luma);
  } else {
    impl.follow(luma);
    if (static_cast<int>(impl.path.size()) > impl.window) {
      impl.end_window();
      impl.begin_window(luma);
    }
  }
  luma.copyTo(impl.previous);
}

double CameraTracker::lost(const cv::Mat& luma) {
  Impl& impl = *impl_;
  const auto before = std::ranges::count(impl.alive, 1);
  if (impl.path.empty() || before < kMinGroup) return 0;
  impl.seek(luma);
  return 1 - static_cast<double>(std::ranges::count(impl.still_alive, 1)) / static_cast<double>(before);
}

CameraMotion CameraTracker::finish() {
  Impl& impl = *impl_;
  // A rest of less than half a second tells too little apart.
  if (static_cast<int>(impl.path.size()) >= std::max(6, impl.window / 2)) impl.end_window();
  for (std::size_t i = 0; i < impl.places.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      impl.motion.drift =
          std::max(impl.motion.drift, distance(impl.places[i], impl.places[j]) / impl.diagonal);
    }
  }
  if (impl.shake_count > 0) {
    impl.motion.shake = std::sqrt(impl.shake_squares / static_cast<double>(impl.shake_count)) / impl.diagonal;
  }
  return impl.motion;
}

const std::vector<CameraWindow>& CameraTracker::windows() const { return impl_->windows; }

CameraMotion motion_of(std::span<const CameraWindow> windows, double diagonal) {
  CameraMotion motion;
  motion.windows = static_cast<int>(windows.size());
  std::vector<Corners> places;
  if (!windows.empty()) places.push_back(windows.front().before);
  double shake_squares = 0;
  std::size_t shake_count = 0;
  for (const CameraWindow& window : windows) {
    if (!window.referenced) continue;
    ++motion.referenced_windows;
    for (const Corners& earlier : places)
      motion.drift = std::max(motion.drift, distance(window.after, earlier) / diagonal);
    places.push_back(window.after);
    shake_squares += window.shake_squares;
    shake_count += window.shake_count;
  }
  if (shake_count > 0) motion.shake = std::sqrt(shake_squares / static_cast<double>(shake_count)) / diagonal;
  return motion;
}

}  // namespace freshet::ingest
