#include <cmath>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "freshet/error.h"
#include "synth/simulate/design/scene_file.h"
#include "synth/simulate/design/shape.h"
#include "synth/simulate/simulate.h"
#include "tests/synth/simulate/sample_hash.h"

namespace freshet::synth::simulate {
namespace {

SceneOptions small_preset(const std::string& name) {
  SceneOptions scene = parse_scene(preset_scene(name), name);
  scene.size = {96, 72};
  scene.design.rows = 48;
  return scene;
}

std::uint64_t hash_of(const SceneOptions& scene, int threads) {
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(threads));
  Simulation design(scene);
  SimulatedFrame frame;
  std::uint64_t hash = 1;
  while (design.next(frame)) {
    for (const cv::Mat& mat : {frame.picture, frame.alpha, frame.motion, frame.emitters})
      hash = hash_of_samples(mat, hash);
  }
  return hash;
}

class EveryDesign : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Presets, EveryDesign,
                         ::testing::Values("plume", "fireball", "firepit", "waterfall-pool", "dragon-breath"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST_P(EveryDesign, GivesTheSameBytesForAnyNumberOfThreads) {
  SceneOptions scene = small_preset(GetParam());
  scene.frames = 4, scene.warm_up_frames = 6;
  const std::uint64_t one = hash_of(scene, 1);
  EXPECT_EQ(one, hash_of(scene, 2));
  EXPECT_EQ(one, hash_of(scene, 8));
  scene.seed = 77;
  EXPECT_NE(one, hash_of(scene, 2));
}

TEST_P(EveryDesign, GivesTheBytesThatItGaveOnOtherMachines) {
  const std::map<std::string, std::uint64_t> expected{{"plume", 0x37551fa919c3fd0dULL},
                                                      {"fireball", 0xa5a595127b1b907bULL},
                                                      {"firepit", 0x53166c80a169ab53ULL},
                                                      {"waterfall-pool", 0x6d075c03f7b1707aULL},
                                                      {"dragon-breath", 0x75b062acd8954527ULL}};
  SceneOptions scene = small_preset(GetParam());
  scene.frames = 6, scene.warm_up_frames = 10, scene.seed = 5;
  EXPECT_EQ(hash_of(scene, 2), expected.at(GetParam()));
}

// Every kind of drawn shape, of force and of side, and 16 bits of alpha, in one scene.
TEST(Design, OfEverythingThereIsGivesTheBytesThatItGaveOnOtherMachines) {
  SceneOptions scene = parse_scene(R"(
size = [101, 77]
frames = 8
seed = 3
grid = 40
steps = 3
[fluid]
buoyancy = 1.4
gravity = 0.6
weight = 3.0
viscosity = 0.0001
drag = 0.1
burning = 0.05
cooling = 0.3
still_air = 0.4
top_speed = 1.5
[sides]
left = "closed"
top = "open"
[look]
glow = 0.5
[[emitter]]
name = "line"
shape = "line"
start = [0.2, 0.8]
end = [0.6, 0.9]
width = 0.08
velocity = [0.1, -0.6]
heat = 1.0
jitter = 0.8
to = 0.2
[[emitter]]
name = "blast"
shape = "polygon"
corners = [[0.6, 0.5], [0.8, 0.5], [0.7, 0.7]]
expansion = 2.0
rate = [[0.0, 0.0], [0.1, 1.5]]
jitter = 0.0
[[obstacle]]
name = "ball"
shape = "disc"
position = [0.5, 0.5]
radius = 0.08
move = [[0.0, 0.0, 0.0], [0.2, 0.2, -0.1]]
[[obstacle]]
name = "gate"
shape = "line"
start = [0.1, 0.3]
end = [0.3, 0.3]
width = 0.04
from = 0.1
[[force]]
kind = "wind"
velocity = [0.2, 0.0]
strength = 0.5
[[force]]
kind = "point"
position = [0.3, 0.3]
radius = 0.2
strength = 2.0
[[force]]
kind = "vortex"
position = [0.7, 0.4]
radius = 0.15
strength = 3.0
[[force]]
kind = "turbulence"
size = 0.1
strength = 2.0
)",
                                   "everything.toml");
  scene.alpha_bits = 16;
  EXPECT_EQ(hash_of(scene, 2), 0x766e09a139009e1aULL);
}

TEST_P(EveryDesign, MovesInEveryFrameAndStaysFinite) {
  SceneOptions scene = small_preset(GetParam());
  scene.frames = 50;
  Simulation design(scene);
  SimulatedFrame frame;
  cv::Mat before;
  for (int i = 0; design.next(frame); ++i) {
    EXPECT_GT(cv::countNonZero(frame.alpha > 60), 10) << "frame " << i << " is as good as empty";
    EXPECT_LT(cv::countNonZero(frame.alpha > 60), 0.9 * 96 * 72) << "frame " << i << " is full";
    for (int y = 0; y < frame.motion.rows; ++y) {
      for (int x = 0; x < frame.motion.cols; ++x) {
        const cv::Vec2f m = frame.motion.at<cv::Vec2f>(y, x);
        ASSERT_TRUE(std::isfinite(m[0]) && std::isfinite(m[1]));
      }
    }
    if (i > 0) {
      EXPECT_GT(cv::norm(frame.alpha, before, cv::NORM_INF), 8) << "frame " << i << " is the one before";
    }
    before = frame.alpha.clone();
  }
}

/// A drop that is there from the first frame, and nothing that takes from it or adds to it.
SceneOptions drop(const std::string& more) {
  return parse_scene(R"(size = [160, 120]
frames = 9
grid = 60
warm_up = 0.5
[sides]
left = "closed"
right = "closed"
top = "closed"
bottom = "closed"
[[emitter]]
shape = "disc"
position = [0.5, 0.4]
radius = 0.15
softness = 0.05
to = -0.3
jitter = 0
)" + more,
                     "drop.toml");
}

