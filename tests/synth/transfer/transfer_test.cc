#include "synth/transfer/transfer.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <unistd.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "synth/transfer/features.h"
#include "tests/harness/scratch_folder.h"
#include "tests/synth/transfer/made_exemplar.h"

namespace freshet::synth::transfer {
namespace {

const cv::Size kFrame(72, 60);

Exemplar still(const cv::Mat& bgra) {
  return [bgra](int) { return ExemplarFrame{bgra}; };
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(Transfer, UsesPatchesUniformlyAndKeepsSegmentsInEveryFrame) {
  for (const Search search : {Search::kPatchMatch, Search::kExact}) {
    Transfer transfer(still(blot({48, 44}, 1)), {.iterations = 2, .search = search});
    for (int t = 0; t < 6; ++t) {
      const TransferredFrame made = transfer.next(turning_disc(kFrame, t));
      EXPECT_EQ(made.index, t);
      EXPECT_TRUE(made.boundary.uniform());
      EXPECT_TRUE(made.interior.uniform());
      EXPECT_GT(made.interior.min_uses, 0);
      EXPECT_EQ(made.violations, 0);
      EXPECT_TRUE(made.remarks.empty());
    }
  }
}

TEST(Transfer, NearestRetrievalIsNotUniform) {
  Transfer transfer(still(blot({48, 44}, 1)), {.iterations = 2, .retrieval = Retrieval::kNearest});
  const TransferredFrame made = transfer.next(turning_disc(kFrame, 0));
  EXPECT_FALSE(made.interior.uniform());
  EXPECT_EQ(made.violations, 0);
}

TEST(Transfer, DoesNotWashOutWhereTheBaselineDoes) {
  double energy[2] = {0, 0};
  const cv::Mat look = blot({48, 44}, 1);
  for (const Retrieval retrieval : {Retrieval::kUniform, Retrieval::kNearest}) {
    Transfer transfer(still(look), {.iterations = 2, .retrieval = retrieval});
    TransferredFrame made;
    for (int t = 0; t < 20; ++t) made = transfer.next(turning_disc(kFrame, t));
    energy[retrieval == Retrieval::kNearest] = laplacian_energy(made.bgra) / laplacian_energy(look);
  }
  std::printf("[ measured ] Laplacian energy of the exemplar's: uniform %.3f, nearest %.3f\n", energy[0],
              energy[1]);
  EXPECT_GT(energy[0], 0.5);
  EXPECT_LT(energy[1], 0.7 * energy[0]);
}

TEST(Transfer, ASmallDesignIsNotMadeOfTheSmoothestPatches) {
  const cv::Mat look = blot({160, 150}, 1);
  Transfer transfer(still(look), {.iterations = 2});
  TransferredFrame made;
  for (int t = 0; t < 3; ++t) made = transfer.next(turning_disc(kFrame, t));
  EXPECT_TRUE(made.boundary.uniform() && made.interior.uniform());
  EXPECT_EQ(made.interior.min_uses, 0);
  const double energy = laplacian_energy(made.bgra) / laplacian_energy(look);
  std::printf("[ measured ] Laplacian energy of a larger exemplar's: %.3f\n", energy);
  EXPECT_GT(energy, 0.3);  // 0.21 where the search chooses which sources are used
}

TEST(Transfer, IsTheSameForAnyNumberOfThreads) {
  cv::Mat frames[2];
  for (std::size_t k = 0; k < 2; ++k) {
    const oneapi::tbb::global_control threads(oneapi::tbb::global_control::max_allowed_parallelism,
                                              1 + 3 * k);
    Transfer transfer(still(blot({48, 44}, 1)), {.iterations = 2, .quarter_turns = 4, .motion_blur = 0.5});
    for (int t = 0; t < 3; ++t) frames[k] = transfer.next(turning_disc(kFrame, t)).bgra;
  }
  EXPECT_TRUE(same(frames[0], frames[1]));
}

TEST(Transfer, GoesOnFromASavedState) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "state";
  const TransferOptions options{.iterations = 2, .seed = 4};
  const cv::Mat look = blot({48, 44}, 1);
  Transfer whole(still(look), options), again(still(look), options);
  for (int t = 0; t < 2; ++t) whole.next(turning_disc(kFrame, t));
  whole.save_state(path);
  again.load_state(path);
  EXPECT_EQ(again.frame(), 2);
  for (int t = 2; t < 4; ++t)
    EXPECT_TRUE(same(whole.next(turning_disc(kFrame, t)).bgra, again.next(turning_disc(kFrame, t)).bgra));
}

TEST(Transfer, CoherenceHoldsFramesTogether) {
  double difference[2] = {0, 0};
  for (const double lambda : {0.0, 0.2}) {
    Transfer transfer(
        still(blot({48, 44}, 1)),
        {.lambda = lambda, .iterations = 2, .start = lambda > 0 ? Start::kWarped : Start::kRandom});
    const TargetFrame design = turning_disc(kFrame, 0, 0);  // nothing moves: nothing should change
    cv::Mat before;
    for (int t = 0; t < 4; ++t) {
      const cv::Mat bgra = transfer.next(design).bgra;
      if (t > 0) difference[lambda > 0] += cv::norm(bgra, before, cv::NORM_L1);
      before = bgra;
    }
  }
  std::printf("[ measured ] change per frame with lambda / without: %.3f\n", difference[1] / difference[0]);
  EXPECT_LT(difference[1], 0.5 * difference[0]);
}

TEST(Transfer, AVideoExemplarsFramesAreThoseShown) {
  // The look goes from dark to bright; the third frame must be as bright as the third look.
  const cv::Mat look = blot({48, 44}, 1);
  const auto at = [&](int t) {
    cv::Mat scaled;
    cv::multiply(look, cv::Scalar(1, 0.4 + 0.2 * std::max(t, 0), 1, 1), scaled);
    return ExemplarFrame{scaled};
  };
  Transfer transfer(at, {.iterations = 2});
  TransferredFrame made;
  for (int t = 0; t < 3; ++t) made = transfer.next(turning_disc(kFrame, t));
  std::vector<cv::Mat> made_planes, look_planes;
  cv::split(made.bgra, made_planes);
  cv::split(at(2).bgra, look_planes);
  EXPECT_NEAR(cv::mean(made_planes[1], made_planes[3] > 0.99)[0],
              cv::mean(look_planes[1], look_planes[3] == 255)[0] / 255, 0.03);
}

TEST(Transfer, AStabilisedExemplarsOwnMotionIsNotTheDesigns) {
  // A wall that rises by 2 px a frame, on a design in which nothing moves.
  const cv::Mat wall = blot({96, 130}, 2)(cv::Rect(24, 36, 48, 66)).clone();
  const cv::Size size(64, 52);
  const TargetFrame design{cv::Mat(size, CV_8U, cv::Scalar(255)),
                           cv::Mat(size, CV_32FC2, cv::Scalar::all(0))};
  double changes[2] = {0, 0};
  for (const bool stabilised : {false, true}) {
    Transfer transfer(
        [&](int t) {
          const cv::Rect window(0, 2 * std::max(t, 0), 48, 44);
          return ExemplarFrame{wall(window).clone(), cv::Mat(window.size(), CV_32FC2, cv::Scalar(0, 2))};
        },
        {.stabilised = stabilised, .iterations = 2});
    cv::Mat before;
    for (int t = 0; t < 8; ++t) {
      const cv::Mat now = transfer.next(design).bgra;
      if (t > 0) changes[stabilised] += cv::norm(now, before, cv::NORM_L1);
      before = now;
    }
  }
  std::printf("[ measured ] change per frame, stabilised / as printed: %.3f\n", changes[1] / changes[0]);
  EXPECT_LT(changes[1], 0.4 * changes[0]);
}

/// Mean red where `of` is above .3, less where it is below -.3.
double redder(const cv::Mat& bgra, const Grid& of) {
  double red[2] = {0, 0}, pixels[2] = {1e-9, 1e-9};
  for (int y = 0; y < bgra.rows; ++y)
    for (int x = 0; x < bgra.cols; ++x) {
      const cv::Vec4f& pixel = bgra.at<cv::Vec4f>(y, x);
      if (pixel[3] < 0.3f || std::abs(of(x, y)) < 0.3f) continue;
      red[of(x, y) > 0] += static_cast<double>(pixel[2]);
      ++pixels[of(x, y) > 0];
    }
  return red[1] / pixels[1] - red[0] / pixels[0];
}

TEST(Transfer, CurvatureBringsTipsToTips) {
  // A lobed blot whose tips are red and whose hollows are not, on a lobed disc.
  cv::Mat look = blot({96, 88}, 1);
  const Grid bends = guides_of(alpha_of(premultiplied(look)), VectorGrid(96, 88), {}).curvature;
  for (int y = 0; y < look.rows; ++y)
    for (int x = 0; x < look.cols; ++x) look.at<cv::Vec4b>(y, x)[2] = bends(x, y) > 0 ? 255 : 0;
  double red[2] = {0, 0};
  for (const bool guided : {false, true}) {
    Transfer transfer(still(look), {.curvature = guided ? 2.0 : 0.0, .iterations = 2});
    for (int t = 0; t < 3; ++t) {
      const TargetFrame target = turning_disc({108, 96}, t);
      const Guides of = guides_of(grid_of(target.alpha), vectors_of(target.flow), {});
      red[guided] += redder(transfer.next(target).bgra, of.curvature) / 3;
    }
  }
  std::printf("[ measured ] tips redder than hollows by %.2f, without curvature %.2f\n", red[1], red[0]);
  EXPECT_GT(red[1], red[0] + 0.2);
}

TEST(Transfer, DivergenceBringsWhatSpreadsToWhereItSpreads) {
  // Red spreads in the exemplar's left half, and in the design's right half; what is not red gathers.
  const auto spread = [](cv::Size size, double left) {
    cv::Mat flow(size, CV_32FC2);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const double side = x < size.width / 2 ? left : -left,
                     middle = (x < size.width / 2 ? 0.25 : 0.75) * size.width;
        flow.at<cv::Vec2f>(y, x) = {static_cast<float>(side * (x - middle)),
                                    static_cast<float>(side * (y - 0.5 * size.height))};
      }
    return flow;
  };
  const cv::Size size(72, 60);
  cv::Mat look = blot({144, 132}, 1)(cv::Rect(44, 40, 56, 52)).clone();
  for (int y = 0; y < look.rows; ++y)
    for (int x = 0; x < look.cols; ++x) look.at<cv::Vec4b>(y, x)[2] = x < look.cols / 2 ? 255 : 0;
  const cv::Mat back = -spread(look.size(), 0.1);
  const TargetFrame target{cv::Mat(size, CV_8U, cv::Scalar(255)), spread(size, -0.1)};
  const Guides of = guides_of(grid_of(target.alpha), vectors_of(target.flow), {});
  double red[2] = {0, 0};
  for (const bool guided : {false, true}) {
    Transfer transfer(
        [&](int) {
          return ExemplarFrame{look, back};
        },
        {.divergence = guided ? 2.0 : 0.0, .iterations = 2});
    red[guided] = redder(transfer.next(target).bgra, of.divergence);
  }
  std::printf("[ measured ] what spreads redder than what gathers by %.2f, without divergence %.2f\n", red[1],
              red[0]);
  EXPECT_GT(red[1], red[0] + 0.4);
}

TEST(Transfer, NamesSourcesOfTurnedExemplarsAsTheyWereGiven) {
  // Half red, half blue: what a patch shows must be what stands at its address.
  cv::Mat look(40, 52, CV_8UC4, cv::Scalar(255, 0, 0, 255));
  look.colRange(0, 26).setTo(cv::Scalar(0, 0, 255, 255));
  look.rowRange(0, 12).setTo(cv::Scalar(0, 255, 0, 255));
  Transfer transfer(still(look), {.levels = 1, .iterations = 3, .quarter_turns = 4});
  const TransferredFrame made =
      transfer.next({cv::Mat(60, 72, CV_8U, cv::Scalar(255)), cv::Mat(60, 72, CV_32FC2, cv::Scalar::all(0))});
  int turned = 0, seen = 0, alike = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 72; ++x) {
      const cv::Vec3i of = made.nearest.at<cv::Vec3i>(y, x);
      ASSERT_TRUE(of[0] >= 2 && of[0] < 50 && of[1] >= 2 && of[1] < 38);
      turned += of[2] > 0;
      if (made.distance.at<float>(y, x) > 1) continue;
      ++seen;
      const cv::Vec4f pixel = made.bgra.at<cv::Vec4f>(y, x);
      const cv::Vec4b there = look.at<cv::Vec4b>(of[1], of[0]);
      int largest = 0;
      for (int c = 1; c < 3; ++c) largest = pixel[c] > pixel[largest] ? c : largest;
      alike += there[largest] == 255;
    }
  EXPECT_GT(turned, 60 * 72 / 2);
  EXPECT_GT(seen, 60 * 72 / 4);
  EXPECT_GT(alike, 0.97 * seen);
}

