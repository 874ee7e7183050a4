#include "studio/drawing/document.h"

#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "hints/svg_strokes.h"
#include "tests/harness/fault.h"

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

Document full() {
  Document document;
  document.store = "/a/water.freshet";
  document.matte_base = MatteBase::kAlpha;
  document.edge = "none";
  document.scribbles = {{.points = {{1, 2}, {3.5f, 4}}, .width = 7, .adds = false, .is_area = false}};
  document.paint = {{.points = {{1, 2}, {9, 2}, {9, 9}}, .width = 0, .adds = true, .is_area = true}};
  document.held = {{.points = {{5, 5}}, .width = 3, .adds = true, .is_area = false}};
  document.strokes = {{.points = {{10, 10}, {10, 40}}, .speed = 80.0f},
                      {.points = {{20, 10}, {30, 40}}, .speed = {}}};
  document.directions = {{.points = {{10, 10}, {10, 40}}, .width = 20, .adds = true, .is_area = false}};
  document.tempo = {{.points = {{5, 5}, {9, 5}}, .width = 12, .factor = 0.5f}};
  document.class_name = "water";
  document.excluded_clips = {"water/<b>1</b>.mp4"};
  document.pins = {{.corner = {-8, 16}, .clip = "water/2.mp4", .variant = 3, .patch = {40, 50}}};
  document.frames = 48;
  document.fps = 24;
  document.loop = false;
  document.speed = 0.5;
  document.horizon = "none";
  document.moving_outline = true;
  document.layout = "stands";
  document.detail_life = 0.5;
  document.flames = "clips";
  document.design = {.fluid = "fire",
                     .sources = {{.points = {{5, 5}}, .width = 9, .adds = false, .is_area = false}},
                     .winds = {{.points = {{1, 1}, {9, 1}}, .speed = {}}},
                     .look = "fire/1.mp4",
                     .ground = "none",
                     .frames = 30,
                     .full = true};
  document.stills = {
      .seconds = 4.5,
      .speed = 2,
      .loop = false,
      .split = 3,
      .full = true,
      .paths = {{.region = "1", .names = {"a.jpg", "c d.jpg"}, .refused = true}},
      .pins = {{.from = "a.jpg", .to = "c d.jpg", .at = {4, 5}, .goes = {9, 6.5f}, .reach = 40}}};
  document.flowlines = {.clip = "fall \"1\".mp4",
                        .dropped = true,
                        .lines = {{.id = "l1", .points = {{1, 2}, {1, 40}}, .speeds = {}}},
                        .edited = {{.id = "l1", .points = {{1, 2}, {9, 40}}, .speeds = {}},
                                   {.id = "l1-2",
                                    .points = {{5, 2}, {9, 40}},
                                    .speeds = {0.5f, 2},
                                    .later = {{.time = 1.5, .points = {{7, 2}, {9, 30}}}}}},
                        .join = 12.5,
                        .stretched = true,
                        .ground = "black",
                        .frames = 77,
                        .loop = true,
                        .moving_camera = true};
  document.scene = {.wind = 7.5,
                    .direction = -90,
                    .gustiness = 0.5,
                    .changes = true,
                    .becomes = 14.5,
                    .frames = 33,
                    .loop = false,
                    .layers = {{.name = "an oak",
                                .motion = "tree",
                                .matte = LayerMatte::kScribbled,
                                .paint = {{.points = {{5, 5}}, .width = 9, .adds = false, .is_area = false}},
                                .lines = {{.points = {{1, 1}, {9, 1}}, .speed = {}}},
                                .plant = "flower",
                                .sway_clip = "grass/1.mp4",
                                .sway_dropped = false,
                                .sway_lines = {{.points = {{30, 90}, {32, 20}}, .speed = {}}},
                                .shimmer = 1.5,
                                .waves = 0.25,
                                .mirrors = true,
                                .roll = 3,
                                .in_3d = true,
                                .drift = -4,
                                .shade = 0.25,
                                .class_name = "fall"},
                               {.name = "fire",
                                .motion = "footage",
                                .film = "clip",
                                .clip = "fire 1.mkv",
                                .matte_clip = "its mattes.mkv",
                                .start = 0.5,
                                .repeats = false,
                                .ground = "black",
                                .blend = "screen",
                                .glow = 0.5,
                                .glow_reach = 40},
                               {.name = "land", .matte = LayerMatte::kRest}}};
  document.sweep = {.axes = {{.setting = "speed", .values = {"0.5", "2"}},
                             {.setting = "class", .values = {"", "a, \\ b", "fall"}}},
                    .full = true};
  return document;
}

void expect_refused(const Json& json, const std::string& word) {
  const std::string fault = fault_of(ErrorKind::kInput, [&] { document_from_json(json.dump(), "document"); });
  EXPECT_NE(fault.find(word), std::string::npos) << fault;
}

TEST(Document, ComesBackFromItsText) {
  EXPECT_EQ(document_from_json(to_json(full()), "document"), full());
  EXPECT_EQ(document_from_json(to_json({}), "document"), Document());
}