float level(const cv::Mat& alpha, float x, float y) {
  const Tap tx = tap(x, alpha.cols), ty = tap(y, alpha.rows);
  const auto at = [&](int row, int column) {
    return static_cast<float>(alpha.at<std::uint16_t>(row, column)) / 65535.0f;
  };
  const float top = at(ty.index, tx.index) * (1 - tx.weight) + at(ty.index, tx.index + tx.step) * tx.weight;
  const float bottom = at(ty.index + ty.step, tx.index) * (1 - tx.weight) +
                       at(ty.index + ty.step, tx.index + tx.step) * tx.weight;
  return top * (1 - ty.weight) + bottom * ty.weight;
}

TEST(Design, FlowOfAFrameCarriesItsAlphaToTheNext) {
  SceneOptions scene = drop(R"([fluid]
gravity = 2.0
vorticity = 0.5
[[force]]
kind = "vortex"
position = [0.4, 0.5]
strength = 6.0
)");
  scene.alpha_bits = 16;
  Simulation design(scene);
  SimulatedFrame frame;
  ASSERT_TRUE(design.next(frame));
  cv::Mat alpha = frame.alpha.clone(), motion = frame.motion.clone();
  double carried = 0.0, still = 0.0, back_to_front = 0.0, speed = 0.0;
  int pixels = 0;
  while (design.next(frame)) {
    for (int y = 2; y < alpha.rows - 2; ++y) {
      for (int x = 2; x < alpha.cols - 2; ++x) {
        if (alpha.at<std::uint16_t>(y, x) < 2000) continue;
        const cv::Vec2f m = motion.at<cv::Vec2f>(y, x);
        const float px = static_cast<float>(x), py = static_cast<float>(y), here = level(alpha, px, py);
        carried += std::fabs(level(frame.alpha, px + m[0], py + m[1]) - here);
        still += std::fabs(level(frame.alpha, px, py) - here);
        back_to_front += std::fabs(level(frame.alpha, px - m[0], py - m[1]) - here);
        speed += std::hypot(m[0], m[1]);
        ++pixels;
      }
    }
    alpha = frame.alpha.clone(), motion = frame.motion.clone();
  }
  carried /= pixels, still /= pixels, back_to_front /= pixels, speed /= pixels;
  EXPECT_GT(speed, 0.8) << "px per frame";
  EXPECT_LT(carried, 0.01);
  EXPECT_LT(carried, 0.2 * still) << still;
  EXPECT_LT(carried, 0.1 * back_to_front) << back_to_front;
}

