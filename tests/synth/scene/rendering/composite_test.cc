#include "synth/scene/rendering/composite.h"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/imgproc.hpp>

#include "platform/random.h"
#include "synth/sampling/bilinear.h"
#include "synth/scene/motion/stillness.h"
#include "synth/scene/rendering/scene_animation.h"
#include "synth/scene/scene_file.h"
#include "tests/synth/scene/made_scene.h"

namespace freshet::synth::scene {
namespace {

/// Moves everything by one vector.
class Shift : public Motion {
 public:
  Shift(float x, float y) : x_(x), y_(y) {}
  void go_to(int) override {}
  float reach() const override { return std::max(std::abs(x_), std::abs(y_)); }
  void row(int, int, int, int n, float* dx, float* dy) const override {
    std::fill(dx, dx + n, x_);
    std::fill(dy, dy + n, y_);
  }

 private:
  float x_, y_;
};

cv::Mat noise(cv::Size size, int type, std::uint64_t seed) {
  cv::Mat out(size, type);
  const Random random(seed, 0);
  auto* values = out.ptr<float>();
  for (std::size_t i = 0; i < out.total() * static_cast<std::size_t>(out.channels()); ++i)
    values[i] = random.at(i);
  return out;
}

/// One channel of a layer over what lies behind it. value   times alpha.
float laid_over(Blend blend, float value, float alpha, float behind) {
  if (blend == Blend::kAdd) return value + behind;
  if (blend == Blend::kScreen) return 1 - (1 - value) * (1 - behind);
  return value + (1 - alpha) * behind;
}

TEST(Composite, IsPorterAndDuffFromBackToFront) {
  const cv::Size kSize(67, 41);
  std::vector<Sprite> sprites;
  std::vector<cv::Mat> colours, alphas;
  for (std::uint64_t i = 0; i < 4; ++i) {
    colours.push_back(noise(kSize, CV_32FC3, 10 + i));
    cv::Mat alpha = noise(kSize, CV_32F, 20 + i);
    if (i == 3) alpha.setTo(1);
    alpha.setTo(0, alpha < 0.3f);
    alpha.setTo(1, alpha > 0.8f);
    alphas.push_back(alpha);
    sprites.push_back(make_sprite(colours.back(), alpha, Outline::kMoves));
  }
  Stillness still;
  constexpr Blend kBlends[] = {Blend::kOver, Blend::kAdd, Blend::kScreen};
  for (int mix = 0; mix < 27; ++mix) {
    std::vector<MovedSprite> layers;
    for (std::size_t i = 0; i < 4; ++i) layers.push_back({&sprites[i], &still});
    for (std::size_t i = 0, rest = static_cast<std::size_t>(mix); i < 3; ++i, rest /= 3)
      layers[i].blend = kBlends[rest % 3];
    cv::Mat found(kSize, CV_32FC4);
    composite(layers, found);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        cv::Vec4f sum(0, 0, 0, 0);
        for (std::size_t i = 4; i-- > 0;) {
          const float a = alphas[i].at<float>(y, x);
          const cv::Vec3f c = colours[i].at<cv::Vec3f>(y, x);
          for (int k = 0; k < 3; ++k) sum[k] = laid_over(layers[i].blend, c[k] * a, a, sum[k]);
          sum[3] = laid_over(Blend::kOver, a, a, sum[3]);
        }
        for (int c = 0; c < 4; ++c) ASSERT_NEAR(found.at<cv::Vec4f>(y, x)[c], sum[c], 1e-5) << mix;
      }
  }
}

TEST(Composite, MovesByWholePixelsWithoutAChange) {
  const cv::Size size(40, 30);
  const cv::Mat colour = noise(size, CV_32FC3, 1);
  cv::Mat alpha(size, CV_32F, cv::Scalar(0));
  alpha(cv::Rect(10, 8, 15, 12)).setTo(1);
  const Sprite sprite = make_sprite(colour, alpha, Outline::kMoves);
  const Shift shift(-4, 3);  // what is shown at p was at p + (-4, 3): it went right and up
  const MovedSprite layer{&sprite, &shift};
  cv::Mat found(size, CV_32FC4);
  composite(std::span(&layer, 1), found);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) {
      const bool there = cv::Rect(14, 5, 15, 12).contains({x, y});
      ASSERT_EQ(found.at<cv::Vec4f>(y, x)[3], there ? 1 : 0) << x << " " << y;
      if (there) {
        ASSERT_EQ(found.at<cv::Vec4f>(y, x)[1], colour.at<cv::Vec3f>(y + 3, x - 4)[1]);
      }
    }
}