TEST(Document, WithoutOtherWaysIsAnOlderOne) {
  Json older = Json::parse(to_json(full()));
  older.erase("tempo");
  older.erase("directions");
  older.erase("design");
  Json unpinned = older;
  unpinned["stills"].erase("pins");
  EXPECT_EQ(document_from_json(unpinned.dump(), "document").stills.pins, Stills().pins);
  older.erase("stills");
  older.erase("flowlines");
  older.erase("scene");
  older.erase("sweep");
  older.erase("layout");
  older.erase("detail_life");
  older.erase("flames");
  Document expected = full();
  expected.tempo.clear();
  expected.directions.clear();
  expected.design = {};
  expected.stills = {};
  expected.flowlines = {};
  expected.scene = {};
  expected.sweep = {};
  expected.layout = {};
  expected.detail_life = 0;
  expected.flames = {};
  EXPECT_EQ(document_from_json(older.dump(), "document"), expected);
  Json film = Json::parse(to_json(full()));
  film["scene"]["layers"][1]["motion"] = "film";
  EXPECT_EQ(document_from_json(film.dump(), "document"), full()) << "what footage was called";
  for (Json& layer : film["scene"]["layers"])
    for (const char* later : {"film", "matte_clip", "start", "repeats", "ground", "blend", "in_3d", "shade",
                              "glow", "glow_reach", "sway_clip", "sway_dropped", "sway_lines"})
      layer.erase(later);
  expected = full();
  expected.scene.layers[0].in_3d = false;
  expected.scene.layers[0].shade = 0;
  expected.scene.layers[0].sway_clip.clear();
  expected.scene.layers[0].sway_dropped = true;
  expected.scene.layers[0].sway_lines.clear();
  expected.scene.layers[1] = {.name = "fire", .motion = "footage", .film = "clip", .clip = "fire 1.mkv"};
  EXPECT_EQ(document_from_json(film.dump(), "document"), expected);
}

TEST(Document, RefusesWhatItDoesNotKnow) {
  const Json good = Json::parse(to_json(full()));
  const auto with = [&](const char* name, const Json& value) {
    Json json = good;
    json[name] = value;
    return json;
  };
  expect_refused(with("colour", 1), "colour");
  expect_refused(with("frames", 0), "frames");
  for (const auto& [name, value] : {std::pair{"fluid", "lava"},
                                    {"ground", "sky"},
                                    {"look", "--overwrite"},
                                    {"frames", "9"},
                                    {"x", "y"}}) {
    Json design = good["design"];
    design[name] = value;
    expect_refused(with("design", design), name);
  }
  for (const auto& [name, value] :
       {std::pair{"seconds", Json(0)},
        {"split", Json(2.5)},
        {"paths", {{{"region", "1"}, {"names", {"a"}}, {"refused", true}}}},
        {"names", {{{"region", "1"}, {"names", {"a\n", "b"}}, {"refused", true}}}},
        {"reach", Json{{{"from", "a"}, {"to", "b"}, {"points", {{1, 1}, {2, 2}}}, {"reach", 0}}}},
        {"points", Json{{{"from", "a"}, {"to", "b"}, {"points", {{1, 1}}}, {"reach", 9}}}},
        {"x", Json(1)}}) {
    Json stills = good["stills"];
    const std::string field = name;
    stills[field == "names" ? "paths" : field == "reach" || field == "points" ? "pins" : field] = value;
    expect_refused(with("stills", stills), name);
  }
  const auto line = [](const char* id, const Json& points, const Json& speeds) {
    return Json{{{"id", id}, {"points", points}, {"speeds", speeds}}};
  };
  for (const auto& [name, value] : {std::pair{"frames", Json(0)},
                                    {"ground", Json("sky")},
                                    {"join", Json(-1)},
                                    {"clip", Json("../../../a.mp4")},
                                    {"x", Json(1)},
                                    {"points", line("a", {{1, 1}}, Json::array())},
                                    {"id", line("a\"/>", {{1, 1}, {2, 2}}, Json::array())},
                                    {"speeds", line("a", {{1, 1}, {2, 2}}, {0})},
                                    {"edited", Json::array()}}) {
    Json flowlines = good["flowlines"];
    const std::string field = name;
    flowlines[field == "points" || field == "id" || field == "speeds" || field == "edited" ? "lines"
                                                                                           : field] = value;
    expect_refused(with("flowlines", flowlines), name);
  }
  for (const auto& [name, value] : {std::pair{"wind", Json(-1)},
                                    {"gustiness", Json(2)},
                                    {"becomes", Json(99)},
                                    {"frames", Json(0)},
                                    {"x", Json(1)}}) {
    Json scene = good["scene"];
    scene[name] = value;
    expect_refused(with("scene", scene), name);
  }
  for (const auto& [name, value] : {std::pair{"name", Json("a\"b")},
                                    {"motion", Json("fly")},
                                    {"matte", Json("guess")},
                                    {"plant", Json("cactus")},
                                    {"shimmer", Json(99)},
                                    {"clip", Json("../a.mkv")},
                                    {"matte_clip", Json("a/b.mkv")},
                                    {"film", Json("sweep")},
                                    {"ground", Json("grey")},
                                    {"start", Json(-1)},
                                    {"blend", Json("dodge")},
                                    {"x", Json(1)}}) {
    Json scene = good["scene"];
    scene["layers"][0][name] = value;
    expect_refused(with("scene", scene), name);
  }
  const auto axis = [](const char* setting, const Json& values) {
    return Json{{{"setting", setting}, {"values", values}}};
  };
  for (const auto& [word, axes] :
       {std::pair{"setting", axis("colour", {"red"})},
        {"values", axis("speed", {"0"})},
        {"values", axis("speed", {"1; rm"})},
        {"values", axis("outline", {"gone"})},
        {"values", axis("class", {"a\nb"})},
        {"twice", axis("lines", {"with", "with"})},
        {"another axis",
         {{{"setting", "speed"}, {"values", {"1"}}}, {{"setting", "speed"}, {"values", {"2"}}}}}})
    expect_refused(with("sweep", {{"axes", axes}, {"full", false}}), word);
  Json moving = good["flowlines"];
  moving["edited"][1]["later"][0]["time"] = 0;
  expect_refused(with("flowlines", moving), "time");
  moving = good["flowlines"];
  moving["edited"][1]["later"].push_back(moving["edited"][1]["later"][0]);
  expect_refused(with("flowlines", moving), "time");
  moving = good["flowlines"];
  moving["lines"][0]["later"] = moving["edited"][1]["later"];
  expect_refused(with("flowlines", moving), "moves");
  Json namesakes = good["scene"];
  namesakes["layers"][1]["name"] = "an oak";
  expect_refused(with("scene", namesakes), "another layer");
  Json doubled = good["flowlines"];
  doubled["edited"][1]["id"] = "l1";
  expect_refused(with("flowlines", doubled), "another line");
  expect_refused(with("tempo", {{{"points", {{1, 1}}}, {"width", 9}, {"factor", 3}}}), "factor");
  expect_refused(with("frames", 2.5), "frames");
  expect_refused(with("frames", 1e9), "frames");
  expect_refused(with("fps", "25"), "fps");
  expect_refused(with("class", "a\nassignment = \"/etc/passwd\""), "class");
  expect_refused(with("store", std::string(5000, 'a')), "store");
  expect_refused(with("matte_base", "magic"), "matte_base");
  expect_refused(with("edge", "soft"), "edge");
  expect_refused(with("strokes", Json::array({{{"points", {{1, "2"}}}}})), "strokes 1");
  expect_refused(with("strokes", Json::array({{{"points", {{1, 1e30}}}}})), "strokes 1");
  expect_refused(with("strokes", Json::array({{{"points", Json::array()}}})), "strokes 1");
  expect_refused(with("excluded_clips", {1}), "name");
  Json lacking = good;
  lacking.erase("paint");
  expect_refused(lacking, "paint");
  expect_refused(Json::array(), "object");
}

