#include "synth/animate/still/continued.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "synth/sampling/remapped.h"
#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

constexpr double kReach = 4;           // of a side's length, a fraction
constexpr int kEven = 8;               // px
constexpr double kCrosses = 0.15;      // of the mean speed, over a side
constexpr int kStrips = 20;            // of the shorter side, a strip along a side
constexpr double kSideShare = 0.1;     // of a side that is fluid, at least
constexpr int kSearched = 160;         // px of the longer side, where places are searched for
constexpr int kBlocks = 6;             // down a side, each with a place of its own,
constexpr int kShared = 2;             // of which neighbours share this part
constexpr int kHigher = 8;             // a place lies by up to this part of the height higher or lower
constexpr int kCompared = 3;           // this part of what is added is compared, within the picture
constexpr std::size_t kOfferedBy = 8;  // places by each block to all
constexpr double kNoFluid = 1.5;       // levels of 0..1 for fluid that a place does not have,
constexpr double kNoRows = 0.5;        // and for rows beyond the picture
constexpr double kNear = 0.03;      // and for a place next to the side: its forms would be seen side by side
constexpr double kJoint = 0.5;      // of two blocks, beside a level at the side
constexpr int kBand = 14;           // the seam lies in this part of what is added, next to the picture,
constexpr int kMirrored = 4;        // and not in this part of that
constexpr double kLateSeam = 0.05;  // levels, for a seam at the end of its band: what is mirrored is seen
constexpr int kStray = 2;           // px by which a seam goes to a side from row to row
constexpr int kBlended = 6;         // Laplacian levels
constexpr double kLight = 10;       // of the longer side, a fraction: sigma

enum Plane { kLuma, kBlue, kRed, kTrusted, kMatte, kPlanes };
using Planes = std::array<cv::Mat, kPlanes>;

Planes each(const Planes& planes, const auto& change) {
  Planes out;
  std::ranges::transform(planes, out.begin(), change);
  return out;
}

/// Row y of a plane that goes on mirrored above and below.
int row_within(int y, int rows) {
  return std::clamp(y < 0 ? -1 - y : y < rows ? y : 2 * rows - 1 - y, 0, rows - 1);
}

/// What lies in `place`, whose rows may be beyond the plane's.
cv::Mat place_of(const cv::Mat& plane, const cv::Rect& place) {
  if ((place & cv::Rect({}, plane.size())) == place) return plane(place);
  cv::Mat out(place.size(), plane.type());
  for (int y = 0; y < out.rows; ++y)
    plane.row(row_within(y + place.y, plane.rows)).colRange(place.x, place.br().x).copyTo(out.row(y));
  return out;
}

/// How far two places are apart at each pixel, levels of 0..1.
cv::Mat apart(const Planes& one, const Planes& other) {
  cv::Mat sum = cv::abs(one[kLuma] - other[kLuma]);
  for (const Plane k : {kBlue, kRed}) sum += cv::abs(one[k] - other[k]);
  return sum;
}

/// The cheapest way down through [first, cost.cols): by row its column.
std::vector<int> cheapest(cv::Mat cost, int first) {
  const int end = cost.cols;
  for (int y = 1; y < cost.rows; ++y) {
    const float* above = cost.ptr<float>(y - 1);
    auto* own = cost.ptr<float>(y);
    for (int x = first; x < end; ++x)
      own[x] += *std::min_element(above + std::max(first, x - kStray), above + std::min(end, x + kStray + 1));
  }
  std::vector<int> columns(static_cast<std::size_t>(cost.rows));
  int from = first, to = end;
  for (int y = cost.rows - 1; y >= 0; --y) {
    const float* row = cost.ptr<float>(y);
    const int x = static_cast<int>(std::min_element(row + from, row + to) - row);
    columns[static_cast<std::size_t>(y)] = x;
    from = std::max(first, x - kStray), to = std::min(end, x + kStray + 1);
  }
  return columns;
}