TEST(Transfer, AnExemplarWhoseFluidEntersAtOneBorderGivesAnOutlineOnAllSides) {
  // The right half of a blot: fluid at the left border of the picture, outline elsewhere.
  const cv::Mat look = blot({96, 88}, 1).colRange(48, 96).clone();
  ASSERT_EQ(look.at<cv::Vec4b>(44, 0)[3], 255);
  for (const int turns : {1, 4}) {
    Transfer transfer(still(look), {.iterations = 2, .quarter_turns = turns});
    for (int t = 0; t < 4; ++t) {
      const TargetFrame target = turning_disc(kFrame, t);
      const TransferredFrame made = transfer.next(target);
      EXPECT_TRUE(made.boundary.uniform() && made.interior.uniform());
      EXPECT_EQ(made.violations, 0);
      cv::Mat alpha, difference;
      cv::extractChannel(made.bgra, alpha, 3);
      cv::absdiff(alpha, target.alpha, difference);
      const double left = cv::mean(difference.colRange(0, kFrame.width / 2))[0],
                   right = cv::mean(difference.colRange(kFrame.width / 2, kFrame.width))[0];
      std::printf("[ measured ] alpha off the design's: left %.4f, right %.4f\n", left, right);
      EXPECT_LT(std::max(left, right), turns == 4 ? 0.06 : 0.1);  // turned, it has an outline for each side
    }
  }
}

