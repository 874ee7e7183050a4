// Small files that ask for much, through every door by which a file comes in: no run takes more than a gigabyte or a
// minute.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <map>
#include <numeric>
#include <random>

#include "tests/faults/campaign.h"
#include "tests/media/picture/bombs.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

struct Bomb {
  std::string kind, name, bytes;
};

std::string scene() {
  return "picture = \"still.png\"\nframes = 3\n[[layer]]\nname = \"a\"\nmotion = \"clouds\"\nmatte = "
         "\"rest\"\n";
}

/// Drawings and tables: entities, depth, and numbers beyond all sense.
std::vector<Bomb> texts() {
  const std::string begin =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"96\" height=\"96\" viewBox=\"0 0 96 96\">";
  const std::string line = "<polyline points=\"10,10 20,80\"/>";
  const auto times = [](const std::string& text, std::size_t count) {
    std::string all;
    for (std::size_t i = 0; i < count; ++i) all += text;
    return all;
  };
  return {
      {"svg", "quadratic.svg",
       "<?xml version=\"1.0\"?><!DOCTYPE svg [<!ENTITY a \"" + std::string(100000, 'A') + "\">]>" + begin +
           "<text>" + times("&a;", 100000) + "</text>" + line + "</svg>"},
      {"svg", "points.svg", begin + "<polyline points=\"10,10 " + times("20,20 ", 400000) + "\"/></svg>"},
      {"svg", "lines.svg", begin + times(line, 100000) + "</svg>"},
      {"svg", "far.svg", begin + "<path d=\"M0 0 L 1e9 1e9 L -1e9 5\"/></svg>"},
      {"svg", "arcs.svg",
       begin + "<path d=\"M 10 10" + times(" a1e-30 1e30 0 0 1 5 5", 20000) + "\"/></svg>"},
      {"toml", "layers.toml",
       scene() + times("[[layer]]\nname = \"l\"\nmotion = \"clouds\"\nmatte = \"rest\"\n", 50000)},
      {"toml", "frames.toml",
       "picture = \"still.png\"\nframes = 100000000\n" + scene().substr(scene().find("[["))},
      {"toml", "keys.toml", scene() + times("x = 1\n", 500000)},
      {"toml", "grid.toml", "size = [65535, 65535]\nframes = 2\ngrid = 32\n"},
  };
}

std::vector<Bomb> bombs() {
  std::vector<Bomb> all;
  for (const auto& made : {media::picture_bombs(), media::openraster_bombs()})
    for (const media::Bomb& bomb : made)
      all.push_back({fs::path(bomb.name).extension().string().substr(1), bomb.name, bomb.bytes});
  for (Bomb& bomb : texts()) all.push_back(std::move(bomb));
  return all;
}

/// All commands that read a file of this kind, with its name in the place of an input.
std::vector<std::vector<std::string>> doors(const std::string& kind, const std::string& name) {
  const std::vector<std::string> animate{"synth",    "animate", "q.store",     "still.png", "--whole",
                                         "--frames", "2",       "--overwrite", "-o",        "out.mkv"};
  const auto with = [&](std::vector<std::string> options) {
    options.insert(options.begin(), animate.begin(), animate.end());
    return options;
  };
  if (kind == "svg")
    return {{"query", "label", "q.store", "still.png", "--whole", "--strokes", name, "--frames", "2", "-o",
             "l.json", "--overwrite"},
            with({"--strokes", name})};
  if (kind == "toml")
    return {{"synth", "scene", name, "-o", "out.mkv", "--overwrite"},
            {"synth", "simulate", name, "-o", "out.mkv", "--overwrite"},
            {"synth", "layers", name, "-o", "out.ora", "--overwrite"},
            {"synth", "tour", "still.png", name, "--frames", "2", "-o", "out.mkv", "--overwrite"}};
  if (kind == "ora")
    return {{"synth", "scene", "paint.toml", "-o", "out.mkv", "--overwrite"},
            {"synth", "scene", "cut.toml", "-o", "out.mkv", "--overwrite"},
            {"synth", "layers", "paint.toml", "-o", "out.ora", "--overwrite"}};
  if (kind == "flo")
    return {{"synth", "transfer", "--alpha-sequence", "design/alpha", "--flow-sequence", name, "--exemplar",
             "still.png", "--restart", "--overwrite", "-o", "out.mkv"}};
  return {
      {"query", "candidates", "q.store", name, "--whole", "--frames", "2"},
      {"query", "candidates", "q.store", "still.png", "--matte", name, "--frames", "2"},
      {"query", "candidates", "q.store", "still.png", "--whole", "--hold", name, "--frames", "2"},
      {"query", "candidates", "q.store", "still.png", "--whole", "--speed-map", name, "--frames", "2"},
      {"query", "candidates", "q.store", "still.png", "--whole", "--orientation-map", name, "--frames", "2"},
      {"synth", "matte", name, "--box", "4,4,50,40", "-o", "matte.png", "--overwrite"},
      {"synth", "matte", "still.png", "--scribbles", name, "-o", "matte.png", "--overwrite"},
      {"synth", "animate", "q.store", name, "--whole", "--frames", "2", "-o", "out.mkv", "--overwrite"},
      {"synth", "transfer", "--design", "design", "--exemplar", name, "--ground", "black", "--frames", "1",
       "--restart", "--overwrite", "-o", "out.mkv"},
      {"ingest", "m.store", "--no-index", "--force", "--", name},
      {"synth", "flowlines", name, "-o", "out.mkv", "--overwrite"},
      {"synth", "tour", name, "--frames", "2", "-o", "out.mkv", "--overwrite"},
      {"synth", "stills", "stills", "-o", "out.mkv", "--overwrite"}};
}

