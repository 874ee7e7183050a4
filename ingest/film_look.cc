#include "ingest/film_look.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "ingest/screening.h"

namespace freshet::ingest {
namespace {

constexpr int kChangeSide = 64;       // px
constexpr double kMovingShare = 0.3;  // of the change that 5 % of the pixels exceed: so much moves

/// 255 where most of the change is, CV_8U; everywhere where nothing changes.
cv::Mat moving_part(const cv::Mat& change) {
  std::vector<float> values(change.begin<float>(), change.end<float>());
  const auto high = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 95 / 100);
  std::ranges::nth_element(values, high);
  if (*high <= 0) return {change.size(), CV_8U, cv::Scalar(255)};
  return change >= kMovingShare * *high;
}

}  // namespace

FilmLook::FilmLook(double fps) : slot_frames_(std::max(1, static_cast<int>(std::lround(fps / 2)))) {}

void FilmLook::add(const media::Frame& frame, const cv::Mat& luma) {
  cv::resize(luma, tiny_, within(luma.size(), kChangeSide), 0, 0, cv::INTER_AREA);
  if (frames_++ % slot_frames_ == 0) {
    Slot& slot = slots_.emplace_back();
    const cv::Mat bgr = media::to_bgr(frame);
    cv::Mat small;
    cv::resize(bgr, small, within(bgr.size(), kSide), 0, 0, cv::INTER_AREA);
    cv::imencode(".jpg", small, slot.jpeg, {cv::IMWRITE_JPEG_QUALITY, 85});
    slot.change = cv::Mat::zeros(tiny_.size(), CV_32F);
  } else {
    cv::absdiff(tiny_, previous_, difference_);
    cv::accumulate(difference_, slots_.back().change);
  }
  std::swap(tiny_, previous_);
}

PartLook FilmLook::look(int first, int last) const {
  PartLook look;
  const int middle = (first + last) / 2;
  cv::Mat change;
  int nearest = -1;
  for (int s = 0; s < static_cast<int>(slots_.size()); ++s) {
    const int at = s * slot_frames_;
    if (at < first || at >= last) continue;
    if (nearest < 0 || std::abs(at - middle) < std::abs(nearest * slot_frames_ - middle)) nearest = s;
    if (at + slot_frames_ > last && !change.empty()) continue;  // it runs into the next part
    if (change.empty()) change = cv::Mat::zeros(slots_[s].change.size(), CV_32F);
    change += slots_[s].change;
  }
  if (nearest < 0) return look;
  look.jpeg = slots_[nearest].jpeg;
  const cv::Mat picture = cv::imdecode(look.jpeg, cv::IMREAD_COLOR);
  cv::Mat moving;
  cv::resize(moving_part(change), moving, picture.size(), 0, 0, cv::INTER_NEAREST);
  look.kind = vision::fluid_kind(vision::fluid_look(picture, moving));
  return look;
}

}  // namespace freshet::ingest
