#include "vision/settings.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "tests/harness/fault.h"

namespace freshet::vision {
namespace {

std::optional<ErrorKind> refused(const std::string& json) {
  return kind_of([&] { settings_from_json(json); });
}

TEST(Settings, SurviveARoundTrip) {
  Settings s;
  s.scales = {1, 0.7f};
  s.rotations_deg = {-11.25f};
  s.flips = false;
  s.grid = {.patch = 64, .stride = 16};
  s.min_coverage = 0.1;
  s.min_motion_px = 1.0 / 3;
  s.flow = {.method = FlowMethod::kTvL1,
            .tvl1_lambda = 0.03,
            .tvl1_theta = 0.3,
            .tvl1_iterations = 7,
            .tvl1_warps = 2};
  s.flow_step = 1;
  s.spectrum = {.cell = 2, .bands = 0, .window_s = 2.56, .max_hz = 10};
  s.texture_cell = 8;
  s.codebook = {.words = 100, .iterations = 3, .seed = 0xfedcba9876543210};
  const Settings back = settings_from_json(to_json(s));
  EXPECT_EQ(to_json(back), to_json(s));
  EXPECT_EQ(back.scales, s.scales);
  EXPECT_EQ(back.min_motion_px, s.min_motion_px);
  EXPECT_EQ(back.codebook.seed, s.codebook.seed);
  EXPECT_EQ(back.flow.method, FlowMethod::kTvL1);
  EXPECT_EQ(back.variants(), s.variants());
  EXPECT_EQ(to_json(settings_from_json(to_json({}))), to_json({}));
}

TEST(Settings, HostileTextIsDamage) {
  for (const std::string text : {"", "null", "[]", "{}", "{\"scales\":", "\xff\xfe", "1e999"}) {
    EXPECT_EQ(refused(text), ErrorKind::kDamaged);
  }
  EXPECT_EQ(refused(std::string(60000, '[')), ErrorKind::kDamaged);
  EXPECT_EQ(refused(std::string(1 << 20, ' ')), ErrorKind::kDamaged);
}

TEST(Settings, EveryFieldIsNeededAndChecked) {
  const auto good = nlohmann::json::parse(to_json({}));
  const auto flat = good.flatten();
  for (const auto& [path, value] : flat.items()) {
    const nlohmann::json::json_pointer pointer(path);
    for (const nlohmann::json& bad :
         {nlohmann::json(nullptr), nlohmann::json("x"), nlohmann::json(-1e300), nlohmann::json(1e300),
          nlohmann::json::array(), nlohmann::json::object()}) {
      auto broken = good;
      broken[pointer] = bad;
      EXPECT_EQ(refused(broken.dump()), ErrorKind::kDamaged) << path << " = " << bad;
    }
    if (path.find("/0") != std::string::npos || path.find("/1") != std::string::npos ||
        path.find("/2") != std::string::npos) {
      continue;  // a shorter list is fit
    }
    auto missing = good;
    missing[pointer.parent_pointer()].erase(pointer.back());
    EXPECT_EQ(refused(missing.dump()), ErrorKind::kDamaged) << path;
  }
}

TEST(Settings, UnknownKeysAreRefused) {
  auto json = nlohmann::json::parse(to_json({}));
  json["flow"]["pyramid"] = 3;
  EXPECT_EQ(refused(json.dump()), ErrorKind::kDamaged);
}

TEST(Settings, CombinationsThatCannotWorkAreRefused) {
  Settings s;
  s.grid.patch = 50;
  EXPECT_EQ(refused(to_json(s)), ErrorKind::kDamaged);
  s = {};
  s.flow_step = 3;
  EXPECT_EQ(refused(to_json(s)), ErrorKind::kDamaged);
  s = {};
  s.spectrum.max_hz = 0.2;
  EXPECT_EQ(refused(to_json(s)), ErrorKind::kDamaged);
  s = {};
  s.scales.assign(16, 1.0f);
  s.rotations_deg.assign(9, 1.0f);
  EXPECT_EQ(refused(to_json(s)), ErrorKind::kDamaged);
}

}  // namespace
}  // namespace freshet::vision
