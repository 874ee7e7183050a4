#include "synth/toml/section.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "freshet/error.h"
#include "platform/printable.h"
#include "platform/text_file.h"

namespace freshet::synth {
namespace {

constexpr std::size_t kMaxFileBytes = 4u << 20, kDeepest = 32;
constexpr std::size_t kMaxKnots = 10000, kMaxTexts = 256;
constexpr double kFar = 1e6;

std::string kind_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::string:
      return "the text \"" + printable(node.ref<std::string>()) + "\"";
    case toml::node_type::integer:
      return fmt::format("{}", node.ref<std::int64_t>());
    case toml::node_type::floating_point:
      return fmt::format("{}", node.ref<double>());
    case toml::node_type::boolean:
      return node.ref<bool>() ? "true" : "false";
    default:
      return "a date";
  }
}

}  // namespace

void Section::refuse(const toml::node& at, const std::string& key, const std::string& fault,
                     const std::string& remedy) const {
  const std::string where = name_.empty() || key.empty() ? name_ + key : name_ + "." + key;
  throw Error(ErrorKind::kInput, fmt::format("{}:{}", file_->string(), at.source().begin.line),
              where.empty() ? fault : where + ": " + fault, remedy);
}

void Section::refuse(const std::string& key, const std::string& fault, const std::string& remedy) const {
  const toml::node* const node = table_->get(key);
  refuse(node != nullptr ? *node : *table_, key, fault, remedy);
}

void Section::refuse_whole(const std::string& fault, const std::string& remedy) const {
  refuse(*table_, "", fault, remedy);
}

const toml::node* Section::find(const std::string& key) {
  known_.push_back(key);
  return table_->get(key);
}

double Section::number(const toml::node& node, const std::string& key, Range range) const {
  const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
  if (!value) refuse(node, key, fmt::format("a number is expected, not {}", kind_of(node)));
  if (!(*value >= range.low && *value <= range.high))
    refuse(node, key, fmt::format("{} is out of range", *value),
           fmt::format("Give {} to {}", range.low, range.high));
  return *value;
}

void Section::expect_whole(const toml::node& node, const std::string& key) const {
  if (!node.is_integer()) refuse(node, key, fmt::format("a whole number is expected, not {}", kind_of(node)));
}

void Section::read(const std::string& key, bool& value, Range) { value = flag(key, value); }

void Section::read(const std::string& key, std::string& value, Range) {
  if (const std::optional<std::string> given = text(key)) value = *given;
}

void Section::read(const std::string& key, std::filesystem::path& value, Range) {
  if (const std::optional<std::string> name = text(key)) value = beside(*name);
}

void Section::read(const std::string& key, std::vector<std::string>& value, Range) {
  if (find(key) != nullptr) value = texts(key);
}

bool Section::read(const std::string& key, Vec2& value, Range range) {
  const toml::node* node = find(key);
  if (node != nullptr) value = pair(*node, key, range);
  return node != nullptr;
}

void Section::read(const std::string& key, Rgb& value) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const std::vector<double> v = numbers(*node, key, 3, {0.0, 4.0});
  value = {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

std::optional<std::string> Section::text(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_string())
    refuse(*node, key, fmt::format("text in quotes is expected, not {}", kind_of(*node)));
  return node->ref<std::string>();
}

std::optional<std::size_t> Section::word(const std::string& key, const std::vector<std::string>& words) {
  const std::optional<std::string> given = text(key);
  if (!given) return std::nullopt;
  const auto at = std::find(words.begin(), words.end(), *given);
  if (at == words.end())
    refuse(*table_->get(key), key, fmt::format("\"{}\" is not known", *given),
           fmt::format("Choose one of {}", fmt::join(words, ", ")));
  return static_cast<std::size_t>(at - words.begin());
}

bool Section::flag(const std::string& key, bool otherwise) {
  const toml::node* node = find(key);
  if (node == nullptr) return otherwise;
  if (!node->is_boolean())
    refuse(*node, key, fmt::format("true or false is expected, not {}", kind_of(*node)));
  return node->ref<bool>();
}

std::vector<double> Section::numbers(const toml::node& node, const std::string& key, std::size_t count,
                                     Range range) const {
  const toml::array* list = node.as_array();
  if (list == nullptr || list->size() != count)
    refuse(node, key,
           fmt::format("a list of {} numbers is expected, not {}", count,
                       list != nullptr ? fmt::format("one of {}", list->size()) : kind_of(node)));
  std::vector<double> values;
  for (const toml::node& each : *list) values.push_back(number(each, key, range));
  return values;
}

Vec2 Section::pair(const toml::node& node, const std::string& key, Range range) const {
  const std::vector<double> values = numbers(node, key, 2, range);
  return {static_cast<float>(values[0]), static_cast<float>(values[1])};
}

