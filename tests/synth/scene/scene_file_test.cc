#include "synth/scene/scene_file.h"

#include <filesystem>
#include <fstream>
#include <map>

#include <unistd.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "freshet/error.h"
#include "synth/scene/printed_scene.h"
#include "synth/scene/scene_marks.h"
#include "tests/harness/scratch_folder.h"
#include "tests/synth/scene/made_scene.h"

namespace freshet::synth::scene {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

template <class Work>
std::string fault_of(Work&& work) {
  try {
    work();
  } catch (const Error& fault) {
    return fault.what();
  }
  return "no fault";
}
std::string parse_fault(const std::string& text) {
  return fault_of([&] { parse_scene(text, "folder/a.toml"); });
}
const std::string kTop = "picture = \"p.png\"\n";

TEST(SceneFile, ReadsWhatStandsInIt) {
  const Scene scene = parse_scene(made_scene_text("speed = 7\ndirection = 30\nseed = 5"), "folder/made.toml");
  EXPECT_EQ(scene.picture, "folder/still.png");
  EXPECT_TRUE(scene.loop);
  EXPECT_EQ(scene.wind.direction_deg, 30);
  ASSERT_EQ(scene.layers.size(), 5u);
  EXPECT_EQ(scene.layers[0].as<TreeMotion>()->armatures.at(0).to, cv::Point2d(30, 20));
  EXPECT_STREQ(scene.layers[2].kind(), "water");
  EXPECT_EQ(scene.layers[2].as<WaterMotion>()->amplitude, 6);
  // What nobody speaks of stays where it is.
  EXPECT_EQ(scene.layers[4].matte.kind, MatteFrom::Kind::kRest);
  EXPECT_STREQ(scene.layers[4].kind(), "still");
}

TEST(SceneFile, APlantSetsWhatIsUsualAndNoMore) {
  const auto tree = [](const std::string& keys) {
    return *parse_scene(
                kTop + "[[layer]]\nname=\"a\"\nmatte=\"rest\"\nmotion=\"tree\"\narmature=[1,9,1,2]\n" + keys,
                "a.toml")
                .layers[0]
                .as<TreeMotion>();
  };
  EXPECT_EQ(tree("plant=\"tree\"").mass, tree("").mass);
  EXPECT_EQ(tree("plant=\"flower\"").frequency_hz, 1.6);
  EXPECT_EQ(tree("plant=\"grass\"").mass, 0.03);
  EXPECT_TRUE(tree("plant=\"grass\"").stand);
  EXPECT_FALSE(tree("plant=\"flower\"").stand);
  EXPECT_EQ(tree("mass=2\nplant=\"grass\"\nshimmer=0").mass, 2);
  EXPECT_EQ(tree("mass=2\nplant=\"grass\"\nshimmer=0").shimmer_px, 0);
}

TEST(SceneFile, LayersStandInTheirOrder) {
  const Scene scene = parse_scene(kTop + R"(
[[layer]]
name = "far"
matte = "rest"
order = 9
motion = "still"
[[layer]]
name = "near"
matte = "m.png"
order = 3
motion = "still"
)",
                                  "a.toml");
  EXPECT_EQ(scene.layers[0].name, "near");
  EXPECT_EQ(scene.layers[1].name, "far");
}

TEST(SceneFile, TheSceneToStartFromIsOne) {
  const Scene scene = parse_scene(first_scene("p.png", {640, 480}), "a.toml");
  EXPECT_EQ(scene.layers.size(), 1u);
  std::string all = first_scene("p.png", {640, 480});
  // With its signs taken away, what it proposes is understood too.
  for (const char* line : {"[[layer]]", "name", "scribbles", "motion", "armature", "frequency", "matte",
                           "hull", "horizon", "roughness", "[[wind.at]]", "time", "speed"})
    for (std::size_t at = 0; (at = all.find(std::string("\n# ") + line, at)) != std::string::npos;)
      all.erase(at + 1, 2);
  const Scene whole = parse_scene(all, "a.toml");
  EXPECT_EQ(whole.layers.size(), 4u);
  EXPECT_EQ(whole.wind.at.size(), 2u);
  EXPECT_EQ(whole.layers[2].as<WaterMotion>()->horizon->from.y, 240);
}

