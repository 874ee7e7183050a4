// Every bench, on simulated clips: it runs, and prints the rows and columns that its published table has.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

struct BenchRun {
  std::string bench;
  std::vector<std::string> arguments;
  std::string chapter;  // below docs/
  std::vector<std::string>
      names;  // of rows and columns, in the chapter and in what is printed; capitals aside
};

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// White on the fluid, black on the ground, nothing between.
void write_scribbles(const fs::path& file) {
  const cv::Mat matte = cv::imread(sample().matte, cv::IMREAD_GRAYSCALE);
  cv::Mat fluid, ground, marks(matte.size(), CV_8UC4, cv::Scalar::all(0));
  cv::erode(matte > 150, fluid, {}, {-1, -1}, 8);
  cv::erode(matte < 100, ground, {}, {-1, -1}, 6);
  marks.setTo(cv::Scalar::all(255), fluid);
  marks.setTo(cv::Scalar(0, 0, 0, 255), ground);
  cv::imwrite(file, marks);
}

std::vector<BenchRun> runs(const WorkFolder& folder) {
  const std::string store = sample().store, fall = sample().clips / "fall/1.mkv",
                    other = sample().clips / "fall/2.mkv", river = sample().clips / "river/1.mkv",
                    still = sample().still, matte = sample().matte, target = still + ":" + matte;
  folder.freshet({"synth", "simulate", "waterfall", "--size", "192x144", "--frames", "16", "-o", "fall.mp4"});
  write_scribbles(folder / "marks.png");
  fs::create_directories(folder / "fires/fire");
  for (const char* const seed : {"1", "2"})
    folder.freshet({"synth", "simulate", "firepit", "--size", "192x144", "--frames", "48", "--seed", seed,
                    "-o", fmt::format("fires/fire/{}.mkv", seed)});
  folder.freshet({"ingest", "fires.store", "fires"});
  fs::create_directories(folder / "takes");
  fs::copy_file(still, folder / "takes/one_still.png");
  fs::copy_file(matte, folder / "takes/one_matte.png");
  fs::create_directories(folder / "drawn");
  fs::copy_file(matte, folder / "drawn/one.png");
  std::ofstream(folder / "outlines.txt") << "water falls simulated/waterfall/1 alpha\nwater flows " << river
                                         << "@50 0,0 100,0 100,100\nfire flames simulated/fire/1 alpha\n";
  return {
      {"bench_store_io", {"fall.mp4", "--frames", "16"}, "measurements/store.md", {"FFV1", "ratio"}},
      {"bench_ingest",
       {fall, "--frames", "8"},
       "measurements/ingest.md",
       {"DIS", "TV-L1", "frames/s", "flow"}},
      {"bench_crossings",
       {fall, "--frames", "32"},
       "measurements/ingest.md",
       {"person", "animal", "boat", "nothing %", "beside %"}},
      {"bench_labelling",
       {store, target, "--runs", "1"},
       "measurements/labelling.md",
       {"TRW-S", "alpha-expansion", "ICM", "bound", "cold", "warm", "open", "search", "tables", "solver"}},
      {"bench_reuse", {store, target, "fall"}, "measurements/labelling.md", {"edges", "candidates"}},
      {"bench_rendering",
       {store, "fall:" + target, "--sizes", "160x120", "--frames", "8", "--runs", "1"},
       "measurements/animation.md",
       {"frames/s", "with a file", "encoder", "CPU s a frame", "end to end", "cold"}},
      {"bench_quality",
       {store, "--frames", "24", "--width", "192", "--hints", "strokes+speed", "--methods", "ours,nothing",
        "--limit", "1"},
       "measurements/quality.md",
       {"spectrum", "of matte", "angle", "speed", "texture", "lifetime", "SWD", "ribbon", "comes again",
        "colour drift", "floor"}},
      {"bench_quality",
       {store, "--frames", "24", "--width", "192", "--hints", "direction,strokes+speed", "--methods",
        "kwatra2005,okabe2009", "--limit", "1"},
       "measurements/quality.md",
       {"kwatra2005", "okabe2009"}},
      {"bench_quality",
       {"fires.store", "--frames", "24", "--width", "192", "--hints", "nothing", "--methods", "transfer-own",
        "--limit", "1"},
       "measurements/quality.md",
       {"transfer-own"}},
      {"bench_quality",
       {store, "--frames", "24", "--width", "192", "--words", "40,300", "--hints", "nothing", "--methods",
        "nothing", "--limit", "1"},
       "measurements/search.md",
       {"words", "candidates", "CPU", "bytes a patch", "of the class", "angle", "speed"}},
      {"bench_films", {fall, other}, "measurements/quality.md", {"spectrum", "SWD", "flicker", "ceiling"}},
      {"bench_blind_look",
       {"blind", "--film", "fall:ours=" + fall, "--film", "fall:real=" + other},
       "measurements/quality.md",
       {}},
      {"bench_scene",
       {"--sizes", "160x120", "--frames", "4", "--runs", "1"},
       "scene.md",
       {"size", "frames/s", "peak MB"}},
      {"bench_tour",
       {"--sizes", "160x120", "--frames", "3", "--runs", "1"},
       "tour.md",
       {"size", "scene", "frames/s", "one thread", "peak MB", "outdoors", "a room", "three things"}},
      {"bench_flowlines",
       {river, "--seconds", "1", "--output-seconds", "2", "--width", "96", "--brief"},
       "flowlines.md",
       {"jump", "dip", "repeats", "kept", "dynamic textures"}},
      {"bench_stills",
       {"smoke", "--stills", "3,8", "--seconds", "1.1", "--width", "128", "--draws", "1"},
       "stills.md",
       {"stills", "apart", "spectrum", "speed", "paced", "half-life", "again", "a path", "other half"}},
      {"bench_scaled_store",
       {store, "scaled.store", "--patches", "300"},
       "measurements/scale.md",
       {"patches"}},
      {"bench_cost_curves",
       {store, target, "--out", "costs", "--sizes", "300,600"},
       "measurements/scale.md",
       {"patches", "cold", "500", "peak MB", "label", "verify s"}},
      {"bench_transfer",
       {fall, "--frames", "2", "--width", "64"},
       "measurements/transfer.md",
       {"exemplar", "method", "sharpness", "slip", "slip x, y", "curvature", "divergence", "uniform",
        "nearest", "stabilised", "no coherence", "discrete", "bidirectional", "occurrences", "benard",
        "browning"}},
      {"bench_transfer",
       {fall, other + "@plume", fall + "*0", "--frames", "4", "--width", "64", "--method", "uniform",
        "--sheet", "ten.png"},
       "measurements/transfer.md",
       {"exemplar", "sharpness", "colours", "change", "CPU s", "_still"}},
      {"bench_layers",
       {still, still, "--width", "100", "--no-smoke", "--only", "alpha"},
       "measurements/layers.md",
       {"SAD", "tree", "outline", "Bayesian", "information flow", "over grey"}},
      {"bench_layers",
       {still, still, "--width", "100", "--no-smoke", "--only", "fill"},
       "measurements/layers.md",
       {"PSNR", "SSIM", "Telea", "Navier-Stokes", "patches of 9 px within 96"}},
      {"bench_kind",
       {"/", "outlines.txt"},
       "measurements/critic.md",
       {"is \\ told", "water", "fire", "sure %", "of the sure right %", "all left out"}},
      {"bench_holds",
       {"takes", "guesses", "--figures", "--drawn", "drawn"},
       "measurements/first_takes.md",
       {"a click costs"}},
      {"bench_matting",
       {still + ":marks.png:" + matte},
       "measurements/mattes.md",
       {"GrabCut alone", "guided, band 2 %"}},
  };
}