double middle_row(const cv::Mat& alpha) {
  double sum = 0.0, weight = 0.0;
  for (int y = 0; y < alpha.rows; ++y) {
    const double mass = cv::sum(alpha.row(y))[0];
    sum += mass * y, weight += mass;
  }
  return sum / weight;
}

TEST(Design, HeavyFluidFallsFreelyAndLightFluidIsHeldUpByTheAir) {
  const auto fall = [](const char* weight) {
    SceneOptions scene =
        drop(std::string("[fluid]\ngravity = 1.5\nvorticity = 0\nweight = ") + weight + "\n");
    scene.design.warm_up_s = 0.0;
    scene.design.emitters[0].span.to_s = 0.01;
    scene.frames = 11;
    Simulation design(scene);
    SimulatedFrame frame;
    double first = 0.0, last = 0.0;
    for (int i = 0; design.next(frame); ++i) (i == 0 ? first : last) = middle_row(frame.alpha);
    return (last - first) / 120.0;  // heights
  };
  // A body in free fall: g t^2 / 2 after 10 frames of 1/25 s.
  const double free = 0.5 * 1.5 * 0.4 * 0.4;
  EXPECT_NEAR(fall("60"), free, 0.2 * free);
  EXPECT_LT(fall("1"), 0.7 * free);
}

/// The fluid of an emitter goes where it is driven to. Driving it after it had been carried on made gusts of
/// one cell grow in every step, to 12 px per frame, and specks of air in the fluid.
TEST(Design, AnEmittersFlowStaysEven) {
  const SceneOptions scene = parse_scene(R"(size = [160, 120]
frames = 40
grid = 60
[[emitter]]
shape = "disc"
position = [0.5, 0.8]
radius = 0.15
velocity = [0.0, -0.6]
jitter = 0.0
)",
                                         "jet.toml");
  Simulation design(scene);
  SimulatedFrame frame;
  while (design.next(frame)) continue;
  for (int y = 86; y < 106; ++y) {
    for (int x = 70; x < 90; ++x) {
      EXPECT_NEAR(frame.motion.at<cv::Vec2f>(y, x)[1], -0.6 * 120 / 25, 1.0) << x << ", " << y;
      EXPECT_NEAR(frame.motion.at<cv::Vec2f>(y, x)[0], 0.0, 1.0) << x << ", " << y;
    }
  }
}

TEST(Design, NoFluidEntersAnObstacleEvenAMovingOne) {
  SceneOptions scene = parse_scene(R"(size = [160, 120]
frames = 30
grid = 60
[[emitter]]
shape = "disc"
position = [0.2, 0.5]
radius = 0.1
velocity = [1.5, 0.0]
[[obstacle]]
shape = "disc"
position = [0.6, 0.5]
radius = 0.12
move = [[0, 0, -0.2], [1.2, 0, 0.2]]
)",
                                   "wall.toml");
  Simulation design(scene);
  SimulatedFrame frame;
  for (int i = 0; design.next(frame); ++i) {
    const float at = shift_at(scene.design.obstacles[0].shape, i / 25.0).y;
    EXPECT_EQ(frame.alpha.at<std::uint8_t>(static_cast<int>((0.5f + at) * 120.0f), 96), 0) << "frame " << i;
  }
  EXPECT_GT(cv::countNonZero(frame.alpha), 500);
}

