#include "synth/scene/layers/exemplar_fill.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <vector>

#include <fmt/format.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "platform/vectors.h"

namespace freshet::synth::scene {
namespace {

constexpr float kLeastData = 1e-3f;
constexpr float kCodesPerLab = 2.55f;  // L reaches 100
constexpr std::uint8_t kSet = 255;

// Squared differences of `n` neighbouring candidates to one known pixel of the patch.
FRESHET_WIDE void add_squares(const std::int16_t* from, std::int16_t to, int n, std::int32_t* sums) {
  for (int i = 0; i < n; ++i) {
    const std::int32_t d = from[i] - to;
    sums[i] += d * d;
  }
}

// One pixel of the patch that is known: where, and its colour.
struct Known {
  int dx, dy;
  std::int16_t lab[3];
};

struct Candidate {
  std::int32_t difference = std::numeric_limits<std::int32_t>::max();
  cv::Point at{-1, -1};
};

struct Front {
  float priority;
  std::uint32_t version;
  cv::Point at;
  // The last of a std::priority_queue comes first: the highest priority, of equals the upper left one.
  bool operator<(const Front& other) const {
    if (priority != other.priority) return priority < other.priority;
    return at.y != other.at.y ? at.y > other.at.y : at.x > other.at.x;
  }
};

class Filler {
 public:
  Filler(const cv::Mat& picture, const Hole& hole, const FillOptions& options);
  Filled run();

 private:
  bool is_known(int x, int y) const { return known_.at<std::uint8_t>(y, x) == kSet; }
  cv::Rect patch_at(cv::Point at) const {
    return cv::Rect(at.x - half_, at.y - half_, options_.patch_px, options_.patch_px) &
           cv::Rect({}, known_.size());
  }
  bool on_front(cv::Point at) const;
  cv::Point2f slope(int x, int y) const;
  float priority(cv::Point at) const;
  void renew(cv::Rect around);
  Candidate best_source(cv::Point at);
  Candidate best_in(const cv::Rect& window);
  void copy(cv::Point to, cv::Point from);

  const FillOptions options_;
  int half_;
  cv::Mat known_, target_;
  cv::Mat lab_[3];  // CV_16S
  cv::Mat luma_;    // CV_32F, L in 0..1
  cv::Mat whole_;   // CV_8U: a patch around here lies in the source
  cv::Mat confidence_;
  cv::Mat version_;  // CV_32S: of the priority that counts
  std::priority_queue<Front> fronts_;
  std::vector<Known> knowns_;       // of the patch in hand
  std::vector<std::int32_t> sums_;  // a row of candidates for every row of the window
  std::vector<Candidate> row_best_;
  Filled out_;
};

Filler::Filler(const cv::Mat& picture, const Hole& hole, const FillOptions& options)
    : options_(options),
      half_(options.patch_px / 2),
      known_(hole.known.clone()),
      target_(hole.target.clone()) {
  cv::Mat lab;
  cv::cvtColor(cv::min(cv::max(picture, 0.0), 1.0), lab, cv::COLOR_BGR2Lab);
  std::vector<cv::Mat> planes;
  cv::split(lab, planes);
  for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)].convertTo(lab_[c], CV_16S, kCodesPerLab);
  planes[0].convertTo(luma_, CV_32F, 0.01);
  // Beyond the picture's edge there is no source.
  cv::erode(hole.source, whole_, cv::Mat::ones(options.patch_px, options.patch_px, CV_8U), {-1, -1}, 1,
            cv::BORDER_CONSTANT, cv::Scalar(0));
  known_.convertTo(confidence_, CV_32F, 1.0 / 255);
  version_ = cv::Mat::zeros(known_.size(), CV_32S);
  knowns_.reserve(static_cast<std::size_t>(options.patch_px) * static_cast<std::size_t>(options.patch_px));
  out_.picture = picture.clone();
  out_.filled = cv::Mat::zeros(known_.size(), CV_8U);
  out_.source = cv::Mat(known_.size(), CV_32SC2, cv::Scalar(-1, -1));
  for (int y = 0; y < known_.rows; ++y)
    for (int x = 0; x < known_.cols; ++x)
      if (is_known(x, y)) out_.source.at<cv::Point>(y, x) = {x, y};
}