TEST(BenchRuns, EachPrintsTheNamesOfItsPublishedTable) {
  const WorkFolder folder;
  std::set<std::string> ran;
  for (const BenchRun& run : runs(folder)) {
    SCOPED_TRACE(run.bench);
    std::vector<std::string> command{FRESHET_BENCHES "/" + run.bench};
    command.insert(command.end(), run.arguments.begin(), run.arguments.end());
    const Outcome outcome = folder.run(command);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string chapter = lowered(text_of(fs::path(FRESHET_SOURCE_DIR "/docs") / run.chapter));
    EXPECT_NE(chapter.find(run.bench), std::string::npos);
    for (const std::string& name : run.names) {
      EXPECT_NE(lowered(outcome.out).find(lowered(name)), std::string::npos) << name << " is not printed:\n"
                                                                             << outcome.out.substr(0, 2000);
      EXPECT_NE(chapter.find(lowered(name)), std::string::npos) << name << " is not in " << run.chapter;
    }
    ran.insert(run.bench);
  }
  EXPECT_FALSE(cv::imread(folder / "guesses/one_hold.png").empty());
  EXPECT_EQ(cv::imread(folder / "ten.png").size(), cv::Size(6 * 64, 3 * (48 + 18)));
  std::istringstream targets(FRESHET_BENCH_TARGETS);
  for (std::string name; targets >> name;) EXPECT_TRUE(ran.contains(name)) << name << " is run by no test";
}

