#include "vision/detail_lifetime.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "vision/flow.h"
#include "vision/pyramid.h"

namespace freshet::vision {
namespace {

constexpr double kFps = 25;
constexpr int kStep = 2;

struct Clip {
  std::vector<cv::Mat> luma;  // CV_8U
  std::vector<cv::Mat> u, v;  // CV_16S, one fewer
};

/// Noise in bands of all sizes, standard deviation about 1.
cv::Mat rich(cv::Size size, cv::RNG& random) {
  cv::Mat sum = cv::Mat::zeros(size, CV_32F), noise(size, CV_32F);
  for (const double sigma : {0.8, 2.0, 4.0, 8.0}) {
    random.fill(noise, cv::RNG::NORMAL, 0, 1);
    cv::GaussianBlur(noise, noise, {}, sigma);
    sum += noise * sigma;
  }
  return sum;
}

void append(Clip& clip, const cv::Mat& luma, cv::Vec2d flow = {}) {
  cv::Mat bytes;
  luma.convertTo(bytes, CV_8U);
  if (!clip.luma.empty()) {
    clip.u.emplace_back();
    clip.v.emplace_back();
    quantize_flow(cv::Mat(bytes.size(), CV_32FC2, cv::Scalar(flow[0], flow[1])), kStep, clip.u.back(),
                  clip.v.back());
  }
  clip.luma.push_back(bytes);
}

/// A texture that goes `step` whole pixels to the right in every frame and keeps kept(x) of itself; the rest comes
/// anew. Detail then keeps kept^n of its correlation after n frames.
struct Carried {
  cv::Size size{320, 192};
  int frames = 80, step = 2;
  double deviation = 20;                                      // luma, 0..255
  double noise = 0;                                           // the same, of every frame for itself
  std::function<double(int)> kept = [](int) { return 1.0; };  // by column; of the middle of what goes there
};

Clip carried(const Carried& made) {
  // The fluid is as wide as all that is ever seen of it.
  const cv::Size fluid(made.size.width + made.step * (made.frames - 1), made.size.height);
  cv::RNG random(11);
  cv::Mat state = rich(fluid, random), noise(made.size, CV_32F);
  Clip clip;
  for (int i = 0; i < made.frames; ++i) {
    const int left = made.step * (made.frames - 1 - i);
    random.fill(noise, cv::RNG::NORMAL, 0, made.noise + 1e-6);
    append(clip, state(cv::Rect({left, 0}, made.size)) * made.deviation + noise + 128,
           {static_cast<double>(made.step), 0});
    const cv::Mat fresh = rich(fluid, random);
    for (int x = 0; x < fluid.width; ++x) {
      const double kept = made.kept(x - left);
      state.col(x) = kept * state.col(x) + std::sqrt(1 - kept * kept) * fresh.col(x);
    }
  }
  return clip;
}

DetailLifetimes measured(const Clip& clip, const cv::Mat& moving = {}) {
  const cv::Size size = clip.luma[0].size();
  DetailLifetimeAccumulator accumulator(size, kStep, kFps);
  accumulator.begin(clip.luma[0]);
  for (std::size_t i = 1; i < clip.luma.size(); ++i)
    accumulator.add(clip.u[i - 1], clip.v[i - 1], clip.luma[i]);
  return accumulator.finish(moving.empty() ? cv::Mat(size, CV_8U, cv::Scalar(255)) : moving);
}

double half_life_s(double kept) { return std::log(0.5) / std::log(kept) / kFps; }

TEST(DetailLifetime, IsTheTimeInWhichHalfOfTheCorrelationIsLost) {
  for (const double kept : {0.5, 0.8, 0.93, 0.97}) {
    const DetailLifetimes life = measured(carried({.kept = [&](int) { return kept; }}));
    for (int b = 0; b < kLifeBands; ++b)
      EXPECT_NEAR(life.clip[b] / half_life_s(kept), 1, b < 3 ? 0.07 : 0.15) << kept << " band " << b;
  }
}

TEST(DetailLifetime, BeyondWhatIsFollowedTheFallGoesOn) {
  const DetailLifetimes life = measured(carried({.kept = [](int) { return 0.99; }}));
  for (int b = 0; b < kLifeBands; ++b) EXPECT_NEAR(life.clip[b] / half_life_s(0.99), 1, 0.2) << b;
}

TEST(DetailLifetime, OfWhatIsOnlyCarriedIsTheLongest) {
  for (const float life : measured(carried({})).clip) EXPECT_EQ(life, kLongestLife_s);
}

/// A texture that goes by over one that stays; `share` of the variance stays, left and right of the middle.
Clip over_standing(double left, double right, cv::Vec2i step) {
  const cv::Size size(320, 192);
  constexpr int kFrames = 80;
  cv::RNG random(5);
  const cv::Mat going = rich({size.width + step[0] * (kFrames - 1), size.height}, random),
                standing = rich(size, random);
  Clip clip;
  for (int i = 0; i < kFrames; ++i) {
    const cv::Mat fluid = going(cv::Rect({step[0] * (kFrames - 1 - i), 0}, size));
    cv::Mat luma(size, CV_32F);
    for (int x = 0; x < size.width; ++x) {
      const double share = x < size.width / 2 ? left : right;
      luma.col(x) = 20 * (std::sqrt(1 - share) * fluid.col(x) + std::sqrt(share) * standing.col(x)) + 128;
    }
    append(clip, luma, {static_cast<double>(step[0]), 0});
  }
  return clip;
}

TEST(DetailStanding, IsTheShareOfTheVarianceThatTheFlowLeavesBehind) {
  for (const double share : {0.0, 0.3, 0.7}) {
    const DetailLifetimes life = measured(over_standing(share, share, {3, 0}));
    for (int b = 0; b < kLifeBands; ++b) EXPECT_NEAR(life.clip_standing[b], share, b < 3 ? 0.07 : 0.12) << b;
  }
}

TEST(DetailStanding, IsKnownCellByCell) {
  const DetailLifetimes life = measured(over_standing(0, 0.8, {3, 0}));
  ASSERT_EQ(life.standing.values.size(), 60u * kStandingChannels);
  for (int row = 0; row < 6; ++row) {
    EXPECT_LT(life.standing.at(row, 1)[1], 0.2f) << row;
    EXPECT_NEAR(life.standing.at(row, 8)[1], 0.8f, 0.15f) << row;
  }
}

TEST(DetailStanding, OfBandsThatAreNotCarriedAwayIsTheFinerOnes) {
  // 32 frames of .4 px: the finest two wavelengths are left behind, the others never.
  Clip clip = over_standing(0.5, 0.5, {0, 0});
  for (cv::Mat& u : clip.u) u.setTo(cv::Scalar(0.4 * 64));
  const DetailLifetimes life = measured(clip);
  // What flow is said to have carried away and is all there: it stands.
  EXPECT_GT(life.clip_standing[0], 0.95f);
  EXPECT_GT(life.clip_standing[1], 0.95f);
  EXPECT_EQ(life.clip_standing[2], life.clip_standing[1]);
  EXPECT_EQ(life.clip_standing[3], life.clip_standing[1]);
}

TEST(DetailStanding, OfNothingThatMovesIsNone) {
  const DetailLifetimes life = measured(over_standing(0.5, 0.5, {0, 0}));
  EXPECT_EQ(life.clip_standing, (std::array<float, kLifeBands>{}));
  for (const float share : life.standing.values) EXPECT_EQ(share, 0);
}

/// A texture that goes 3 px to the right in every frame, strong and weak in spots of some 40 px: these stand, or go
/// along.
Clip spotted(bool stands) {
  const cv::Size size(320, 192);
  constexpr int kFrames = 80, kBy = 3;
  cv::RNG random(5);
  const cv::Size long_size(size.width + kBy * (kFrames - 1), size.height);
  cv::Mat going = rich(long_size, random), spots(stands ? size : long_size, CV_32F);
  random.fill(spots, cv::RNG::NORMAL, 0, 1);
  cv::GaussianBlur(spots, spots, {}, 10);
  cv::exp(spots * 30, spots);
  Clip clip;
  for (int i = 0; i < kFrames; ++i) {
    const cv::Rect now({kBy * (kFrames - 1 - i), 0}, size);
    append(clip, 8 * going(now).mul(stands ? spots : spots(now)) + 128, {static_cast<double>(kBy), 0});
  }
  return clip;
}

TEST(DetailLayout, TellsContrastThatStandsFromContrastThatGoes) {
  for (const bool stands : {false, true}) {
    const CellMap layout = measured(spotted(stands)).layout;
    ASSERT_EQ(layout.values.size(), 60u * kLayoutChannels);
    double stayed = 0, went = 0;  // of the band of 8 px
    for (int cell = 0; cell < 60; ++cell) {
      stayed += layout.at(cell / 10, cell % 10)[1] / 60;
      went += layout.at(cell / 10, cell % 10)[kLifeBands + 1] / 60;
    }
    EXPECT_GT(stands ? stayed : went, 0.6) << stands;
    EXPECT_LT(stands ? went : stayed, 0.35) << stands;
  }
}

TEST(DetailLayout, OfNothingThatMovesIsNone) {
  for (const float share : measured(over_standing(0.5, 0.5, {0, 0})).layout.values) EXPECT_EQ(share, 0);
}

TEST(DetailLifetime, OfNoiseIsLessThanAFrame) {
  Clip clip;
  cv::RNG random(3);
  cv::Mat noise(192, 320, CV_32F);
  for (int i = 0; i < 60; ++i) {
    random.fill(noise, cv::RNG::NORMAL, 128, 20);
    append(clip, noise, {1, 0});
  }
  const DetailLifetimes life = measured(clip);
  for (int b = 0; b < kLifeBands; ++b) {
    EXPECT_LT(life.clip[b], 1 / kFps) << b;
    EXPECT_GT(life.clip[b], 0) << b;
  }
}

TEST(DetailLifetime, OfBandsIsEachBandsOwn) {
  // Coarse detail is carried, fine detail comes anew in every frame.
  cv::RNG random(5);
  cv::Mat coarse(192, 320 + 2 * 80, CV_32F), fine(192, 320, CV_32F), low;
  random.fill(coarse, cv::RNG::NORMAL, 0, 1);
  cv::GaussianBlur(coarse, coarse, {}, 5);
  coarse *= 400;
  Clip clip;
  for (int i = 0; i < 80; ++i) {
    random.fill(fine, cv::RNG::NORMAL, 0, 10);
    cv::GaussianBlur(fine, low, {}, 1.2);
    append(clip, coarse(cv::Rect(2 * (79 - i), 0, 320, 192)) + (fine - low) + 128, {2, 0});
  }
  const DetailLifetimes life = measured(clip);
  EXPECT_LT(life.clip[0], 1 / kFps);
  EXPECT_GT(life.clip[3], 4);
}

TEST(DetailLifetime, DiffersFromPlaceToPlace) {
  const DetailLifetimes life =
      measured(carried({.size = {640, 192}, .kept = [](int x) { return x < 320 ? 0.7 : 0.95; }}));
  for (int row = 1; row < life.cells.rows - 1; ++row) {
    for (int column = 1; column < 8; ++column)
      EXPECT_NEAR(life.cells.at(row, column)[1] / half_life_s(0.7), 1, 0.4) << row << ", " << column;
    for (int column = 12; column < 18; ++column)
      EXPECT_NEAR(life.cells.at(row, column)[1] / half_life_s(0.95), 1, 0.5) << row << ", " << column;
  }
}

TEST(DetailLifetime, IsNotShortenedByCodingNoise) {
  // Faint detail under noise of the greatest deviation that is taken for noise: without the nugget, a quarter of it is
  // lost.
  const Carried still{.deviation = 7, .noise = 0.003 * 255, .kept = [](int) { return 0.97; }};
  const DetailLifetimes life = measured(carried(still));
  for (int b = 0; b < kLifeBands; ++b) EXPECT_NEAR(life.clip[b] / half_life_s(0.97), 1, 0.1) << b;
}

TEST(DetailLifetime, OfDetailAboveNoiseIsShortWhereItIsShort) {
  // Half of the variance lives for one frame, half for long. That is no nugget: it is what is seen.
  Clip clip = carried({.kept = [](int) { return 0.99; }});
  cv::RNG random(9);
  cv::Mat noise;
  for (cv::Mat& luma : clip.luma) {
    noise.create(luma.size(), CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0, 25);
    cv::add(luma, noise, luma, cv::noArray(), CV_8U);
  }
  EXPECT_LT(measured(clip).clip[0], 1 / kFps);
}

TEST(DetailLifetime, ACutAndAFlashDoNotShortenIt) {
  const double kept = 0.97;
  const Carried made{.frames = 96, .kept = [&](int) { return kept; }};
  Clip clip = carried(made);
  // Another scene from frame 50 on; frame 70 is white. Flow says so by being wild.
  Carried other = made;
  other.deviation = -20;
  const Clip second = carried(other);
  for (std::size_t i = 50; i < clip.luma.size(); ++i) clip.luma[i] = 255 - second.luma[i];
  clip.luma[70] = cv::Scalar(255);
  for (const std::size_t flow : {49, 69, 70}) clip.u[flow] = cv::Scalar(30 * 64);
  const DetailLifetimes life = measured(clip);
  for (int b = 0; b < kLifeBands; ++b) EXPECT_NEAR(life.clip[b] / half_life_s(kept), 1, 0.15) << b;
  for (std::size_t i = 0; i < life.flow_outliers.size(); ++i)
    EXPECT_EQ(life.flow_outliers[i], i == 49 || i == 69 || i == 70 ? FlowOutlier::kFast : FlowOutlier::kNone)
        << i;
}

TEST(DetailLifetime, RepeatedFramesTakeTheirTime) {
  // Every frame twice: half as many changes a second, and every beginning would fall on a frame that stands still.
  const double kept = 0.9;
  const Clip once = carried({.frames = 60, .kept = [&](int) { return kept; }});
  Clip twice;
  const cv::Mat none = cv::Mat::zeros(once.u[0].size(), CV_16S);
  for (std::size_t i = 0; i < once.luma.size(); ++i) {
    twice.luma.insert(twice.luma.end(), 2, once.luma[i]);
    twice.u.push_back(none), twice.v.push_back(none);
    if (i + 1 < once.luma.size()) twice.u.push_back(once.u[i]), twice.v.push_back(once.v[i]);
  }
  const DetailLifetimes life = measured(twice);
  for (int b = 0; b < kLifeBands; ++b) EXPECT_NEAR(life.clip[b] / (2 * half_life_s(kept)), 1, 0.2) << b;
}

TEST(DetailLifetime, WhereNothingIsKnownTheNeighbourhoodAndTheClipSpeak) {
  // The right half is flat: it has no detail to follow. The mask says that the bottom does not move.
  Clip clip = carried({.kept = [](int) { return 0.8; }});
  for (cv::Mat& luma : clip.luma) luma.colRange(160, 320) = cv::Scalar(90);
  const DetailLifetimes life = measured(clip);
  for (int row = 0; row < life.cells.rows; ++row)
    for (int b = 0; b < 2; ++b) EXPECT_NEAR(life.cells.at(row, 8)[b], life.clip[b], 1e-6) << row;

  cv::Mat moving(clip.luma[0].size(), CV_8U, cv::Scalar(255));
  moving.rowRange(96, 192) = cv::Scalar(0);
  const DetailLifetimes part = measured(clip, moving);
  for (int column = 0; column < part.cells.columns; ++column)
    EXPECT_NEAR(part.cells.at(5, column)[0], part.clip[0], 1e-6) << column;
}

TEST(DetailLifetime, IsZeroInAClipThatTellsNothing) {
  Clip flat, still;
  cv::RNG random(2);
  const cv::Mat texture = rich({320, 192}, random) * 20 + 128;
  for (int i = 0; i < 20; ++i) {
    append(flat, cv::Mat(192, 320, CV_8U, cv::Scalar(90)), {2, 0});
    append(still, texture);
  }
  for (const Clip& clip : {flat, still}) {
    const DetailLifetimes life = measured(clip);
    for (std::size_t i = 0; i < life.cells.values.size(); ++i)
      EXPECT_EQ(i % kLifeChannels < kLifeBands ? life.cells.values[i] : 0, 0);
    EXPECT_EQ(life.clip, (std::array<float, kLifeBands>{}));
  }
}

TEST(DetailLifetime, TakesClipsOfAnySize) {
  for (const cv::Size size : {cv::Size(16, 16), cv::Size(33, 65), cv::Size(97, 31)}) {
    const DetailLifetimes life = measured(carried({.size = size, .frames = 9, .step = 1}));
    EXPECT_EQ(life.cells.rows, (size.height + 31) / 32);
    EXPECT_EQ(life.cells.columns, (size.width + 31) / 32);
    EXPECT_EQ(life.cells.cell, 32);
    EXPECT_EQ(life.flow_outliers.size(), 8u);
    for (const float value : life.cells.values) EXPECT_TRUE(value >= 0 && value <= kLongestLife_s);
  }
  EXPECT_THROW(DetailLifetimeAccumulator({0, 5}, 2, 25), Error);
  EXPECT_THROW(DetailLifetimeAccumulator({64, 64}, 2, 0), Error);
}

// The slow and obvious twin: every track from its own beginning through all flows, in doubles.
struct Twin {
  static constexpr std::array<int, 8> kLags{1, 2, 4, 8, 12, 16, 24, 32};
  struct Sums {
    double count = 0, product = 0, first = 0, second = 0;
  };
  const Clip& clip;
  cv::Size size = clip.luma[0].size();
  int columns = (size.width + 31) / 32, rows = (size.height + 31) / 32;
  std::vector<std::vector<cv::Mat>> bands;
  std::vector<std::array<std::array<Sums, 8>, kLifeBands>> sums;  // by cell

