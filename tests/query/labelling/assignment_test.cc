#include "query/labelling/assignment.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "tests/harness/fault.h"
#include "tests/stored/made_store.h"

namespace freshet::query {
namespace {

Assignment some_assignment() {
  Assignment assignment;
  assignment.picture = {100, 80};
  assignment.clips = {{"a \"b\".mp4", "water", "CC BY 4.0", std::string(32, 'a')},
                      {"c.mp4", "", "", std::string(32, '0')}};
  assignment.pieces = {{{-4, -2}, 0, {0.75f, -22.5f, true}, {12, 13}, 0.123456f},
                       {{20, -2}, 1, {1, 0, false}, {0, 0}, 1},
                       {{-4, 46}, 1, {0.5f, 22.5f, false}, {700, 3}, 0}};
  assignment.minimizer = "trw-s";
  assignment.cost_form = "log";
  assignment.energy = 1.0 / 3;
  assignment.lower_bound = 0.25;
  return assignment;
}

TEST(Assignment, IsReadBackAsItWasWritten) {
  const ScratchFolder folder;
  Assignment assignment = some_assignment();
  write_assignment(folder.path() / "a.json", assignment);
  EXPECT_EQ(read_assignment(folder.path() / "a.json"), assignment);
  assignment.lower_bound = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(assignment_from_json(to_json(assignment), "a"), assignment);
  EXPECT_THROW(write_assignment(folder.path() / "none" / "a.json", assignment), Error);
  EXPECT_THROW(read_assignment(folder.path() / "b.json"), Error);
  EXPECT_THROW(read_assignment(folder.path()), Error);
}

bool refused(const std::string& json) {
  return kind_of([&] { assignment_from_json(json, "a"); }) == ErrorKind::kInput;
}

TEST(Assignment, RefusesWhatIsMissingOfAnotherTypeOrOutOfRange) {
  const auto whole = nlohmann::json::parse(to_json(some_assignment()));
  ASSERT_FALSE(refused(whole.dump()));
  const std::vector<nlohmann::json> strange{
      nullptr, "x", -1, 1e300, 3.5, 1ull << 63, true, nlohmann::json::array({1}), nlohmann::json::object()};
  const auto attack = [&](const nlohmann::json::json_pointer& object) {
    const nlohmann::json fields = whole.at(object);
    for (const auto& [name, value] : fields.items()) {
      auto without = whole;
      without.at(object).erase(name);
      EXPECT_TRUE(refused(without.dump())) << name;
      for (const auto& odd : strange) {
        if (odd.type() == value.type() || (odd.is_number() && value.is_number())) continue;
        if (name == "lower_bound" && odd.is_null()) continue;
        auto changed = whole;
        changed.at(object)[name] = odd;
        EXPECT_TRUE(refused(changed.dump())) << name << " " << odd;
      }
    }
  };
  attack(nlohmann::json::json_pointer(""));
  attack(nlohmann::json::json_pointer("/clips/0"));
  attack(nlohmann::json::json_pointer("/pieces/1"));
  const auto with = [&](const char* where, const nlohmann::json& value) {
    auto changed = whole;
    changed.at(nlohmann::json::json_pointer(where)) = value;
    return changed.dump();
  };
  for (const auto& [where, value] :
       std::initializer_list<std::pair<const char*, nlohmann::json>>{{"/version", 2},
                                                                     {"/width", 0},
                                                                     {"/width", 1 << 30},
                                                                     {"/side", 0},
                                                                     {"/side", 1u << 31},
                                                                     {"/stride", 49},
                                                                     {"/stride", 0},
                                                                     {"/pieces/0/clip", 2},
                                                                     {"/pieces/0/clip", -1},
                                                                     {"/pieces/1/x", 21},
                                                                     {"/pieces/1/x", 20 + 24 * 4},
                                                                     {"/pieces/2/y", -50},
                                                                     {"/pieces/1/scale", 0},
                                                                     {"/pieces/1/score", 2},
                                                                     {"/pieces/1/patch_x", -1},
                                                                     {"/clips/0/source_hash", "ABC"}}) {
    EXPECT_TRUE(refused(with(where, value))) << where << " " << value;
  }
  EXPECT_TRUE(refused(""));
  EXPECT_TRUE(refused("[]"));
  EXPECT_TRUE(refused(std::string(100000, '[')));
  const std::string text = to_json(some_assignment());
  for (std::size_t cut = 0; cut + 2 < text.size(); cut += 7) EXPECT_TRUE(refused(text.substr(0, cut)));
}

// What other programs read, to the byte.
TEST(Assignment, IsWrittenAsTheseBytes) {
  Assignment assignment;
  assignment.picture = {96, 48};
  assignment.clips = {{"a.mp4", "water", "CC0", std::string(32, 'a')}};
  assignment.pieces = {{{24, -8}, 0, {0.5f, -22.5f, true}, {3, 4}, 0.25f}};
  assignment.minimizer = "icm";
  assignment.cost_form = "power";
  assignment.energy = 2.5;
  assignment.lower_bound = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(to_json(assignment), R"({
 "clips": [
  {
   "class": "water",
   "licence": "CC0",
   "name": "a.mp4",
   "source_hash": "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"
  }
 ],
 "cost_form": "power",
 "energy": 2.5,
 "format": "freshet-assignment",
 "height": 48,
 "lower_bound": null,
 "minimizer": "icm",
 "pieces": [
  {
   "clip": 0,
   "flip": true,
   "patch_x": 3,
   "patch_y": 4,
   "rotation_deg": -22.5,
   "scale": 0.5,
   "score": 0.25,
   "x": 24,
   "y": -8
  }
 ],
 "side": 48,
 "stride": 24,
 "version": 1,
 "width": 96
}
)");
}

TEST(Assignment, OfAReducedPictureIsAnotherVersionThatKnowsItsScale) {
  Assignment assignment = some_assignment();
  assignment.picture = {200, 160};
  assignment.piece_scale = 1.5;
  const auto json = nlohmann::json::parse(to_json(assignment));
  EXPECT_EQ(json.at("version"), 2);
  EXPECT_EQ(assignment_from_json(json.dump(), "a"), assignment);
  // Who knows only version 1 gets no scale, and one who claims version 2 has to say it.
  EXPECT_FALSE(nlohmann::json::parse(to_json(some_assignment())).contains("piece_scale"));
  auto without = json;
  without.erase("piece_scale");
  EXPECT_TRUE(refused(without.dump()));
  for (const double scale : {0.5, 0.0, -1.0, 1000.0}) {
    auto odd = json;
    odd["piece_scale"] = scale;
    EXPECT_TRUE(refused(odd.dump())) << scale;
  }
  // A piece may lie at 180 of 200 px, but not of the 133 that are left at scale 1.5.
  auto outside = json;
  outside["pieces"][1]["x"] = -4 + 8 * 24;
  EXPECT_TRUE(refused(outside.dump()));
  outside["version"] = 1;
  EXPECT_FALSE(refused(outside.dump()));
}

TEST(Assignment, ARefusalNamesTheFileThePieceAndTheField) {
  auto json = nlohmann::json::parse(to_json(some_assignment()));
  json["pieces"][2]["score"] = 1.5;
  const std::string what = fault_of([&] { assignment_from_json(json.dump(), "some.json"); });
  for (const char* part : {"some.json", "piece 2", "\"score\"", "1.5"})
    EXPECT_NE(what.find(part), std::string::npos) << what;
}

TEST(Assignment, NamesThatAreNoUtf8DoNotBreakTheFile) {
  Assignment assignment = some_assignment();
  assignment.clips[0].name = "caf\xe9.mp4";
  const Assignment read = assignment_from_json(to_json(assignment), "a");
  EXPECT_EQ(read.clips[0].source_hash, assignment.clips[0].source_hash);
  EXPECT_EQ(read.pieces, assignment.pieces);
}

TEST(Assignment, LeavesNothingBesideAFileThatCannotBeWrittenAndReplacesOneThatIsThere) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder.path() / "taken");
  EXPECT_THROW(write_assignment(folder.path() / "taken", some_assignment()), Error);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "taken.part"));
  std::ofstream(folder.path() / "a.json") << std::string(10000, 'x');
  write_assignment(folder.path() / "a.json", some_assignment());
  EXPECT_EQ(read_assignment(folder.path() / "a.json"), some_assignment());
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.json.part"));
}