TEST(Composite, TheFirstLightMovesWithTheColoursWhereItIsAskedTo) {
  const cv::Size size(40, 30);
  const cv::Mat colour = noise(size, CV_32FC3, 1), first = noise(size, CV_32F, 2),
                second = noise(size, CV_32F, 3);
  const Sprite sprite = make_sprite(colour, cv::Mat(size, CV_32F, cv::Scalar(1)), Outline::kMoves);
  const Shift shift(-4, 3);
  MovedSprite layer{&sprite, &shift};
  layer.lights = {&first, &second};
  for (const bool moves : {true, false}) {
    layer.light_moves = moves;
    cv::Mat found(size, CV_32FC4);
    composite(std::span(&layer, 1), found);
    for (int y = 0; y < 27; ++y)
      for (int x = 4; x < 40; ++x) {
        const float light = moves ? first.at<float>(y + 3, x - 4) : first.at<float>(y, x);
        ASSERT_FLOAT_EQ(found.at<cv::Vec4f>(y, x)[1],
                        colour.at<cv::Vec3f>(y + 3, x - 4)[1] * (light * second.at<float>(y, x)));
      }
  }
}

TEST(Composite, BetweenPixelsItIsTheCubicThatOpenCvHas) {
  const cv::Size size(60, 50);
  cv::Mat colour;
  cv::GaussianBlur(noise(size, CV_32FC3, 2), colour, {}, 1.5);
  const cv::Mat alpha(size, CV_32F, cv::Scalar(1));
  const Sprite sprite = make_sprite(colour, alpha, Outline::kMoves);
  const float dx = 21 / 32.0f, dy = -10 / 32.0f;
  const Shift shift(dx, dy);
  const MovedSprite layer{&sprite, &shift};
  cv::Mat found(size, CV_32FC4), expected;
  composite(std::span(&layer, 1), found);
  cv::Mat map_x(size, CV_32F), map_y(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) map_x.at<float>(y, x) = x + dx, map_y.at<float>(y, x) = y + dy;
  cv::remap(colour, expected, map_x, map_y, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  for (int y = 4; y < 46; ++y)
    for (int x = 4; x < 56; ++x)
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(found.at<cv::Vec4f>(y, x)[c], expected.at<cv::Vec3f>(y, x)[c], 1e-4);
}

TEST(Composite, WhatIsHeldKeepsItsOutlineAndShowsNoEdgeInside) {
  const cv::Size size(60, 50);
  const cv::Mat colour(size, CV_32FC3, cv::Scalar::all(0.5));
  cv::Mat alpha(size, CV_32F, cv::Scalar(0));
  alpha(cv::Rect(5, 20, 50, 25)).setTo(1);
  for (const Outline outline : {Outline::kHeld, Outline::kCyclic}) {
    const Sprite sprite = make_sprite(colour, alpha, outline, 70);
    const Shift shift(6.3f, -5.6f);
    const MovedSprite layer{&sprite, &shift};
    cv::Mat found(size, CV_32FC4);
    composite(std::span(&layer, 1), found);
    for (int y = 0; y < 50; ++y)
      for (int x = 0; x < 60; ++x) {
        ASSERT_EQ(found.at<cv::Vec4f>(y, x)[3], alpha.at<float>(y, x));
        ASSERT_NEAR(found.at<cv::Vec4f>(y, x)[0], 0.5f * alpha.at<float>(y, x), 1e-4);
      }
  }
}

TEST(Composite, BeyondThePicturesEdgeIsTheMirrorImageOfWhatIsHeld) {
  const cv::Size size(30, 20);
  const cv::Mat colour = noise(size, CV_32FC3, 3), alpha(size, CV_32F, cv::Scalar(1));
  const Sprite sprite = make_sprite(colour, alpha, Outline::kHeld);
  const Shift shift(-4, 3);
  const MovedSprite layer{&sprite, &shift};
  cv::Mat found(size, CV_32FC4);
  composite(std::span(&layer, 1), found);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 30; ++x)
      ASSERT_EQ(found.at<cv::Vec4f>(y, x)[2],
                colour.at<cv::Vec3f>(y + 3 < 20 ? y + 3 : 38 - (y + 3), std::abs(x - 4))[2]);
}