  explicit Twin(const Clip& made) : clip(made), sums(static_cast<std::size_t>(columns * rows)) {
    for (const cv::Mat& luma : clip.luma) {
      cv::Mat picture;
      luma.convertTo(picture, CV_32F, 1.0 / 255);
      laplacian_pyramid(picture, kLifeBands, bands.emplace_back());
    }
    const int frames = static_cast<int>(clip.luma.size());
    for (int frame = 0, number = 0; frame + 1 < frames; frame += 8, ++number)
      for (int y = (3 * number + number / 4) % 4; y < size.height; y += 4)
        for (int x = number % 4; x < size.width; x += 4) follow(frame, x, y);
  }

  template <class T>
  static double mixed(const cv::Mat& map, double x, double y) {
    x = std::clamp(x, 0.0, map.cols - 1.0), y = std::clamp(y, 0.0, map.rows - 1.0);
    const int left = static_cast<int>(x), top = static_cast<int>(y);
    const int right = std::min(left + 1, map.cols - 1), bottom = std::min(top + 1, map.rows - 1);
    const double fx = x - left, fy = y - top;
    return (1 - fy) * ((1 - fx) * map.at<T>(top, left) + fx * map.at<T>(top, right)) +
           fy * ((1 - fx) * map.at<T>(bottom, left) + fx * map.at<T>(bottom, right));
  }
  cv::Vec2d flow(int frame, double x, double y) const {
    const double fx = (x + 0.5) / kStep - 0.5, fy = (y + 0.5) / kStep - 0.5;
    return {mixed<short>(clip.u[frame], fx, fy) / 64, mixed<short>(clip.v[frame], fx, fy) / 64};
  }
  bool inside(double x, double y) const {
    return x >= 1 && y >= 1 && x <= size.width - 2 && y <= size.height - 2;
  }
  double band(int frame, int b, double x, double y) const {
    return mixed<float>(bands[frame][b], x / (1 << b), y / (1 << b));
  }

