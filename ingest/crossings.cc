#include "ingest/crossings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "ingest/screening.h"

namespace freshet::ingest {
namespace {

// Chosen on 21 of the shared clips, of which none was drawn by lot, with figures planted in them (bench_crossings).
constexpr float kLeastLuma = 16;                     // grey levels from the place's median
constexpr float kLumaDeviations = 4;                 // ... and times its median deviation
constexpr float kLeastMotion = 0.6f;                 // px a frame from the place's median motion
constexpr float kMotionDeviations = 2;               // ... and times its median deviation
constexpr double kSmallest = 0.001, kLargest = 0.2;  // of the frame
constexpr std::size_t kLeastFrames = 6;
constexpr float kStraight = 0.75f;              // of the way, its ends' distance
constexpr float kSameLook = 0.82f;              // correlation over kApart frames, median
constexpr float kFollowed = 0.6f;               // correlation from frame to frame
constexpr int kMostBetween = 2;                 // frames from one blob of a track to the next
constexpr double kWayOff = 0.6, kWayOffPx = 2;  // of a blob's side, and px, from where its track should go on
constexpr double kLeastRatio = 0.4, kMostRatio = 2.5;  // of the areas of blobs that follow each other
constexpr std::size_t kApart = 3;                      // blobs of a track
constexpr std::size_t kLeastLooks = 2;
constexpr int kNear = 3;                  // px, around where a blob of a track is
constexpr double kFlat = 1;               // grey levels of deviation, below which a picture has no look
constexpr int kMissed = 3;                // frames, after which a thing is lost
constexpr int kSearch = 5;                // px, around where it is expected
constexpr int kRim = 3;                   // px
constexpr int kLeastSide = 48;            // px, of a reduced frame in which anything is looked for
constexpr std::size_t kLeastWindow = 13;  // frames, in fewer of which nothing is usual

struct Blob {
  int frame = 0;
  cv::Rect box;
  cv::Mat mask;  // CV_8U, of the box
  double area = 0;
  cv::Point2f centre, velocity;
};
using Track = std::vector<Blob>;

template <class T>
T median_of(std::span<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// What every place has for most of a window.
struct Usual {
  cv::Mat luma, threshold;   // CV_32F: its median, and how far something else is from it
  cv::Mat motion;            // CV_32FC2, px a frame
  cv::Mat motion_deviation;  // CV_32F
};

Usual usual_of(const std::vector<cv::Mat>& frames, const std::vector<cv::Mat>& flows) {
  const cv::Size size = frames.front().size();
  Usual usual{cv::Mat(size, CV_32F), cv::Mat(size, CV_32F), cv::Mat(size, CV_32FC2), cv::Mat(size, CV_32F)};
  std::vector<float> values(frames.size()), along(flows.size()), down(flows.size());
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      for (std::size_t t = 0; t < frames.size(); ++t) values[t] = frames[t].at<std::uint8_t>(y, x);
      const float luma = median_of<float>(values);
      for (float& value : values) value = std::abs(value - luma);
      usual.luma.at<float>(y, x) = luma;
      usual.threshold.at<float>(y, x) = std::max(kLeastLuma, kLumaDeviations * median_of<float>(values));
      for (std::size_t t = 0; t < flows.size(); ++t) {
        const cv::Vec2f& flow = flows[t].at<cv::Vec2f>(y, x);
        along[t] = flow[0];
        down[t] = flow[1];
      }
      const cv::Vec2f motion(median_of<float>(along), median_of<float>(down));
      for (std::size_t t = 0; t < flows.size(); ++t)
        along[t] = static_cast<float>(cv::norm(flows[t].at<cv::Vec2f>(y, x) - motion));
      usual.motion.at<cv::Vec2f>(y, x) = motion;
      usual.motion_deviation.at<float>(y, x) = median_of<float>(along);
    }
  }
  return usual;
}

/// Regions of a frame that look and move otherwise than their place does.
std::vector<Blob> blobs_of(const cv::Mat& frame, const cv::Mat& flow, const Usual& usual, int number) {
  cv::Mat luma, other, labels, boxes, centres;
  frame.convertTo(luma, CV_32F);
  cv::absdiff(luma, usual.luma, luma);
  other = luma > usual.threshold;
  cv::morphologyEx(other, other, cv::MORPH_CLOSE, cv::Mat::ones(5, 5, CV_8U));
  cv::morphologyEx(other, other, cv::MORPH_OPEN, cv::Mat::ones(3, 3, CV_8U));
  const int count = cv::connectedComponentsWithStats(other, labels, boxes, centres, 8);
  std::vector<Blob> blobs;
  std::vector<float> excess, deviation;
  for (int i = 1; i < count; ++i) {
    const double area = boxes.at<int>(i, cv::CC_STAT_AREA), whole = static_cast<double>(frame.total());
    if (area < kSmallest * whole || area > kLargest * whole) continue;
    const cv::Rect box(boxes.at<int>(i, cv::CC_STAT_LEFT), boxes.at<int>(i, cv::CC_STAT_TOP),
                       boxes.at<int>(i, cv::CC_STAT_WIDTH), boxes.at<int>(i, cv::CC_STAT_HEIGHT));
    const cv::Mat mask = labels(box) == i;
    excess.clear();
    deviation.clear();
    cv::Vec2f sum(0, 0);
    for (int y = 0; y < box.height; ++y) {
      for (int x = 0; x < box.width; ++x) {
        if (mask.at<std::uint8_t>(y, x) == 0) continue;
        const cv::Point at = box.tl() + cv::Point(x, y);
        const cv::Vec2f& moved = flow.at<cv::Vec2f>(at);
        excess.push_back(static_cast<float>(cv::norm(moved - usual.motion.at<cv::Vec2f>(at))));
        deviation.push_back(usual.motion_deviation.at<float>(at));
        sum += moved;
      }
    }
    if (median_of<float>(excess) < std::max(kLeastMotion, kMotionDeviations * median_of<float>(deviation)))
      continue;
    const cv::Vec2f velocity = sum / static_cast<float>(area);
    blobs.push_back({.frame = number,
                     .box = box,
                     .mask = mask,
                     .area = area,
                     .centre = cv::Point2f(static_cast<float>(centres.at<double>(i, 0)),
                                           static_cast<float>(centres.at<double>(i, 1))),
                     .velocity = cv::Point2f(velocity[0], velocity[1])});
  }
  return blobs;
}

/// Each blob goes on the track whose last one was on its way there, if any.
void link(std::vector<Blob> blobs, std::vector<Track>& tracks) {
  for (Blob& blob : blobs) {
    Track* nearest = nullptr;
    double least = kWayOff * std::sqrt(blob.area) + kWayOffPx;
    for (Track& track : tracks) {
      const Blob& last = track.back();
      const int frames = blob.frame - last.frame;
      if (frames > kMostBetween || frames == 0) continue;
      const double distance =
          cv::norm(last.centre + last.velocity * static_cast<float>(frames) - blob.centre);
      const double ratio = blob.area / last.area;
      if (distance >= least || ratio <= kLeastRatio || ratio >= kMostRatio) continue;
      least = distance;
      nearest = &track;
    }
    if (nearest != nullptr)
      nearest->push_back(std::move(blob));
    else
      tracks.push_back({std::move(blob)});
  }
}

cv::Rect grown(const cv::Rect& box, int by) {
  return {box.x - by, box.y - by, box.width + 2 * by, box.height + 2 * by};
}

struct Likeness {
  double correlation;
  cv::Point at;
};
/// Where a look is most alike in a part of another frame; nothing where it has no room there, or is flat.
std::optional<Likeness> likeness(const cv::Mat& look, const cv::Mat& frame, const cv::Rect& around) {
  const cv::Rect inside = around & cv::Rect({}, frame.size());
  if (inside.width < look.cols || inside.height < look.rows || look.cols < 3 || look.rows < 3) return {};
  cv::Scalar mean, deviation;
  cv::meanStdDev(look, mean, deviation);
  if (deviation[0] < kFlat) return {};
  cv::Mat correlation;
  cv::matchTemplate(frame(inside), look, correlation, cv::TM_CCOEFF_NORMED);
  Likeness best{};
  cv::minMaxLoc(correlation, nullptr, &best.correlation, nullptr, &best.at);
  best.at += inside.tl();
  return best;
}

bool is_a_thing(const Track& track, const std::vector<cv::Mat>& frames) {
  if (track.size() < kLeastFrames) return false;
  std::vector<double> areas;
  double way = 0;
  for (std::size_t i = 0; i < track.size(); ++i) {
    areas.push_back(track[i].area);
    if (i > 0) way += cv::norm(track[i].centre - track[i - 1].centre);
  }
  const double distance = cv::norm(track.back().centre - track.front().centre);
  if (distance <= std::sqrt(median_of<double>(areas)) || distance <= kStraight * way) return false;
  std::vector<double> correlations;
  for (std::size_t i = 0; i + kApart < track.size(); ++i) {
    const Blob &from = track[i], &to = track[i + kApart];
    const cv::Point moved(cvRound(to.centre.x - from.centre.x), cvRound(to.centre.y - from.centre.y));
    const auto like =
        likeness(frames[from.frame](from.box), frames[to.frame], grown(from.box + moved, kNear));
    if (like) correlations.push_back(like->correlation);
  }
  return correlations.size() >= kLeastLooks && median_of<double>(correlations) > kSameLook;
}

void mark(const cv::Mat& mask, cv::Point at, cv::Mat& crossed) {
  const cv::Rect inside = cv::Rect(at, mask.size()) & cv::Rect({}, crossed.size());
  if (inside.empty()) return;
  crossed(inside) |= mask(inside - at);
}

/// From a blob on, forwards or backwards, as long as it is seen, and out of the frame.
void follow(const Blob& begin, cv::Point2f velocity, int direction, const std::vector<cv::Mat>& frames,
            cv::Mat& crossed) {
  const cv::Rect whole({}, crossed.size());
  cv::Mat look = frames[begin.frame](begin.box);
  cv::Point2f place = begin.box.tl();
  int missed = 0;
  for (int t = begin.frame + direction; t >= 0 && t < static_cast<int>(frames.size()) && missed < kMissed;
       t += direction) {
    place += velocity;
    cv::Rect box(cv::Point(cvRound(place.x), cvRound(place.y)), begin.box.size());
    if ((box & whole).empty()) return;
    if ((box & whole) == box) {  // else it leaves, as it went
      const auto like = likeness(look, frames[t], grown(box, kSearch));
      if (like && like->correlation > kFollowed) {
        place += cv::Point2f(like->at - box.tl());
        box = cv::Rect(like->at, box.size());
        look = frames[t](box);
        missed = 0;
      } else {
        ++missed;
      }
    }
    mark(begin.mask, box.tl(), crossed);
  }
}

}  // namespace