std::vector<float> boat_rows(const std::string& mapping) {
  std::string text = made_scene_text("speed = 6\ngustiness = 0.4");
  const std::string usual = "amplitude = 6";
  text.replace(text.find(usual), usual.size(), usual + "\nmapping = \"" + mapping + "\"");
  MadeScene made(text);
  cv::Mat frame(kMadeSize, CV_8UC3);
  std::vector<float> all, dx(40), dy(40);
  for (const int at : {3, 11, 17}) {
    made.animation().render(at, frame);
    made.animation().motion(1).row(0, 80, 90, 40, dx.data(), dy.data());
    all.insert(all.end(), dy.begin(), dy.end());
  }
  return all;
}

TEST(SceneAnimation, BoatsRideTheSurfaceItselfWhereItMirrors) {
  const std::vector<float> lifted = boat_rows("displacement"), mirrored = boat_rows("normals");
  EXPECT_GT(cv::norm(lifted, cv::NORM_INF), 0.1);
  for (std::size_t i = 0; i < lifted.size(); ++i) EXPECT_NEAR(mirrored[i], lifted[i], 0.01) << i;
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  text.replace(text.find(from), from.size(), to);
  return text;
}

TEST(SceneAnimation, KeptSpritesServeOtherWinds) {
  constexpr std::size_t kLake = 2, kSky = 3;
  for (const bool loop : {false, true}) {
    const auto text = [&](double speed) {
      const std::string made = made_scene_text(fmt::format("speed = {}", speed));
      return changed(changed(made, "loop = true", fmt::format("loop = {}", loop)), "amplitude = 6",
                     fmt::format("amplitude = 6\nmirrors = true\ncalm = {}", speed / 1000));
    };
    KeptSprites kept;
    const std::uint8_t* sky = nullptr;
    for (const double speed : {4.0, 9.0}) {
      MadeScene made(text(speed)), plain(text(speed));
      plain.animation();
      read_marks(made.scene(), kMadeSize);
      SceneAnimation animation(made.scene(), made.pixels(), kMadeSize, {}, nullptr, &kept);
      cv::Mat first, frame, own, other;
      animation.render(0, first);
      for (const int at : {3, 20}) {
        animation.render(at, frame);
        plain.animation().render(at, other);
        for (std::size_t i = 0; i < made.scene().layers.size(); ++i) {
          if (loop && (i == kSky || i == kLake)) continue;  // a sky that is continued further, and its mirror
          animation.layer(i, own);
          plain.animation().layer(i, other);
          EXPECT_EQ(cv::norm(own, other, cv::NORM_INF), 0) << speed << " layer " << i;
        }
      }
      EXPECT_EQ(cv::norm(first, frame, cv::NORM_INF) == 0, loop) << "it comes round";
      const std::uint8_t* const now = kept.layers[kSky].sprite.texture.data;
      EXPECT_TRUE(sky == nullptr || sky == now) << "it was made anew";
      sky = now;
    }
    if (!loop) continue;
    const int before = kept.layers[kSky].sprite.period();
    MadeScene storm(text(60));
    read_marks(storm.scene(), kMadeSize);
    const SceneAnimation animation(storm.scene(), storm.pixels(), kMadeSize, {}, nullptr, &kept);
    EXPECT_GT(kept.layers[kSky].sprite.period(), before) << "clouds go further";
  }
}

TEST(SceneAnimation, UnmovedLayersGiveTheStill) {
  MadeScene made(made_scene_text("speed = 0"));
  cv::Mat frame;
  made.animation().render(3, frame);
  cv::Mat still;
  made.picture().convertTo(still, CV_8U, 255);
  EXPECT_LE(cv::norm(frame, still, cv::NORM_INF), 1);
}

/// A wind that stays, and one that goes from calm to storm and back.
constexpr const char* kWinds[] = {
    "speed = 7\ngustiness = 0.6",
    "speed = 1\ngustiness = 0.6\n[[wind.at]]\ntime = 0.5\nspeed = 12\ndirection = 60\n"
    "[[wind.at]]\ntime = 1\nspeed = 1\ndirection = 0"};

TEST(SceneAnimation, ALoopEndsWhereItBeganToTheBit) {
  for (const char* wind : kWinds) {
    MadeScene made(made_scene_text(wind));
    cv::Mat first, other, again;
    made.animation().render(0, first);
    made.animation().render(7, other);
    made.animation().render(made.scene().frames, again);
    EXPECT_GT(cv::norm(first, other, cv::NORM_INF), 8);
    EXPECT_EQ(cv::norm(first, again, cv::NORM_INF), 0);
  }
}