bool Filler::on_front(cv::Point at) const {
  if (target_.at<std::uint8_t>(at) != kSet || is_known(at.x, at.y)) return false;
  for (const cv::Point d : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
    const cv::Point n = at + d;
    if (n.inside(cv::Rect({}, known_.size())) && is_known(n.x, n.y)) return true;
  }
  return false;
}

// Of the luma, from pixels that are known; nothing where one of them is not.
cv::Point2f Filler::slope(int x, int y) const {
  if (x < 1 || y < 1 || x + 1 >= known_.cols || y + 1 >= known_.rows) return {};
  if (!is_known(x - 1, y) || !is_known(x + 1, y) || !is_known(x, y - 1) || !is_known(x, y + 1)) return {};
  return {0.5f * (luma_.at<float>(y, x + 1) - luma_.at<float>(y, x - 1)),
          0.5f * (luma_.at<float>(y + 1, x) - luma_.at<float>(y - 1, x))};
}

float Filler::priority(cv::Point at) const {
  const cv::Rect patch = patch_at(at);
  float confidence = 0, steepest = 0;
  cv::Point2f isophote;
  for (int y = patch.y; y < patch.br().y; ++y)
    for (int x = patch.x; x < patch.br().x; ++x) {
      if (!is_known(x, y)) continue;
      confidence += confidence_.at<float>(y, x);
      const cv::Point2f g = slope(x, y);
      if (const float steep = g.dot(g); steep > steepest) steepest = steep, isophote = {-g.y, g.x};
    }
  confidence /= static_cast<float>(options_.patch_px * options_.patch_px);
  // Normal of the front: where what is known lies, by Sobel's weights.
  cv::Point2f normal;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const cv::Point n(at.x + dx, at.y + dy);
      if (!n.inside(cv::Rect({}, known_.size())) || !is_known(n.x, n.y)) continue;
      const float weight = dx == 0 || dy == 0 ? 2.0f : 1.0f;
      normal += cv::Point2f(weight * static_cast<float>(dx), weight * static_cast<float>(dy));
    }
  const float length = std::sqrt(normal.dot(normal));
  const float data = length > 0 ? std::abs(isophote.dot(normal)) / length : 0;
  return confidence * (data + kLeastData);
}

void Filler::renew(cv::Rect around) {
  around &= cv::Rect({}, known_.size());
  for (int y = around.y; y < around.br().y; ++y)
    for (int x = around.x; x < around.br().x; ++x)
      if (on_front({x, y})) {
        const auto version = static_cast<std::uint32_t>(++version_.at<int>(y, x));
        fronts_.push({priority({x, y}), version, {x, y}});
      }
}

// Best of the window: each row by itself, then the first of the best rows.
Candidate Filler::best_in(const cv::Rect& window) {
  const auto width = static_cast<std::size_t>(window.width), height = static_cast<std::size_t>(window.height);
  if (sums_.size() < width * height) sums_.resize(width * height);
  if (row_best_.size() < height) row_best_.resize(height);
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<int>(0, window.height, 16), [&](const auto& rows) {
    std::int32_t reached = std::numeric_limits<std::int32_t>::max();
    for (int row = rows.begin(); row < rows.end(); ++row) {
      Candidate& best = row_best_[static_cast<std::size_t>(row)] = {};
      const std::uint8_t* whole = whole_.ptr<std::uint8_t>(window.y + row) + window.x;
      int first = 0, last = window.width - 1;
      while (first <= last && whole[first] != kSet) ++first;
      while (last >= first && whole[last] != kSet) --last;
      if (first > last) continue;
      std::int32_t* sums = sums_.data() + static_cast<std::size_t>(row) * width;
      const int n = last - first + 1;
      std::fill(sums, sums + n, 0);
      int dy = knowns_.front().dy;
      bool beaten = false;
      for (const Known& known : knowns_) {
        if (known.dy != dy) {
          // A row of the patch further: has every candidate of this row lost?
          dy = known.dy;
          beaten = *std::min_element(sums, sums + n) > reached;
          if (beaten) break;
        }
        const int y = window.y + row + known.dy;
        // What is not whole may have its patch beyond the picture's edge, where nothing can be read.
        const int left = window.x + first + known.dx;
        for (int c = 0; c < 3; ++c) add_squares(lab_[c].ptr<std::int16_t>(y) + left, known.lab[c], n, sums);
      }
      if (beaten) continue;
      for (int i = 0; i < n; ++i)
        if (whole[first + i] == kSet && sums[i] < best.difference)
          best = {sums[i], {window.x + first + i, window.y + row}};
      reached = std::min(reached, best.difference);
    }
  });
  Candidate best;
  for (std::size_t row = 0; row < height; ++row)
    if (row_best_[row].difference < best.difference) best = row_best_[row];
  return best;
}

