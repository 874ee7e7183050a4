#include "synth/animate/motion/motion_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "platform/smoothstep.h"
#include "stored/clip_cells.h"
#include "vision/dot.h"
#include "vision/look/horizon.h"
#include "vision/patch_features.h"

namespace freshet::synth::animate {
namespace {

constexpr double kEvened = 0.01;  // sigma of asked directions, of the picture's diagonal
// Of evened motion: sigma of what lies around and of what is a place's own, of the longer side; px that it is evened
// by; of the mean speed around, that of what rests and of what goes.
constexpr double kAround = 0.15, kOfAPlace = 0.025;
constexpr int kEvenStep = 8;
constexpr float kRests = 0.3f, kGoes = 0.8f;
constexpr float kFlows = 0.5f;                  // the same, of what counts in that mean
constexpr int kMeans = 3;                       // of all fluid, then of what goes
constexpr float kOppose = 0.1f, kAgree = 0.3f;  // the mean motion's length, of the mean speed
constexpr float kMostQuickened = 4;             // by a place's own speed
constexpr float kLeastFluid = 1e-6f;            // of all around: else there is none

// Of water that falls freely. Lengths are those of a picture of 640 px.
constexpr double kMeantFor_px = 640, kStreak_px = 1.5, kFallEdge_px = 6;
constexpr double kLeastFall = 0.25;                          // of the picture's height
constexpr double kStreakedFrom = 0.5, kStreakedSure = 0.57;  // of all gradients, those across
constexpr float kLeans = 0.47f;                              // tangent of 25 degrees
constexpr double kGained = 3, kLost = 0.9;                   // of the first speed's square, down and up
constexpr double kEvenRows = 0.05;                           // sigma, of the height
constexpr float kMostFaster = 4;
constexpr double kFalls = 0.35, kMostGain = 4;  // longer sides a second; times the patches' own mean speed
// Of what is thrown up: of half its width what rises, in the middle (.21 of a fountain's places do, .33 of a simulated
// one's), and to both sides of that, over which it goes over to what comes down; how far above it air is looked for, of
// the picture's height.
constexpr float kCore = 0.35f, kCoreEdge = 0.2f;
constexpr double kOpen = 0.02;

/// Directions evened out, of length 1 where they agree and less where they oppose each other; 0 where none is asked.
cv::Mat evened(const cv::Mat& direction) {
  cv::Mat asked(direction.size(), CV_32F), out, mass;
  for (int y = 0; y < direction.rows; ++y)
    for (int x = 0; x < direction.cols; ++x)
      asked.at<float>(y, x) = direction.at<cv::Vec2f>(y, x) != cv::Vec2f(0, 0) ? 1.0f : 0.0f;
  const double sigma = kEvened * std::hypot(direction.cols, direction.rows);
  cv::GaussianBlur(direction, out, {}, sigma, sigma, cv::BORDER_REPLICATE);
  cv::GaussianBlur(asked, mass, {}, sigma, sigma, cv::BORDER_REPLICATE);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x)
      out.at<cv::Vec2f>(y, x) *= asked.at<float>(y, x) / std::max(mass.at<float>(y, x), 1e-6f);
  return out;
}

double unit_of(const cv::Mat& picture) { return std::max(picture.cols, picture.rows) / kMeantFor_px; }

/// Squares of gradients across and of all: CV_32FC2.
cv::Mat uprightness(const cv::Mat& luma, double unit) {
  cv::Mat soft, across, down, out;
  cv::GaussianBlur(luma, soft, {}, kStreak_px * unit, kStreak_px * unit, cv::BORDER_REPLICATE);
  cv::Sobel(soft, across, CV_32F, 1, 0);
  cv::Sobel(soft, down, CV_32F, 0, 1);
  across = across.mul(across);
  cv::merge(std::vector<cv::Mat>{across, across + down.mul(down)}, out);
  return out;
}

/// Of all gradients within a stretch those across, but at its own border.
double share_across(const cv::Mat& uprightness, const cv::Mat& stretch) {
  cv::Mat within;
  cv::erode(stretch, within, cv::Mat::ones(9, 9, CV_8U));
  const cv::Scalar mean = cv::mean(uprightness, within);
  return mean[1] > 0 ? mean[0] / mean[1] : 0;
}

/// What is to go down (way 1) or up (-1) at no speed that is asked: CV_8U.
cv::Mat upright(const cv::Mat& motion, const query::MotionGuide& guide, const cv::Mat& matte, float way) {
  cv::Mat out(motion.size(), CV_8U);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const cv::Vec2f v = motion.at<cv::Vec2f>(y, x);
      const bool free = guide.direction.at<cv::Vec2f>(y, x) != cv::Vec2f(0, 0) &&
                        (guide.speed.empty() || guide.speed.at<float>(y, x) < 0);
      out.at<std::uint8_t>(y, x) =
          free && matte.at<float>(y, x) > 0.5f && way * v[1] > 0 && std::abs(v[0]) < kLeans * way * v[1] ? 255
                                                                                                         : 0;
    }
  return out;
}