TEST(SceneFile, EveryKeyIsExplainedInTheManualToo) {
  const std::string keys = scene_keys();
  for (const char* key :
       {"picture",   "marks",         "paint",        "cut",           "frames",   "fps",
        "loop",      "speed",         "kappa",        "gustiness",     "armature", "horizon",
        "focal",     "camera_height", "roughness",    "against",       "hull",     "reflection_of",
        "far_speed", "store",         "design_alpha", "exemplar_alpha"})
    EXPECT_THAT(keys, HasSubstr(std::string("\n") + key)) << key;
  std::ifstream file(FRESHET_SOURCE_DIR "/docs/scene.md");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  EXPECT_THAT(page, HasSubstr("```text\n" + keys + "```\n")) << "docs/scene.md holds what --keys prints";
}

TEST(SceneFile, EveryNumberIsHeldToTheRangeThatIsShown) {
  const std::map<std::string, std::string> needed{
      {"patches", "store=\"s\"\n"},
      {"transfer", "design_alpha=\"a\"\ndesign_flow=\"f\"\nexemplar=\"e\"\n"},
      {"footage", "file=\"f.mov\"\n"}};
  EXPECT_GE(scene_ranges().size(), 20u);
  for (const SceneRange& range : scene_ranges()) {
    const bool own = range.table == "transfer" || range.table == "footage";
    const auto fault = [&](double value) {
      const std::string line = fmt::format("{} = {:f}\n", range.key, value);
      if (range.table == "wind.at")
        return parse_fault(kTop + "[[layer]]\nname=\"a\"\nmatte=\"rest\"\nmotion=\"still\"\n[[wind.at]]\n" +
                           (range.key == "time" ? "speed = 1\n" : "time = 0.04\n") + line);
      if (range.table == "wind")
        return parse_fault(kTop + "[[layer]]\nname=\"a\"\nmatte=\"rest\"\nmotion=\"still\"\n[wind]\n" + line);
      const auto more = needed.find(range.table);
      return parse_fault(kTop + "[[layer]]\nname=\"a\"\nmotion=\"" +
                         (range.table == "layer" ? "still" : range.table) + "\"\n" +
                         (own ? "" : "matte=\"rest\"\n") + (more == needed.end() ? "" : more->second) + line);
    };
    EXPECT_TRUE(range.range.low <= range.slider.low && range.slider.high <= range.range.high) << range.key;
    EXPECT_THAT(fault(range.range.high + 1), AnyOf(HasSubstr("out of range"), HasSubstr("whole number")))
        << range.key;
    EXPECT_THAT(fault(range.range.low - 1), AnyOf(HasSubstr("out of range"), HasSubstr("whole number")))
        << range.key;
    EXPECT_THAT(fault(range.range.low), Not(HasSubstr("out of range"))) << range.table << "." << range.key;
    EXPECT_THAT(fault(range.range.low), Not(HasSubstr("no such key"))) << range.table << "." << range.key;
  }
}

TEST(SceneFile, ANameWithANulIsRefusedWithFaultAndRemedy) {
  EXPECT_THAT(parse_fault(kTop + "[[layer]]\nname=\"a\"\nmatte=\"p\\u0000x\"\nmotion=\"still\"\n"),
              AllOf(HasSubstr("a.toml:4"), HasSubstr("NUL"), HasSubstr("Remove it")));
}

