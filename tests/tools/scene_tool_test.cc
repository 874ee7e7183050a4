// freshet synth scene: what a scene gives, and what a wrong one leaves behind.
#include <ImfChannelList.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "media/picture/motion_file.h"
#include "tests/media/exr_channel.h"
#include "tests/tools/sample.h"
#include "tests/tools/work_folder.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

/// A folder with a picture of a lake, a tree beside it, and their mattes.
class Landscape : public WorkFolder {
 public:
  Landscape() {
    const cv::Size size(160, 120);
    cv::Mat picture(size, CV_8UC3), tree(size, CV_8U, cv::Scalar(0)), lake = tree.clone();
    cv::RNG(3).fill(picture, cv::RNG::UNIFORM, 60, 190);
    cv::GaussianBlur(picture, picture, {}, 1.2);
    cv::ellipse(tree, {40, 40}, {14, 22}, 0, 0, 360, 255, -1, cv::LINE_AA);
    tree(cv::Rect(36, 50, 8, 32)).setTo(255);
    lake.rowRange(60, 120).setTo(255);
    picture.setTo(cv::Scalar(30, 120, 40), tree > 127);
    cv::imwrite((*this / "still.png").string(), picture);
    cv::imwrite((*this / "tree.png").string(), tree);
    cv::imwrite((*this / "lake.png").string(), lake);
  }
  void scene(const std::string& tree = "armature = [40, 80, 40, 20]", const std::string& top = {},
             const std::string& more = {}, const std::string& horizon = "[0, 55, 160, 55]") const {
    file("scene.toml",
         "picture = \"still.png\"\nframes = 6\nfps = 6\nloop = true\n" + top +
             "\n[wind]\nspeed = 8\n[[layer]]\nname = \"tree\"\nmatte = \"tree.png\"\nmotion = "
             "\"tree\"\nmass = 1\n" +
             tree + "\n" + more +
             "\n[[layer]]\nname = \"lake\"\nmatte = \"lake.png\"\nmotion = \"water\"\nhorizon = " + horizon +
             "\ntile = 64\n");
  }
  Outcome render(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"synth", "scene", "scene.toml"};
    words.insert(words.end(), more.begin(), more.end());
    return freshet(words);
  }
};