/// Rows of block `block` of `rows`, with what it shares with its neighbours.
cv::Range rows_of(int block, int rows) {
  const int height = (rows + kBlocks - 1) / kBlocks, shared = std::max(1, height / kShared);
  return {std::clamp(block * height - shared, 0, rows - 1),
          std::clamp((block + 1) * height + shared, 1, rows)};
}

/// Chooses places for the blocks of a picture's right side: by how they go on from its last columns, and how
/// neighbours go together.
class Places {
 public:
  /// planes of the reduced picture; compared: its columns that are; added: those that are added.
  Places(const Planes& planes, int compared, int added)
      : planes_(planes), compared_(compared), added_(added), size_(planes[kLuma].size()) {}

  /// By block, its place's corner less its own: how much lower, and its column.
  std::vector<cv::Point> chosen() const {
    const std::vector<cv::Point> offered = all_offered();
    const std::size_t n = offered.size();
    std::vector<double> cost(n);
    std::vector<std::vector<std::size_t>> from;
    for (int block = 0; block < kBlocks; ++block) {
      std::vector<double> next(n);
      std::vector<std::size_t> best(n);
      const std::vector<double> joints = block > 0 ? all_joints(block, offered) : std::vector<double>(n * n);
      for (std::size_t k = 0; k < n; ++k) {
        const auto total = [&](std::size_t before) { return cost[before] + joints[before * n + k]; };
        for (std::size_t before = 1; before < n; ++before)
          if (total(before) < total(best[k])) best[k] = before;
        next[k] = total(best[k]) + misfit(block, offered[k]);
      }
      cost = std::move(next);
      from.push_back(std::move(best));
    }
    std::size_t k = static_cast<std::size_t>(std::ranges::min_element(cost) - cost.begin());
    std::vector<cv::Point> out(kBlocks);
    for (int block = kBlocks - 1; block >= 0; --block) {
      const auto at = static_cast<std::size_t>(block);
      out[at] = offered[k];
      k = from[at][k];
    }
    return out;
  }

 private:
  Planes at(cv::Point place, cv::Range rows, int first, int width) const {
    return each(planes_, [&](const cv::Mat& of) {
      return place_of(of, cv::Rect(place.x + first, rows.start + place.y, width, rows.size()));
    });
  }

  double misfit(int block, cv::Point place) const {
    const cv::Range rows = rows_of(block, size_.height);
    const cv::Rect end(size_.width - compared_, rows.start, compared_, rows.size());
    const Planes own = each(planes_, [&](const cv::Mat& of) { return of(end); });
    const Planes other = at(place, rows, 0, compared_ + added_);
    const cv::Mat away =
        apart(own, each(other, [&](const cv::Mat& of) { return of.colRange(0, compared_); }));
    double sum = 0, mass = 0, lacks = 0;
    for (int y = 0; y < rows.size(); ++y) {
      const auto *fluid = own[kMatte].ptr<float>(y), *brought = other[kMatte].ptr<float>(y);
      for (int x = 0; x < compared_; ++x) {
        const double near = (x + 1.0) / compared_;
        sum += near * fluid[x] * away.at<float>(y, x), mass += near;
      }
      const double mean = std::accumulate(brought, brought + compared_ + added_, 0.0) / (compared_ + added_);
      lacks += std::max(0.0, fluid[compared_ - 1] - mean) / rows.size();
    }
    const int beyond = std::max(0, -(rows.start + place.y)) + std::max(0, rows.end + place.y - size_.height);
    const double nearness = static_cast<double>(place.x + compared_) / size_.width;
    return sum / mass + kNoFluid * lacks + kNoRows * beyond / rows.size() + kNear * nearness;
  }