TEST(SceneAnimation, IsTheSameForAnyNumberOfThreads) {
  for (const char* wind : kWinds) {
    cv::Mat frames[3];
    int i = 0;
    for (const int threads : {1, 2, 8}) {
      const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
      MadeScene made(made_scene_text(wind));
      made.animation().render(9, frames[i++]);
    }
    EXPECT_EQ(cv::norm(frames[0], frames[1], cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(frames[0], frames[2], cv::NORM_INF), 0);
  }
}

TEST(SceneAnimation, FramesMoveAndAreNotTheStill) {
  MadeScene made(made_scene_text("speed = 7"));
  cv::Mat a, b;
  made.animation().render(2, a);
  made.animation().render(3, b);
  EXPECT_GT(cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total()), 0.05);
}

/// How much the lake's alpha at its upper border, and far below it, changes over the frames.
struct BorderChange {
  double border = 0, below = 0;
};
BorderChange border_change(const char* edge) {
  MadeScene made(made_scene_text("speed = 8\n"));
  auto& water = std::get<WaterMotion>(made.scene().layers[2].motion);
  water.edge_moves = std::string(edge) == "moving";
  cv::Mat alpha(kMadeSize, CV_32F, cv::Scalar(0));
  alpha(cv::Rect(0, 85, 160, 35)).setTo(1);
  made.pixels()[2].alpha = alpha;
  SceneAnimation& animation = made.animation();
  BorderChange change;
  cv::Mat frame(kMadeSize, CV_32FC4), layer;
  for (int t = 0; t < 20; t += 2) {
    animation.render(t, frame);
    animation.layer(2, layer);
    cv::Mat covered, different;
    cv::extractChannel(layer, covered, 3);
    covered.convertTo(covered, CV_32F);
    cv::absdiff(covered, alpha, different);
    change.border = std::max(change.border, cv::norm(different.rowRange(80, 90), cv::NORM_INF));
    change.below = std::max(change.below, cv::norm(different.rowRange(104, 112), cv::NORM_INF));
  }
  return change;
}

TEST(SceneAnimation, AMatteMovesWithItsWaterWhereItsEdgeDoes) {
  const BorderChange held = border_change("held"), moving = border_change("moving");
  EXPECT_LT(held.border, 0.01);
  EXPECT_GT(moving.border, 0.3);
  EXPECT_LT(moving.below, 0.01);
}

TEST(SceneAnimation, WhatALayerShowsIsInTheNextFrameWhereItsMotionSays) {
  MadeScene made(made_scene_text("speed = 25\ndirection = 10\n"));
  cv::Mat smooth;  // so that reading between pixels costs nothing
  cv::GaussianBlur(made.picture(), smooth, {}, 2);
  smooth = (smooth - cv::Scalar::all(0.6)) * 3 + cv::Scalar::all(0.5);
  for (LayerPixels& pixels : made.pixels())
    if (!pixels.colour.empty()) pixels.colour = smooth;
  SceneAnimation& animation = made.animation();
  cv::Mat frame, now, next;
  for (const int at : {8, 19}) {  // the last runs into the first
    animation.render(at, frame = cv::Mat());
    const std::vector<cv::Mat> motions = animation.motions();
    ASSERT_EQ(motions.size(), made.scene().layers.size());
    cv::Mat again;
    animation.render(at, again);
    EXPECT_EQ(cv::norm(frame, again, cv::NORM_INF), 0);
    for (std::size_t i = 0; i < 4; ++i) {
      SCOPED_TRACE(made.scene().layers[i].name + " at " + std::to_string(at));
      animation.render(at, again), animation.layer(i, now);
      animation.render(at + 1, again), animation.layer(i, next);
      double moved = 0, stood = 0, speed = 0;
      int pixels = 0;
      for (int y = 12; y < kMadeSize.height - 12; ++y) {
        for (int x = 12; x < kMadeSize.width - 12; ++x) {
          const cv::Vec2f by = motions[i].at<cv::Vec2f>(y, x);
          const auto to = sampling::bilinear<cv::Vec4f>(next, static_cast<float>(x) + by[0],
                                                        static_cast<float>(y) + by[1]);
          const auto from = now.at<cv::Vec4f>(y, x);
          if (from[3] < 0.99f || to[3] < 0.99f) continue;
          moved += std::abs(to[1] - from[1]);
          stood += std::abs(next.at<cv::Vec4f>(y, x)[1] - from[1]);
          speed += cv::norm(by);
          ++pixels;
        }
      }
      ASSERT_GT(pixels, 200);
      EXPECT_GT(speed / pixels, 0.02);
      EXPECT_LT(moved, 0.5 * stood) << moved / stood << ", " << speed / pixels << " px a frame";
    }
  }
}

}  // namespace
}  // namespace freshet::synth::scene