TEST(SceneTool, GivesFramesLayersAndADrawing) {
  const Landscape folder;
  folder.scene();
  const Outcome outcome = folder.render({"-o", "f/%02d.png", "--layers-out", "l/{layer}.%02d.png", "--draw",
                                         "d.png", "--sheet", "s.png", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const cv::Mat whole = cv::imread((folder / "f/03.png").string());
  ASSERT_EQ(whole.size(), cv::Size(160, 120));
  EXPECT_GT(cv::norm(whole, cv::imread((folder / "f/00.png").string()), cv::NORM_INF), 5);
  // The layers over each other are the frame.
  cv::Mat sum(whole.size(), CV_32FC3, cv::Scalar::all(0));
  for (const char* layer : {"(rest)", "lake", "tree"}) {
    const cv::Mat one =
        cv::imread((folder / fmt::format("l/{}.03.png", layer)).string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(one.type(), CV_16UC4) << layer;
    for (int y = 0; y < sum.rows; ++y)
      for (int x = 0; x < sum.cols; ++x) {
        const cv::Vec4w v = one.at<cv::Vec4w>(y, x);
        for (int c = 0; c < 3; ++c)
          sum.at<cv::Vec3f>(y, x)[c] += (v[c] / 257.0f - sum.at<cv::Vec3f>(y, x)[c]) * v[3] / 65535.0f;
      }
  }
  cv::Mat expected;
  whole.convertTo(expected, CV_32F);
  EXPECT_LE(cv::norm(sum, expected, cv::NORM_INF), 2.5);
  EXPECT_EQ(cv::imread((folder / "d.png").string()).size(), whole.size());
  EXPECT_FALSE(cv::imread((folder / "s.png").string()).empty());
}

TEST(SceneTool, IsTheSameForAnyNumberOfThreads) {
  const Landscape folder;
  folder.scene();
  ASSERT_EQ(folder.render({"-o", "a.mkv", "-j", "1"}).exit_code, 0);
  ASSERT_EQ(folder.render({"-o", "b.mkv", "-j", "4"}).exit_code, 0);
  EXPECT_EQ(text_of(folder / "a.mkv"), text_of(folder / "b.mkv"));
}

TEST(SceneTool, LeavesASceneToStartFrom) {
  const Landscape folder;
  Outcome outcome = folder.freshet({"synth", "scene", "--init", "still.png", "-o", "new.toml"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  outcome = folder.freshet({"synth", "scene", "new.toml", "-o", "new.mkv"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(folder.freshet({"synth", "scene", "--init", "still.png", "-o", "new.toml"}).exit_code, 2);
  outcome = folder.freshet({"synth", "scene", "--keys"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.out.find("roughness"), std::string::npos);
}

TEST(SceneTool, MixesPatchesAndFootage) {
  const Landscape folder;
  folder.scene();
  ASSERT_EQ(folder.render({"-o", "f/%02d.png", "--layers-out", "l/{layer}.%02d.png"}).exit_code, 0);
  // The tree that was written comes in again as footage, 20 px further right.
  folder.scene("armature = [40, 80, 40, 20]", {},
               "[[layer]]\nname = \"copy\"\nmotion = \"footage\"\nfile = \"l/tree.%02d.png\"\nat = [20, 0]");
  Outcome outcome = folder.render({"-o", "g/%02d.png"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const cv::Vec3b green = cv::imread((folder / "g/00.png").string()).at<cv::Vec3b>(40, 66);
  EXPECT_NEAR(green[1], 120, 12);
  EXPECT_LT(green[2], 60);

  folder.file(
      "lake_patches.toml",
      fmt::format("picture = \"{}\"\nframes = 6\nfps = 6\n[[layer]]\nname = \"fall\"\nmatte = \"{}\"\nmotion "
                  "= \"patches\"\nstore = \"{}\"\nclass = \"fall\"\noptions = [\"--direction\", \"down\"]\n",
                  sample().still.string(), sample().matte.string(), sample().store.string()));
  outcome = folder.freshet({"synth", "scene", "lake_patches.toml", "-o", "p/%02d.png"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_GT(cv::norm(cv::imread((folder / "p/01.png").string()), cv::imread((folder / "p/04.png").string()),
                     cv::NORM_INF),
            8);
}

TEST(SceneTool, ATreeSwaysAsTheOneOfAFilmOrOfAStoresClip) {
  const Landscape folder;
  const std::string top = "frames = 64\nfps = 25", tree = "armature = [40, 80, 40, 20]";
  const auto scene = [&](const std::string& more) {
    folder.file(
        "scene.toml",
        "picture = \"still.png\"\n" + top +
            "\n[wind]\nspeed = 8\n[[layer]]\nname = \"tree\"\nmatte = \"tree.png\"\nmotion = \"tree\"\n" +
            tree + "\n" + more);
  };
  scene("frequency = 1.5\nmass = 0.3");
  ASSERT_EQ(folder.render({"-o", "plants/swaying.mkv"}).exit_code, 0);
  const std::string there = "\nmotion_armature = [40, 80, 40, 20]\n";
  scene("motion_from = \"plants/swaying.mkv\"" + there);
  Outcome outcome = folder.render({"-o", "film.mkv"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("layer tree: in 2.6 s of "), std::string::npos) << outcome.err;
  ASSERT_EQ(folder
                .freshet({"ingest", "plants.store", "plants/swaying.mkv", "--force", "--no-index",
                          "--min-coverage", "0"})
                .exit_code,
            0);
  scene("motion_from = \"plants.store\"\nmotion_clip = \"swaying.mkv\"" + there);
  outcome = folder.render({"-o", "store.mkv"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(text_of(folder / "film.mkv"), text_of(folder / "store.mkv"));
  scene({});
  ASSERT_EQ(folder.render({"-o", "usual.mkv"}).exit_code, 0);
  EXPECT_NE(text_of(folder / "film.mkv"), text_of(folder / "usual.mkv"));
  scene("motion_from = \"plants.store\"\nmotion_clip = \"oak\"" + there);
  outcome = folder.render({"-o", "oak.mkv"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("plants.store has no clip of this name"), std::string::npos) << outcome.err;
}

TEST(SceneTool, LayersOfOneFileAreThoseOfManyNumberedAsTheFilm) {
  const Landscape folder;
  folder.scene();
  for (const char* out : {"l/{layer}.####.exr", "all.####.exr"}) {
    const Outcome outcome =
        folder.render({"-o", "f/%04d.exr", "--layers-out", out, "--start-number", "1001", "--overwrite"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  for (const char* number : {"1001", "1006"}) {
    const std::string all = (folder / fmt::format("all.{}.exr", number)).string();
    Imf::MultiPartInputFile parts(all.c_str());
    ASSERT_EQ(parts.parts(), 4);
    EXPECT_EQ(parts.header(1).name(), "tree");
    EXPECT_EQ(parts.header(3).name(), "(rest)");
    // The film first; then each layer, as alone.
    const std::vector<std::pair<std::string, std::string>> kFiles{
        {fmt::format("f/{}.exr", number), ""},
        {fmt::format("l/tree.{}.exr", number), "tree."},
        {fmt::format("l/lake.{}.exr", number), "lake."}};
    for (std::size_t part = 0; part < kFiles.size(); ++part) {
      const auto& [file, before] = kFiles[part];
      const cv::Mat alone = exr_channel((folder / file).string(), 0, "G"),
                    together = exr_channel(all, static_cast<int>(part), before + "G");
      EXPECT_EQ(cv::norm(alone, together, cv::NORM_INF), 0) << file;
    }
    // What moves has its motion beside it, in px; where the layer is not, nothing moves.
    const cv::Mat across = exr_channel(all, 1, "tree.forward.u"), alpha = exr_channel(all, 1, "tree.A");
    EXPECT_GT(cv::norm(across, cv::NORM_INF), 0.01);
    EXPECT_LT(cv::norm(across, cv::NORM_INF), 20);
    EXPECT_EQ(cv::norm(across, cv::NORM_INF, alpha == 0), 0);
    EXPECT_EQ(parts.header(0).channels().findChannel("(film).forward.u"), nullptr);
  }
  EXPECT_FALSE(fs::exists(folder / "all.0000.exr"));
}

/// A layer of one frame in an EXR of all layers.
struct ExrLayer {
  ExrLayer(const fs::path& file, int part, const std::string& layer)
      : green(exr_channel(file.string(), part, layer + ".G")),
        alpha(exr_channel(file.string(), part, layer + ".A")),
        u(exr_channel(file.string(), part, layer + ".forward.u")),
        v(exr_channel(file.string(), part, layer + ".forward.v")) {
    EXPECT_EQ(cv::norm(u, cv::NORM_INF, alpha == 0), 0) << layer;
  }
  /// What of a plane of the next frame lies where this frame's motion leads.
  cv::Mat led_to(const cv::Mat& plane) const {
    cv::Mat x(u.size(), CV_32F), y = x.clone(), there;
    for (int row = 0; row < x.rows; ++row)
      for (int col = 0; col < x.cols; ++col) {
        x.at<float>(row, col) = static_cast<float>(col) + u.at<float>(row, col);
        y.at<float>(row, col) = static_cast<float>(row) - v.at<float>(row, col);  // y up
      }
    cv::remap(plane, there, x, y, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    return there;
  }
  cv::Mat green, alpha, u, v;
};

/// How much nearer what is opaque is to the next frame when its motion carries it there, a share of how near it is as
/// it stands.
double share_left(const ExrLayer& now, const ExrLayer& next) {
  const cv::Mat there = now.led_to(next.green);
  const cv::Mat seen = (now.alpha > 0.9) & (next.alpha > 0.9) & (now.led_to(next.alpha) > 0.9);
  EXPECT_GT(cv::countNonZero(seen), 200);
  return cv::norm(there, now.green, cv::NORM_L1, seen) / cv::norm(next.green, now.green, cv::NORM_L1, seen);
}

TEST(SceneTool, WhatBringsItsFramesHasTheirMotionInTheExrOfAllLayers) {
  const Landscape folder;
  ASSERT_EQ(folder
                .freshet({"synth", "simulate", "plume", "--size", "80x80", "--grid", "48", "--frames", "16",
                          "-o", "design"})
                .exit_code,
            0);
  cv::Mat look(64, 64, CV_8UC3);
  cv::RNG(4).fill(look, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(look, look, {}, 1.5);
  cv::Mat outline(look.size(), CV_8U, cv::Scalar(0));
  cv::circle(outline, {32, 32}, 24, 255, -1);
  cv::GaussianBlur(outline, outline, {}, 2);
  cv::cvtColor(look, look, cv::COLOR_BGR2BGRA);
  cv::insertChannel(outline, look, 3);
  cv::imwrite((folder / "look.png").string(), look);
  constexpr int kLength = 12;
  folder.file(
      "own.toml",
      fmt::format("picture = \"{}\"\nframes = {}\nfps = 25\nloop = true\n"
                  "[[layer]]\nname = \"river\"\nmotion = \"footage\"\nfile = \"{}\"\nat = [30, 20]\n"
                  "width = 130\nstart = 0.2\n"
                  "[[layer]]\nname = \"smoke\"\nmotion = \"transfer\"\ndesign_alpha = \"design/alpha\"\n"
                  "design_flow = \"design/flow\"\nexemplar = \"look.png\"\nat = [90, 30]\n"
                  "[[layer]]\nname = \"fall\"\nmatte = \"{}\"\nmotion = \"patches\"\nstore = \"{}\"\n"
                  "class = \"fall\"\noptions = [\"--direction\", \"down\"]\n",
                  sample().still.string(), kLength, (sample().clips / "river/1.mkv").string(),
                  sample().matte.string(), sample().store.string()));
  for (const char* threads : {"1", "4"}) {
    const Outcome outcome =
        folder.freshet({"synth", "scene", "own.toml", "-o", "own.mkv", "--overwrite", "--layers-out",
                        fmt::format("own{}.##.exr", threads), "-j", threads});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  const auto layer_of = [&](int frame, int part, const char* name) {
    return ExrLayer(folder / fmt::format("own1.{:02}.exr", frame % kLength), part, name);
  };
  // Of all frames, of which the last runs into the first.
  const struct {
    const char* name;
    int part;
    double mean, worst;  // of share_left
  } kLayers[]{{"river", 1, 0.8, 0.9}, {"fall", 3, 0.75, 1}};
  for (const auto& layer : kLayers) {
    double sum = 0, worst = 0;
    for (int i = 0; i < kLength; ++i) {
      const double share =
          share_left(layer_of(i, layer.part, layer.name), layer_of(i + 1, layer.part, layer.name));
      sum += share / kLength;
      worst = std::max(worst, share);
    }
    EXPECT_LT(sum, layer.mean) << layer.name;
    EXPECT_LT(worst, layer.worst) << layer.name;
  }
  // Of what was transferred the design's flow, placed, along which the design's outline goes; its first four frames go
  // by before the loop. The look itself is made anew in each frame.
  const cv::Rect place(90, 30, 80, 80);
  const auto mask_of = [&](int frame) {
    const cv::Mat read = cv::imread((folder / fmt::format("design/alpha/{:05}.png", frame + 4)).string(),
                                    cv::IMREAD_GRAYSCALE);
    cv::Mat whole(kHeight, kWidth, CV_32F, cv::Scalar(0)), mask;
    read.convertTo(mask, CV_32F, 1.0 / 255);
    mask.copyTo(whole(place));
    return whole;
  };
  double carried = 0, stood = 0;
  for (int i = 0; i < 7; ++i) {
    const ExrLayer now = layer_of(i, 2, "smoke");
    const cv::Mat flow = media::read_motion(folder / fmt::format("design/flow/{:05}.flo", i + 4));
    cv::Mat across, up, within = now.alpha > 0;
    cv::extractChannel(flow, across, 0), cv::extractChannel(-flow, up, 1);
    EXPECT_LT(cv::norm(across, now.u(place), cv::NORM_INF, within(place)), 0.01) << i;
    EXPECT_LT(cv::norm(up, now.v(place), cv::NORM_INF, within(place)), 0.01) << i;
    within.rowRange(0, place.y + 6).setTo(0);  // goes out of the design
    carried += cv::norm(now.led_to(mask_of(i + 1)), mask_of(i), cv::NORM_L1, within);
    stood += cv::norm(mask_of(i + 1), mask_of(i), cv::NORM_L1, within);
  }
  EXPECT_LT(carried, 0.7 * stood);
  for (int i = 0; i < kLength; ++i)
    EXPECT_EQ(text_of(folder / fmt::format("own1.{:02}.exr", i)),
              text_of(folder / fmt::format("own4.{:02}.exr", i)));
}

TEST(SceneTool, LightIsAddedOrScreenedOverWhatLiesBehind) {
  const Landscape folder;
  cv::imwrite((folder / "light.png").string(), cv::Mat(120, 160, CV_8UC4, cv::Scalar(0, 64, 128, 255)));
  const auto green_and_red = [&](const std::string& blend) {
    folder.scene(
        "armature = [40, 80, 40, 20]", {},
        "[[layer]]\nname = \"light\"\norder = 1\nmotion = \"footage\"\nfile = \"light.png\"\nblend = \"" +
            blend + "\"\n");
    std::string text = text_of(folder / "scene.toml");
    // The light lies before the tree.
    text.insert(text.find("name = \"tree\""), "order = 2\n");
    text.insert(text.find("name = \"lake\""), "order = 3\n");
    folder.file("scene.toml", text);
    const Outcome outcome = folder.render({"-o", blend + "/%02d.png"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return cv::imread((folder / (blend + "/00.png")).string()).at<cv::Vec3b>(20, 100);
  };
  const cv::Vec3b under = cv::imread((folder / "still.png").string()).at<cv::Vec3b>(20, 100);
  const cv::Vec3b over = green_and_red("over"), added = green_and_red("add"),
                  screened = green_and_red("screen");
  for (int c = 0; c < 3; ++c) {
    const double light = c == 0 ? 0 : c == 1 ? 64 : 128;
    EXPECT_NEAR(over[c], light, 1);
    EXPECT_NEAR(added[c], std::min(255.0, under[c] + light), 2);
    EXPECT_NEAR(screened[c], 255 - (255 - under[c]) * (255 - light) / 255, 2);
  }
}

TEST(SceneTool, ATransferredFireLoopsWithTheScene) {
  const Landscape folder;
  ASSERT_EQ(folder
                .freshet({"synth", "simulate", "plume", "--size", "48x48", "--grid", "32", "--frames", "16",
                          "-o", "design"})
                .exit_code,
            0);
  // Light on black, without alpha.
  cv::Mat light(40, 40, CV_8UC3, cv::Scalar::all(0));
  cv::circle(light, {20, 20}, 12, {40, 140, 250}, -1);
  cv::GaussianBlur(light, light, {}, 2);
  cv::imwrite((folder / "light.png").string(), light);
  const auto scene = [&](const std::string& length) {
    folder.file("fire.toml",
                "picture = \"still.png\"\nfps = 6\nloop = true\n" + length +
                    "\n[[layer]]\nname = \"fire\"\nmotion = \"transfer\"\ndesign_alpha = "
                    "\"design/alpha\"\ndesign_flow = \"design/flow\"\nexemplar = \"light.png\"\nground = "
                    "\"black\"\nat = [100, 10]\n");
    return folder.freshet({"synth", "scene", "fire.toml", "-o", "fire/%02d.png", "--overwrite"});
  };
  Outcome outcome = scene("frames = 10");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::vector<cv::Mat> frames;
  for (int i = 0; i < 10; ++i)
    frames.push_back(cv::imread((folder / fmt::format("fire/{:02d}.png", i)).string()));
  double steps = 0;
  for (std::size_t i = 1; i < 10; ++i) steps += cv::norm(frames[i], frames[i - 1], cv::NORM_L1) / 9;
  EXPECT_GT(steps, 0);
  EXPECT_LT(cv::norm(frames[9], frames[0], cv::NORM_L1), 1.6 * steps);
  EXPECT_GT(cv::norm(frames[5], frames[0], cv::NORM_L1), 1.2 * steps);
  // Black is nothing: the picture shows beside the light.
  const cv::Mat still = cv::imread((folder / "still.png").string());
  EXPECT_LE(cv::norm(frames[5](cv::Rect(102, 12, 4, 4)), still(cv::Rect(102, 12, 4, 4)), cv::NORM_INF), 1);
  outcome = scene("frames = 14");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("layer fire: its design has 16 frames, and a loop of 14 needs 18"),
            std::string::npos)
      << outcome.err;
}

TEST(SceneTool, AnOraCutShortIsNamedWhereverItEnds) {
  const Landscape folder;
  folder.scene();
  ASSERT_EQ(folder.freshet({"synth", "layers", "scene.toml", "-o", "whole.ora"}).exit_code, 0);
  const std::string whole = text_of(folder / "whole.ora");
  for (const std::size_t length : {std::size_t{0}, std::size_t{3}, whole.size() / 2, whole.size() - 30}) {
    folder.file("short.ora", whole.substr(0, length));
    for (const bool painted : {false, true}) {
      if (painted)
        folder.scene("armature = [40, 80, 40, 20]", "paint = \"short.ora\"",
                     "[[layer]]\nname = \"near\"\nmatte = \"paint\"\nmotion = \"still\"");
      else
        folder.scene("armature = [40, 80, 40, 20]", "cut = \"short.ora\"");
      const Outcome outcome = folder.render({"-o", "out.mkv", "--layers-out", "l/{layer}.%02d.png"});
      EXPECT_EQ(outcome.exit_code, 1) << length;
      EXPECT_NE(outcome.err.find("short.ora"), std::string::npos) << outcome.err;
      EXPECT_FALSE(fs::exists(folder / "out.mkv"));
      EXPECT_FALSE(fs::exists(folder / "l/tree.00.png"));
    }
  }
}

TEST(SceneTool, WhatIsWrongIsNamedAndNothingIsLeft) {
  const Landscape folder;
  const auto refused = [&](const std::string& expected) {
    const Outcome outcome = folder.render({"-o", "out.mkv"});
    EXPECT_NE(outcome.exit_code, 0);
    EXPECT_EQ(outcome.signal, 0);
    EXPECT_NE(outcome.err.find(expected), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "out.mkv"));
    const Outcome drawn = folder.render({"--draw", "drawn.png", "--overwrite"});
    EXPECT_NE(drawn.exit_code, 0) << "what a run refuses is refused before one";
    EXPECT_NE(drawn.err.find(expected), std::string::npos) << drawn.err;
    EXPECT_FALSE(fs::exists(folder / "drawn.png"));
  };
  folder.scene("armature = [140, 80, 140, 20]");
  refused("lies outside of it");
  folder.scene("armature = [40, 80, 40]");
  refused("scene.toml:");
  folder.scene("armature = [40, 80, 40, 20]", "marks = \"none.svg\"");
  refused("none.svg");
  folder.scene("armature = [40, 80, 40, 20]", {}, "order = 2");
  refused("one order");
  cv::imwrite((folder / "small.png").string(), cv::Mat(50, 70, CV_8U, cv::Scalar(0)));
  folder.scene("armature = [40, 80, 40, 20]", {},
               "[[layer]]\nname = \"b\"\nmatte = \"small.png\"\nmotion = \"still\"");
  refused("small.png");
  folder.scene("armature = [40, 80, 40, 20]", {},
               "[[layer]]\nname = \"b\"\nmotion = \"footage\"\nfile = \"none.%04d.png\"");
  refused("none.%04d.png");
  cv::imwrite((folder / "seq0.png").string(), cv::Mat(40, 60, CV_8UC3, cv::Scalar(9, 9, 9)));
  cv::imwrite((folder / "seq1.png").string(), cv::Mat(20, 30, CV_8UC3, cv::Scalar(9, 9, 9)));
  folder.scene("armature = [40, 80, 40, 20]", {},
               "[[layer]]\nname = \"b\"\nmotion = \"footage\"\nfile = \"seq%d.png\"");
  refused("seq1.png: it has 30 x 20 px");
  folder.scene("armature = [40, 80, 40, 20]", {},
               "[[layer]]\nname = \"b\"\nmotion = \"footage\"\nfile = \"seq0.png\"\nmatte = \"lake.png\"");
  refused("lake.png: the matte has 160 x 120 px, the film");
  folder.scene("armature = [40, 80, 40, 20]", {},
               "[[layer]]\nname = \"b\"\nmotion = \"footage\"\nfile = \"seq0.png\"\nmatte = \"rest\"");
  refused("it is of the picture, and this layer is a film");
  folder.file("clip.mp4", "no video");
  folder.scene("armature = [40, 80, 40, 20]", {},
               "[[layer]]\nname = \"b\"\nmotion = \"footage\"\nfile = \"clip.mp4\"");
  refused("clip.mp4: not a video");
  folder.file("half.png", text_of(folder / "still.png").substr(0, 2000));
  folder.scene("armature = [40, 80, 40, 20]", {},
               "[[layer]]\nname = \"b\"\nmatte = \"half.png\"\nmotion = \"still\"");
  refused("half.png: the ");
  folder.file("m.svg", "<svg><path d=\"M 1 2 L");
  folder.scene("armature = [40, 80, 40, 20]", "marks = \"m.svg\"");
  refused("m.svg: not a whole XML file");
  folder.scene("armature = [40, 80, 40, 20]", {}, {}, "[0, 90, 160, 90]");
  refused("layer lake: its horizon lies below 5");
  folder.file("scene.toml",
              "picture = \"still.png\"\n[[layer]]\nname = \"boat\"\nmatte = \"tree.png\"\nmotion = "
              "\"boat\"\nhull = [26, 60, 54, 60]\n");
  refused("no layer of the scene is water, and a boat rides its waves");
  folder.scene();
  const Outcome outcome = folder.render({"-o", "out.mkv", "--layers-out", "layers.mov"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("{layer}"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace freshet::tools