/// Water that goes down or up as by its weight.
struct Stretch {
  cv::Mat within;   // CV_8U
  cv::Range rows;   // that it lies in
  double sure = 0;  // 0..1, > 0
};

std::vector<Stretch> stretches(const cv::Mat& motion, const query::MotionGuide& guide, const cv::Mat& luma,
                               const cv::Mat& matte, float way) {
  if (guide.direction.empty() || guide.horizon) return {};  // a horizon is a plane's
  std::vector<Stretch> out;
  cv::Mat labels, stats, unused, across;
  const int found =
      cv::connectedComponentsWithStats(upright(motion, guide, matte, way), labels, stats, unused, 4);
  for (int label = 1; label < found; ++label) {
    const int first = stats.at<int>(label, cv::CC_STAT_TOP), rows = stats.at<int>(label, cv::CC_STAT_HEIGHT);
    if (rows < kLeastFall * motion.rows) continue;
    if (across.empty()) across = uprightness(luma, unit_of(luma));
    Stretch stretch{labels == label, {first, first + rows}};
    stretch.sure = smoothstep(kStreakedFrom, kStreakedSure, share_across(across, stretch.within));
    if (stretch.sure > 0) out.push_back(std::move(stretch));
  }
  return out;
}

/// Nothing of the fluid lies above a stretch, nor does it leave the picture there.
bool ends_in_the_open(const Stretch& stretch, const cv::Mat& matte) {
  if (stretch.rows.start == 0) return false;
  const int above = std::max(stretch.rows.start - static_cast<int>(std::lround(kOpen * matte.rows)), 0);
  cv::Mat across;
  cv::reduce(stretch.within.rowRange(stretch.rows.start, stretch.rows.start + 1), across, 0, cv::REDUCE_MAX);
  return cv::mean(matte.row(above), across)[0] < 0.5;
}

/// Of a row of a stretch, how far what comes down shows: not in the core, alone at the flanks.
void share_row(const std::uint8_t* within, int n, float sure, float* share) {
  for (int first = 0, end = 0; first < n; first = end) {
    while (first < n && within[first] == 0) ++first;
    for (end = first; end < n && within[end] != 0;) ++end;
    for (int x = first; x < end; ++x) {
      const float side =
          std::abs(2 * (static_cast<float>(x - first) + 0.5f) / static_cast<float>(end - first) - 1);
      share[x] = sure * smoothstep(kCore - kCoreEdge, kCore + kCoreEdge, side);
    }
  }
}

/// What is said of the fluid evened across the ends of a stretch, where nothing is to jump. Within the matte.
cv::Mat evened_ends(const cv::Mat& values, const cv::Mat& matte) {
  const double sigma = kFallEdge_px * unit_of(matte);
  cv::Mat mass, out;
  cv::GaussianBlur(values.mul(matte), out, {}, sigma, sigma, cv::BORDER_REPLICATE);
  cv::GaussianBlur(matte, mass, {}, sigma, sigma, cv::BORDER_REPLICATE);
  out /= cv::max(mass, 1e-3);
  return out;
}