TEST(Transfer, AnOpaqueExemplarTakesTheTargetsAlpha) {
  cv::Mat look = blot({48, 44}, 1);
  for (int y = 0; y < look.rows; ++y)
    for (int x = 0; x < look.cols; ++x) look.at<cv::Vec4b>(y, x)[3] = 255;
  Transfer transfer(still(look), {.iterations = 2});
  const TargetFrame target = turning_disc(kFrame, 0);
  const TransferredFrame made = transfer.next(target);
  EXPECT_EQ(made.remarks.size(), 2u);
  EXPECT_TRUE(made.interior.uniform());
  EXPECT_EQ(made.boundary.targets, 0);
  std::vector<cv::Mat> planes;
  cv::split(made.bgra, planes);
  EXPECT_LT(cv::norm(planes[3], target.alpha, cv::NORM_INF), 0.01);
}

TEST(Transfer, AnEmptyMaskIsATransparentFrameAndAFullOneIsFull) {
  Transfer transfer(still(blot({48, 44}, 1)), {.iterations = 1});
  const cv::Mat flow(kFrame, CV_32FC2, cv::Scalar::all(0));
  TransferredFrame made = transfer.next({cv::Mat(kFrame, CV_8U, cv::Scalar(0)), flow});
  EXPECT_EQ(cv::norm(made.bgra, cv::NORM_INF), 0);
  EXPECT_EQ(made.remarks.size(), 1u);
  made = transfer.next({cv::Mat(kFrame, CV_8U, cv::Scalar(255)), flow});
  EXPECT_TRUE(made.interior.uniform());
  EXPECT_EQ(made.interior.targets, kFrame.area());
}