TEST(SceneFile, MistakesNameLineKeyAndRemedy) {
  EXPECT_THAT(
      parse_fault(kTop + "[[layer]]\nname=\"a\"\nmatte=\"rest\"\nmotion=\"dance\"\n"),
      AllOf(HasSubstr("a.toml:5"), HasSubstr("layer 1 (a).motion"), HasSubstr("dance"), HasSubstr("tree")));
  EXPECT_THAT(parse_fault(kTop + "[[layer]]\nname=\"a\"\nmatte=\"rest\"\nmotion=\"still\"\nroughness=3\n"),
              AllOf(HasSubstr("a.toml:6"), HasSubstr("no such key")));
  EXPECT_THAT(parse_fault(kTop + "[wind]\nspeed = 99\n"),
              AllOf(HasSubstr("a.toml:3"), HasSubstr("wind.speed"), HasSubstr("0 to 60")));
  EXPECT_THAT(parse_fault(kTop), HasSubstr("[[layer]]"));
  EXPECT_THAT(parse_fault("frames = 3"), HasSubstr("a.toml:1: it needs picture"));
  EXPECT_THAT(parse_fault("\xff\xfe"), AllOf(HasSubstr("it is not TOML"), HasSubstr("--init PICTURE")));
  EXPECT_THAT(parse_fault(kTop + "fps = nan\n"),
              AllOf(HasSubstr("a.toml:2: fps"), HasSubstr("Give 1 to 240")));
  EXPECT_THAT(parse_fault(kTop + "[wind]\nspeed = inf\n"), HasSubstr("out of range"));
  EXPECT_THAT(parse_fault(kTop + "fps = \"six\"\n"), HasSubstr("not the text \"six\""));
  EXPECT_THAT(parse_fault(kTop + "frames = 1\nloop = true\n"), HasSubstr("Ask for 2 frames or more"));
  EXPECT_THAT(parse_fault(kTop + "[[layer]]\nname=\"a\"\nmotion=\"transfer\"\nexemplar=\"e.png\"\n"),
              HasSubstr("it needs design_alpha"));
  EXPECT_THAT(parse_fault(kTop + "[[layer]]\nname=\"a\"\nmotion=\"transfer\"\ndesign_alpha=\"a\"\n"
                                 "design_flow=\"f\"\nexemplar=\"e.png\"\nground=\"blue\"\n"),
              AllOf(HasSubstr("ground"), HasSubstr("none, black, white")));
  EXPECT_THAT(
      parse_fault(kTop + "frames = 50\n[[layer]]\nname=\"a\"\nmotion=\"footage\"\nfile=\"a.mov\"\nstart=2\n"),
      AllOf(HasSubstr("a.toml:7"), HasSubstr("the scene ends after 2 s")));
  EXPECT_THAT(
      parse_fault(kTop + "[[layer]]\nname=\"a\"\nmotion=\"footage\"\nfile=\"a.mov\"\nblend=\"lighten\"\n"),
      AllOf(HasSubstr("blend"), HasSubstr("over, add, screen")));
  EXPECT_THAT(parse_fault(kTop + "[[layer]]\nname=\"a\"\nmotion=\"still\"\n"),
              HasSubstr("nothing says where it is"));
  EXPECT_THAT(parse_fault(kTop + "[[layer]]\nname=\"a/b\"\nmatte=\"m.png\"\nmotion=\"still\"\n"),
              HasSubstr("no name of a layer"));
  EXPECT_THAT(parse_fault(kTop + "[[layer]]\nname=\"a\"\nmatte=\"m.png\"\nmotion=\"water\"\ntile=100\n"),
              HasSubstr("no power of 2"));
  EXPECT_THAT(parse_fault(kTop + "[[layer]]\nname=\"a\"\nmatte=\"m.png\"\nmotion=\"water\"\nmirrors=true\n"
                                 "edge=\"moving\"\n"),
              AllOf(HasSubstr("mirrors"), HasSubstr("outline that is held")));
  EXPECT_THAT(parse_fault(kTop + "[[layer]]\nname=\"a\"\nmatte=\"paint\"\nmotion=\"still\"\n"),
              HasSubstr("paint = "));
}

