#include "tests/faults/command_tree.h"

#include <optional>
#include <regex>
#include <sstream>

namespace freshet::tools {
namespace {

/// The text between brackets that follows a type, split at commas.
std::vector<std::string> choices_of(const std::string& text) {
  std::vector<std::string> choices(1);
  for (const char c : text)
    if (c == ',')
      choices.emplace_back();
    else
      choices.back() += c;
  return choices;
}

/// What a line of --help says of an option: "  --fps FLOAT:FLOAT in [1 - 240]=25   Frames ...".
std::optional<Option> parse_option(const std::string& line) {
  static const std::regex kOption(R"(^  (?:-\w,)?(--[a-z][a-z-]*)( (.*))?$)"),
      kRange(R"((INT|FLOAT|UINT) in \[([-+.\de]+) - ([-+.\de]+)\])"), kChoice(R"(^[A-Z]+:\{([^}]*)\})");
  std::smatch found;
  if (!std::regex_match(line, found, kOption)) return std::nullopt;
  Option option{.name = found[1]};
  const std::string rest = found[3];
  const std::string type = rest.substr(0, rest.find("   "));
  if (option.name.starts_with("--help")) return std::nullopt;
  if (std::smatch range; std::regex_search(type, range, kRange)) {
    const bool whole = range[1] != "FLOAT";
    option.good = {range[2], range[3]};
    option.bad = {
        "nan", "x", "1e999", "-1e18", whole ? "1.5" : "inf", whole ? "99999999999999999999" : "-inf"};
    if (type.find("OR") != std::string::npos) option.good.clear();
  } else if (std::smatch choice; std::regex_search(type, choice, kChoice)) {
    option.good = choices_of(choice[1]);
    option.bad = {"nonsense", "nan", "-1"};
  } else if (type.starts_with("FLOAT") || type.starts_with("INT") || type.starts_with("UINT")) {
    option.good = {"0", "1"};
    option.bad = {"nan", "x", "-1"};
  } else if (rest.empty() || rest[0] == ' ' || type.starts_with("Excludes")) {
    option.is_flag = true;
  }  // else a text: what is right, only the command knows
  return option;
}

/// Of a command, or of the program where there is none.
Outcome help_of(const Campaign& c, const std::string& command, const char* kind) {
  std::vector<std::string> words = words_of(command);
  words.emplace_back(kind);
  return c.run(words);
}

}  // namespace

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::vector<std::string> commands_of(const Campaign& c) {
  std::vector<std::string> found, open{""};
  while (!open.empty()) {
    const std::string command = open.front();
    open.erase(open.begin());
    const Outcome help = help_of(c, command, "--help");
    EXPECT_EQ(help.exit_code, 0) << command << help.err;
    std::vector<std::string> below;
    bool listed = false;
    for (const std::string& line : lines_of(help.out)) {
      if (line.empty() || line.front() != ' ') listed = line == "Subcommands:" || (listed && line.empty());
      if (listed && line.starts_with("  ") && line.size() > 2 && line[2] != ' ')
        below.push_back((command.empty() ? "" : command + " ") + words_of(line).front());
    }
    if (below.empty()) found.push_back(command);
    open.insert(open.begin(), below.begin(), below.end());
  }
  return found;
}

std::vector<Option> options_of(const Campaign& c, const std::string& command) {
  Outcome help = help_of(c, command, "--help-all");
  if (help.exit_code != 0) help = help_of(c, command, "--help");
  EXPECT_EQ(help.exit_code, 0) << command;
  std::vector<Option> options;
  for (const std::string& line : lines_of(help.out))
    if (auto option = parse_option(line)) options.push_back(std::move(*option));
  return options;
}

}  // namespace freshet::tools
