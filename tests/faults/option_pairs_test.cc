// Every option with nonsense and extremes, alone and in pairs: a message that names it, never a crash and never
// silence. The options are those that each command's own --help lists, with the types and ranges that it gives.

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <csignal>
#include <iostream>
#include <map>
#include <random>

#include "tests/faults/campaign.h"
#include "tests/faults/command_tree.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

struct Command {
  std::string help;                // "synth animate"
  std::vector<std::string> words;  // that run it, with what it cannot do without
  std::vector<Option> options;     // but for those among the words
};

/// What a command cannot do without.
const std::map<std::string, std::string> kNeeded{
    {"ingest", "new.store clip1.mkv"},
    {"index", "f.store"},
    {"store info", "f.store"},
    {"store verify", "f.store"},
    {"store digest", "f.store"},
    {"store framemd5", "f.store clip1.mkv"},
    {"store page", "f.store -o out.html"},
    {"store export", "f.store clip1.mkv -o out.mkv"},
    {"store compact", "f.store"},
    {"store remove", "f.store clip1.mkv"},
    {"store merge", "one.store rest.store -o new.store"},
    {"store repair", "f.store -o new.store"},
    {"store starter", "--recipe recipe.toml -o new.store"},
    {"query candidates", "f.store still.png --whole"},
    {"query label", "f.store still.png --whole"},
    {"query kind", "still.png"},
    {"query bench", "f.store"},
    {"synth animate", "f.store still.png --whole -o out.mkv"},
    {"synth sweep", "f.store still.png --whole --vary tau=0,1 -o sweep"},
    {"synth judge", "clip1.mkv still.png --whole"},
    {"synth matte", "still.png -o matte.png"},
    {"synth simulate", "river -o out.mkv"},
    {"synth stills", "stills -o out.mkv"},
    {"synth transfer", "--exemplar still.png -o out.mkv"},
    {"synth scene", "scene.toml -o out.mkv"},
    {"synth layers", "scene.toml -o out.ora"},
    {"synth flowlines", "clip1.mkv -o out.mkv"},
    {"synth tour", "clip1.mkv -o out.mkv"},
    {"work", "--queue nats://127.0.0.1:1 --status"},
    {"studio", "--folder projects --no-browser --no-starter"}};

/// All commands of the executable, as its help lists them.
const std::vector<Command>& commands(const Campaign& c) {
  static const std::vector<Command> all = [&] {
    std::vector<Command> found;
    for (const std::string& name : commands_of(c)) {
      const auto needed = kNeeded.find(name);
      EXPECT_NE(needed, kNeeded.end()) << name << ": say what it cannot do without";
      if (needed == kNeeded.end()) continue;
      Command command{name, words_of(name + " " + needed->second), options_of(c, name)};
      EXPECT_FALSE(command.options.empty()) << name;
      std::erase_if(command.options, [&](const Option& option) {
        return option.name == "--overwrite" ||
               std::ranges::find(command.words, option.name) != command.words.end();
      });
      found.push_back(std::move(command));
    }
    return found;
  }();
  return all;
}

const Command& command_named(const Campaign& c, const std::string& name) {
  return *std::ranges::find(commands(c), name, &Command::help);
}

/// One case: some options and their values.
struct Case {
  const Command* command;
  std::vector<std::pair<std::string, std::string>> options;
  std::vector<std::string> refused;  // one of these options must be named; empty: whatever the command says
};

std::string text_of_case(const Case& one) {
  std::string text = one.command->help;
  for (const auto& [name, value] : one.options) text.append(" ").append(name).append(" ").append(value);
  return text;
}

/// What is wrong with the answer; empty when it is right.
std::string judge_case(const Campaign& c, const Case& one, int seconds) {
  c.begin_with("indexed.store", "f.store");
  for (const char* name :
       {"new.store", "new.store-lock", "out.mkv", "out.ora", "matte.png", "sweep", "nonsense", "projects"})
    fs::remove_all(c.folder / name);
  // SIGINT first: a run of valid options may take its time, and is then stopped in order.
  std::vector<std::string> words = one.command->words;
  for (const auto& [name, value] : one.options) words.push_back(value.empty() ? name : name + "=" + value);
  const Outcome outcome = c.run_for({.seconds = static_cast<double>(seconds)}, words);
  if (outcome.signal == SIGALRM) return "it hung";
  if (outcome.exit_code == 130 || outcome.signal == SIGINT)
    return one.refused.empty() ? "" : "it was not refused";
  if (outcome.signal != 0 || outcome.exit_code < 0 || outcome.exit_code > 3)
    return "it died, " + std::to_string(outcome.exit_code) + ": " + outcome.err;
  if (outcome.err.find("unexpected") != std::string::npos) return outcome.err;
  if (outcome.exit_code != 0 && outcome.err.find("freshet: ") == std::string::npos) return "it says nothing";
  if (outcome.err.find("freshet: : ") != std::string::npos) return "it names nothing: " + outcome.err;
  if (one.refused.empty()) return "";
  if (outcome.exit_code != 2)
    return "it was not refused, " + std::to_string(outcome.exit_code) + ": " + outcome.err;
  const bool named = std::ranges::any_of(
      one.refused, [&](const std::string& name) { return outcome.err.find(name) != std::string::npos; });
  return named ? "" : "it does not name the option: " + outcome.err;
}

