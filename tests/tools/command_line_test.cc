// Help, wrong usage, configuration files, and what goes to which stream.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "starter/starter_store.h"
#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The exit code is for wrong usage, stdout is silent, and stderr has one message of ours that holds `part`.
void expect_usage_fault(const std::vector<std::string>& arguments, const std::string& part) {
  const Outcome outcome = WorkFolder().freshet(arguments);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err.rfind("freshet: ", 0), 0U) << outcome.err;
  EXPECT_TRUE(holds(outcome.err, part)) << outcome.err;
}

TEST(CommandLine, EveryCommandExplainsItselfAndItsDefaults) {
  struct Command {
    std::vector<std::string> words;
    const char* a_default;
  };
  const std::vector<Command> commands{{{}, "ingest"},
                                      {{"ingest"}, "=half of the patch"},
                                      {{"index"}, "="},
                                      {{"store"}, "framemd5"},
                                      {{"store", "info"}, "[all cores]"},
                                      {{"store", "verify"}, "[all cores]"},
                                      {{"store", "digest"}, "[all cores]"},
                                      {{"store", "framemd5"}, "[all cores]"},
                                      {{"store", "export"}, "[all cores]"},
                                      {{"query"}, "label"},
                                      {{"query", "candidates"}, "[the picture's own alpha]"},
                                      {{"query", "label"}, "=trw-s"},
                                      {{"synth"}, "simulate"},
                                      {{"synth", "animate"}, "--help-all"},
                                      {{"synth", "simulate"}, "[the scene's]"}};
  for (const Command& command : commands) {
    std::vector<std::string> arguments = command.words;
    arguments.emplace_back("--help");
    const Outcome outcome = WorkFolder().freshet(arguments);
    const std::string name = command.words.empty() ? "freshet" : command.words.back();
    EXPECT_EQ(outcome.exit_code, 0) << name;
    EXPECT_EQ(outcome.err, "") << name;
    EXPECT_TRUE(holds(outcome.out, command.a_default)) << name << "\n" << outcome.out;
  }
}

TEST(CommandLine, TheShortHelpOfAnimateIsInTheWordsOfTheTradeAndAllOfItIsBehindHelpAll) {
  const WorkFolder folder;
  const Outcome brief = folder.freshet({"synth", "animate", "--help"});
  const Outcome all = folder.freshet({"synth", "animate", "--help-all"});
  EXPECT_EQ(brief.exit_code, 0);
  EXPECT_EQ(all.exit_code, 0) << all.err;
  for (const char* word :
       {"--matte", "--layer", "--alpha", "--depth", "--preset", "--range", "--strokes", "--loop"})
    EXPECT_TRUE(holds(brief.out, word)) << word;
  for (const char* word : {"--rho", "--vote", "--lambda", "--solver", "--renewal", "--candidates", "trw-s"}) {
    EXPECT_FALSE(holds(brief.out, word)) << word;
    EXPECT_TRUE(holds(all.out, word)) << word;
  }
  EXPECT_LT(lines_of(brief.out).size(), 95U);
}

TEST(CommandLine, WrongUsageIsSaidInOneLine) {
  expect_usage_fault({}, "a command is missing; there are ingest, index, store, query, synth");
  expect_usage_fault({"nosuch"}, "there is no command \"nosuch\"");
  expect_usage_fault(
      {"query", "nosuch"},
      "there is no command \"nosuch\"; there are candidates, label, kind, bench. See freshet query --help");
  expect_usage_fault({"ingest"}, "STORE is required. See freshet ingest --help");
  expect_usage_fault({"query", "label"}, "PICTURE is required. See freshet query label --help");
  expect_usage_fault({"synth", "animate", sample().store, "-o", "x.mp4"}, "PICTURE is required");
  expect_usage_fault({"query", "label", "a", "b", "--nosuch"}, "--nosuch");
  expect_usage_fault({"query", "label", "a", "b", "-k", "0"}, "not in range");
  expect_usage_fault({"synth", "simulate", "lava", "-o", "x.mkv"}, "Choose one of plume, fireball");
  expect_usage_fault({"synth", "simulate", "river", "--size", "3x", "-o", "x.mkv"}, "WIDTHxHEIGHT");
  expect_usage_fault({"ingest", "a.store", "clips", "--shard", "3/2"}, "--shard 3/2");
  expect_usage_fault({"query", "label", sample().store, sample().still, "--direction", "sideways"},
                     "sideways");
  expect_usage_fault({"ingest", sample().store, sample().clips, "--stride", "48"},
                     "made with another --stride: 24, and 48 was asked for");
  expect_usage_fault({"ingest", sample().store, sample().clips, "--patch", "96"},
                     "made with another --patch: 48, and 96 was asked for");
  expect_usage_fault({"ingest", "new.store", sample().clips, "--patch", "50"}, "--patch: 50 not in");
}