  void follow(int frame, int x0, int y0) {
    if (!inside(x0, y0) || cv::norm(flow(frame, x0, y0)) < 0.2) return;
    double x = x0, y = y0;
    for (int lag = 1; lag <= 32 && frame + lag < static_cast<int>(clip.luma.size()); ++lag) {
      const cv::Vec2d v = flow(frame + lag - 1, x, y);
      x += v[0], y += v[1];
      if (!inside(x, y)) return;
      const auto place = std::find(kLags.begin(), kLags.end(), lag);
      if (place == kLags.end()) continue;
      for (int b = 0; b < kLifeBands; ++b) {
        const double then = band(frame, b, x0, y0), now = band(frame + lag, b, x, y);
        Sums& sum = sums[static_cast<std::size_t>(y0 / 32 * columns + x0 / 32)][b][place - kLags.begin()];
        sum.count += 1;
        sum.product += then * now;
        sum.first += then * then;
        sum.second += now * now;
      }
    }
  }

  static constexpr double kNoisePower = kDetailNoise * kDetailNoise;
  double power(int cell, int b) const {
    const Sums& sum = sums[cell][b][0];
    return sum.count > 0 ? (sum.first + sum.second) / (2 * sum.count) : 0;
  }
  double weight(int cell, int b, int lag) const {
    const double independent = std::min(1.0, 16.0 / (4 << (2 * b)));
    return std::max(0.0, 1 - kNoisePower / std::max(power(cell, b), 1e-20)) * independent *
           sums[cell][b][lag].count;
  }

