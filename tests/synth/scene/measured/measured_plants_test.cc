// Plants of which all is known, measured as if nothing were.
#include "synth/scene/measured/measured_plants.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "synth/scene/cycle.h"
#include "synth/scene/measured/clip_sway.h"
#include "synth/scene/measured/sway_fit.h"
#include "synth/scene/motion/tree_sway.h"
#include "synth/scene/scene_file.h"
#include "synth/scene/wind/gusts.h"
#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::synth::scene {
namespace {

using testing::HasSubstr;

constexpr double kFps = 25;

struct Plant {
  double frequency_hz, damping_per_s, mass;
};
constexpr Plant kPlants[] = {{0.5, 0.6, 6}, {1.6, 2, 0.3}, {0.8, 3, 2}, {3, 2, 0.05}};

/// How far the mean wind bends it, lengths (Eq. 4 at rest).
double lean(double frequency_hz, double mass, const Wind& wind) {
  const double turn = 2 * std::numbers::pi * frequency_hz;
  return wind.speed_m_per_s / (mass * turn * turn);
}

/// Its tip in pieces of so many seconds, as films would show them, beside noise of half a hundredth of a length.
std::vector<std::vector<float>> pieces_of(const Plant& plant, const Wind& wind, double seconds) {
  const int length = static_cast<int>(seconds * kFps), count = 6;
  const Cycle cycle{.frames = 2 * count * length, .fps = kFps};
  Harmonics force = wind_harmonics(wind, cycle, 3);
  for (std::complex<double>& f : force) f /= plant.mass;
  const std::vector<float> tip =
      series(oscillator(force, cycle, plant.frequency_hz, plant.damping_per_s), cycle);
  cv::RNG random(4);
  std::vector<std::vector<float>> pieces;
  for (int i = 0; i < count; ++i) {
    pieces.emplace_back(tip.begin() + 2 * i * length, tip.begin() + (2 * i + 1) * length);
    for (float& value : pieces.back()) value += static_cast<float>(random.gaussian(5e-4));
  }
  return pieces;
}

/// How far its tip goes to and fro in so many seconds.
double deviation(const Plant& plant, const Wind& wind, double seconds) {
  const Cycle cycle{.frames = static_cast<int>(seconds * kFps), .fps = kFps};
  Harmonics force((static_cast<std::size_t>(cycle.frames) - 1) / 2 + 1);
  for (std::size_t k = 1; k < force.size(); ++k)
    force[k] = std::sqrt(wind_power(wind, static_cast<double>(k) / seconds) / seconds) / plant.mass;
  double sum = 0;
  for (const auto& one : oscillator(force, cycle, plant.frequency_hz, plant.damping_per_s))
    sum += std::norm(one);
  return std::sqrt(sum);
}

TEST(SwayFit, ReadsFrequencyDampingAmplitudeAndLeanBack) {
  const Wind wind{.speed_m_per_s = 6, .turbulence = 0.2, .kappa_m = 60};
  for (const double seconds : {24.0, 8.0})
    for (const Plant& plant : kPlants) {
      double frequency = 0, damping = 0, sway = 0, leans = 0;
      const std::vector<std::vector<float>> pieces = pieces_of(plant, wind, seconds);
      for (const std::vector<float>& piece : pieces) {
        const SwayFit fit = fit_sway(std::span(&piece, 1), kFps, wind, 1);
        // Each by itself, as a person has one film.
        EXPECT_NEAR(std::log(fit.frequency_hz / plant.frequency_hz), 0, 0.5) << plant.frequency_hz;
        const auto share = [&](double found, double true_one) {
          return std::log(found / true_one) / static_cast<double>(pieces.size());
        };
        frequency += share(fit.frequency_hz, plant.frequency_hz);
        damping += share(fit.damping_per_s, plant.damping_per_s);
        sway += share(deviation({fit.frequency_hz, fit.damping_per_s, fit.mass}, wind, seconds),
                      deviation(plant, wind, seconds));
        leans += share(lean(fit.frequency_hz, fit.mass, wind), lean(plant.frequency_hz, plant.mass, wind));
      }
      const std::string which = fmt::format("{} Hz, {} s", plant.frequency_hz, seconds);
      EXPECT_NEAR(frequency, 0, 0.12) << which;
      EXPECT_NEAR(damping, 0, seconds > 10 ? 0.65 : 0.8) << which;
      EXPECT_NEAR(sway, 0, seconds > 10 ? 0.1 : 0.45) << which;
      EXPECT_NEAR(leans, 0, seconds > 10 ? 0.2 : 0.45) << which;
    }
}

const cv::Size kFilmSize(240, 260);
const Wind kWind{.speed_m_per_s = 6};

/// A bough before a wall, of which all frames lie in a folder.
class Film {
 public:
  explicit Film(const TreeMotion& tree, int frames = 300)
      : cycle_{.frames = frames, .fps = kFps},
        gusts_(kWind, cycle_, kFilmSize.width),
        sway_(tree, gusts_, cycle_, 7, {{0, 0}, kFilmSize}) {
    cv::Mat wall(kFilmSize, CV_8U), bough(kFilmSize, CV_8U), where(kFilmSize, CV_8U, cv::Scalar(0));
    cv::RNG random(2);
    random.fill(wall, cv::RNG::UNIFORM, 60, 120);
    random.fill(bough, cv::RNG::UNIFORM, 60, 255);
    for (cv::Mat* each : {&wall, &bough}) cv::GaussianBlur(*each, *each, {}, 1.3);
    const Line& line = tree.armatures[0];
    cv::line(where, line.from, line.to, 255, 36);
    cv::Mat from(kFilmSize, CV_32FC2), seen, alpha, frame;
    for (int t = 0; t < frames; ++t) {
      sway_.go_to(t);
      std::vector<float> dx(240), dy(240);
      for (int y = 0; y < from.rows; ++y) {
        sway_.row(0, 0, y, 240, dx.data(), dy.data());
        for (int x = 0; x < 240; ++x) {
          const auto i = static_cast<std::size_t>(x);
          from.at<cv::Vec2f>(y, x) = {static_cast<float>(x) + dx[i], static_cast<float>(y) + dy[i]};
        }
      }
      cv::remap(bough, seen, from, {}, cv::INTER_LINEAR);
      cv::remap(where, alpha, from, {}, cv::INTER_LINEAR);
      wall.copyTo(frame);
      seen.copyTo(frame, alpha > 127);
      cv::imwrite((folder_ / fmt::format("{:03}.png", t)).string(), frame);
    }
  }
  std::string path() const { return folder_.path().string(); }
  /// Since the first frame.
  std::vector<float> tip() const {
    std::vector<float> tip = sway_.tip(0);
    for (float& value : tip) value -= sway_.tip(0)[0];
    return tip;
  }