  std::vector<cv::Point> all_offered() const {
    std::vector<cv::Point> out;
    for (int block = 0; block < kBlocks; ++block) {
      std::vector<std::pair<double, cv::Point>> found;
      const int most = size_.height / kHigher;
      for (int y = -most; y <= most; y += 2)
        for (int x = 0; x + compared_ + added_ <= size_.width; ++x)
          found.emplace_back(misfit(block, {x, y}), cv::Point(x, y));
      std::ranges::stable_sort(found, {}, &std::pair<double, cv::Point>::first);
      for (std::size_t k = 0; k < std::min(kOfferedBy, found.size()); ++k)
        if (std::ranges::find(out, found[k].second) == out.end()) out.push_back(found[k].second);
    }
    return out;
  }

  /// What each place above costs with each below: the least difference down each column that they share.
  std::vector<double> all_joints(int block, const std::vector<cv::Point>& offered) const {
    const cv::Range rows(rows_of(block, size_.height).start, rows_of(block - 1, size_.height).end);
    std::vector<Planes> shown;
    for (const cv::Point place : offered) shown.push_back(at(place, rows, compared_, added_));
    std::vector<double> out;
    cv::Mat least;
    for (const Planes& above : shown)
      for (const Planes& below : shown) {
        cv::reduce(apart(above, below), least, 0, cv::REDUCE_MIN);
        out.push_back(kJoint * std::accumulate(least.begin<float>(), least.end<float>(), 0.0) / added_);
      }
    return out;
  }

  const Planes& planes_;
  int compared_, added_;
  cv::Size size_;
};

/// `seen` from 0 to 1: the second over the first, each band over as wide a way as it has waves.
cv::Mat blended(const cv::Mat& first, const cv::Mat& second, cv::Mat seen) {
  std::vector<cv::Mat> own, other;
  const int levels = vision::levels_within(first.size(), kBlended);
  vision::laplacian_pyramid(first, levels, own);
  vision::laplacian_pyramid(second, levels, other);
  for (std::size_t level = 0; level < own.size(); ++level) {
    own[level] += seen.mul(other[level] - own[level]);
    if (level + 1 < own.size()) cv::pyrDown(seen, seen, own[level + 1].size());
  }
  return vision::collapse(own);
}

/// The same of all planes; of mattes as it is seen.
Planes blended(const Planes& first, const Planes& second, const cv::Mat& seen) {
  Planes out;
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] = k == kMatte || k == kTrusted ? cv::Mat(first[k] + seen.mul(second[k] - first[k]))
                                          : blended(first[k], second[k], seen.clone());
  return out;
}

/// What goes on from the right side, with the picture's columns that were compared before it.
Planes placed(const Planes& planes, int compared, int added) {
  const cv::Size size = planes[kLuma].size();
  const double scale = std::min(1.0, kSearched / static_cast<double>(std::max(size.width, size.height)));
  const Planes small = each(planes, [&](const cv::Mat& of) {
    cv::Mat out;
    cv::resize(of, out, {}, scale, scale, cv::INTER_AREA);
    return out;
  });
  const auto reduced = [&](int px) { return std::max(1, static_cast<int>(scale * px)); };
  const std::vector<cv::Point> chosen = Places(small, reduced(compared), reduced(added)).chosen();
  const auto at = [&](int block) {
    const cv::Point place = chosen[static_cast<std::size_t>(block)];
    const auto full = [&](int px) { return static_cast<int>(std::lround(px / scale)); };
    const int x = std::min(full(place.x), size.width - compared - added);
    return each(planes, [&](const cv::Mat& of) {
      return place_of(of, cv::Rect(x, full(place.y), compared + added, size.height));
    });
  };
  Planes out = at(0);
  for (int block = 1; block < kBlocks; ++block) {
    if (chosen[static_cast<std::size_t>(block)] == chosen[static_cast<std::size_t>(block) - 1]) continue;
    const Planes next = at(block);
    const cv::Range rows(rows_of(block, size.height).start, rows_of(block - 1, size.height).end);
    const std::vector<int> seam = cheapest(apart(out, next).rowRange(rows).t(), 0);
    cv::Mat seen = cv::Mat::zeros(size.height, compared + added, CV_32F);
    for (int x = 0; x < seen.cols; ++x)
      seen.col(x).rowRange(rows.start + seam[static_cast<std::size_t>(x)], size.height) = 1;
    out = blended(out, next, seen);
  }
  return out;
}