TEST(SceneFile, AKeyWithoutWhatItBelongsToIsRefusedByName) {
  struct Belonging {
    std::string motion, key, needs, absent;  // absent: as good as not there; empty: nothing is
  };
  for (const Belonging& each : {Belonging{"still", "shadow_darkness = 0.5", "shadow = [1,9,5,3]", ""},
                                {"still", "shadow_softness = 3", "shadow = [1,9,5,3]", ""},
                                {"still", "shadow_in_still = false", "shadow = [1,9,5,3]", ""},
                                {"patches", "glow_reach = 40", "glow = 0.5", "glow = 0"},
                                {"tree", "shimmer_size = 20", "shimmer = 1", "shimmer = 0"},
                                {"tree", "shimmer_size = 20", "plant = \"grass\"", "plant = \"flower\""},
                                {"clouds", "shade_size = 0.3", "shade = 0.5", "shade = 0"},
                                {"clouds", "ground = [0,9,9,9]", "shade = 0.5", "shade = 0"},
                                {"water", "gust_darkening = 0.3", "[wind]\ngustiness = 0.5", "[wind]"},
                                {"water", "gust_darkening = 0.3",
                                 "[wind]\n[[wind.at]]\ntime = 1\ngustiness = 0.5", "[wind]\ngustiness = 0"},
                                {"still", "[wind]\nwidth = 20", "gustiness = 0.5", "gustiness = 0"}}) {
    const std::string layer = kTop + "[[layer]]\nname=\"a\"\nmatte=\"m.png\"\nmotion=\"" + each.motion +
                              "\"\n" + (each.motion == "patches" ? "store = \"s\"\n" : "") + each.key + "\n";
    EXPECT_EQ(parse_fault(layer + each.needs), "no fault") << each.key << " with " << each.needs;
    const std::string key = each.key.substr(each.key.rfind('\n') + 1), name = key.substr(0, key.find(' '));
    for (const std::string& absent : {std::string(), each.absent})
      EXPECT_THAT(parse_fault(layer + absent),
                  AllOf(HasSubstr("." + name + ": it belongs to "), HasSubstr(", and there is none. Give "),
                        HasSubstr(" or take " + name + " out")))
          << absent;
  }
  EXPECT_THAT(parse_fault(kTop + "[[layer]]\nname=\"a\"\nmatte=\"m.png\"\nmotion=\"clouds\"\nshade_size=1"),
              HasSubstr("a.toml:6: layer 1 (a).shade_size: it belongs to shade"));
}

TEST(SceneFile, TwoLayersOfOneOrderAreRefused) {
  EXPECT_THAT(parse_fault(kTop + "[[layer]]\nname=\"a\"\nmatte=\"m.png\"\norder=2\nmotion=\"still\"\n"
                                 "[[layer]]\nname=\"b\"\nmatte=\"n.png\"\nmotion=\"still\"\n"),
              AllOf(HasSubstr("a and b have one order, 2"), HasSubstr("nearest")));
  EXPECT_THAT(parse_fault(kTop + "[[layer]]\nname=\"a\"\nmatte=\"rest\"\nmotion=\"still\"\n"
                                 "[[layer]]\nname=\"b\"\nmatte=\"n.png\"\nmotion=\"still\"\n"),
              HasSubstr("behind a, which is the rest"));
}

TEST(SceneFile, ABoatNeedsWater) {
  EXPECT_THAT(parse_fault(kTop + "[[layer]]\nname=\"a\"\nmatte=\"m.png\"\nmotion=\"boat\"\n"),
              AllOf(HasSubstr("no layer of the scene is water"), HasSubstr("motion = \"water\"")));
  EXPECT_THAT(parse_fault(kTop + "[[layer]]\nname=\"a\"\nmatte=\"m.png\"\nmotion=\"boat\"\nwater=\"sea\"\n"
                                 "[[layer]]\nname=\"lake\"\nmatte=\"n.png\"\nmotion=\"water\"\n"),
              HasSubstr("\"sea\" is no layer of water"));
}