 private:
  ScratchFolder folder_;
  Cycle cycle_;
  Gusts gusts_;
  TreeSway sway_;
};

/// A scene whose one plant moves as a film's.
Scene scene_of(const std::string& film, const std::string& more, const std::string& wind = "speed = 6") {
  return parse_scene(
      "picture = \"still.png\"\n[wind]\n" + wind +
          "\n[[layer]]\nname = \"oak\"\nmatte = \"oak.png\"\nmotion = \"tree\"\narmature = [30, "
          "80, 30, 20]\nmotion_from = \"" +
          film + "\"\n" + more,
      "made.toml");
}
const std::string kUpright = "motion_armature = [120, 250, 120, 40]";

TEST(ClipSway, FollowsTheTipWhereverTheArmatureStands) {
  for (const Line& line :
       {Line{{120, 250}, {120, 40}}, Line{{20, 200}, {200, 150}}, Line{{120, 420}, {120, 40}}}) {
    const Film film({.armatures = {line}, .frequency_hz = 1, .damping_per_s = 1, .mass = 1}, 60);
    int at = 0;
    const auto next = [&]() -> std::optional<cv::Mat> {
      if (at == 60) return {};
      return cv::imread(fmt::format("{}/{:03}.png", film.path(), at++), cv::IMREAD_GRAYSCALE);
    };
    const std::vector<float> found = clip_sway(next, {line}, "film")[0], tip = film.tip();
    ASSERT_EQ(found.size(), tip.size());
    double square = 0, error = 0;
    for (std::size_t t = 0; t < tip.size(); ++t) {
      square += tip[t] * tip[t];
      error += (found[t] - tip[t]) * (found[t] - tip[t]);
    }
    EXPECT_GT(std::sqrt(square / 60), 0.01) << line.to;
    EXPECT_LT(std::sqrt(error / square), 0.1) << line.to;
  }
}

TEST(MeasuredPlants, SwayAsThePlantOfTheFilm) {
  const Plant plant{1.2, 1, 0.6};
  const Film film({.armatures = {{{120, 250}, {120, 40}}},
                   .frequency_hz = plant.frequency_hz,
                   .damping_per_s = plant.damping_per_s,
                   .mass = plant.mass});
  Scene scene = scene_of(film.path(), kUpright);
  std::vector<std::string> notices;
  measure_plants(scene, &notices);
  const TreeMotion found = *scene.layers[0].as<TreeMotion>();
  EXPECT_NEAR(std::log(found.frequency_hz / plant.frequency_hz), 0, 0.1);
  EXPECT_NEAR(std::log(found.damping_per_s / plant.damping_per_s), 0, 0.65);
  EXPECT_NEAR(std::log(deviation({found.frequency_hz, found.damping_per_s, found.mass}, kWind, 12) /
                       deviation(plant, kWind, 12)),
              0, 0.2);
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_THAT(notices[0], HasSubstr(fmt::format("layer oak: in 12 s of {} the tip sways by", film.path())));
}

TEST(MeasuredPlants, TheFilmsWindIsTheScenesAtItsStrongest) {
  const Film film({.armatures = {{{120, 250}, {120, 40}}}, .frequency_hz = 2, .mass = 0.2}, 60);
  const auto mass = [&](const std::string& wind) {
    Scene scene = scene_of(film.path(), kUpright, wind);
    measure_plants(scene);
    return scene.layers[0].as<TreeMotion>()->mass;
  };
  const double usual = mass("speed = 6");
  EXPECT_DOUBLE_EQ(mass("speed = 1\n[[wind.at]]\ntime = 2\nspeed = 6"), usual);
  EXPECT_NEAR(mass("speed = 6\nturbulence = 0.5"), 2 * usual, 1e-6 * usual);
  // A wind away from the viewer moves it by three quarters of what one along the picture does.
  EXPECT_NEAR(mass("speed = 6\ndirection = 90"), 0.75 * usual, 1e-6 * usual);
}

TEST(MeasuredPlants, WhatIsWrongIsNamed) {
  const TreeMotion still{.armatures = {{{120, 250}, {120, 40}}}, .mass = 1e5};
  const Film film(still, 60);
  const auto fault = [](Scene scene) { return fault_of([&] { measure_plants(scene); }); };
  EXPECT_THAT(
      fault(scene_of(film.path(), kUpright)),
      testing::AllOf(HasSubstr(film.path()), HasSubstr("the plant of layer oak does not sway in it")));
  EXPECT_THAT(fault(scene_of(film.path(), "motion_armature = [600, 250, 600, 40]")),
              HasSubstr("its 240 x 260 px do not show the plant from (600, 250) to (600, 40)"));
  const Film brief(still, 40);
  EXPECT_THAT(fault(scene_of(brief.path(), kUpright)),
              HasSubstr("its 40 frames are too few to see how a plant sways"));
  const auto parsing = [](const std::string& more) { return fault_of([&] { scene_of("sway.mp4", more); }); };
  EXPECT_THAT(parsing(""), HasSubstr("motion_from: nothing says where in it the plant stands"));
  EXPECT_THAT(parsing(kUpright + "\nmass = 2"), HasSubstr("mass: it is measured in motion_from"));
  EXPECT_THAT(parsing("motion_armature = [3, 3, 3, 4]"),
              HasSubstr("motion_armature: it is shorter than 4 px"));
  EXPECT_THAT(fault_of([&] {
                parse_scene(
                    "picture = \"a.png\"\n[[layer]]\nname = \"oak\"\nmatte = \"a.png\"\nmotion = "
                    "\"tree\"\n" +
                        kUpright,
                    "made.toml");
              }),
              HasSubstr("motion_armature: it belongs to motion_from, and there is none"));
}

}  // namespace
}  // namespace freshet::synth::scene