/// Planes that are wider by `added` at the right.
Planes continued_right(const Planes& planes, int added) {
  const int rows = planes[kLuma].rows, end = planes[kLuma].cols;
  const int compared = added / kCompared, band = std::max(1, added / kBand);
  const Planes place = placed(planes, compared, added);
  const Planes mirror = each(planes, [&](const cv::Mat& of) {
    cv::Mat wider;
    cv::copyMakeBorder(of.colRange(end - added, end), wider, 0, 0, 0, added,
                       cv::BORDER_REFLECT | cv::BORDER_ISOLATED);
    return cv::Mat(wider.colRange(added - compared, 2 * added));
  });
  cv::Mat cost = apart(mirror, place).colRange(compared, compared + band).clone();
  for (int x = 0; x < band; ++x) cost.col(x) += kLateSeam * x / band;
  const std::vector<int> seam = cheapest(cost, band / kMirrored);
  cv::Mat seen = cv::Mat::zeros(rows, compared + added, CV_32F);
  for (int y = 0; y < rows; ++y)
    seen.row(y).colRange(compared + seam[static_cast<std::size_t>(y)], seen.cols) = 1;
  const Planes joined = blended(mirror, place, seen);
  const double light = std::max(rows, end) / kLight;
  Planes out;
  for (std::size_t k = 0; k < out.size(); ++k) {
    cv::Mat lit = joined[k];
    if (k != kMatte && k != kTrusted) {
      // Light and colour of so wide a place stay the side's.
      cv::Mat wide;
      cv::GaussianBlur(mirror[k] - lit, wide, {}, light);
      lit += wide;
    }
    cv::Mat beyond = lit.colRange(compared, compared + added);
    // Wide bands reach over the side: the rest of that goes within the seam's band.
    const cv::Mat step = planes[k].col(end - 1) - lit.col(compared - 1);
    for (int x = 0; x < added; ++x) beyond.col(x) += step * std::exp(-static_cast<double>(x) / band);
    cv::hconcat(planes[k], beyond, out[k]);
  }
  return out;
}

Planes flipped(const Planes& planes) {
  return each(planes, [](const cv::Mat& of) {
    cv::Mat out;
    cv::flip(of, out, 1);
    return out;
  });
}

Planes transposed(const Planes& planes) {
  return each(planes, [](const cv::Mat& of) { return cv::Mat(of.t()); });
}

Planes continued_across(Planes planes, int left, int right) {
  if (right > 0) planes = continued_right(planes, right);
  if (left > 0) planes = flipped(continued_right(flipped(planes), left));
  return planes;
}

/// So much beyond each side of the picture as mirrored.
void mirror_rims(cv::Mat& plane, const cv::Rect& picture, const Sides& rims) {
  const auto row = [&](int from, int to) { plane.row(from).copyTo(plane.row(to)); };
  const auto column = [&](int from, int to) { plane.col(from).copyTo(plane.col(to)); };
  for (int i = 0; i < rims.top; ++i) row(picture.y + i, picture.y - 1 - i);
  for (int i = 0; i < rims.bottom; ++i) row(picture.br().y - 1 - i, picture.br().y + i);
  for (int i = 0; i < rims.left; ++i) column(picture.x + i, picture.x - 1 - i);
  for (int i = 0; i < rims.right; ++i) column(picture.br().x - 1 - i, picture.br().x + i);
}

}  // namespace