CrossingFinder::CrossingFinder(cv::Size source, double fps)
    : source_(source), size_(within(source, kSide)), step_(std::max(1, cvRound(fps / kRate))) {
  crossed_ = cv::Mat::zeros(size_, CV_8U);
}

void CrossingFinder::add(const cv::Mat& luma) {
  if (frames_++ % step_ != 0 || std::min(size_.width, size_.height) < kLeastSide) return;
  cv::Mat small;
  cv::resize(luma, small, size_, 0, 0, cv::INTER_AREA);
  if (!window_.empty()) {
    cv::Mat flow;
    cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_FAST)->calc(window_.back(), small, flow);
    cv::GaussianBlur(flow, flow, {}, 1.5);
    flows_.push_back(flow);
  }
  window_.push_back(small);
  ++unseen_;
  if (window_.size() < kWindow) return;
  search();
  window_.erase(window_.begin(), window_.begin() + kWindow / 2);
  flows_.erase(flows_.begin(), flows_.begin() + kWindow / 2);
}

void CrossingFinder::search() {
  unseen_ = 0;
  const Usual usual = usual_of(window_, flows_);
  std::vector<Track> tracks;
  for (std::size_t t = 0; t < flows_.size(); ++t)
    link(blobs_of(window_[t], flows_[t], usual, static_cast<int>(t)), tracks);
  for (const Track& track : tracks) {
    if (!is_a_thing(track, window_)) continue;
    for (const Blob& blob : track) mark(blob.mask, blob.box.tl(), crossed_);
    const Blob &first = track.front(), &last = track.back();
    const cv::Point2f velocity = (last.centre - first.centre) / static_cast<float>(last.frame - first.frame);
    follow(last, velocity, 1, window_, crossed_);
    follow(first, -velocity, -1, window_, crossed_);
  }
}

cv::Mat CrossingFinder::finish() {
  if (unseen_ > 0 && window_.size() >= kLeastWindow) search();
  if (cv::countNonZero(crossed_) == 0) return {};
  cv::Mat whole;
  cv::dilate(crossed_, crossed_, cv::getStructuringElement(cv::MORPH_RECT, {2 * kRim + 1, 2 * kRim + 1}));
  cv::resize(crossed_, whole, source_, 0, 0, cv::INTER_NEAREST);
  return whole;
}

}  // namespace freshet::ingest
