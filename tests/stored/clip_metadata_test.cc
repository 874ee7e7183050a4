#include "stored/clip_metadata.h"

#include <string>

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "stored/store_settings.h"
#include "tests/harness/fault.h"
#include "tests/stored/altered_record.h"
#include "tests/stored/made_store.h"

namespace freshet::stored {
namespace {

/// A store of one clip, whose metadata are put in its place.
class Metadata : public testing::Test {
 protected:
  Metadata() { made_store(file_, {{.name = "fall.mp4"}}); }

  ClipMetadata read(const std::string& text) {
    alter_first_clip(file_, [&](store::StoredClip& clip) { clip.record.metadata = text; });
    const store::Snapshot snapshot = store::Store::open_read(file_).snapshot();
    return metadata_of(snapshot, snapshot.clips()[0]);
  }
  /// What is said of the text, which names store and clip.
  std::string fault(const std::string& text) {
    try {
      read(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kDamaged);
      EXPECT_NE(std::string(error.what()).find(file_.string() + ", clip \"fall.mp4\""), std::string::npos)
          << error.what();
      return error.what();
    }
    ADD_FAILURE() << text << " was taken";
    return {};
  }

  const ScratchFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "a.store";
};

TEST_F(Metadata, ComeBackAsTheyWere) {
  ClipMetadata written{
      .layout = media::PixelLayout{.format = "yuv420p", .width = 64, .height = 48, .range = 1},
      .codec = "h264",
      .container = "mov",
      .variable_frame_rate = true,
      .repairs = "yadif",
      .notices = {"one", "two"},
      .cells = {.motion = CellShape{2, 3, 26, 4}, .texture = {{4, 5, 4, 8}, {2, 3, 4, 16}}},
      .patches = {7, 0, 3},
      .loop = vision::LoopRule{.from = 30, .to = 4, .fade = 8, .distance = 0.25},
      .half_life_s = std::array{0.5f, 1.0f, 0.0f, 6.0f}};
  written.more["screening"] = {{"frames", 40}};
  const std::string text = to_json(written);
  const ClipMetadata found = read(text);
  EXPECT_EQ(to_json(found), text);
  EXPECT_EQ(found.layout->format, "yuv420p");
  EXPECT_EQ(found.layout->height, 48);
  EXPECT_TRUE(found.variable_frame_rate);
  EXPECT_EQ(found.cells.motion->channels, 26);
  EXPECT_EQ(found.cells.texture[1].cell, 16);
  EXPECT_FALSE(found.cells.life);
  EXPECT_EQ(found.patches[2], 3u);
  EXPECT_EQ(found.loop->from, 30u);
  EXPECT_EQ((*found.half_life_s)[1], 1);
  EXPECT_FALSE(found.standing);
  EXPECT_EQ(found.more.at("screening").at("frames"), 40);
}

TEST_F(Metadata, TellNoRuleFromNoRulesYet) {
  EXPECT_TRUE(read(R"({"loop": null})").loop_known);
  EXPECT_FALSE(read(R"({"loop": null})").loop);
  EXPECT_FALSE(read("{}").loop_known);
}

TEST_F(Metadata, ThatAreNoneAreNamedByStoreAndClip) {
  for (const char* text : {"", "{", "no JSON", "[1]", "7", "\"{}\""})
    EXPECT_NE(fault(text).find("JSON"), std::string::npos);
  EXPECT_NE(fault(std::string(100'000, '[')).find("no JSON"), std::string::npos);
}

TEST_F(Metadata, OfOtherTypesOrOutOfRangeAreRefused) {
  for (const char* text :
       {R"({"codec": 7})", R"({"notices": "one"})", R"({"variable_frame_rate": 1})",
        R"({"patches": {"a": 1}})", R"({"layout": {}})", R"({"layout": 1})", R"({"loop": 3})",
        R"({"loop": {"from": 3}})", R"({"loop": {"from": -3, "to": 1, "fade": 2, "distance": 0}})",
        R"({"loop": {"from": 3.5, "to": 1, "fade": 2, "distance": 0}})", R"({"half_life_s": [1, 2, 3]})",
        R"({"half_life_s": [1, 2, 3, "a"]})", R"({"standing": 1})", R"({"cells": {"motion": 1}})",
        R"({"cells": {"motion": {"rows": 0, "columns": 1, "channels": 1, "cell": 4}}})",
        R"({"cells": {"motion": {"rows": 1, "columns": 1e9, "channels": 1, "cell": 4}}})",
        R"({"cells": {"motion": {"rows": 1, "columns": 1000000000, "channels": 1, "cell": 4}}})",
        R"({"cells": {"motion": {"rows": 1, "columns": 1, "channels": 1, "cell": 0}}})",
        R"({"cells": {"motion": {"rows": 1, "columns": 1, "channels": 1, "cell": 1e300}}})"})
    EXPECT_NE(fault(text), "");
}

TEST(StoreSettings, ThatAreNoneAreNamedByStore) {
  const ScratchFolder folder;
  store::Store store = store::Store::create(folder.path() / "a.store", "no settings");
  const std::string fault = fault_of(ErrorKind::kDamaged, [&] { settings_of(store.snapshot()); });
  EXPECT_TRUE(fault.starts_with((folder.path() / "a.store").string())) << fault;
}

}  // namespace
}  // namespace freshet::stored
