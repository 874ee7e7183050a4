#include "tools/options/as_printed.h"

#include <charconv>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "freshet/error.h"

namespace freshet::tools {
namespace {

std::optional<double> number_of(const std::string& text) {
  double number = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

bool same(const std::string& given, const std::string& printed) {
  const std::optional<double> a = number_of(given), b = number_of(printed);
  return a && b ? *a == *b : given == printed;
}

/// As it would be typed.
std::string typed(const PrintedValue& option) {
  return option.value == "true" ? option.name : option.name + " " + option.value;
}

}  // namespace

CLI::Option* AsPrinted::add_to(CLI::App& command, const std::string& paper,
                               std::vector<PrintedValue> options) {
  command_ = &command;
  options_ = std::move(options);
  std::vector<std::string> all;
  for (const PrintedValue& option : options_)
    if (option.value != "false") all.push_back(typed(option));
  return command.add_flag("--as-printed", asked_,
                          fmt::format("The method as {} prints it, whole: {}", paper, fmt::join(all, ", ")));
}

void AsPrinted::apply() const {
  if (!asked_) return;
  for (const PrintedValue& printed : options_) {
    CLI::Option* const option = command_->get_option(printed.name);
    if (option->count() == 0) {
      option->add_result(printed.value);
      option->run_callback();
    } else if (const std::string given = option->results().back(); !same(given, printed.value)) {
      throw Error(ErrorKind::kUsage, "--as-printed",
                  fmt::format("{} {} contradicts it: the paper prints {} ({})", printed.name, given,
                              printed.value, printed.where),
                  fmt::format("Leave {} out, or --as-printed", printed.name));
    }
  }
}

}  // namespace freshet::tools
