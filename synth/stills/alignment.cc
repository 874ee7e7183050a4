#include "synth/stills/alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "freshet/error.h"
#include "synth/stills/still_set.h"

namespace freshet::synth::stills {
namespace {

constexpr int kFeatures = 2000;
constexpr double kMatchRatio = 0.8;  // of the best match's distance to the second's (Lowe)
constexpr int kMinMatches = 20;
constexpr double kRansacPx = 1;
constexpr double kStandingShare = 0.5;  // of the pixels, those that differ least, on which ECC looks

struct Seen {
  cv::Mat grey;  // CV_8U
  std::vector<cv::KeyPoint> points;
  cv::Mat descriptors;
};

Seen look(const cv::Mat& picture, int side) {
  Seen seen;
  cv::cvtColor(reduced({picture}, side)[0], seen.grey, cv::COLOR_BGR2GRAY);
  // Dark scenes (a candle) have corners too faint for the usual threshold.
  cv::Mat even;
  cv::createCLAHE(3, {8, 8})->apply(seen.grey, even);
  cv::ORB::create(kFeatures, 1.2f, 8, 15, 0, 2, cv::ORB::HARRIS_SCORE, 31, 8)
      ->detectAndCompute(even, {}, seen.points, seen.descriptors);
  return seen;
}

/// A map that was found, and with how many numbers it is free.
struct Found {
  cv::Mat map;  // 3 x 3, CV_64F; empty: none that could be relied on
  bool projective = false;
};

// The camera's turn and shift, or a homography where that explains clearly more: features in one corner
// alone would leave its far corners to chance.
Found map_of(const std::vector<cv::Point2f>& from, const std::vector<cv::Point2f>& to, cv::Mat& inliers) {
  constexpr double kProjectiveGain = 1.2;
  Found found;
  const cv::Mat similar = cv::estimateAffinePartial2D(from, to, inliers, cv::RANSAC, kRansacPx, 2000, .995);
  if (!similar.empty()) {
    found.map = cv::Mat::eye(3, 3, CV_64F);
    similar.copyTo(found.map(cv::Rect(0, 0, 3, 2)));
  }
  cv::Mat more;
  const cv::Mat homography = cv::findHomography(from, to, cv::RANSAC, kRansacPx, more, 2000, .995);
  const int similar_count = similar.empty() ? 0 : cv::countNonZero(inliers);
  if (!homography.empty() && cv::countNonZero(more) > kProjectiveGain * similar_count) {
    found = {homography, true};
    inliers = more;
  }
  return found;
}

// A map is relied on where many features follow it, all over the picture, and clearly more than stay where
// they are: on a tripod what is matched stands still, or is fluid that looks like itself elsewhere.
Found camera_motion(const Seen& reference, const Seen& still) {
  constexpr int kCells = 4, kMinCells = 5;
  constexpr double kMoreThanStay = 1.25;
  if (reference.descriptors.empty() || still.descriptors.empty()) return {};
  std::vector<std::vector<cv::DMatch>> matches;
  cv::BFMatcher(cv::NORM_HAMMING).knnMatch(reference.descriptors, still.descriptors, matches, 2);
  std::vector<cv::Point2f> from, to;
  int staying = 0;
  for (const auto& match : matches)
    if (match.size() == 2 && match[0].distance < kMatchRatio * match[1].distance) {
      from.push_back(reference.points[match[0].queryIdx].pt);
      to.push_back(still.points[match[0].trainIdx].pt);
      staying += cv::norm(from.back() - to.back()) < kRansacPx;
    }
  if (from.size() < kMinMatches) return {};
  cv::Mat inliers;
  const Found found = map_of(from, to, inliers);
  const int following = found.map.empty() ? 0 : cv::countNonZero(inliers);
  if (following < kMinMatches || following < kMoreThanStay * staying) return {};
  bool seen[kCells * kCells] = {};
  for (std::size_t i = 0; i < from.size(); ++i)
    if (inliers.at<std::uint8_t>(static_cast<int>(i)) != 0) {
      const int x = static_cast<int>(from[i].x * kCells / static_cast<float>(reference.grey.cols));
      const int y = static_cast<int>(from[i].y * kCells / static_cast<float>(reference.grey.rows));
      seen[std::clamp(y, 0, kCells - 1) * kCells + std::clamp(x, 0, kCells - 1)] = true;
    }
  return std::count(std::begin(seen), std::end(seen), true) < kMinCells ? Found() : found;
}

double corner_motion(const cv::Mat& map, cv::Size size) {
  const auto w = static_cast<float>(size.width), h = static_cast<float>(size.height);
  const std::vector<cv::Point2f> corners{{0, 0}, {w, 0}, {0, h}, {w, h}};
  std::vector<cv::Point2f> moved;
  cv::perspectiveTransform(corners, moved, map);
  double most = 0;
  for (int i = 0; i < 4; ++i) most = std::max(most, cv::norm(moved[i] - corners[i]));
  return std::isfinite(most) ? most : 1e9;
}

cv::Mat seen_from_reference(const cv::Mat& grey, const cv::Mat& map, int border = cv::BORDER_REPLICATE) {
  cv::Mat out;
  cv::warpPerspective(grey, out, map, grey.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, border);
  return out;
}

// Where the two differ least, of what both show.
cv::Mat standing(const cv::Mat& reference, const cv::Mat& grey, const cv::Mat& map) {
  cv::Mat difference,
      shown = seen_from_reference(cv::Mat(grey.size(), CV_8U, cv::Scalar(255)), map, cv::BORDER_CONSTANT);
  cv::absdiff(reference, seen_from_reference(grey, map), difference);
  cv::blur(difference, difference, {15, 15});
  int histogram[256] = {};
  int total = 0;
  for (int y = 0; y < difference.rows; ++y)
    for (int x = 0; x < difference.cols; ++x)
      if (shown.at<std::uint8_t>(y, x) == 255) ++histogram[difference.at<std::uint8_t>(y, x)], ++total;
  int limit = 0;
  for (int seen = 0; limit < 255 && (seen += histogram[limit]) < kStandingShare * total;) ++limit;
  return (difference <= limit) & (shown == 255);
}

// -1..1; of the two where the mask is.
double correlation(const cv::Mat& a, const cv::Mat& b, const cv::Mat& mask) {
  cv::Scalar mean_a, mean_b, dev_a, dev_b;
  cv::meanStdDev(a, mean_a, dev_a, mask);
  cv::meanStdDev(b, mean_b, dev_b, mask);
  cv::Mat fa, fb, product;
  a.convertTo(fa, CV_32F, 1, -mean_a[0]);
  b.convertTo(fb, CV_32F, 1, -mean_b[0]);
  cv::multiply(fa, fb, product);
  const double spread = dev_a[0] * dev_b[0];
  return spread > 0 ? cv::mean(product, mask)[0] / spread : 1;
}

struct Fit {
  cv::Mat map;  // of the copies
  double agreement = 0;
};

Fit fit(const Seen& reference, const Seen& still) {
  constexpr double kFurther = 3;  // px, that ECC may move a corner from where the features have it
  const auto judged = [&](const cv::Mat& map) {
    return Fit{map, correlation(reference.grey, seen_from_reference(still.grey, map),
                                standing(reference.grey, still.grey, map))};
  };
  const Fit none = judged(cv::Mat::eye(3, 3, CV_64F));
  const Found found = camera_motion(reference, still);
  if (found.map.empty()) return none;
  Fit best = judged(found.map);
  cv::Mat refined;
  found.map.convertTo(refined, CV_32F);
  if (!found.projective) refined = refined.rowRange(0, 2).clone();
  try {
    cv::findTransformECC(reference.grey, still.grey, refined,
                         found.projective ? cv::MOTION_HOMOGRAPHY : cv::MOTION_AFFINE,
                         {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 25, 1e-4},
                         standing(reference.grey, still.grey, found.map), 5);
    cv::Mat as_double = cv::Mat::eye(3, 3, CV_64F), part = as_double.rowRange(0, refined.rows);
    refined.convertTo(part, CV_64F);
    if (corner_motion(as_double * found.map.inv(), reference.grey.size()) < kFurther)
      if (Fit other = judged(as_double); other.agreement > best.agreement) best = std::move(other);
  } catch (const cv::Exception&) {
    // ECC did not converge: what the features said stands, and is judged by its agreement.
  }
  return best.agreement > none.agreement ? best : none;
}

// The largest box about the middle that every still covers, found by shrinking.
cv::Rect common_box(const std::vector<cv::Mat>& maps, cv::Size size) {
  for (double cut = 0; cut < 0.5; cut += 0.0025) {
    const int x = static_cast<int>(std::ceil(cut * size.width)),
              y = static_cast<int>(std::ceil(cut * size.height));
    const cv::Rect box(x, y, size.width - 2 * x, size.height - 2 * y);
    std::vector<cv::Point2f> corners, moved;
    for (const auto& [px, py] : {std::pair(box.x, box.y),
                                 {box.x + box.width - 1, box.y},
                                 {box.x, box.y + box.height - 1},
                                 {box.x + box.width - 1, box.y + box.height - 1}})
      corners.emplace_back(static_cast<float>(px), static_cast<float>(py));
    const bool inside = std::all_of(maps.begin(), maps.end(), [&](const cv::Mat& map) {
      cv::perspectiveTransform(corners, moved, map);
      return std::all_of(moved.begin(), moved.end(), [&](const cv::Point2f& p) {
        return p.x >= 0 && p.y >= 0 && p.x <= static_cast<float>(size.width - 1) &&
               p.y <= static_cast<float>(size.height - 1);
      });
    });
    if (inside) return box;
  }
  return {};
}

}  // namespace

Alignment find_alignment(const std::vector<cv::Mat>& pictures, const std::vector<std::string>& names,
                         const AlignmentOptions& options, const Job& job) {
  const int n = static_cast<int>(pictures.size());
  std::vector<Seen> seen(pictures.size());
  oneapi::tbb::parallel_for(0, n, [&](int i) { seen[i] = look(pictures[i], options.side); });
  std::vector<Fit> fits(pictures.size());
  fits[0] = {cv::Mat::eye(3, 3, CV_64F), 1};
  std::mutex reporting;
  std::size_t done = 0;
  oneapi::tbb::parallel_for(1, n, [&](int i) {
    if (job.stop.stop_requested()) return;
    fits[i] = fit(seen[0], seen[i]);
    const std::lock_guard lock(reporting);
    if (job.progress) job.progress({"aligning", ++done, pictures.size() - 1});
  });
  if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "stills", "stopped");

