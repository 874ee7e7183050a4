#include "tools/synth/sweep_point.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string_view>

#include <fmt/format.h>

#include "freshet/error.h"
#include "tools/console/numbers.h"

namespace freshet::tools {
namespace {

[[noreturn]] void refuse(const std::string& text, const std::string& fault, const std::string& remedy) {
  throw Error(ErrorKind::kUsage, "--vary " + text, fault, remedy);
}

bool is_flag(const CLI::Option& option) { return option.get_expected_max() == 0; }
bool takes_several(const CLI::Option& option) { return option.get_expected_max() > 1; }

/// Parts of a text between separators; a backslash takes the character after it as it stands.
std::vector<std::string> parts_of(const std::string& text, char separator, bool keep_backslashes) {
  std::vector<std::string> parts{""};
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == separator) {
      parts.emplace_back();
      continue;
    }
    if (text[i] == '\\' && i + 1 < text.size()) {
      if (keep_backslashes) parts.back() += text[i];
      ++i;
    }
    parts.back() += text[i];
  }
  return parts;
}

/// The words that give an option this value.
std::vector<std::string> words_of(const CLI::Option& option, const std::string& value) {
  if (value == kWithout) return {};
  std::vector<std::string> words;
  for (const std::string& part : parts_of(value, takes_several(option) ? '+' : '\0', false))
    words.push_back(option.get_name() + "=" + part);
  return words;
}

/// The words of a command line that was parsed, for options that `known` has too.
std::vector<std::string> given_words(const CLI::App& given, const CLI::App& known) {
  std::vector<std::string> words;
  for (const CLI::Option* option : given.get_options()) {
    if (option->count() == 0 || known.get_option_no_throw(option->get_name()) == nullptr) continue;
    for (const std::string& value : option->results())
      words.push_back(option->get_positional() ? value : option->get_name() + "=" + value);
  }
  return words;
}

std::string quoted(const std::string& word) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("-_=./,:+%#@").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::ranges::all_of(word, plain) && word.front() != '#') return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// One form of a value that can be written in several.
std::string plain_value(const std::string& value) {
  double number = 0;
  const auto [end, fault] = std::from_chars(value.data(), value.data() + value.size(), number);
  return fault == std::errc() && end == value.data() + value.size() ? fmt::format("{}", number) : value;
}

}  // namespace

void add_varied_to(CLI::App& app, AnimateCommand& command) {
  command.add_to(app);
  for (const char* name : {"--output", "--sheet", "--credits", "--json", "--takes", "--draw", "--speed-out",
                           "--orientation-out", "--matte-out", "--motion-out"})
    app.remove_option(app.get_option(name));
}

SweepAxis parse_axis(const std::string& text, const CLI::App& animate) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos)
    refuse(text, "no \"=\"", "Write an option and its values, for example --vary speed=0.5,1,2");
  SweepAxis axis{.name = text.substr(0, equals), .description = {}, .values = {}, .words = {}};
  const CLI::Option* const option =
      axis.name.empty() || axis.name == "store" ? nullptr : animate.get_option_no_throw("--" + axis.name);
  if (option == nullptr)
    refuse(text, fmt::format("freshet synth animate has no option --{} that can be varied", axis.name),
           "freshet synth animate --help-all explains those that there are");
  axis.description = option->get_description();
  for (const std::string& value : parts_of(text.substr(equals + 1), ',', true)) {
    if (value.empty())
      refuse(text, "a value is missing",
             fmt::format("Write values with a comma between two; {} is the option left out", kWithout));
    if (std::ranges::find(axis.values, value) != axis.values.end())
      refuse(text, fmt::format("{} is given twice", value), "Give each value once");
    axis.values.push_back(value);
    axis.words.push_back(words_of(*option, value));
  }
  return axis;
}

SweepPoint::SweepPoint(std::vector<std::pair<std::string, std::string>> settings,
                       std::vector<std::string> words, const std::string& output)
    : settings_(std::move(settings)),
      words_(std::move(words)),
      app_(std::make_unique<CLI::App>("", "animate")),
      command_(std::make_unique<AnimateCommand>()) {
  command_->add_to(*app_);
  std::vector<std::string> all(words_.rbegin(), words_.rend());
  all.insert(all.begin(), "--output=" + output);
  try {
    app_->parse(all);
  } catch (const CLI::ParseError& fault) {
    refuse(title(), fault.what(), "freshet synth animate --help-all explains its options");
  }
  refuse_non_numbers(*app_);
  command_->output.add_ending();
}

std::string SweepPoint::title() const {
  std::string text;
  for (const auto& [name, value] : settings_) {
    if (!text.empty()) text += ", ";
    text += value == kWithout ? "without " + name : name + " " + value;
  }
  return text;
}

std::string SweepPoint::command_line() const {
  std::string text = "freshet synth animate";
  for (const std::string& word : words_) text += " " + quoted(word);
  return text + " -o " + quoted(command_->output.name());
}

std::vector<std::string> SweepPoint::rendering_words() const {
  CLI::App choosing;
  AnimateCommand of_choosing;
  of_choosing.add_choosing_to(choosing);
  std::vector<std::string> words;
  for (const CLI::Option* option : app_->get_options()) {
    const std::string name = option->get_name();
    if (choosing.get_option_no_throw(name) != nullptr || name == "--output" || name == "--overwrite")
      continue;
    if (is_flag(*option)) {
      words.push_back(name + (option->count() > 0 && option->as<bool>() ? "=true" : "=false"));
      continue;
    }
    if (option->count() == 0) words.push_back(name + "=" + plain_value(option->get_default_str()));
    for (const std::string& value : option->results()) words.push_back(name + "=" + plain_value(value));
  }
  return words;
}

std::vector<SweepPoint> make_points(const std::vector<SweepAxis>& axes, const CLI::App& given,
                                    const std::string& folder, bool a_folder_each) {
  std::size_t count = 1;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::string& name = axes[i].name;
    if (std::any_of(axes.begin(), axes.begin() + static_cast<std::ptrdiff_t>(i),
                    [&](const SweepAxis& before) { return before.name == name; }))
      refuse(name, "it is varied twice", "Give all of its values at once, with a comma between two");
    if (given.count("--" + name) > 0)
      refuse(name, fmt::format("--{} is given for all, too", name), "Leave one of the two out");
    count *= axes[i].values.size();
    if (count > kMaxPoints)
      refuse(name,
             fmt::format("that makes {} animations or more; {} at most are made at once", count, kMaxPoints),
             "Vary less at a time");
  }
  CLI::App known;
  AnimateCommand options;
  add_varied_to(known, options);
  const std::vector<std::string> shared = given_words(given, known);
  std::vector<SweepPoint> points;
  for (std::size_t number = 0; number < count; ++number) {
    std::vector<std::pair<std::string, std::string>> settings(axes.size());
    std::vector<std::string> words = shared;
    std::size_t rest = number;
    for (std::size_t i = axes.size(); i-- > 0; rest /= axes[i].values.size()) {
      const std::size_t value = rest % axes[i].values.size();
      settings[i] = {axes[i].name, axes[i].values[value]};
      words.insert(words.end(), axes[i].words[value].begin(), axes[i].words[value].end());
    }
    const std::string name = number_of(number);
    points.emplace_back(std::move(settings), std::move(words),
                        folder + "/" + (a_folder_each ? name + "/" : "") + name);
  }
  return points;
}

std::string number_of(std::size_t point) { return fmt::format("{:02}", point + 1); }

}  // namespace freshet::tools