/// By row of a stretch, what speeds are multiplied by.
std::vector<float> fall_factors(const cv::Mat& motion, const Stretch& stretch, bool down, double usual) {
  const cv::Range& rows = stretch.rows;
  cv::Mat sums = cv::Mat::zeros(rows.size(), 1, CV_32F), counts = sums.clone();
  for (int y = rows.start; y < rows.end; ++y)
    for (int x = 0; x < motion.cols; ++x)
      if (stretch.within.at<std::uint8_t>(y, x) != 0) {
        const cv::Vec2f v = motion.at<cv::Vec2f>(y, x);
        sums.at<float>(y - rows.start) += std::hypot(v[0], v[1]);
        counts.at<float>(y - rows.start) += 1;
      }
  std::vector<float> factors;
  double wanted = 0;
  for (int i = 0; i < rows.size(); ++i) {
    const double way = (down ? i + 0.5 : rows.size() - i - 0.5) / rows.size();
    factors.push_back(static_cast<float>(std::sqrt(1 + (down ? kGained : -kLost) * way)));
    wanted += factors.back() * counts.at<float>(i);
  }
  const double own = cv::sum(sums)[0] / std::max(cv::sum(counts)[0], 1.0),
               gain = std::clamp(usual / std::max(own, 1e-3), 1.0, kMostGain);
  const auto mean = static_cast<float>(gain * cv::sum(sums)[0] / wanted);
  const double even = kEvenRows * rows.size();
  cv::GaussianBlur(sums, sums, {1, 0}, 1e-6, even, cv::BORDER_REPLICATE);
  cv::GaussianBlur(counts, counts, {1, 0}, 1e-6, even, cv::BORDER_REPLICATE);
  for (int i = 0; i < rows.size(); ++i) {
    const float found = sums.at<float>(i) / std::max(counts.at<float>(i), 1.0f);
    factors[static_cast<std::size_t>(i)] *= std::min(mean / std::max(found, 1e-3f), kMostFaster);
  }
  return factors;
}

/// What evened motion makes of a place.
struct Evened {
  cv::Vec2f motion{0, 0};         // px/s: the mean's, as far as ways agree
  float keeps = 1;                // times the place's own beside it
  float follows = 1, counts = 1;  // 0..1: how far it goes so, and is fluid that goes
};

/// around, near   motion, speed and mass of the fluid there, summed.
Evened evened_place(const cv::Vec4f& around, const cv::Vec4f& near) {
  if (around[3] < kLeastFluid || around[2] <= 0) return {};
  const float speed = around[2] / around[3], length = std::hypot(around[0], around[1]);
  const float agreed = smoothstep(kOppose, kAgree, length / around[2]);
  Evened out;
  if (length > 0) out.motion = cv::Vec2f(around[0], around[1]) * (agreed * speed / length);
  float share = 1;  // of the mean speed, the place's
  if (near[3] >= kLeastFluid) {
    share = near[2] / near[3] / speed;
    out.follows = smoothstep(kRests, kGoes, share);
    out.counts = smoothstep(kRests, kFlows, share);
  }
  out.keeps = (1 - agreed) * std::min(1 / std::max(share, 1e-3f), kMostQuickened);
  return out;
}

/// How fast a plane is seen to go, over its mean in the fluid. CV_32F.
cv::Mat seen_share(const Horizon& horizon, const cv::Mat& direction, const cv::Mat& matte) {
  cv::Mat seen = vision::seen_speeds(horizon, direction, matte.size());
  const double mean = vision::dot(seen, matte) / std::max(cv::sum(matte)[0], 1.0);
  if (mean > 0) seen /= mean;
  return seen;
}

}  // namespace