// 2: nothing but another command line would help. 1: another file, store or disk would.
TEST(CommandLine, ExitCodesTellACommandLineFromWhatItMeets) {
  const WorkFolder folder;
  std::ofstream(folder / "kept.mp4") << "mine";
  const std::string store = sample().store, still = sample().still, matte = sample().matte;
  const auto animate = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"synth", "animate", store, still};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  const std::vector<std::pair<std::vector<std::string>, int>> runs{
      {animate({"--matte", matte, "-o", "a.xyz"}), 2},
      {animate({"--matte", matte, "-o", still}), 2},
      {animate({"--matte", matte, "-o", "kept.mp4"}), 2},
      {animate({"-o", "a.mp4"}), 2},
      {animate({"--matte", matte, "--frames", "0", "-o", "a.mp4"}), 2},
      {animate({"--matte", matte, "--preset", "edit", "-o", "a.mp4"}), 2},
      {{"synth", "transfer", "--exemplar", still, "-o", "a.mov"}, 2},
      {{"synth", "simulate", "lava", "-o", "a"}, 2},
      {animate({"--matte", "none.png", "-o", "a.mp4"}), 1},
      {animate({"--matte", matte, "--strokes", "none.svg", "-o", "a.mp4"}), 1},
      {animate({"--matte", matte, "--class", "none", "-o", "a.mp4"}), 1},
      {animate({"--matte", matte, "--exclude", "none", "-o", "a.mp4"}), 1},
      {{"synth", "animate", "none.store", still, "--matte", matte, "-o", "a.mp4"}, 1},
      {{"synth", "animate", store, "none.png", "--whole", "-o", "a.mp4"}, 1},
      {{"synth", "transfer", "--design", "none", "--exemplar", still, "-o", "a.mov"}, 1},
      {{"synth", "simulate", "none.toml", "-o", "a"}, 1},
      {{"synth", "scene", "none.toml", "-o", "a.mp4"}, 1},
      {{"store", "export", store, "none", "-o", "a.mkv"}, 1},
      {{"ingest", "new.store", "none.mp4"}, 1}};
  for (const auto& [words, code] : runs) {
    const Outcome outcome = folder.freshet(words);
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
}

TEST(CommandLine, WithoutAStoreTheStarterStoreIsTakenWhichTheCacheHas) {
  const WorkFolder folder;
  // A name alone is the picture: before a store is made, it has to be there.
  const Outcome missing = folder.freshet({"query", "candidates", "no.png"});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_TRUE(holds(missing.err, "no.png: there is no such file")) << missing.err;
  const std::vector<std::string> search{"query", "candidates", sample().still, "--matte", sample().matte};
  const Outcome homeless = folder.freshet_after("unset HOME XDG_CACHE_HOME", search);
  EXPECT_EQ(homeless.exit_code, 2);
  EXPECT_TRUE(holds(homeless.err, "neither XDG_CACHE_HOME nor HOME is set. Name a store")) << homeless.err;
  // The store that is kept under the recipe's name is used as it is.
  const std::string name = starter::kept_name("freshet", starter::own_recipe()).string();
  fs::create_directories(folder / "cache/freshet");
  fs::copy_file(sample().store, folder / ("cache/" + name));
  const Outcome found = folder.freshet_after("XDG_CACHE_HOME=$PWD/cache; export XDG_CACHE_HOME", search);
  EXPECT_EQ(found.exit_code, 0) << found.err;
  EXPECT_TRUE(holds(found.out, "fall/1.mkv")) << found.out;
}

TEST(CommandLine, AStarterStoreIsMadeOfARecipeOfOnesOwn) {
  const WorkFolder folder;
  folder.file("tiny.toml",
              "size = [96, 96]\nframes = 9\n[[clip]]\nname = \"fire/small\"\nclip = \"fire\"\nspeed = 2\n");
  const std::vector<std::string> make{"store", "starter", "--recipe", "tiny.toml", "-o", "deep/tiny.store"};
  const Outcome made = folder.freshet(make);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.out, "deep/tiny.store\n");
  EXPECT_TRUE(holds(folder.freshet({"store", "info", "deep/tiny.store"}).out, "fire/small"));
  EXPECT_EQ(folder.freshet(make).exit_code, 2) << "it is there";
  EXPECT_EQ(folder.freshet({"store", "starter"}).exit_code, 2);
  EXPECT_TRUE(holds(folder.freshet({"store", "starter", "--print-recipe"}).out, "name = \"fire/camp fire\""));
}