TEST(Design, EmittersAreShownWhileTheyGive) {
  SceneOptions scene = parse_scene(R"(size = [80, 60]
frames = 10
grid = 30
[[emitter]]
shape = "disc"
position = [0.5, 0.5]
radius = 0.2
from = 0.08
to = 0.24
)",
                                   "puff.toml");
  Simulation design(scene);
  SimulatedFrame frame;
  for (int i = 0; design.next(frame); ++i) {
    EXPECT_EQ(cv::countNonZero(frame.emitters) > 0, i >= 2 && i < 6) << "frame " << i;
    if (i == 3) {
      EXPECT_EQ(frame.emitters.at<std::uint8_t>(30, 40), 255);
      EXPECT_EQ(frame.emitters.at<std::uint8_t>(5, 5), 0);
    }
  }
}

TEST(Design, LooksTheSameAtAnotherSizeOfPicture) {
  const auto fraction = [](cv::Size size) {
    SceneOptions scene = drop("[fluid]\ngravity = 2.0\n");
    scene.size = size;
    Simulation design(scene);
    SimulatedFrame frame;
    while (design.next(frame)) continue;
    return std::pair(cv::mean(frame.alpha)[0], middle_row(frame.alpha) / size.height);
  };
  const auto small = fraction({160, 120}), large = fraction({400, 300});
  EXPECT_NEAR(small.first, large.first, 0.03 * large.first);
  EXPECT_NEAR(small.second, large.second, 0.01);
}

TEST(Shape, CoversWhatItShould) {
  Grid coverage(200, 100);
  const auto area = [&](const Shape& shape, Vec2 shift) {
    const cv::Rect bounds = draw_shape(shape, shift, coverage);
    double sum = 0.0;
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 200; ++x) {
        if (!bounds.contains({x, y})) {
          EXPECT_EQ(coverage(x, y), 0.0f);
        }
        sum += static_cast<double>(coverage(x, y));
      }
    }
    return sum;
  };
  const Shape disc{.points = {{0.5f, 0.5f}}, .radius = 0.2f};
  EXPECT_NEAR(area(disc, {}), 3.14159 * 20 * 20, 15.0);
  EXPECT_NEAR(area(disc, {0.5f, 0.0f}), 3.14159 * 20 * 20 / 2, 20.0);
  EXPECT_NEAR(
      area({.kind = Shape::Kind::kLine, .points = {{0.25f, 0.5f}, {0.75f, 0.5f}}, .radius = 0.1f}, {}),
      100 * 20 + 3.14159 * 100, 15.0);
  EXPECT_NEAR(area({.kind = Shape::Kind::kPolygon, .points = {{0.1f, 0.1f}, {0.6f, 0.1f}, {0.1f, 0.9f}}}, {}),
              0.5 * 100 * 80, 15.0);
  cv::Mat half(10, 10, CV_8U, cv::Scalar(0));
  half.colRange(0, 5).setTo(255);
  EXPECT_NEAR(area({.kind = Shape::Kind::kPicture, .picture = half}, {}), 200 * 100 / 2, 100.0);
  EXPECT_EQ(area(disc, {3.0f, 0.0f}), 0.0);
}

TEST(SceneFile, EveryPresetIsAScene) {
  std::set<std::string> names;
  for (const PresetScene& each : preset_scenes()) {
    const SceneOptions scene = parse_scene(preset_scene(each.name), each.name);
    check(scene);
    EXPECT_EQ(scene.design.emitters.empty(), scene.kind != SceneKind::kDesign) << each.name;
    EXPECT_FALSE(each.summary.empty());
    names.insert(each.name);
  }
  EXPECT_EQ(names.size(), 15u);
}

/// The fault of a scene, "" when there is none.
std::string fault_of(const std::string& text) {
  try {
    parse_scene(text, "a.toml");
    return "";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput);
    return error.what();
  }
}