std::string animation_fault(const std::string& text) {
  return fault_of([&] {
    MadeScene made(text);
    made.animation();
  });
}
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(SceneMarks, AHorizonBelowItsWaterIsRefused) {
  const std::string text = made_scene_text("speed = 5");
  EXPECT_THAT(animation_fault(replaced(text, "[0, 58, 160, 58]", "[0, 90, 160, 90]")),
              AllOf(HasSubstr("layer lake"), HasSubstr("horizon lies below 50 %"),
                    HasSubstr("at or above its far shore")));
  EXPECT_THAT(animation_fault(replaced(text, "[0, 58, 160, 58]", "[50, 0, 50, 90]")),
              HasSubstr("stands upright"));
}

TEST(SceneMarks, ASoftEdgeAboveTheHorizonIsNoNotice) {
  MadeScene made(made_scene_text("speed = 5"));
  read_marks(made.scene(), kMadeSize);
  cv::Mat alpha = made.pixels()[2].alpha.clone();
  std::vector<std::string> notices;
  alpha.row(57).setTo(0.5);
  check_marks(made.scene(), made.scene().layers[2], alpha, &notices);
  EXPECT_TRUE(notices.empty());
  alpha.rowRange(52, 58).setTo(0.8);
  check_marks(made.scene(), made.scene().layers[2], alpha, &notices);
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_THAT(notices[0], HasSubstr("lies above its horizon"));
}

TEST(SceneMarks, AnArmatureOutsideItsLayerIsRefused) {
  const std::string text = made_scene_text("speed = 5");
  EXPECT_THAT(animation_fault(replaced(text, "[30, 80, 30, 20]", "[130, 80, 130, 20]")),
              AllOf(HasSubstr("layer tree"), HasSubstr("lies outside of it"), HasSubstr("x 15 to 45")));
  EXPECT_THAT(animation_fault(replaced(text, "[30, 80, 30, 20]", "[30, 80, 30, 80.2]")),
              HasSubstr("no length"));
  EXPECT_THAT(animation_fault(replaced(text, "armature = [30, 80, 30, 20]\n", "")),
              AllOf(HasSubstr("layer tree: it has no armature"), HasSubstr("SVG")));
  EXPECT_THAT(animation_fault(replaced(text, "[80, 90, 120, 90]", "[20, 20, 60, 20]")),
              HasSubstr("layer boat: its hull line"));
}

TEST(SceneMarks, ABoatIn3dHasTheHorizonAboveIt) {
  const std::string text = replaced(made_scene_text("speed = 5"), "hull = [80, 90, 120, 90]\n",
                                    "hull = [80, 90, 120, 90]\nin_3d = true\n");
  EXPECT_EQ(animation_fault(text), "no fault");
  // A camera so wide that a side of the boat lies behind it.
  for (const char* focal : {"focal = 1\n", "focal = 8\ncamera_height = 0.01\n", "focal = 1e6\n"}) {
    MadeScene made(replaced(text, "amplitude = 6\n", std::string("amplitude = 6\n") + focal));
    cv::Mat frame(kMadeSize, CV_32FC4);
    made.animation().render(3, frame);
    EXPECT_TRUE(cv::checkRange(frame)) << focal;
  }
  const std::string above = replaced(replaced(text, "hull = [80, 90, 120, 90]", "hull = [80, 65, 120, 65]"),
                                     "[0, 58, 160, 58]", "[0, 58, 160, 72]");
  EXPECT_THAT(animation_fault(above), AllOf(HasSubstr("layer boat: the middle of its hull line, (100, 65)"),
                                            HasSubstr("leave in_3d out")));
  // Turned by 45 degrees, and seen from 45 degrees aside.
  EXPECT_THAT(
      animation_fault(replaced(replaced(text, "hull = [80, 90, 120, 90]", "hull = [94, 104, 106, 76]"),
                               "amplitude = 6\n", "amplitude = 6\nfocal = 22.7\n")),
      AllOf(HasSubstr("layer boat: its hull line, from (94, 104) to (106, 76), points at the camera"),
            HasSubstr("leave in_3d out")));
}