/// Each option alone with each of its bad values, or with one of them.
std::vector<Case> single_cases(const Command& command, bool all, std::mt19937& random) {
  std::vector<Case> cases;
  for (const Option& option : command.options) {
    if (option.bad.empty()) continue;
    const std::size_t first = random() % option.bad.size();
    for (std::size_t i = 0; i < (all ? option.bad.size() : 1); ++i)
      cases.push_back(
          {&command, {{option.name, option.bad[(first + i) % option.bad.size()]}}, {option.name}});
  }
  return cases;
}

/// Cases that hold every pair of two options' values at least once, as few as a greedy choice finds. A value is the
/// low end, the high end, or "-" for an option that is not given; a text is nonsense.
std::vector<Case> pair_cases(const Command& command, std::mt19937& random) {
  const std::vector<Option>& options = command.options;
  std::vector<std::vector<std::string>> values;  // "-": not given
  for (const Option& option : options) {
    values.push_back({"-"});
    if (option.is_flag)
      values.back().emplace_back("");
    else if (!option.good.empty()) {
      values.back().push_back(option.good.front());
      if (option.good.size() > 1) values.back().push_back(option.good.back());
    } else {
      values.back().emplace_back("nonsense");
    }
  }
  const std::size_t n = values.size();
  std::set<std::array<std::size_t, 4>> open;  // option, value, option, value
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b)
      for (std::size_t i = 0; i < values[a].size(); ++i)
        for (std::size_t j = 0; j < values[b].size(); ++j) open.insert({a, i, b, j});
  std::vector<Case> cases;
  while (!open.empty()) {
    std::vector<std::size_t> chosen(n), best;
    std::size_t most = 0;
    for (int attempt = 0; attempt < 12; ++attempt) {
      for (std::size_t a = 0; a < n; ++a) chosen[a] = random() % values[a].size();
      if (attempt % 2 == 0) {  // around a pair that is still open
        const auto& [a, i, b, j] = *open.begin();
        chosen[a] = i;
        chosen[b] = j;
      }
      std::size_t covers = 0;
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = a + 1; b < n; ++b) covers += open.contains({a, chosen[a], b, chosen[b]}) ? 1 : 0;
      if (covers > most) {
        most = covers;
        best = chosen;
      }
    }
    Case one{&command, {}, {}};
    for (std::size_t a = 0; a < n; ++a) {
      if (values[a][best[a]] != "-") one.options.emplace_back(options[a].name, values[a][best[a]]);
      for (std::size_t b = a + 1; b < n; ++b) open.erase({a, best[a], b, best[b]});
    }
    cases.push_back(std::move(one));
  }
  return cases;
}

/// A picture, a folder of stills, and a scene.
void make_still(const Campaign& c) {
  cv::Mat still(96, 96, CV_8UC3);
  cv::randu(still, 0, 255);
  cv::imwrite((c.folder / "still.png").string(), still);
  fs::create_directories(c.folder / "stills");
  for (int i = 0; i < 4; ++i) {
    cv::Mat moved = still.clone();
    cv::circle(moved, {20 + 18 * i, 48}, 10, cv::Scalar::all(250), cv::FILLED);
    cv::imwrite((c.folder / "stills" / (std::to_string(i) + ".png")).string(), moved);
  }
  fs::remove(c.folder / "scene.toml");
  EXPECT_EQ(c.run({"synth", "scene", "--init", "still.png", "-o", "scene.toml"}).exit_code, 0);
}

TEST(OptionPairs, NonsenseIsRefusedByName) {
  const Campaign& c = campaign();
  make_still(c);
  std::mt19937 random(19);
  std::size_t cases = 0;
  for (const Command& command : commands(c)) {
    std::vector<Case> all = single_cases(command, at_full_length(), random);
    if (!at_full_length()) {  // of options that several commands share, each command tries others
      std::ranges::shuffle(all, random);
      all.resize(std::min<std::size_t>(all.size(), 7));
    }
    for (const Case& one : all) {
      EXPECT_EQ(judge_case(c, one, 60), "") << text_of_case(one);
      ++cases;
    }
  }
  std::cout << cases << " cases\n";
  EXPECT_GT(cases, 50u);
}

TEST(OptionPairs, ExtremesInPairsAreDoneOrRefused) {
  const Campaign& c = campaign();
  make_still(c);
  std::mt19937 random(23);
  std::size_t tried = 0, all = 0;
  for (const Command& command : commands(c)) {
    std::vector<Case> cases = pair_cases(command, random);
    all += cases.size();
    if (!at_full_length()) cases.resize(std::min<std::size_t>(cases.size(), 2));
    for (const Case& one : cases) {
      EXPECT_EQ(judge_case(c, one, at_full_length() ? 20 : 2), "") << text_of_case(one);
      ++tried;
    }
  }
  std::cout << tried << " of " << all << " cases\n";
}

TEST(OptionPairs, AnOptionThatIsIgnoredIsSeen) {
  const Campaign& c = campaign();
  make_still(c);
  const Command& verify = command_named(c, "store verify");
  // Planted: a value that is right is said to be wrong, and one that nobody knows not to be named.
  EXPECT_NE(judge_case(c, {&verify, {{"--threads", "1"}}, {"--threads"}}, 20), "");
  EXPECT_NE(judge_case(c, {&verify, {{"--threads", "nan"}}, {"--nothing"}}, 20), "");
  EXPECT_EQ(judge_case(c, {&verify, {{"--threads", "nan"}}, {"--threads"}}, 20), "");
}

}  // namespace
}  // namespace freshet::tools