cv::Mat motion_field(const store::Snapshot& snapshot, const vision::Settings& settings,
                     const Placement& placement, cv::Size picture) {
  // Motion is sampled in squares of 8 px: finer than the flow is true, fine enough for a fall's edge.
  const int square = common_step(placement, 8);
  const cv::Rect canvas = canvas_of(placement);
  const cv::Size squares(canvas.width / square, canvas.height / square);
  const int per_side = placement.side / square;
  cv::Mat sum = cv::Mat::zeros(squares, CV_32FC2), mass = cv::Mat::zeros(squares, CV_32F);

  std::map<store::ClipId, vision::CellMap> cells;
  for (const PlacedPatch& placed : placement.patches) {
    auto found = cells.find(placed.clip);
    if (found == cells.end())
      found = cells.emplace(placed.clip, stored::motion_cells(snapshot, settings, placed.clip)).first;
    const store::ClipRecord& record = snapshot.clip(placed.clip);
    const vision::VariantFrame frame = vision::variant_frame(
        {static_cast<int>(record.width), static_cast<int>(record.height)}, placed.variant);
    const cv::Point corner = (placed.piece - canvas.tl()) / square;
    for (int row = 0; row < per_side; ++row)
      for (int column = 0; column < per_side; ++column) {
        const cv::Vec2f motion =
            static_cast<float>(placed.speed) *
            vision::patch_mean_motion(found->second, frame, placed.patch.x + column * square,
                                      placed.patch.y + row * square, square);
        const auto tent = [&](int i) {
          return 1 - std::abs(2 * (i + 0.5f) / static_cast<float>(per_side) - 1);
        };
        const float weight = tent(row) * tent(column);
        sum.at<cv::Vec2f>(corner.y + row, corner.x + column) += weight * motion;
        mass.at<float>(corner.y + row, corner.x + column) += weight;
      }
  }
  for (int row = 0; row < squares.height; ++row)
    for (int column = 0; column < squares.width; ++column)
      if (mass.at<float>(row, column) > 0) sum.at<cv::Vec2f>(row, column) /= mass.at<float>(row, column);

  // From squares to pixels of the picture: bilinear between the squares' middles.
  // What is enlarged goes so much faster.
  sum *= placement.piece_scale;
  cv::Mat field;
  cv::warpAffine(sum, field, squares_from_picture(placement, canvas.tl(), square, picture), picture,
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return field;
}

cv::Mat evened_motion(const cv::Mat& motion, const cv::Mat& matte, double whole) {
  cv::Mat fluid(motion.size(), CV_32FC4);  // motion, speed, and how much fluid it is
  for (int y = 0; y < motion.rows; ++y)
    for (int x = 0; x < motion.cols; ++x) {
      const cv::Vec2f& v = motion.at<cv::Vec2f>(y, x);
      fluid.at<cv::Vec4f>(y, x) = matte.at<float>(y, x) * cv::Vec4f(v[0], v[1], std::hypot(v[0], v[1]), 1);
    }
  const auto coarse = [](int n) { return (n + kEvenStep - 1) / kEvenStep; };
  cv::resize(fluid, fluid, {coarse(motion.cols), coarse(motion.rows)}, 0, 0, cv::INTER_AREA);
  const auto sums = [&](const cv::Mat& of, double share) {
    const double sigma = share * std::max(motion.cols, motion.rows) / kEvenStep;
    cv::Mat out;
    cv::GaussianBlur(of, out, {}, sigma, sigma, cv::BORDER_CONSTANT);
    return out;
  };

  // What rests is told from all that is around it, then from what goes around it.
  const cv::Mat near = sums(fluid, kOfAPlace);
  cv::Mat around = sums(fluid, kAround), counted(fluid.size(), fluid.type());
  // The mean motion as far as ways agree, what a place's own is multiplied by beside it, and how far all that is
  // followed.
  cv::Mat towards(fluid.size(), CV_32FC4);
  const auto whole_part = static_cast<float>(whole);
  for (int pass = 0; pass < kMeans; ++pass) {
    for (int y = 0; y < fluid.rows; ++y)
      for (int x = 0; x < fluid.cols; ++x) {
        const Evened place = evened_place(around.at<cv::Vec4f>(y, x), near.at<cv::Vec4f>(y, x));
        counted.at<cv::Vec4f>(y, x) = std::lerp(place.counts, 1.0f, whole_part) * fluid.at<cv::Vec4f>(y, x);
        towards.at<cv::Vec4f>(y, x) = {place.motion[0], place.motion[1], place.keeps,
                                       std::lerp(place.follows, 1.0f, whole_part)};
      }
    if (pass + 1 < kMeans) around = sums(counted, kAround);
  }

  cv::resize(towards, towards, motion.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat out = motion.clone();
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const cv::Vec4f& to = towards.at<cv::Vec4f>(y, x);
      cv::Vec2f& v = out.at<cv::Vec2f>(y, x);
      v += to[3] * (cv::Vec2f(to[0], to[1]) + to[2] * v - v);
    }
  return out;
}

double fastest_speed(cv::Size picture) { return 0.8 * std::max(picture.width, picture.height); }

cv::Mat apply_guide(const cv::Mat& motion, const query::MotionGuide& guide, const cv::Mat& matte) {
  cv::Mat out = motion.clone();
  const cv::Mat way = guide.direction.empty() ? cv::Mat() : evened(guide.direction);
  const auto fastest = static_cast<float>(fastest_speed(motion.size()));
  const cv::Mat seen = guide.horizon ? seen_share(*guide.horizon, guide.direction, matte) : cv::Mat();
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      cv::Vec2f& v = out.at<cv::Vec2f>(y, x);
      float speed = std::hypot(v[0], v[1]);
      const bool asked = !guide.speed.empty() && guide.speed.at<float>(y, x) >= 0 && speed > 0;
      if (asked || !seen.empty()) {
        const float goes =
            asked ? std::min(guide.speed.at<float>(y, x), fastest) : speed * seen.at<float>(y, x);
        if (speed > 0) v *= goes / speed;
        speed = goes;
      }
      if (!way.empty() && guide.direction.at<cv::Vec2f>(y, x) != cv::Vec2f(0, 0))
        v = way.at<cv::Vec2f>(y, x) * speed;
    }
  return out;
}