  Alignment alignment;
  const cv::Size full = pictures[0].size(), small = seen[0].grey.size();
  const auto fitting = std::count_if(
      fits.begin() + 1, fits.end(), [&](const Fit& each) { return each.agreement >= options.min_agreement; });
  if (2 * fitting < n - 1) {
    // Open sea: nothing stands still by which anything could be said of the camera.
    alignment.tripod = alignment.unsure = true;
    alignment.common = cv::Rect({}, full);
    return alignment;
  }
  double most = 0;
  for (int i = 0; i < n; ++i) {
    if (fits[i].agreement < options.min_agreement)
      throw Error(
          ErrorKind::kInput, names[i],
          fmt::format("it does not fit onto {}: what stands still agrees to {:.2f} of 1, at least {:.2f} is "
                      "needed",
                      names[0], fits[i].agreement, options.min_agreement),
          "Take it out of the folder if it shows another view; if the camera stood still, say --camera "
          "tripod");
    most = std::max(most, corner_motion(fits[i].map, small));
    const cv::Mat up = cv::Mat(
        cv::Matx33d(1.0 * full.width / small.width, 0, 0, 0, 1.0 * full.height / small.height, 0, 0, 0, 1));
    alignment.maps.push_back(up * fits[i].map * up.inv());
  }
  alignment.largest_px = most * full.width / small.width;
  alignment.tripod = most < options.still_px;
  alignment.common = cv::Rect({}, full);
  if (alignment.tripod) return alignment;
  alignment.common = common_box(alignment.maps, full);
  if (alignment.common.width < (1 - options.max_cut) * full.width ||
      alignment.common.height < (1 - options.max_cut) * full.height)
    throw Error(ErrorKind::kInput, names[0],
                fmt::format("the stills have too little in common: {} x {} of {} x {} px",
                            alignment.common.width, alignment.common.height, full.width, full.height),
                "Take out those from another place; if the camera stood still, say --camera tripod");
  return alignment;
}