TEST(CommandLine, SettingsThatDoNotGoTogetherLeaveNoStoreBehind) {
  const WorkFolder folder;
  const auto expect_refusal = [&](const std::vector<std::string>& settings, const std::string& part) {
    std::vector<std::string> arguments{"ingest", "a.store", sample().clips};
    arguments.insert(arguments.end(), settings.begin(), settings.end());
    const Outcome outcome = folder.freshet(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_TRUE(holds(outcome.err, part)) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "a.store"));
  };
  expect_refusal({"--cell", "1"}, "Add --flow-step 1");
  expect_refusal({"--cell", "8", "--stride", "12"}, "--cell 8 --stride 12");
  expect_refusal({"--cell", "8", "--patch", "40"}, "--cell 8 --stride 20");
  expect_refusal({"--patch", "24", "--stride", "48"}, "multiple of 4 px, from 8 to 24");
  expect_refusal({"--stride", "14"}, "multiple of 4 px, from 12 to 48");
}

TEST(CommandLine, SaysSoWhenMemoryDoesNotSuffice) {
  const Outcome outcome = WorkFolder().freshet_after(
      "ulimit -v 700000",
      {"synth", "simulate", "clouds", "--size", "4096x4096", "--frames", "1", "-j", "1", "-o", "x.png"});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_TRUE(holds(outcome.err, "not enough memory")) << outcome.err;
}

TEST(CommandLine, AConfigurationFileSaysWhatFlagsSay) {
  const WorkFolder folder;
  const auto file = folder.file("a.toml", "[query.label]\nclass = \"fall\"\nframes = 16\nsolver = \"icm\"\n");
  const std::vector<std::string> label{"query", "label", sample().store, sample().still, "-o"};
  const auto run = [&](const std::string& out, const std::vector<std::string>& before,
                       const std::vector<std::string>& after) {
    std::vector<std::string> arguments = before;
    arguments.insert(arguments.end(), label.begin(), label.end());
    arguments.push_back(out);
    arguments.insert(arguments.end(), after.begin(), after.end());
    const Outcome outcome = folder.freshet(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return text_of(folder / out);
  };
  const std::string by_flags =
      run("flags.json", {}, {"--class", "fall", "--frames", "16", "--solver", "icm"});
  ASSERT_FALSE(by_flags.empty());
  EXPECT_EQ(run("before.json", {"--config", "a.toml"}, {}), by_flags);
  EXPECT_EQ(run("behind.json", {}, {"--config", "a.toml"}), by_flags);
  // A flag is stronger than the file.
  EXPECT_NE(run("stronger.json", {"--config", "a.toml"}, {"--solver", "trw-s"}), by_flags);
}

TEST(CommandLine, AConfigurationFileWithAMistakeIsNotPassedOver) {
  const WorkFolder folder;
  folder.file("misspelt.toml", "[query.label]\nframs = 16\n");
  folder.file("broken.toml", "[query.label\nframes = 16\n");
  for (const char* name : {"misspelt.toml", "broken.toml", "missing.toml"}) {
    const Outcome outcome = folder.freshet({"--config", name, "store", "digest", sample().store});
    EXPECT_EQ(outcome.exit_code, 2) << name;
    EXPECT_TRUE(holds(outcome.err, name)) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
  const Outcome outcome = folder.freshet({"--config", "misspelt.toml", "store", "digest", sample().store});
  EXPECT_TRUE(holds(outcome.err, "query.label.frams")) << outcome.err;
}

TEST(CommandLine, ResultsGoToStdoutAndMessagesToStderr) {
  const WorkFolder folder;
  const Outcome ingest = folder.freshet({"ingest", "a.store", sample().clips / "fall/1.mkv", "--json"});
  ASSERT_EQ(ingest.exit_code, 0) << ingest.err;
  EXPECT_EQ(nlohmann::json::parse(ingest.out)["clips"][0]["outcome"], "added");
  EXPECT_TRUE(holds(ingest.err, "freshet: index: "));
  const Outcome label =
      folder.freshet({"query", "label", "a.store", sample().still, "--frames", "16", "--json"});
  ASSERT_EQ(label.exit_code, 0) << label.err;
  EXPECT_TRUE(nlohmann::json::accept(label.out));
  EXPECT_TRUE(holds(label.err, "searching candidates"));
}

}  // namespace
}  // namespace freshet::tools