cv::Mat falling_freely(const cv::Mat& motion, const query::MotionGuide& guide, const cv::Mat& luma,
                       const cv::Mat& matte, double played) {
  const double usual = played * kFalls * std::max(luma.cols, luma.rows);
  cv::Mat times(motion.size(), CV_32F, cv::Scalar(1)), both;
  bool falls = false;
  for (const float way : {1.0f, -1.0f})
    for (const Stretch& stretch : stretches(motion, guide, luma, matte, way)) {
      const std::vector<float> factors = fall_factors(motion, stretch, way > 0, usual);
      for (int y = stretch.rows.start; y < stretch.rows.end; ++y)
        times.row(y).setTo(
            std::lerp(1, factors[static_cast<std::size_t>(y - stretch.rows.start)], stretch.sure),
            stretch.within.row(y));
      falls = true;
    }
  if (!falls) return motion;
  times = evened_ends(times, matte);
  cv::merge(std::vector<cv::Mat>{times, times}, both);
  return motion.mul(both);
}

ComingDown coming_down(const cv::Mat& motion, const query::MotionGuide& guide, const cv::Mat& luma,
                       const cv::Mat& matte) {
  ComingDown out;
  cv::Mat turned = cv::Mat::zeros(motion.size(), CV_32F);
  for (const Stretch& stretch : stretches(motion, guide, luma, matte, -1)) {
    if (!ends_in_the_open(stretch, matte)) continue;
    if (out.share.empty()) out.share = turned.clone();
    turned.setTo(1, stretch.within);
    for (int y = stretch.rows.start; y < stretch.rows.end; ++y)
      share_row(stretch.within.ptr(y), motion.cols, static_cast<float>(stretch.sure),
                out.share.ptr<float>(y));
  }
  if (out.share.empty()) return out;
  out.share = evened_ends(out.share, matte);
  turned = evened_ends(turned, matte);
  out.motion = motion.clone();
  for (int y = 0; y < motion.rows; ++y)
    for (int x = 0; x < motion.cols; ++x) out.motion.at<cv::Vec2f>(y, x)[1] *= 1 - 2 * turned.at<float>(y, x);
  return out;
}

double pace(const cv::Mat& assigned, const cv::Mat& asked, const cv::Mat& matte) {
  constexpr float kLeast = 1e-3f;  // px/s
  constexpr double kMost = 4;
  double sum = 0, mass = 0;
  for (int y = 0; y < matte.rows; ++y)
    for (int x = 0; x < matte.cols; ++x) {
      if (matte.at<std::uint8_t>(y, x) == 0) continue;
      const double had = cv::norm(assigned.at<cv::Vec2f>(y, x)), goes = cv::norm(asked.at<cv::Vec2f>(y, x));
      if (had < kLeast || goes < kLeast) continue;
      sum += goes * std::log(std::clamp(goes / had, 1 / kMost, kMost));
      mass += goes;
    }
  return mass > 0 ? std::exp(sum / mass) : 1;
}

}  // namespace freshet::synth::animate