void align(std::vector<cv::Mat>& pictures, const Alignment& alignment) {
  if (alignment.tripod) return;
  oneapi::tbb::parallel_for(std::size_t{0}, pictures.size(), [&](std::size_t i) {
    const cv::Rect& box = alignment.common;
    cv::Mat moved, shift = cv::Mat::eye(3, 3, CV_64F);
    shift.at<double>(0, 2) = box.x;
    shift.at<double>(1, 2) = box.y;
    cv::warpPerspective(pictures[i], moved, alignment.maps[i] * shift, box.size(),
                        cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    pictures[i] = moved;
  });
}

std::vector<cv::Vec3d> find_levels(const std::vector<cv::Mat>& small) {
  constexpr double kMinStanding = .02;
  constexpr int kDark = 16, kBright = 244;
  std::vector<cv::Vec3d> factors(small.size(), cv::Vec3d(1, 1, 1));
  // The middle of all stills at each pixel; what stands still is near it in most of them, but for one factor.
  const cv::Size size = small[0].size();
  cv::Mat middle(size, CV_8UC3);
  cv::Mat spread(size, CV_32F);
  std::vector<std::uint8_t> values(small.size());
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      float widest = 0;
      for (int c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < small.size(); ++i) values[i] = small[i].at<cv::Vec3b>(y, x)[c];
        std::sort(values.begin(), values.end());
        middle.at<cv::Vec3b>(y, x)[c] = values[values.size() / 2];
        const int quarter = static_cast<int>(values.size()) / 4;
        widest = std::max(widest, static_cast<float>(values[values.size() - 1 - quarter] - values[quarter]) /
                                      static_cast<float>(std::max<int>(kDark, values[values.size() / 2])));
      }
      spread.at<float>(y, x) = widest;
    }
  std::vector<float> sorted(spread.begin<float>(), spread.end<float>());
  const auto third = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 3);
  std::nth_element(sorted.begin(), third, sorted.end());
  const cv::Mat calm = spread <= std::max(*third, .04f);
  for (std::size_t i = 0; i < small.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      std::vector<double> ratios;
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
          const int m = middle.at<cv::Vec3b>(y, x)[c], v = small[i].at<cv::Vec3b>(y, x)[c];
          if (calm.at<std::uint8_t>(y, x) != 0 && m > kDark && m < kBright && v > kDark && v < kBright)
            ratios.push_back(static_cast<double>(m) / v);
        }
      if (static_cast<double>(ratios.size()) < kMinStanding * static_cast<double>(size.area())) continue;
      // The mean of the middle half: a median of eight bits' ratios would come in steps.
      std::sort(ratios.begin(), ratios.end());
      double sum = 0;
      const std::size_t low = ratios.size() / 4, high = ratios.size() - low;
      for (std::size_t k = low; k < high; ++k) sum += ratios[k];
      factors[i][c] = sum / static_cast<double>(high - low);
    }
  return factors;
}

int level(std::vector<cv::Mat>& pictures, const std::vector<cv::Vec3d>& factors) {
  constexpr double kSmallest = .004;
  int changed = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const cv::Vec3d& by = factors[i];
    if (std::abs(by[0] - 1) < kSmallest && std::abs(by[1] - 1) < kSmallest && std::abs(by[2] - 1) < kSmallest)
      continue;
    cv::Mat out;
    cv::multiply(pictures[i], cv::Scalar(by[0], by[1], by[2]), out);
    pictures[i] = out;
    ++changed;
  }
  return changed;
}

}  // namespace freshet::synth::stills