/// The pixel deepest inside what is white, in a picture reduced or enlarged to 640 px on its longer side, as TOML.
std::string deepest(const cv::Mat& white) {
  cv::Mat depth;
  cv::distanceTransform(white, depth, cv::DIST_L2, cv::DIST_MASK_5);
  cv::Point at;
  cv::minMaxLoc(depth, nullptr, nullptr, nullptr, &at);
  const double scale = 640.0 / std::max(white.cols, white.rows);
  return fmt::format("[[{:.0f}, {:.0f}], [{:.0f}, {:.0f}]]", scale * at.x, scale * at.y, scale * at.x,
                     scale * at.y + 40);
}

TEST(BenchRuns, FirstTakesOfAPictureComeToAFilmASheetAndARow) {
  const WorkFolder folder;
  const cv::Mat matte = cv::imread(sample().matte, cv::IMREAD_GRAYSCALE);
  const std::string name = fs::path(sample().still).stem().string(), on = deepest(matte > 150);
  std::ofstream(folder / "asks.toml")
      << fmt::format("[{}]\nkind = \"fall\"\non = [{}]\nbeside = [{}]\nstrokes = [{}]\n[away]\n", name, on,
                     deepest(matte < 100), on);
  const Outcome outcome =
      folder.run({"/usr/bin/python3", FRESHET_SOURCE_DIR "/bench/takes/first_takes.py", FRESHET_EXECUTABLE,
                  sample().store, fs::path(sample().still).parent_path(), "takes", "--asks", "asks.toml",
                  "--kinds", "--frames", "12"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("away: not in"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.out.find("| " + name + " | "), std::string::npos) << outcome.out;
  const std::string head = outcome.out.substr(0, outcome.out.find('\n')),
                    chapter = text_of(FRESHET_SOURCE_DIR "/docs/measurements/first_takes.md");
  for (const char* const column : {"looks like", "faults", "worst"}) {
    EXPECT_NE(head.find(column), std::string::npos) << head;
    EXPECT_NE(chapter.find(column), std::string::npos) << column;
  }
  EXPECT_FALSE(cv::imread(folder / "takes" / (name + ".png")).empty());
}

TEST(BenchRuns, SeveralFluidsAreLaidOverOnePicture) {
  const WorkFolder folder;
  const std::string fall = sample().clips / "fall/1.mkv", river = sample().clips / "river/1.mkv";
  const Outcome outcome =
      folder.run({"/usr/bin/env", "FRESHET=" FRESHET_EXECUTABLE, "sh",
                  FRESHET_SOURCE_DIR "/bench/transfer/composition.sh", sample().still, "made", "3", "40x32",
                  fall, "none", "waterfall-pool", "4,6", river, "none", "firepit", "50,40"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string chapter = text_of(FRESHET_SOURCE_DIR "/docs/measurements/transfer.md");
  const std::string head = outcome.out.substr(0, outcome.out.find('\n'));
  EXPECT_NE(chapter.find(head), std::string::npos) << head;
  EXPECT_EQ(lines_of(outcome.out).size(), 4U) << outcome.out;
  const cv::Mat still = cv::imread(sample().still), one = cv::imread(folder / "made/1/002.png"),
                both = cv::imread(folder / "made/2/002.png");
  ASSERT_EQ(both.size(), still.size());
  const cv::Rect first(4, 6, 40, 32), second(50, 40, 40, 32);
  EXPECT_GT(cv::norm(both(first), still(first), cv::NORM_L1), 0);
  EXPECT_GT(cv::norm(both(second), still(second), cv::NORM_L1), 0);
  EXPECT_EQ(cv::norm(one(second), still(second), cv::NORM_L1), 0) << "the first lies in its place alone";
  EXPECT_EQ(cv::norm(both(first), one(first), cv::NORM_L1), 0) << "the second leaves the first as it is";
}

TEST(BenchRuns, WindsRaiseTheWavesThatAreAsked) {
  const WorkFolder folder;
  cv::Mat picture(120, 160, CV_8UC3), matte(120, 160, CV_8U, cv::Scalar(0));
  cv::randu(picture, 0, 255);
  matte.rowRange(50, 120).setTo(255);
  cv::imwrite(folder / "still.png", picture), cv::imwrite(folder / "matte.png", matte);
  const Outcome outcome = folder.run({"/usr/bin/python3", FRESHET_SOURCE_DIR "/bench/scene/winds.py",
                                      FRESHET_EXECUTABLE, "still.png", "matte.png", "made", "--horizon", "40",
                                      "--camera", "0.75", "--frames", "24", "--sheet", "winds.png"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<std::string> lines = lines_of(outcome.out);
  ASSERT_EQ(lines.size(), 9U) << outcome.out;
  EXPECT_NE(text_of(FRESHET_SOURCE_DIR "/docs/scene.md").find(lines[0]), std::string::npos) << lines[0];
  std::vector<double> heights;
  for (std::size_t i = 2; i < lines.size(); ++i) {
    std::istringstream row(lines[i]);
    std::string bar;
    double speed = 0, direction = 0, roughness = 0, asked = 0, rendered = 0, towards = 0;
    row >> bar >> speed >> bar >> direction >> bar >> roughness >> bar >> asked >> bar >> rendered >> bar >>
        towards;
    EXPECT_NEAR(towards, direction, 45) << lines[i];  // few waves are in so small a picture
    EXPECT_GT(rendered, 0.4 * asked) << lines[i];
    EXPECT_LT(rendered, 1.5 * asked) << lines[i];
    heights.push_back(rendered);
  }
  EXPECT_LT(heights[0], heights[1]);
  EXPECT_LT(heights[1], heights[2]);
  EXPECT_LT(heights[5], heights[6]) << "smoother water is higher";
  EXPECT_EQ(cv::imread(folder / "winds.png").cols, 3 * (160 + 4));
}

TEST(BenchRuns, MovedCutsAreMadeAndCounted) {
  const WorkFolder folder;
  const Outcome outcome = folder.run({"/usr/bin/python3", FRESHET_SOURCE_DIR "/bench/ingest/moved_cuts.py",
                                      FRESHET_EXECUTABLE, sample().clips, "films", "--count", "9"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string chapter = text_of(FRESHET_SOURCE_DIR "/docs/measurements/ingest.md");
  for (const char* const row :
       {"| camera |", "| tripod |", "| shake 1 % |", "| pan 3 %/s |", "| cut |", "| all |"}) {
    EXPECT_NE(outcome.out.find(row), std::string::npos) << outcome.out;
    EXPECT_NE(chapter.find(row), std::string::npos) << row;
  }
  EXPECT_NE(outcome.out.find("| tripod | 1 | 1 | 100 | 100 |"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("\n1 cuts: "), std::string::npos) << outcome.out;
}

}  // namespace
}  // namespace freshet::tools
