#include "studio/ways/way.h"

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "studio/drawing/reduced.h"
#include "studio/ways/layer_scene.h"
#include "studio/ways/sweep_recipe.h"
#include "synth/scene/scene_file.h"
#include "tests/tools/sample.h"

namespace freshet::studio {
namespace {

Document designed() {
  Document document;
  document.design.sources = {
      {.points = {{40, 130}, {60, 132}, {90, 130}}, .width = 10, .adds = true, .is_area = false},
      {.points = {{60, 100}}, .width = 12, .adds = false, .is_area = false},
      {.points = {{0, 0}, {20, 0}, {0, 20}}, .width = 0, .adds = false, .is_area = true}};
  document.design.winds = {{.points = {{10, 10}, {60, 20}}, .speed = {}}};
  document.design.frames = 3;
  return document;
}

const cv::Mat kPicture(151, 193, CV_8UC3, cv::Scalar(40, 60, 80));

/// Of a project that is all fluid.
const RecipeFiles kFiles{.picture = "picture.png",
                         .matte = {},
                         .held = {},
                         .whole = true,
                         .strokes = "strokes.svg",
                         .tempo = {},
                         .assignment = {}};

std::vector<WayFile> files_of(const std::string& way, const Document& document,
                              const RecipeFiles& files = kFiles, const std::filesystem::path& folder = {}) {
  return way_of(way).files({document, kPicture, files, folder});
}

void write_files(const tools::WorkFolder& folder, const std::string& way, const Document& document,
                 const RecipeFiles& files = kFiles) {
  const std::string at = "ways/" + way_of(way).plan(document).folder + "/";
  std::filesystem::create_directories(folder / at);
  for (const WayFile& file : files_of(way, document, files)) folder.file(at + file.name, file.bytes);
}

TEST(Way, EveryFluidIsASceneThatTheCommandLineTakes) {
  for (const char* fluid : {"smoke", "fire", "water"}) {
    const tools::WorkFolder folder;
    Document document = designed();
    document.design.fluid = fluid;
    const WayPlan plan = way_of("design").plan(document);
    ASSERT_EQ(plan.commands.size(), 1u);
    write_files(folder, "design", document);
    const tools::Outcome outcome = folder.freshet(plan.commands[0]);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(folder / plan.film)) << fluid;
  }
}

TEST(Way, ALookIsASecondCommandOverThePicture) {
  Document document = designed();
  document.design.look = "fire/1.mp4";
  document.store = "/a/fire.freshet";
  const WayPlan plan = way_of("design").plan(document);
  ASSERT_EQ(plan.commands.size(), 2u);
  EXPECT_EQ(plan.commands[1][1], "transfer");
  EXPECT_EQ(files_of("design", document).back().name, "behind.png");
  document.store.clear();
  EXPECT_THROW(way_of("design").plan(document), Error);
}

TEST(Way, WhatIsSaidOfStillsIsHeededByTheCommandLine) {
  const tools::WorkFolder folder;
  std::filesystem::create_directories(folder / "ways/stills/pictures");
  for (const std::string seed : {"1", "2", "3", "4", "5", "6", "7", "8"}) {
    const tools::Outcome made =
        folder.freshet({"synth", "simulate", "fire", "--size", "160x120", "--frames", "1", "--seed", seed,
                        "-o", "ways/stills/pictures/" + seed + ".png"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  Document document;
  document.stills.seconds = 1;
  const auto run = [&] {
    const WayPlan plan = way_of("stills").plan(document);
    write_files(folder, "stills", document);
    const tools::Outcome outcome = folder.freshet(plan.commands.at(0));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(folder / plan.film));
    for (const std::string& shown : plan.shown)
      EXPECT_TRUE(std::filesystem::exists(folder / ("ways/stills/" + shown))) << shown;
    return nlohmann::json::parse(outcome.out).at("regions").at(0);
  };
  const nlohmann::json before = run();
  const auto first = before.at("paths").at(0).get<std::vector<std::string>>();
  document.stills.paths = {{.region = before.at("name"), .names = first, .refused = true}};
  const nlohmann::json after = run();
  for (const nlohmann::json& path : after.at("paths")) EXPECT_NE(path.get<std::vector<std::string>>(), first);
  // A pin changes what lies between two of them; the file holds places of pixels' middles.
  const auto shown = after.at("sequence").get<std::vector<std::string>>();
  const std::string unpinned = tools::text_of(folder / "ways/stills/film.mp4");
  document.stills.pins = {
      {.from = shown.at(0), .to = shown.at(1), .at = {80.5f, 70}, .goes = {86.5f, 66}, .reach = 20}};
  EXPECT_EQ(run().at("sequence"), after.at("sequence"));
  EXPECT_NE(tools::text_of(folder / "ways/stills/film.mp4"), unpinned);
  const std::string toml = files_of("stills", document).at(0).bytes;
  EXPECT_NE(toml.find("at = [80.00, 69.50]\ngoes = [86.00, 65.50]\nreach = 20\n"), std::string::npos) << toml;
}

/// Runs a way's only command in a project's folder.
nlohmann::json run_in(const tools::WorkFolder& folder, const std::string& way, const Document& document,
                      const RecipeFiles& files = kFiles) {
  const WayPlan plan = way_of(way).plan(document);
  write_files(folder, way, document, files);
  const tools::Outcome outcome = folder.freshet(plan.commands.at(0));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const std::string& shown : plan.shown)
    EXPECT_TRUE(std::filesystem::exists(folder / ("ways/" + plan.folder + "/" + shown))) << shown;
  EXPECT_EQ(std::filesystem::is_regular_file(folder / plan.film), !plan.film.empty());
  return outcome.exit_code == 0 ? nlohmann::json::parse(outcome.out) : nlohmann::json();
}

TEST(Way, AClipGoesOnAlongLinesThatWereMoved) {
  const tools::WorkFolder folder;
  Document document;
  document.store = tools::sample().store;
  document.flowlines.clip = "fall/1.mkv";
  document.flowlines.frames = 20;
  EXPECT_GT(run_in(folder, "lines", document)["lines"], 0);
  document.flowlines.lines = {{.id = "a", .points = {{80, 10}, {80, 130}}, .speeds = {}},
                              {.id = "b", .points = {{100, 10}, {100, 130}}, .speeds = {}}};
  document.flowlines.edited = {{.id = "a", .points = {{70, 10}, {60, 130}}, .speeds = {2}},
                               {.id = "b-2", .points = {{110, 10}, {120, 130}}, .speeds = {0.5f, 1}}};
  EXPECT_EQ(run_in(folder, "flowlines", document)["lines"], 2);
  EXPECT_NE(tools::text_of(folder / "ways/flowlines/edited.svg").find("data-speed=\"0.5 1\""),
            std::string::npos);
  document.flowlines.edited[0].later = {{.time = 0.4, .points = {{30, 10}, {20, 130}}},
                                        {.time = 0.72, .points = {{50, 10}, {60, 130}}}};
  EXPECT_EQ(run_in(folder, "flowlines", document)["lines"], 2) << "one of which moves";
}

TEST(Way, AClipIsTheStoresOrTheProjects) {
  Document document;
  EXPECT_THROW(way_of("flowlines").plan(document), Error);
  document.flowlines.clip = "--draw";
  EXPECT_THROW(way_of("lines").plan(document), Error) << "of no store";
  document.store = "/a/b.freshet";
  const std::vector<std::string> stored = way_of("lines").plan(document).commands[0];
  EXPECT_EQ(stored[3], "--clip=--draw");
  document.flowlines.dropped = true;
  document.flowlines.clip = "fall.mp4";
  EXPECT_EQ(way_of("lines").plan(document).commands[0][2], "ways/flowlines/clips/fall.mp4");
  document.flowlines.moving_camera = true;
  document.flowlines.loop = true;
  const std::vector<std::string> words = way_of("flowlines").plan(document).commands[0];
  for (const char* word : {"--moving-camera", "--loop"})
    EXPECT_NE(std::find(words.begin(), words.end(), word), words.end()) << word;
}

Drawn area(float left, float top, float right, float bottom) {
  return {.points = {{left, top}, {right, top}, {right, bottom}, {left, bottom}},
          .width = 0,
          .adds = true,
          .is_area = true};
}

/// Sky, water with a boat, and a tree before them, on a picture of 193 x 151 px.
DrawnScene layers() {
  DrawnScene scene;
  scene.frames = 6;
  scene.layers = {
      {.name = "oak",
       .motion = "tree",
       .paint = {area(10, 20, 50, 140)},
       .lines = {{.points = {{30, 138}, {30, 30}}, .speed = {}}},
       .plant = "grass",
       .shimmer = 1},
      {.name = "a boat",
       .motion = "boat",
       .paint = {area(100, 90, 140, 112)},
       .lines = {{.points = {{102, 110}, {138, 110}}, .speed = {}}},
       .roll = 2,
       .in_3d = true},
      {.name = "lake",
       .motion = "water",
       .paint = {area(0, 80, 193, 151)},
       .lines = {{.points = {{0, 75}, {193, 75}}, .speed = {}}},
       .waves = 0.1,
       .mirrors = true},
      {.name = "sky", .motion = "clouds", .paint = {area(0, 0, 193, 70)}, .drift = 12, .shade = 0.3},
      {.name = "land", .motion = "still", .matte = LayerMatte::kRest}};
  return scene;
}

/// A photograph's stand-in of kPicture's size.
void write_picture(const tools::WorkFolder& folder) {
  cv::Mat picture;
  cv::resize(cv::imread(tools::sample().still), picture, kPicture.size());
  ASSERT_TRUE(cv::imwrite(folder / "picture.png", picture));
}

TEST(Way, LayersOfEveryKindAreAScene) {
  const tools::WorkFolder folder;
  write_picture(folder);
  Document document;
  document.scene = layers();
  const nlohmann::json made = run_in(folder, "scene", document);
  EXPECT_EQ(made["layers"], 5);
  EXPECT_EQ(made["frames"], 6);
  const std::string toml = tools::text_of(folder / "ways/scene/scene.toml");
  for (const char* said : {"roll = 2\nin_3d = true\n", "speed = 12\nshade = 0.3\n"})
    EXPECT_NE(toml.find(said), std::string::npos) << toml;
  // A layer that is scribbled on, and beside.
  document.scene.layers[0].matte = LayerMatte::kScribbled;
  document.scene.layers[0].paint.push_back(area(60, 20, 80, 60));
  document.scene.layers[0].paint.back().adds = false;
  EXPECT_EQ(run_in(folder, "scene", document)["layers"], 5);
}

TEST(Way, ALayerOfPatchesTakesAStoreOfAnyName) {
  const tools::WorkFolder folder;
  write_picture(folder);
  const std::string odd = "a \"store\" \\ of mine.freshet";
  std::filesystem::copy_file(tools::sample().store, folder / odd);
  Document document;
  document.store = folder / odd;
  document.scene.frames = 4;
  document.scene.layers = {{.name = "fall",
                            .motion = "patches",
                            .paint = {area(20, 20, 150, 140)},
                            .lines = {{.points = {{60, 30}, {60, 120}}, .speed = {}}},
                            .class_name = "fall"}};
  EXPECT_EQ(run_in(folder, "scene", document)["layers"], 2) << "and the rest";
}

TEST(Way, AFilmIsALayerWhereItWasPlaced) {
  const tools::WorkFolder folder;
  write_picture(folder);
  std::filesystem::create_directories(folder / "ways/flowlines/clips");
  const tools::Outcome white = folder.freshet({"synth", "simulate", "fire", "--size", "96x72", "--frames",
                                               "4", "-o", "ways/flowlines/clips/a fire.mkv"});
  ASSERT_EQ(white.exit_code, 0) << white.err;
  Document document;
  document.scene.frames = 4;
  document.scene.layers = {{.name = "fire",
                            .motion = "footage",
                            .lines = {{.points = {{150, 20}, {60, 90}}, .speed = {}}},
                            .film = "clip",
                            .clip = "a fire.mkv",
                            .start = 0.04,
                            .repeats = false,
                            .ground = "black",
                            .blend = "screen",
                            .glow = 0.4}};
  EXPECT_EQ(run_in(folder, "scene", document)["layers"], 2) << "and the rest";
  const std::string toml = tools::text_of(folder / "ways/scene/scene.toml");
  for (const char* said : {"at = [60, 20]\nwidth = 90\nstart = 0.04\nrepeat = false\nground = \"black\"\n",
                           "blend = \"screen\"\nglow = 0.4\n"})
    EXPECT_NE(toml.find(said), std::string::npos) << toml;
  document.scene.layers[0].film = "flowlines";
  EXPECT_THROW(files_of("scene", document), Error) << "no clip was made endless";
  document.flowlines.clip = "water/1.mp4";
  EXPECT_NE(files_of("scene", document).back().bytes.find("../flowlines/film.mp4"), std::string::npos);
  document.scene.layers[0].film = "stills";
  EXPECT_NE(files_of("scene", document).back().bytes.find("../stills/film.mp4"), std::string::npos);
  document.scene.layers[0].film = "design";
  EXPECT_THROW(files_of("scene", document), Error) << "Design has made none";
  document.design.look = "fire/1.mp4";
  EXPECT_NE(files_of("scene", document).back().bytes.find("../design/fluid.mkv"), std::string::npos);
}

TEST(Way, ATreeSwaysAsInADroppedClipOrOneOfTheStore) {
  Document document;
  document.store = "a store.freshet";
  document.scene.layers = {{.name = "reed",
                            .motion = "tree",
                            .paint = {area(10, 20, 50, 140)},
                            .lines = {{.points = {{30, 138}, {30, 30}}, .speed = {}}},
                            .plant = "grass",
                            .sway_clip = "my reed.mp4"}};
  DrawnLayer& layer = document.scene.layers[0];
  EXPECT_THROW(files_of("scene", document), Error) << "nothing says where in it the reed stands";
  layer.sway_lines = {{.points = {{40, 90}, {41, 60}, {44, 12.5f}}, .speed = {}},
                      {.points = {{70, 90}, {70, 20}}, .speed = {}}};
  const auto reed = [&] {
    const std::string toml = files_of("scene", document).back().bytes;
    return *synth::scene::parse_scene(toml, "scene.toml").layers[0].as<synth::scene::TreeMotion>();
  };
  EXPECT_EQ(reed().motion_from, "../flowlines/clips/my reed.mp4");
  EXPECT_EQ(reed().motion_clip, "");
  ASSERT_EQ(reed().motion_armatures.size(), 2U);
  EXPECT_EQ(reed().motion_armatures[0].from, cv::Point2d(40, 90)) << "its root";
  EXPECT_EQ(reed().motion_armatures[0].to, cv::Point2d(44, 12.5));
  EXPECT_EQ(way_of("scene").plan(document).store, "");
  layer.sway_dropped = false;
  layer.sway_clip = "grass/1.mp4";
  EXPECT_EQ(reed().motion_from, "a store.freshet");
  EXPECT_EQ(reed().motion_clip, "grass/1.mp4");
  EXPECT_EQ(way_of("scene").plan(document).store, "a store.freshet");
  document.store.clear();
  EXPECT_THROW(files_of("scene", document), Error) << "no store is chosen";
}

TEST(Way, WaterLightsWhatIsAroundItAsFarAsItIsAsked) {
  Document document;
  document.scene.layers = {{.name = "lake",
                            .motion = "water",
                            .paint = {area(0, 80, 193, 151)},
                            .lines = {{.points = {{0, 75}, {193, 75}}, .speed = {}}},
                            .glow = 3}};
  const auto toml = [&] { return files_of("scene", document).back().bytes; };
  EXPECT_NE(toml().find("glow = 3\n"), std::string::npos) << toml();
  EXPECT_EQ(toml().find("glow_reach"), std::string::npos) << "the usual";
  document.scene.layers[0].glow_reach = 25;
  const synth::scene::SceneLayer lake = synth::scene::parse_scene(toml(), "scene.toml").layers[0];
  EXPECT_EQ(lake.glow, 3);
  EXPECT_EQ(lake.glow_reach_px, 25);
  EXPECT_EQ(reduced(document.scene, 2).layers[0].glow_reach, 12.5) << "of a smaller picture";
  document.scene.layers[0].motion = "clouds";
  EXPECT_EQ(toml().find("glow"), std::string::npos) << "clouds light nothing";
}

TEST(Way, AWindThatChangesEndsAsItSaysAndALoopsAsItBegan) {
  Document document;
  document.scene = {.wind = 2,
                    .changes = true,
                    .becomes = 13.5,
                    .frames = 77,
                    .loop = false,
                    .layers = {{.name = "all", .motion = "clouds", .matte = LayerMatte::kRest}}};
  const auto wind = [&] {
    const std::string toml = files_of("scene", document).back().bytes;
    return synth::scene::parse_scene(toml, "scene.toml").wind;
  };
  ASSERT_EQ(wind().at.size(), 1u);
  EXPECT_EQ(wind().at[0].time_s, 77 / 25.0);
  EXPECT_EQ(wind().at[0].speed_m_per_s, 13.5);
  document.scene.loop = true;
  ASSERT_EQ(wind().at.size(), 2u);
  EXPECT_EQ(wind().at[0].time_s, 38.5 / 25.0);
  EXPECT_EQ(wind().at[1].speed_m_per_s, 2);
  document.scene.changes = false;
  EXPECT_FALSE(wind().changes());
}

TEST(Way, WhatIsPaintedOverAFilmIsItsMatte) {
  const tools::WorkFolder folder;
  write_picture(folder);
  std::filesystem::create_directories(folder / "ways/flowlines/clips");
  std::filesystem::create_directories(folder / "ways/scene");
  const tools::Outcome made = folder.freshet({"synth", "simulate", "fire", "--size", "96x72", "--frames", "4",
                                              "-o", "ways/flowlines/clips/fire.mkv"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  Document document;
  document.scene.frames = 4;
  document.scene.layers = {{.name = "fire",
                            .motion = "footage",
                            .lines = {{.points = {{60, 20}, {150, 90}}, .speed = {}}},
                            .film = "clip",
                            .clip = "fire.mkv"}};
  const auto paint = [&](float left, float right) {
    document.scene.layers[0].paint = {{.points = {{left, 0}, {right, 0}, {right, 140}, {left, 140}},
                                       .width = 1,
                                       .adds = true,
                                       .is_area = true}};
    std::vector<WayFile> files = files_of("scene", document, kFiles, folder.path());
    for (const WayFile& file : files) folder.file("ways/scene/" + file.name, file.bytes);
    return files;
  };
  const std::vector<WayFile> half = paint(0, 105);
  ASSERT_EQ(half.front().name, "layer-1.png");
  EXPECT_NE(half.back().bytes.find("matte = \"layer-1.png\""), std::string::npos);
  const cv::Mat matte = cv::imread((folder / "ways/scene/layer-1.png").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(matte.size(), cv::Size(96, 72)) << "the film's";
  EXPECT_EQ(matte.at<std::uint8_t>(30, 46), 255);  // 104 px of the picture
  EXPECT_EQ(matte.at<std::uint8_t>(30, 51), 0);
  // Where it is painted the film is seen, beside it the picture.
  const tools::Outcome outcome = folder.freshet(
      {"synth", "scene", "ways/scene/scene.toml", "-o", "f/%02d.png", "--layers-out", "l/{layer}.%02d.png"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const cv::Mat layer = cv::imread((folder / "l/fire.01.png").string(), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(layer.at<cv::Vec4w>(50, 90)[3], 65535);
  EXPECT_EQ(layer.at<cv::Vec4w>(50, 120)[3], 0);
  EXPECT_THROW(paint(0, 40), Error) << "beside the film";
  EXPECT_EQ(paint(0, 180).back().bytes.find("matte ="), std::string::npos) << "all of it is seen";
  // A clip of mattes takes the paint's place, frame by frame: here the fire's own light.
  document.scene.layers[0].matte_clip = "fire.mkv";
  document.scene.loop = false;
  const std::vector<WayFile> mattes = paint(0, 105);
  ASSERT_EQ(mattes.size(), 1u);
  EXPECT_NE(mattes.back().bytes.find("\nmatte = \"../flowlines/clips/fire.mkv\"\n"), std::string::npos);
  const tools::Outcome limited =
      folder.freshet({"synth", "scene", "ways/scene/scene.toml", "-o", "f/%02d.png", "--layers-out",
                      "l/{layer}.%02d.png", "--overwrite"});
  ASSERT_EQ(limited.exit_code, 0) << limited.err;
  cv::Mat alphas[2];
  for (const int i : {0, 1}) {
    const cv::Mat seen =
        cv::imread((folder / fmt::format("l/fire.{:02}.png", 2 * i)).string(), cv::IMREAD_UNCHANGED);
    cv::extractChannel(seen, alphas[i], 3);
  }
  const int seen = cv::countNonZero(alphas[0] > 20000);
  EXPECT_GT(seen, 100);
  EXPECT_LT(seen, 90 * 67 / 3) << "its dark ground is not seen";
  EXPECT_GT(cv::norm(alphas[0], alphas[1], cv::NORM_INF), 8000) << "it moves";
}

TEST(Way, SettingsAreTriedBesideEachOther) {
  const tools::WorkFolder folder;
  write_picture(folder);
  Document document;
  document.store = tools::sample().store;
  document.class_name = "fall";
  document.frames = 5;
  document.strokes = {{.points = {{90, 20}, {90, 120}}, .speed = {}}};
  folder.file("strokes.svg", strokes_svg(document, kPicture.size()));
  document.sweep.axes = {{.setting = "speed", .values = {"0.5", "2"}},
                         {.setting = "lines", .values = {"with", "without"}}};
  const nlohmann::json found = run_in(folder, "sweep", document).at("animations");
  ASSERT_EQ(found.size(), 4u);
  EXPECT_EQ(found[3].at("settings"), (nlohmann::json{{"speed", "2"}, {"strokes", "-"}}));
  document.sweep.axes = {{.setting = "outline", .values = {"still", "moving"}},
                         {.setting = "class", .values = {"", "fall"}}};
  cv::Mat matte = cv::Mat::zeros(kPicture.size(), CV_8U);
  cv::rectangle(matte, {40, 30}, {150, 130}, 255, cv::FILLED);
  ASSERT_TRUE(cv::imwrite(folder / "matte.png", matte));
  RecipeFiles files = kFiles;
  files.whole = false;
  files.matte = "matte.png";
  EXPECT_EQ(run_in(folder, "sweep", document, files).at("animations").size(), 4u);
  document.sweep.axes = {{.setting = "speed", .values = {"2"}}};
  EXPECT_THROW(way_of("sweep").plan(document), Error);
  document.sweep.axes = {{.setting = "lines", .values = {"with", "without"}}};
  document.strokes.clear();
  EXPECT_THROW(files_of("sweep", document), Error);
  document.sweep.axes = {{.setting = "speed", .values = {"1", "2", "3", "4", "5", "6", "7", "8", "9"}},
                         {.setting = "outline", .values = {"still", "moving"}}};
  EXPECT_THROW(way_of("sweep").plan(document), Error);
}

TEST(Way, ASweepKeepsPinnedPiecesWhereNoOthersAreChosen) {
  Document document;
  document.frames = 500;
  RecipeFiles files = kFiles;
  files.assignment = "assignment.json";
  document.sweep.axes = {{.setting = "speed", .values = {"1", "2"}}};
  EXPECT_NE(sweep_toml(document, files).find("assignment.json"), std::string::npos);
  EXPECT_NE(sweep_toml(document, files).find("frames = 48\n"), std::string::npos);
  document.sweep.full = true;
  EXPECT_NE(sweep_toml(document, files).find("frames = 500\n"), std::string::npos);
  document.sweep.axes = {{.setting = "class", .values = {"a", "b, c"}}};
  EXPECT_EQ(sweep_toml(document, files).find("assignment"), std::string::npos);
  EXPECT_EQ(sweep_words(document), std::vector<std::string>{"--vary=class=a,b\\, c"});
}

TEST(Way, ALayerSaysWhatItLacks) {
  const auto fault_of = [](const DrawnScene& scene, const std::string& store = {}) {
    try {
      layer_scene(
          scene, kPicture.size(),
          {.picture = "../../picture.png", .store = store, .design = {}, .flowlines = {}, .clips = {}});
    } catch (const Error& fault) {
      EXPECT_EQ(fault.kind(), ErrorKind::kUsage);
      return std::string(fault.what());
    }
    return std::string();
  };
  EXPECT_EQ(fault_of(layers()), "");
  EXPECT_NE(fault_of({}).find("Add one"), std::string::npos);
  for (std::size_t i = 0; i < 3; ++i) {
    DrawnScene lacking = layers();
    lacking.layers[i].lines.clear();
    EXPECT_NE(fault_of(lacking).find(lacking.layers[i].name), std::string::npos);
    lacking = layers();
    lacking.layers[i].paint.clear();
    EXPECT_NE(fault_of(lacking).find("nowhere"), std::string::npos);
  }
  DrawnScene patches = layers();
  patches.layers[0].motion = "patches";
  EXPECT_NE(fault_of(patches).find("store"), std::string::npos);
  EXPECT_EQ(fault_of(patches, "/a/b.freshet"), "");
}

TEST(Way, NamesOfStillsAreQuoted) {
  Document document;
  const std::string odd = "a \"b\" \\ c.png";
  document.stills.paths = {{.region = odd, .names = {odd, "d.png"}, .refused = true}};
  document.stills.pins = {{.from = odd, .to = "d.png", .at = {}, .goes = {}}};
  const std::string toml = files_of("stills", document).at(0).bytes;
  EXPECT_NE(toml.find("name = \"a \\\"b\\\" \\\\ c.png\""), std::string::npos) << toml;
  EXPECT_NE(toml.find("from = \"a \\\"b\\\" \\\\ c.png\"\nto = \"d.png\"\n"), std::string::npos) << toml;
  EXPECT_NE(toml.find("refuse = [[\"a \\\"b\\\" \\\\ c.png\", \"d.png\"]]"), std::string::npos) << toml;
}

TEST(Way, WantsASource) {
  Document document = designed();
  document.design.sources.erase(document.design.sources.begin());
  EXPECT_THROW(way_of("design").plan(document), Error);
  EXPECT_THROW(way_of("elsewhere").plan(designed()), Error);
}

}  // namespace
}  // namespace freshet::studio