Candidate Filler::best_source(cv::Point at) {
  knowns_.clear();
  const cv::Rect patch = patch_at(at);
  for (int y = patch.y; y < patch.br().y; ++y)
    for (int x = patch.x; x < patch.br().x; ++x)
      if (is_known(x, y))
        knowns_.push_back({x - at.x,
                           y - at.y,
                           {lab_[0].at<std::int16_t>(y, x), lab_[1].at<std::int16_t>(y, x),
                            lab_[2].at<std::int16_t>(y, x)}});
  for (int reach = options_.search_px;; reach *= 2) {
    const cv::Rect window =
        cv::Rect(at.x - reach, at.y - reach, 2 * reach + 1, 2 * reach + 1) & cv::Rect({}, known_.size());
    const Candidate best = best_in(window);
    if (best.at.x >= 0 || window.size() == known_.size()) return best;
  }
}

void Filler::copy(cv::Point to, cv::Point from) {
  const cv::Rect patch = patch_at(to);
  float confidence = 0;
  for (int y = patch.y; y < patch.br().y; ++y)
    for (int x = patch.x; x < patch.br().x; ++x)
      if (is_known(x, y)) confidence += confidence_.at<float>(y, x);
  confidence /= static_cast<float>(options_.patch_px * options_.patch_px);
  for (int y = patch.y; y < patch.br().y; ++y)
    for (int x = patch.x; x < patch.br().x; ++x) {
      if (is_known(x, y) || target_.at<std::uint8_t>(y, x) != kSet) continue;
      const cv::Point source(x - to.x + from.x, y - to.y + from.y);
      out_.picture.at<cv::Vec3f>(y, x) = out_.picture.at<cv::Vec3f>(source);
      out_.source.at<cv::Point>(y, x) = source;
      out_.filled.at<std::uint8_t>(y, x) = kSet;
      for (cv::Mat& plane : lab_) plane.at<std::int16_t>(y, x) = plane.at<std::int16_t>(source);
      luma_.at<float>(y, x) = luma_.at<float>(source);
      confidence_.at<float>(y, x) = confidence;
    }
  // Only now, or the patch would have read what it wrote.
  known_(patch).setTo(kSet, out_.filled(patch));
}

Filled Filler::run() {
  renew(cv::Rect({}, known_.size()));
  const bool any = cv::countNonZero(whole_) > 0;
  while (any && !fronts_.empty()) {
    const Front front = fronts_.top();
    fronts_.pop();
    if (is_known(front.at.x, front.at.y) ||
        static_cast<std::uint32_t>(version_.at<int>(front.at)) != front.version)
      continue;
    const Candidate best = best_source(front.at);
    copy(front.at, best.at);
    const int reach = 2 * half_ + 1;
    renew({front.at.x - reach, front.at.y - reach, 2 * reach + 1, 2 * reach + 1});
  }
  return std::move(out_);
}

}  // namespace

Filled exemplar_fill(const cv::Mat& picture, const Hole& hole, const FillOptions& options) {
  if (options.patch_px < 3 || options.patch_px > 33 || options.patch_px % 2 == 0 || options.search_px < 1)
    throw Error(ErrorKind::kUsage, "filling",
                fmt::format("patches of {} px, searched within {} px", options.patch_px, options.search_px),
                "Patches have an odd side of 3 to 33 px, the search at least 1 px");
  return Filler(picture, hole, options).run();
}

}  // namespace freshet::synth::scene