/// A drawing in a file that goes away.
class Drawing {
 public:
  explicit Drawing(const std::string& body) {
    folder_.file("marks.svg",
                 "<svg xmlns='http://www.w3.org/2000/svg' "
                 "xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape' "
                 "width='160' height='120'>" +
                     body + "</svg>");
  }
  Scene scene() const {
    std::string text = made_scene_text("speed = 5");
    text = replaced(text, "armature = [30, 80, 30, 20]\n", "");
    text = replaced(text, "hull = [80, 90, 120, 90]\n", "");
    text = replaced(text, "horizon = [0, 58, 160, 58]\n", "");
    Scene scene = parse_scene(text, "made.toml");
    scene.marks = folder_ / "marks.svg";
    return scene;
  }

 private:
  ScratchFolder folder_;
};

TEST(SceneMarks, LinesBelongToTheLayerThatNamesThem) {
  const Drawing drawing(
      R"(<g inkscape:label='Tree'><path id='path12' d='M30,80 L31,20'/><path d='M20,80 L12,30'/></g>
<line id='boat-1' x1='80' y1='90' x2='120' y2='91'/>
<g transform='translate(0,8)'><polyline data-layer='lake' points='0,50 160,52'/></g>
<line id='line7' x1='1' y1='2' x2='3' y2='4'/>)");
  Scene scene = drawing.scene();
  std::vector<std::string> notices;
  read_marks(scene, kMadeSize, &notices);
  ASSERT_EQ(scene.layers[0].as<TreeMotion>()->armatures.size(), 2u);
  EXPECT_EQ(scene.layers[0].as<TreeMotion>()->armatures[0].to, cv::Point2d(31, 20));
  EXPECT_EQ(scene.layers[1].as<BoatMotion>()->hull->to, cv::Point2d(120, 91));
  EXPECT_EQ(scene.layers[2].as<WaterMotion>()->horizon->from, cv::Point2d(0, 58));
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_THAT(notices[0], AllOf(HasSubstr("line7"), HasSubstr("names no layer")));
}

TEST(SceneMarks, ALineForNoLayerIsAnError) {
  const Drawing drawing("<line data-layer='oak' x1='1' y1='2' x2='3' y2='4'/>");
  Scene scene = drawing.scene();
  EXPECT_THAT(fault_of([&] { read_marks(scene, kMadeSize); }),
              AllOf(HasSubstr("\"oak\" is no layer"), HasSubstr(".svg")));
}

TEST(SceneFile, AsPrintedHasThePapersValuesAndRefusesOthersByName) {
  const std::string text = made_scene_text("speed = 7\n");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return changed;
  };
  const auto fault = [](const std::string& of) {
    return fault_of([&] { parse_printed_scene(of, "folder/a.toml"); });
  };
  const std::string printable = with("shimmer = 0.5\n", "");
  const Scene plain = parse_scene(printable, "a.toml"), printed = parse_printed_scene(printable, "a.toml");
  const auto& water = *printed.layers[2].as<WaterMotion>();
  EXPECT_EQ(plain.layers[2].as<WaterMotion>()->against, 0.3);
  EXPECT_EQ(water.against, 1);
  EXPECT_TRUE(water.edge_moves);
  EXPECT_EQ(water.mapping, WaterMapping::kDisplacement);
  EXPECT_EQ(water.amplitude, 6) << "what the paper leaves to a person stays";
  EXPECT_EQ(printed.wind.speed_m_per_s, 7);
  EXPECT_EQ(printed.layers[3].as<CloudMotion>()->far_speed, 1);

  EXPECT_THAT(fault(text), AllOf(HasSubstr("folder/a.toml:14"), HasSubstr("tree"), HasSubstr("shimmer"),
                                 HasSubstr("the paper prints 0")));
  EXPECT_THAT(fault(printable + "[[layer]]\nname = \"film\"\nmotion = \"footage\"\nfile = \"a.mp4\"\n"),
              AllOf(HasSubstr("film"), HasSubstr("none of the paper's motions")));
  EXPECT_THAT(fault("picture = 3\n"), HasSubstr("picture"));
  EXPECT_THAT(fault(printable + "[[wind.at]]\ntime = 0.1\nspeed = 9\n[[wind.at]]\ntime = 0.2\nspeed = 7\n"),
              AllOf(HasSubstr("wind.at"), HasSubstr("the paper's wind stays as it is")));
  const std::string hull = "hull = [80, 90, 120, 90]\n";
  EXPECT_THAT(fault(replaced(printable, hull, hull + "in_3d = true\n")),
              HasSubstr("true contradicts --as-printed: the paper prints false (Sec. 3.4)"));
  EXPECT_THAT(fault(replaced(printable, hull, hull + "shadow = [100, 90, 60, 105]\n")),
              AllOf(HasSubstr("layer (boat).shadow"), HasSubstr("the paper's layers cast none")));
}