struct Cost {
  int runs = 0, taken = 0;
  long kib = 0;
  double seconds = 0;
};

TEST(Bombs, ThroughEveryDoorTakeNeitherAGigabyteNorAMinute) {
  const Campaign& c = campaign();
  cv::Mat still(48, 64, CV_8UC3);  // as large as the bombs that can be read
  cv::randu(still, 0, 255);
  cv::imwrite((c.folder / "still.png").string(), still);
  c.begin_with("indexed.store", "q.store");
  ASSERT_EQ(
      c.run({"synth", "simulate", "plume", "--frames", "2", "--size", "64x48", "--overwrite", "-o", "design"})
          .exit_code,
      0);
  struct Case {
    const Bomb* bomb;
    std::size_t door;
  };
  const std::vector<Bomb> all = bombs();
  std::vector<Case> cases;
  for (const Bomb& bomb : all)
    for (std::size_t i = 0; i < doors(bomb.kind, bomb.name).size(); ++i) cases.push_back({&bomb, i});
  std::mt19937 random(41);
  std::shuffle(cases.begin(), cases.end(), random);
  if (!at_full_length()) cases.resize(40);
  std::map<std::string, Cost> by_kind;
  walk("bombs", cases, [&](const Case& tried) {
    const std::string name = "bomb_" + tried.bomb->name;
    c.folder.file(name, tried.bomb->bytes);
    fs::remove_all(c.folder / "stills");
    fs::create_directory(c.folder / "stills");
    for (int i = 0; i < 3; ++i)
      cv::imwrite((c.folder / ("stills/" + std::to_string(i) + ".png")).string(), still + 20 * i);
    fs::copy_file(c.folder / name, c.folder / ("stills/" + name));
    for (const std::string key : {"paint", "cut"})
      c.folder.file(key + ".toml", key + " = \"" + name + "\"\n" + scene());
    c.begin_with("", "m.store");
    const std::vector<std::string> door = doors(tried.bomb->kind, name)[tried.door];
    const auto begin = std::chrono::steady_clock::now();
    const Outcome outcome = c.run(door);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const std::string what =
        std::accumulate(door.begin(), door.end(), std::string(),
                        [](const std::string& a, const std::string& b) { return a + ' ' + b; });
    EXPECT_EQ(judge_file(outcome), "") << what;
    EXPECT_LT(seconds, 60) << what;
    EXPECT_LT(outcome.err.size(), 20000U) << what;
    if (outcome.exit_code == 2) std::cout << "usage:" << what << ": " << outcome.err;
    Cost& cost = by_kind[tried.bomb->kind];
    ++cost.runs;
    cost.taken += outcome.exit_code == 0 ? 1 : 0;
    cost.kib = std::max(cost.kib, outcome.peak_kib);
    cost.seconds = std::max(cost.seconds, seconds);
    fs::remove(c.folder / name);
  });
  for (const auto& [kind, cost] : by_kind)
    std::cout << kind << ": " << cost.runs << " runs, " << cost.taken << " taken, at most "
              << (cost.kib >> 10) << " MiB, " << cost.seconds << " s\n";
}

}  // namespace
}  // namespace freshet::tools
