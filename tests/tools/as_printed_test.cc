// --as-printed: one word for all options of a paper, and what contradicts it.

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

using Words = std::vector<std::string>;

Outcome animate(const WorkFolder& folder, const std::string& name, const Words& more) {
  std::filesystem::create_directories(folder / name);
  Words arguments{"synth",    "animate", sample().store, sample().still,     "--matte", sample().matte,
                  "--frames", "8",       "-o",           name + "/%05d.png", "--class", "fall"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return folder.freshet(arguments);
}

bool same(const std::vector<cv::Mat>& one, const std::vector<cv::Mat>& other) {
  if (one.size() != other.size()) return false;
  for (std::size_t i = 0; i < one.size(); ++i)
    if (cv::norm(one[i], other[i], cv::NORM_INF) != 0) return false;
  return !one.empty();
}

TEST(AsPrinted, OfAnimateIsTheWholeOfItsOptions) {
  const WorkFolder folder;
  const Words all{"--method",     "paper",   "--piece-scale", "1",     "--candidates",  "100",
                  "--coherent",   "0",       "--hint",        "none",  "--hint-search", "narrow",
                  "--costs",      "power",   "--vote",        "0",     "--hint-weight", "0",
                  "--reuse",      "0",       "--crowd",       "0",     "--solver",      "alpha-expansion",
                  "--resampling", "nearest", "--blend",       "paper", "--low-band",    "keep",
                  "--matching",   "frame",   "--max-gain",    "20",    "--direction",   "down"};
  const Outcome one = animate(folder, "one", {"--as-printed", "--direction", "down", "--vote", "0.0"});
  ASSERT_EQ(one.exit_code, 0) << one.err;
  const Outcome whole = animate(folder, "all", all);
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  const Outcome rendering = animate(folder, "rendering", {"--method", "paper", "--direction", "down"});
  ASSERT_EQ(rendering.exit_code, 0) << rendering.err;
  const std::vector<cv::Mat> printed = read_frames(folder / "one");
  EXPECT_TRUE(same(printed, read_frames(folder / "all")));
  EXPECT_FALSE(same(printed, read_frames(folder / "rendering")));
}

TEST(AsPrinted, RefusesWhatContradictsItByName) {
  const WorkFolder folder;
  const std::string scene =
      "picture = \"p.png\"\n[[layer]]\nname = \"lake\"\nmatte = \"rest\"\n"
      "motion = \"water\"\nhorizon = [0, 10, 100, 10]\nagainst = 0.5\n";
  folder.file("a.toml", scene);
  const std::vector<std::pair<Words, std::string>> cases{
      {{"synth", "animate", sample().store, sample().still, "--matte", sample().matte, "-o", "a.mp4",
        "--blend", "variance"},
       "--blend variance contradicts it: the paper prints paper (Sec. 6)"},
      {{"synth", "animate", sample().store, sample().still, "--matte", sample().matte, "-o", "a.mp4",
        "--vote", "4"},
       "--vote 4 contradicts it: the paper prints 0"},
      {{"synth", "transfer", "--exemplar", "a.png", "--design", "d", "-o", "%05d.png", "--search",
        "patchmatch"},
       "--search patchmatch contradicts it: the paper prints exact"},
      {{"synth", "transfer", "--exemplar", "a.mp4", "--design", "d", "-o", "%05d.png", "--stabilise"},
       "--stabilise true contradicts it: the paper prints false"},
      {{"synth", "stills", "folder", "-o", "a.mp4", "--one-region", "--distance", "paths"},
       "--distance paths contradicts it: the paper prints l2"},
      {{"synth", "stills", "folder", "-o", "a.mp4"}, "a person marks the paper's regions"},
      {{"synth", "flowlines", "a.mp4", "-o", "b.mp4", "--lines", "a.svg", "--blend", "cut"},
       "--blend cut contradicts it: the paper prints feather"},
      {{"synth", "flowlines", "a.mp4", "-o", "b.mp4"}, "an artist draws the paper's lines"},
      {{"synth", "scene", "a.toml", "-o", "a.mp4"},
       "against: 0.5 contradicts --as-printed: the paper prints 1"}};
  for (auto [words, fault] : cases) {
    words.emplace_back("--as-printed");
    const Outcome outcome = folder.freshet(words);
    EXPECT_NE(outcome.exit_code, 0) << words[1];
    EXPECT_NE(outcome.err.find(fault), std::string::npos) << words[1] << ": " << outcome.err;
  }
}

/// A command without what contradicts, and for each option that the paper settles another value.
struct Contradicted {
  std::string command;
  Words rest;
  struct Option {
    std::string name, other, printed;
  };
  std::vector<Option> options;
};

TEST(AsPrinted, RefusesAnotherValueOfEachOptionThatItSets) {
  const WorkFolder folder;
  const std::vector<Contradicted> commands{
      {"animate",
       {sample().store, sample().still, "--matte", sample().matte, "-o", "a.mp4"},
       {{"--method", "carried", "paper"},
        {"--piece-scale", "2", "1"},
        {"--candidates", "50", "100"},
        {"--coherent", "10", "0"},
        {"--hint", "auto", "none"},
        {"--hint-search", "wide", "narrow"},
        {"--costs", "log", "power"},
        {"--vote", "4", "0"},
        {"--hint-weight", "1", "0"},
        {"--reuse", "0.1", "0"},
        {"--crowd", "0.02", "0"},
        {"--solver", "trw-s", "alpha-expansion"},
        {"--horizon", "20", "none"},
        {"--speed", "2", "1"},
        {"--resampling", "flow", "nearest"},
        {"--blend", "variance", "paper"},
        {"--low-band", "shared", "keep"},
        {"--matching", "sequence", "frame"},
        {"--max-gain", "2", "20"}}},
      {"transfer",
       {"--exemplar", "a.png", "--design", "d", "-o", "%05d.png"},
       {{"--uniformity", "off", "on"},
        {"--search", "patchmatch", "exact"},
        {"--initialise", "random", "warped"},
        {"--rotations", "1", "4"},
        {"--exemplar-scale", "0.5", "1"},
        {"--stabilise", "true", "false"},
        {"--curvature", "1", "0"},
        {"--divergence", "1", "0"},
        {"--ground", "black", "none"},
        {"--patch", "7", "5"},
        {"--lambda", "0.3", "0.2"},
        {"--lower", "0.2", "0.1"},
        {"--upper", "0.8", "0.9"}}},
      {"stills",
       {"folder", "-o", "a.mp4", "--one-region"},
       {{"--camera", "auto", "tripod"},
        {"--level", "on", "off"},
        {"--distance", "paths", "l2"},
        {"--cut-above", "3", "2"},
        {"--normalise", "mean", "sum"}}},
      {"flowlines",
       {"a.mp4", "-o", "b.mp4", "--lines", "a.svg"},
       {{"--blend", "cut", "feather"},
        {"--repeats", "varied", "in-turn"},
        {"--strand", "12", "0"},
        {"--ground", "black", "none"}}}};
  for (const Contradicted& one : commands) {
    SCOPED_TRACE(one.command);
    // Its help lists what it sets: all of them are here, and flags that it leaves off.
    const std::string help =
        folder.freshet({"synth", one.command, one.command == "animate" ? "--help-all" : "--help"}).out;
    const std::size_t from = help.find("prints it, whole: ");
    ASSERT_NE(from, std::string::npos);
    const std::string listed = help.substr(from, help.find("\n\n", from) - from);
    std::ptrdiff_t set = 0;
    for (std::size_t at = listed.find("--"); at != std::string::npos; at = listed.find("--", at + 1)) ++set;
    EXPECT_EQ(set,
              std::count_if(one.options.begin(), one.options.end(),
                            [](const Contradicted::Option& option) { return option.printed != "false"; }))
        << listed;
    for (const auto& [name, other, printed] : one.options) {
      EXPECT_TRUE(printed == "false" || listed.find(name + " " + printed) != std::string::npos) << name;
      Words words{"synth", one.command};
      words.insert(words.end(), one.rest.begin(), one.rest.end());
      words.insert(words.end(), {"--as-printed", name});
      if (other != "true") words.push_back(other);
      const Outcome outcome = folder.freshet(words);
      EXPECT_EQ(outcome.exit_code, 2) << name;
      EXPECT_NE(outcome.err.find(name + " " + other + " contradicts it: the paper prints " + printed + " ("),
                std::string::npos)
          << outcome.err;
      EXPECT_NE(outcome.err.find("Leave " + name + " out, or --as-printed"), std::string::npos)
          << outcome.err;
    }
  }
}

}  // namespace
}  // namespace freshet::tools