TEST(SceneFile, AsPrintedRefusesAnotherValueOfEachKeyThatItSets) {
  const std::map<std::string, std::string> of_motion{{"tree", "armature = [1, 9, 1, 2]\n"},
                                                     {"water", "horizon = [0, 10, 100, 10]\n"},
                                                     {"boat", "hull = [5, 9, 20, 9]\n"},
                                                     {"clouds", ""}};
  const std::map<std::string, std::string> others{
      {"gustiness", "0.5"},       {"plant", "\"grass\""}, {"shimmer", "0.5"},  {"mapping", "\"normals\""},
      {"against", "0.5"},         {"edge", "\"held\""},   {"mirrors", "true"}, {"in_3d", "true"},
      {"reflection_of", "\"b\""}, {"far_speed", "0.5"},   {"shade", "0.5"},    {"calm", "0.05"}};
  const auto fault = [](const std::string& text) {
    return fault_of([&] { parse_printed_scene(text, "folder/a.toml"); });
  };
  const auto layer = [&](const std::string& motion, const std::string& keys, const std::string& name = "a") {
    return "[[layer]]\nname = \"" + name + "\"\nmatte = \"" + name + ".png\"\nmotion = \"" + motion + "\"\n" +
           of_motion.at(motion) + keys;
  };
  for (const PrintedKey& key : printed_keys()) {
    const std::string line = key.key + " = ", other = others.at(key.key);
    const auto scene = [&](const std::string& value) {
      if (key.table == "wind") return kTop + "[wind]\n" + line + value + "\n" + layer("clouds", "");
      return kTop + layer(key.table, line + value + "\n") + layer("boat", "", "b") + layer("water", "", "c");
    };
    EXPECT_EQ(fault(scene(key.value)), "no fault") << key.key;
    EXPECT_EQ(parse_fault(scene(other)), "no fault") << key.key;
    EXPECT_THAT(fault(scene(other)),
                AllOf(HasSubstr("." + key.key + ": "), HasSubstr("contradicts --as-printed"),
                      HasSubstr("the paper prints " + key.value), HasSubstr(key.where)))
        << key.key;
  }
  // What is refused whatever it says.
  EXPECT_THAT(fault(kTop + layer("water", "glow = 1\n")), HasSubstr("glow: contradicts --as-printed"));
  EXPECT_THAT(fault(kTop + layer("tree", "motion_from = \"a.mp4\"\nmotion_armature = [1, 90, 1, 20]\n")),
              HasSubstr("motion_from: contradicts --as-printed"));
}