  /// Weight with which cell `other` speaks for `cell`, but for the lag.
  std::vector<double> say(int cell, int b) const {
    std::vector<double> clip_share(sums.size(), 0), around(sums.size(), 0);
    double all = 0, powers = 0;
    for (int other = 0; other < rows * columns; ++other) {
      all += weight(other, b, 0);
      powers += weight(other, b, 0) * power(other, b);
    }
    for (int other = 0; other < rows * columns; ++other)
      clip_share[other] = all > 0 ? power(other, b) * all / powers * std::min(1.0, 50 / all) : 0;
    around = clip_share;
    double near = std::min(all, 50.0);
    for (int other = 0; other < rows * columns; ++other) {
      const int dx = other % columns - cell % columns, dy = other / columns - cell / columns;
      if (other == cell || std::abs(dx) > 1 || std::abs(dy) > 1) continue;
      around[other] += 1;
      near += weight(other, b, 0);
    }
    for (double& share : around) share *= near > 0 ? std::min(1.0, 50 / near) : 0;
    around[cell] += 1;
    return around;
  }

  double half_life(int cell, int b) const {
    const std::vector<double> share = say(cell, b);
    std::array<double, 8> correlation{}, weights{};
    double noise = 0;
    for (int lag = 0; lag < 8; ++lag)
      for (int other = 0; other < rows * columns; ++other) {
        const double w = share[other] * weight(other, b, lag);
        const Sums& sum = sums[other][b][lag];
        if (w <= 0) continue;
        correlation[lag] += w * sum.product / std::sqrt(sum.first * sum.second);
        weights[lag] += w;
        if (lag == 0) noise += w * kNoisePower / power(other, b);
      }
    if (weights[0] <= 0) return 0;
    noise /= weights[0];
    for (int lag = 0; lag < 8; ++lag) correlation[lag] /= std::max(weights[lag], 1e-20);
    const double c2 = std::min(correlation[0], correlation[1]);
    const double nugget = c2 > 0 ? std::clamp(1 - correlation[0] * correlation[0] / c2, 0.0, noise) : 0;
    double last = 1;
    int from = 0;
    for (int lag = 0; lag < 8 && weights[lag] > 0; ++lag) {
      const double here = std::clamp(correlation[lag] / (1 - nugget), 0.01, 1.0);
      if (here < 0.5)
        return (from + (kLags[lag] - from) * std::log2(2 * last) / std::log2(last / here)) / kFps;
      last = here, from = kLags[lag];
    }
    return std::min(kLongestLife_s, from / -std::log2(std::min(last, 0.9999)) / kFps);
  }
};

TEST(DetailLifetime, EqualsTheSlowTwin) {
  // A whirl that keeps less at its left, under flow that bends and varies, as it is kept in a store.
  const cv::Size size(150, 110);
  cv::RNG random(4);
  Clip clip;
  cv::Mat state = rich(size, random), moved, map(size, CV_32FC2), flow(size, CV_32FC2), bytes;
  for (int i = 0; i < 48; ++i) {
    cv::Mat(state * 20 + 128).convertTo(bytes, CV_8U);
    clip.luma.push_back(bytes.clone());
    if (i == 47) break;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const cv::Vec2f v(static_cast<float>(-0.03 * (y - 50) + 0.3 * std::sin(i)),
                          static_cast<float>(0.03 * (x - 70)));
        flow.at<cv::Vec2f>(y, x) = v;
        map.at<cv::Vec2f>(y, x) = cv::Vec2f(static_cast<float>(x), static_cast<float>(y)) - v;
      }
    quantize_flow(flow, kStep, clip.u.emplace_back(), clip.v.emplace_back());
    cv::remap(state, moved, map, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
    cv::Mat fresh = rich(size, random);
    for (int x = 0; x < size.width; ++x) {
      const double kept = 0.75 + 0.2 * x / size.width;
      state.col(x) = kept * moved.col(x) + std::sqrt(1 - kept * kept) * fresh.col(x);
    }
  }
  const DetailLifetimes life = measured(clip);
  const Twin twin(clip);
  ASSERT_EQ(life.cells.rows, twin.rows);
  ASSERT_EQ(life.cells.columns, twin.columns);
  for (int cell = 0; cell < twin.rows * twin.columns; ++cell)
    for (int b = 0; b < kLifeBands; ++b) {
      const double slow = twin.half_life(cell, b);
      EXPECT_GT(slow, 0);
      const auto values = life.cells.at(cell / twin.columns, cell % twin.columns);
      EXPECT_NEAR(values[b] / slow, 1, 2e-3) << cell << " band " << b;
      EXPECT_NEAR(values[kLifeBands + b] / std::sqrt(twin.power(cell, b)), 1, 1e-3) << cell << " band " << b;
    }
}

}  // namespace
}  // namespace freshet::vision