Sides crossed_sides(const cv::Mat& motion, const cv::Mat& matte, int step) {
  double speed = 0, fluid = 0;
  for (int y = 0; y < matte.rows; ++y)
    for (int x = 0; x < matte.cols; ++x) {
      const auto& v = motion.at<cv::Vec2f>(y, x);
      const double own = matte.at<float>(y, x);
      speed += own * std::hypot(v[0], v[1]), fluid += own;
    }
  if (speed <= 0) return {};
  // Of a side's fluid how fast it goes across, beside the mean speed.
  const auto by = [&](const cv::Rect& side, int component, int length) {
    double across = 0, mass = 0;
    for (int y = side.y; y < side.br().y; ++y)
      for (int x = side.x; x < side.br().x; ++x) {
        const double own = matte.at<float>(y, x);
        across += own * std::abs(motion.at<cv::Vec2f>(y, x)[component]), mass += own;
      }
    if (mass < kSideShare * side.area() || across * fluid < kCrosses * speed * mass) return 0;
    const int even = std::max(kEven, step);
    return static_cast<int>(length / kReach) / even * even;
  };
  const int w = matte.cols, h = matte.rows, strip = std::max(1, std::min(w, h) / kStrips);
  return {.left = by({0, 0, strip, h}, 0, w),
          .right = by({w - strip, 0, strip, h}, 0, w),
          .top = by({0, 0, w, strip}, 1, h),
          .bottom = by({0, h - strip, w, strip}, 1, h)};
}

ContinuedFluid continued(const FluidPlanes& planes, const cv::Mat& matte, const Sides& by) {
  const cv::Rect picture({by.left, by.top}, matte.size());
  if (by.left + by.right + by.top + by.bottom == 0) return {planes, matte, picture};
  // What goes on does so from within the rim, which nothing brings that is carried far over a side. What has hardly
  // been carried leaves less of it out (rim_left_out), and reads the rim's mirror image.
  const auto rim = [](int side, int length) { return side > 0 ? length / sampling::kRims : 0; };
  const int left = rim(by.left, matte.cols), right = rim(by.right, matte.cols), top = rim(by.top, matte.rows),
            bottom = rim(by.bottom, matte.rows);
  const cv::Rect within(left, top, matte.cols - left - right, matte.rows - top - bottom);
  const Planes own{planes.luma, planes.blue, planes.red, planes.trusted, matte};
  Planes all = each(own, [&](const cv::Mat& of) { return of(within); });
  all = continued_across(all, by.left - left, by.right - right);
  if (by.top + by.bottom > 0)
    all = transposed(continued_across(transposed(all), by.top - top, by.bottom - bottom));
  struct Part {
    int first, from, length;  // where it lies, and where in what was made without the rims
  };
  const std::array<Part, 3> across{
      {{0, 0, by.left},
       {by.left, by.left - 2 * left, matte.cols},
       {by.left + matte.cols, by.left + matte.cols - 2 * (left + right), by.right}}},
      down{{{0, 0, by.top},
            {by.top, by.top - 2 * top, matte.rows},
            {by.top + matte.rows, by.top + matte.rows - 2 * (top + bottom), by.bottom}}};
  all = each(all, [&](const cv::Mat& of) {
    cv::Mat out(by.top + matte.rows + by.bottom, by.left + matte.cols + by.right, of.type());
    for (const Part& y : down)
      for (const Part& x : across)
        if (x.length > 0 && y.length > 0)
          of(cv::Rect(x.from, y.from, x.length, y.length))
              .copyTo(out(cv::Rect(x.first, y.first, x.length, y.length)));
    return out;
  });
  for (std::size_t k = 0; k < all.size(); ++k) {
    own[k].copyTo(all[k](picture));
    mirror_rims(all[k], picture, {.left = left, .right = right, .top = top, .bottom = bottom});
  }
  return {.planes = {.luma = all[kLuma], .blue = all[kBlue], .red = all[kRed], .trusted = all[kTrusted]},
          .matte = all[kMatte],
          .picture = picture};
}

}  // namespace freshet::synth::animate