TEST(SceneFile, TheWindMayChangeAndItsMistakesNameLineKeyAndRemedy) {
  const std::string rest = "[[layer]]\nname=\"a\"\nmatte=\"rest\"\nmotion=\"still\"\n";
  const Scene scene = parse_scene(
      "picture = \"p.png\"\nframes = 100\nfps = 25\nloop = true\n[wind]\nspeed = 3\ndirection = 350\n"
      "[[wind.at]]\ntime = 1.5\nspeed = 12\ndirection = 40\n[[wind.at]]\ntime = 2\ngustiness = 0.6\n"
      "[[wind.at]]\ntime = 4\nspeed = 3\ndirection = -10\ngustiness = 0\n" +
          rest,
      "a.toml");
  ASSERT_EQ(scene.wind.at.size(), 3u);
  EXPECT_TRUE(scene.wind.changes());
  EXPECT_EQ(scene.wind.at[0].time_s, 1.5);
  EXPECT_EQ(scene.wind.at[0].speed_m_per_s, 12);
  EXPECT_FALSE(scene.wind.at[0].gustiness.has_value());
  EXPECT_FALSE(scene.wind.at[1].speed_m_per_s.has_value());
  EXPECT_EQ(scene.wind.at[1].gustiness, 0.6);

  const auto fault = [&](const std::string& keys, bool loop = false) {
    return parse_fault("picture = \"p.png\"\nframes = 100\nfps = 25\n" +
                       std::string(loop ? "loop = true\n" : "loop = false\n") +
                       "[wind]\nspeed = 3\ndirection = 20\n" + keys + rest);
  };
  EXPECT_EQ(fault("[[wind.at]]\ntime = 2\nspeed = 12\n"), "no fault");
  EXPECT_THAT(fault("[[wind.at]]\nspeed = 12\n"), AllOf(HasSubstr("wind.at 1"), HasSubstr("it needs time")));
  EXPECT_THAT(fault("[[wind.at]]\ntime = 0\nspeed = 12\n"), HasSubstr("wind.at 1.time: 0 is out of range"));
  EXPECT_THAT(fault("[[wind.at]]\ntime = 2\nspeed = 99\n"),
              AllOf(HasSubstr("a.toml:10"), HasSubstr("wind.at 1.speed"), HasSubstr("0 to 60")));
  EXPECT_THAT(fault("[[wind.at]]\ntime = 2\nspeed = 9\n[[wind.at]]\ntime = 2\nspeed = 3\n"),
              AllOf(HasSubstr("a.toml:12: wind.at 2.time: 2 s does not come after 2 s"), HasSubstr("grow")));
  EXPECT_THAT(fault("[[wind.at]]\ntime = 4.1\nspeed = 9\n"),
              AllOf(HasSubstr("wind.at 1.time"), HasSubstr("beyond the scene's end, 4 s")));
  EXPECT_THAT(fault("[[wind.at]]\ntime = 2\n"), AllOf(HasSubstr("wind.at 1"), HasSubstr("nothing changes")));
  EXPECT_THAT(fault("[[wind.at]]\ntime = 2\nturbulence = 0.3\n"), HasSubstr("no such key"));
  EXPECT_THAT(fault("at = 3\n"), HasSubstr("[[at]]"));
  // A loop ends as it begins, or says how it would.
  EXPECT_THAT(fault("[[wind.at]]\ntime = 2\nspeed = 12\n", true),
              AllOf(HasSubstr("a.toml:8: wind.at: the loop ends with speed 12 and begins with 3"),
                    HasSubstr("Add [[wind.at]] with time = 4 and speed = 3, or set loop = false")));
  EXPECT_THAT(fault("[[wind.at]]\ntime = 2\ngustiness = 1\n", true),
              HasSubstr("ends with gustiness 1 and begins with 0"));
  EXPECT_THAT(fault("[[wind.at]]\ntime = 2\ndirection = 30\n", true), HasSubstr("direction 30"));
  EXPECT_EQ(fault("[[wind.at]]\ntime = 2\ndirection = 200\n[[wind.at]]\ntime = 4\ndirection = -340\n", true),
            "no fault");
}

}  // namespace
}  // namespace freshet::synth::scene