std::vector<std::string> Section::texts(const std::string& key) {
  std::vector<std::string> result;
  const toml::node* node = find(key);
  if (node == nullptr) return result;
  const toml::array* list = node->as_array();
  const auto is_text = [](const toml::node& each) { return each.is_string(); };
  if (list == nullptr || list->size() > kMaxTexts || !std::all_of(list->begin(), list->end(), is_text))
    refuse(*node, key, fmt::format("a list of texts is expected, not {}", kind_of(*node)));
  for (const toml::node& each : *list) result.push_back(each.ref<std::string>());
  return result;
}

std::vector<std::vector<double>> Section::rows(const std::string& key, std::size_t width, Range range) {
  std::vector<std::vector<double>> result;
  const toml::node* node = find(key);
  if (node == nullptr) return result;
  const toml::array* list = node->as_array();
  if (list == nullptr || list->empty() || list->size() > kMaxKnots)
    refuse(*node, key,
           fmt::format("a list of lists of {} numbers is expected, not {}", width, kind_of(*node)));
  if (list->front().is_number()) return {numbers(*node, key, width, range)};
  for (const toml::node& each : *list) result.push_back(numbers(each, key, width, range));
  return result;
}

std::vector<std::vector<double>> Section::knots(const toml::node& node, const std::string& key,
                                                std::size_t width, Range range) const {
  const toml::array* list = node.as_array();
  if (list == nullptr || list->empty() || list->size() > kMaxKnots)
    refuse(node, key,
           fmt::format("a list of 1 to {} lists [second, ...] is expected, not {}", kMaxKnots,
                       list != nullptr ? fmt::format("one of {}", list->size()) : kind_of(node)));
  std::vector<std::vector<double>> result;
  for (const toml::node& each : *list) {
    const toml::array* knot = each.as_array();
    if (knot == nullptr || knot->size() != width + 1)
      refuse(each, key, fmt::format("each knot is a list of {} numbers, the first its second", width + 1));
    std::vector<double> values{number((*knot)[0], key, {-kFar, kFar})};
    for (std::size_t i = 0; i < width; ++i) values.push_back(number((*knot)[i + 1], key, range));
    if (!result.empty() && !(values[0] > result.back()[0]))
      refuse(each, key, fmt::format("second {} does not come after {}", values[0], result.back()[0]));
    result.push_back(std::move(values));
  }
  return result;
}

std::optional<Section> Section::table(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_table())
    refuse(*node, key, fmt::format("a table [{}] is expected, not {}", key, kind_of(*node)));
  return Section(*file_, *node->as_table(), key);
}

std::vector<Section> Section::tables(const std::string& key, std::size_t most) {
  std::vector<Section> result;
  const toml::node* node = find(key);
  if (node == nullptr) return result;
  const toml::array* list = node->as_array();
  const auto is_table = [](const toml::node& each) { return each.is_table(); };
  if (list == nullptr || !std::all_of(list->begin(), list->end(), is_table))
    refuse(*node, key, fmt::format("tables are expected, each below [[{}]]", key));
  if (list->size() > most)
    refuse(*node, key, fmt::format("there are {}", list->size()), fmt::format("{} is the maximum", most));
  for (std::size_t i = 0; i < list->size(); ++i)
    result.emplace_back(*file_, *(*list)[i].as_table(),
                        fmt::format("{}{}{} {}", name_, name_.empty() ? "" : ".", key, i + 1));
  return result;
}

void Section::done() const {
  for (const auto& [key, node] : *table_) {
    const std::string name(key.str());
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    refuse(node, name, "no such key", fmt::format("There are {}", fmt::join(known_, ", ")));
  }
}

std::filesystem::path Section::beside(const std::string& name) const {
  const std::filesystem::path path(name);
  return path.is_relative() ? file_->parent_path() / path : path;
}

unsigned line_with_nul(const toml::node& node) {
  if (const toml::table* table = node.as_table())
    for (const auto& [key, below] : *table) {
      if (key.str().find('\0') != std::string_view::npos) return key.source().begin.line;
      if (const unsigned line = line_with_nul(below); line != 0) return line;
    }
  if (const toml::array* list = node.as_array())
    for (const toml::node& below : *list)
      if (const unsigned line = line_with_nul(below); line != 0) return line;
  const auto* const text = node.as_string();
  return text != nullptr && text->get().find('\0') != std::string::npos ? node.source().begin.line : 0;
}

TomlText::TomlText(std::string_view text, const std::filesystem::path& name, const std::string& remedy)
    : name_(name) {
  expect_nesting(toml_nesting(text), kDeepest, name.string(), remedy);
  try {
    table_ = toml::parse(text);
  } catch (const toml::parse_error& fault) {
    throw Error(ErrorKind::kInput, fmt::format("{}:{}", name.string(), fault.source().begin.line),
                fmt::format("it is not TOML: {}", fault.description()), remedy);
  }
  if (const unsigned line = line_with_nul(table_); line != 0)
    throw Error(ErrorKind::kInput, fmt::format("{}:{}", name.string(), line),
                "a text in it has a NUL (\\u0000)", "Remove it");
}

std::string toml_file_text(const std::filesystem::path& path, const std::string& remedy) {
  return read_text_file(path, kMaxFileBytes, remedy);
}

}  // namespace freshet::synth