TEST(Transfer, SaysWhatIsWrongWithItsInput) {
  const cv::Mat look = blot({48, 44}, 1);
  const TargetFrame good = turning_disc(kFrame, 0);
  const auto kind_of = [](Transfer& transfer, const TargetFrame& target) {
    try {
      transfer.next(target);
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::kCancelled;
  };
  Transfer transfer(still(look), {.iterations = 1});
  TargetFrame bad = good;
  bad.flow = good.flow.clone();
  bad.flow.at<cv::Vec2f>(3, 3)[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(kind_of(transfer, bad), ErrorKind::kInput);
  EXPECT_EQ(kind_of(transfer, {good.alpha, {}}), ErrorKind::kInput);
  EXPECT_EQ(kind_of(transfer, {{}, good.flow}), ErrorKind::kInput);
  EXPECT_EQ(transfer.frame(), 0);
  transfer.next(good);
  EXPECT_EQ(kind_of(transfer, turning_disc({40, 40}, 1)), ErrorKind::kInput);
  Transfer small(still(blot({9, 30}, 1)), {});
  EXPECT_EQ(kind_of(small, good), ErrorKind::kInput);
  Transfer clear(still(cv::Mat(40, 40, CV_8UC4, cv::Scalar::all(0))), {});
  EXPECT_EQ(kind_of(clear, good), ErrorKind::kInput);
  Transfer three(still(cv::Mat(40, 40, CV_8UC3)), {});
  EXPECT_EQ(kind_of(three, good), ErrorKind::kInput);
}

TEST(Transfer, RefusesOptionsOutOfRange) {
  const auto refused = [](const TransferOptions& options) {
    try {
      Transfer transfer(still({}), options);
      return false;
    } catch (const Error& error) {
      return error.kind() == ErrorKind::kUsage;
    }
  };
  EXPECT_FALSE(refused({}));
  EXPECT_TRUE(refused({.patch = 4}));
  EXPECT_TRUE(refused({.patch = 11}));
  EXPECT_TRUE(refused({.lambda = -0.1}));
  EXPECT_TRUE(refused({.curvature = 17}));
  EXPECT_TRUE(refused({.divergence = -1}));
  EXPECT_TRUE(refused({.eta = std::numeric_limits<double>::quiet_NaN()}));
  EXPECT_TRUE(refused({.lower = 0.9, .upper = 0.1}));
  EXPECT_TRUE(refused({.iterations = 0}));
  EXPECT_TRUE(refused({.quarter_turns = 2}));
}

TEST(Transfer, AFrameThatIsStoppedLeavesTheStateAsItWas) {
  const cv::Mat look = blot({48, 44}, 1);
  Transfer stopped(still(look), {.iterations = 2}), whole(still(look), {.iterations = 2});
  EXPECT_THROW(stopped.next(turning_disc(kFrame, 0),
                            [](double fraction) {
                              if (fraction > 0.5) throw std::runtime_error("stop");
                            }),
               std::runtime_error);
  for (int t = 0; t < 2; ++t)
    EXPECT_TRUE(same(stopped.next(turning_disc(kFrame, t)).bgra, whole.next(turning_disc(kFrame, t)).bgra));
}

}  // namespace
}  // namespace freshet::synth::transfer
