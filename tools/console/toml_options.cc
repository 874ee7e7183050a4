#include "tools/console/toml_options.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include "freshet/error.h"

namespace freshet::tools {
namespace {

[[noreturn]] void refuse(const std::string& fault) {
  throw Error(ErrorKind::kUsage, "--config", fault, "Give a TOML file with a table for each command");
}

/// A NUL would cut a path, or a message, short there.
const std::string& without_nul(const std::string& text, const toml::node& value) {
  if (text.find('\0') != std::string::npos)
    refuse(fmt::format("the text in line {} has a NUL (\\u0000)", value.source().begin.line));
  return text;
}

std::string text_of(const toml::node& value, const std::string& name) {
  if (const auto* text = value.as_string()) return without_nul(text->get(), value);
  if (const auto* number = value.as_integer()) return fmt::format("{}", number->get());
  if (const auto* number = value.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* flag = value.as_boolean()) return flag->get() ? "true" : "false";
  refuse(fmt::format("\"{}\" in line {} is no value that an option takes", name, value.source().begin.line));
}

void take(const toml::table& table, const std::vector<std::string>& parents,
          std::vector<CLI::ConfigItem>& items) {
  for (const auto& [key, value] : table) {
    const std::string name = without_nul(std::string(key.str()), value);
    if (const toml::table* below = value.as_table()) {
      std::vector<std::string> path = parents;
      path.push_back(name);
      take(*below, path, items);
      continue;
    }
    CLI::ConfigItem item;
    item.parents = parents;
    item.name = name;
    if (const toml::array* list = value.as_array())
      for (const toml::node& each : *list) item.inputs.push_back(text_of(each, name));
    else
      item.inputs.push_back(text_of(value, name));
    items.push_back(std::move(item));
  }
}

}  // namespace

std::vector<CLI::ConfigItem> TomlOptions::from_config(std::istream& stream) const {
  std::vector<CLI::ConfigItem> found;
  try {
    take(toml::parse(stream), {}, found);
  } catch (const toml::parse_error& fault) {
    refuse(fmt::format("{}, line {}: {}", app_.get_config_ptr()->as<std::string>(), fault.source().begin.line,
                       fault.description()));
  }
  return found;
}

}  // namespace freshet::tools