TEST(Document, RefusesWhatWouldEndTheProcess) {
  EXPECT_THROW(document_from_json(std::string(100000, '['), "document"), Error);
  EXPECT_THROW(document_from_json("", "document"), Error);
  EXPECT_THROW(document_from_json(std::string(17u << 20, ' '), "document"), Error);
}

TEST(Document, StrokesAreReadAsTheyWereDrawn) {
  const auto strokes =
      hints::read_svg_strokes(strokes_svg(full(), {640, 360}), "strokes", {640, 360}, nullptr);
  ASSERT_EQ(strokes.size(), 2u + 5u) << "and five of the brush";
  EXPECT_EQ(strokes[0].points.front(), cv::Point2f(10, 10));
  EXPECT_EQ(strokes[0].points.back(), cv::Point2f(10, 40));
  EXPECT_EQ(strokes[0].speed_px_per_s, 80.0f);
  EXPECT_FALSE(strokes[1].speed_px_per_s.has_value());
}

TEST(Document, KeysChangeWithWhatTheyStandFor) {
  const Document before = full();
  Document after = before;
  after.speed = 2;
  EXPECT_EQ(matte_key(after), matte_key(before));
  EXPECT_EQ(labels_key(after), labels_key(before));
  EXPECT_NE(frames_key(after), frames_key(before));
  after = before;
  after.horizon = "auto";
  EXPECT_EQ(matte_key(after), matte_key(before));
  EXPECT_NE(labels_key(after), labels_key(before)) << "speeds between strokes are those of a plane";
  after = before;
  after.strokes[0].points[0].x += 1;
  EXPECT_EQ(matte_key(after), matte_key(before));
  EXPECT_NE(labels_key(after), labels_key(before));
  after = before;
  after.held.clear();
  EXPECT_NE(matte_key(after), matte_key(before));
}

/// browser_test.sh checks the page's types against this file.
TEST(Document, IsWhatThePageIsCheckedAgainst) {
  std::ifstream file(DOCUMENT_JSON);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_EQ(Json::parse(to_json(full())).dump(1) + "\n", text) << "write it anew, and look at types.ts";
}

}  // namespace
}  // namespace freshet::studio