TEST(Assignment, KnowsItsGapOnlyWithABound) {
  Assignment assignment = some_assignment();
  EXPECT_NEAR(assignment.gap(), (1.0 / 3 - 0.25) / 0.25, 1e-12);
  EXPECT_FALSE(assignment.reaches_gap());
  assignment.energy = 0.2524;
  EXPECT_TRUE(assignment.reaches_gap());
  assignment.lower_bound = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(assignment.gap(), std::numeric_limits<double>::infinity());
  EXPECT_FALSE(assignment.reaches_gap());
}

TEST(Assignment, FindsItsClipsInAStoreBySourceHashAndNamesThoseItLacks) {
  const ScratchFolder folder;
  const store::Snapshot snapshot = made_store(folder.path() / "a.store", some_clips()).snapshot();
  Assignment assignment = some_assignment();
  assignment.clips[0].source_hash = source_hash_of({.name = "river.mp4"});
  assignment.clips[1].source_hash = source_hash_of({.name = "still.mp4"});
  assignment.pieces[2].patch = {12, 3};
  const auto ids = find_clips(assignment, snapshot);
  ASSERT_EQ(ids.size(), 2u);
  EXPECT_EQ(snapshot.clip(ids[0]).name, "river.mp4");
  EXPECT_EQ(snapshot.clip(ids[1]).name, "still.mp4");
  const auto found = [&] { find_clips(assignment, snapshot); };
  // Frames are 192 px wide.
  assignment.pieces[1].patch = {192 - 48, 0};
  EXPECT_NO_THROW(find_clips(assignment, snapshot));
  assignment.pieces[1].patch = {192 - 47, 0};
  EXPECT_NE(fault_of(found).find("piece 1"), std::string::npos);
  assignment.pieces[1].patch = {0, 0};
  assignment.clips[1] = {"unknown.mp4", "", "", std::string(32, '0')};
  EXPECT_NE(fault_of(ErrorKind::kNotFound, found).find("unknown.mp4"), std::string::npos);
}

}  // namespace
}  // namespace freshet::query