TEST(SceneFile, FaultsNameLineKeyAndWhatWasExpected) {
  const std::string emitter = "[[emitter]]\nshape = \"disc\"\nposition = [0.5, 0.5]\n";
  ASSERT_EQ(fault_of(emitter), "");
  const struct {
    std::string text, line, part;
  } faults[] = {
      {"size = [640\n", "a.toml:", "not TOML"},
      {"sise = [640, 360]\n" + emitter, "a.toml:1: sise", "no such key. There are"},
      {"size = [640, -2]\n" + emitter, "a.toml:1: size", "-2 is out of range. Give 16 to 4096"},
      {"size = 640\n" + emitter, "a.toml:1: size", "a list of 2 numbers is expected, not 640"},
      {"frames = 2.5\n" + emitter, "a.toml:1: frames", "a whole number is expected, not 2.5"},
      {"fps = \"25\"\n" + emitter, "a.toml:1: fps", "a number is expected, not the text \"25\""},
      {"fps = nan\n" + emitter, "a.toml:1: fps", "out of range"},
      {"grid = 100000\n" + emitter, "a.toml:1: grid", "Give 16 to 2048"},
      {"clip = \"lava\"\n", "a.toml:1: clip", "Choose one of smoke, fire"},
      {"clip = \"fire\"\n[fluid]\n", "a.toml:2: fluid", "no such key"},
      {"frames = 3\n", "a.toml:1", "no emitter"},
      {emitter + "radius = -1\n", "a.toml:4: emitter 1.radius", "-1 is out of range"},
      {emitter + "name = \"vent\"\nrate = [[0, 1], [0, 2]]\n", "a.toml:5: emitter 1 (vent).rate",
       "second 0 does not come after 0"},
      {emitter + "from = 2\nto = 1\n", "a.toml:5: emitter 1.to", "before it begins at 2 s"},
      {"[[emitter]]\nshape = \"disc\"\n", "a.toml:1: emitter 1", "a disc needs position"},
      {"[[emitter]]\nshape = \"disc\"\nposition = [1.5, 0.5]\n", "a.toml:1: emitter 1",
       "it lies outside the picture"},
      {"[[emitter]]\nshape = \"blob\"\n", "a.toml:2: emitter 1.shape", "Choose one of disc, line"},
      {"[[emitter]]\nshape = \"polygon\"\ncorners = [[0, 0], [1, 1]]\n", "a.toml:3: emitter 1.corners",
       "at least three"},
      {"[[emitter]]\nshape = \"picture\"\npicture = \"absent.png\"\n", "a.toml:3: emitter 1.picture",
       "absent.png"},
      {"[emitter]\nshape = \"disc\"\n", "a.toml:1: emitter", "below [[emitter]]"},
      {emitter + "[[force]]\nkind = \"wind\"\n", "a.toml:4: force 1", "a wind needs a velocity"},
      {emitter + "[[force]]\nkind = \"vortex\"\nposition = [0.5, 0.5]\nsize = 1\n", "a.toml:7: force 1.size",
       "no such key"},
      {emitter + "[sides]\nleft = \"ajar\"\n", "a.toml:5: sides.left", "Choose one of open, closed"},
  };
  for (const auto& fault : faults) {
    const std::string said = fault_of(fault.text);
    EXPECT_NE(said.find(fault.line), std::string::npos) << said << "\n" << fault.text;
    EXPECT_NE(said.find(fault.part), std::string::npos) << said << "\n" << fault.text;
  }
}

TEST(SceneFile, OnlyDesignsHaveSixteenBits) {
  EXPECT_NO_THROW(check({.kind = SceneKind::kDesign, .alpha_bits = 16}));
  EXPECT_THROW(check({.kind = SceneKind::kFire, .alpha_bits = 16}), Error);
}

}  // namespace
}  // namespace freshet::synth::simulate
