// synth/toml/keys.h — the keys of a table as rows: what reads them and what explains them walks the same ones.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "synth/toml/section.h"

namespace freshet::synth {

/// One of some words. set   told the place of the one that was given.
template <class Object>
struct Words {
  std::vector<std::string> words;
  void (*set)(Object&, std::size_t);
};
/// A key that reads itself.
template <class Object>
using ReadKey = void (*)(Section&, Object&);

/// Where a key's value goes. Nothing: another row reads it too, and this one explains it.
template <class Object>
using KeyField =
    std::variant<std::monostate, double Object::*, float Object::*, int Object::*, std::uint64_t Object::*,
                 std::optional<double> Object::*, std::optional<int> Object::*, std::optional<bool> Object::*,
                 bool Object::*, std::string Object::*, std::filesystem::path Object::*,
                 std::vector<std::string> Object::*, Words<Object>, ReadKey<Object>>;

/// Of a key without which the table says nothing.
inline constexpr std::string_view kNeeded = "needed";

/// A row.
template <class Object>
struct Key {
  const char* name;
  KeyField<Object> field;
  Range range;                  // of numbers
  const char* unit;             // empty: none
  const char* help;             // what it is, and what more of it does
  std::string_view usual = {};  // kNeeded, or what holds without it in words; empty: the field's own value
  std::optional<Range> slider = {};  // the part of the range in which one looks first; nothing: all of it
};

/// Reads the keys that the table has. needed   where to read of them, for who left out one that is needed.
template <class Object>
void read_keys(Section& section, const std::vector<Key<Object>>& keys, Object& object,
               const std::string& needed) {
  for (const Key<Object>& key : keys)
    std::visit(
        [&](const auto& field) {
          using Field = std::decay_t<decltype(field)>;
          if constexpr (std::is_same_v<Field, Words<Object>>) {
            if (const auto word = section.word(key.name, field.words)) field.set(object, *word);
          } else if constexpr (std::is_same_v<Field, ReadKey<Object>>) {
            field(section, object);
          } else if constexpr (!std::is_same_v<Field, std::monostate>) {
            section.read(key.name, object.*field, key.range);
          }
          if (key.usual == kNeeded && !section.has(key.name))
            section.refuse_whole(fmt::format("it needs {}", key.name), needed);
        },
        key.field);
}

/// A row for a person.
struct KeyText {
  std::string name, usual, help;
};

namespace key_text {

inline std::string number(double value) { return fmt::format("{}", value); }

/// What holds without the key.
template <class Object>
std::string usual(const Key<Object>& key, const Object& object) {
  if (!key.usual.empty()) return key.usual == kNeeded ? std::string(kNeeded) : fmt::format("[{}]", key.usual);
  return std::visit(
      [&](const auto& field) -> std::string {
        using Field = std::decay_t<decltype(field)>;
        if constexpr (std::is_same_v<Field, double Object::*> || std::is_same_v<Field, float Object::*> ||
                      std::is_same_v<Field, int Object::*>)
          return number(object.*field);
        else if constexpr (std::is_same_v<Field, std::uint64_t Object::*>)
          return fmt::format("{}", object.*field);
        else if constexpr (std::is_same_v<Field, bool Object::*>)
          return object.*field ? "true" : "false";
        else if constexpr (std::is_same_v<Field, Words<Object>>)
          return field.words.front();
        else
          return "";
      },
      key.field);
}

template <class Object>
bool is_number(const KeyField<Object>& field) {
  return std::holds_alternative<double Object::*>(field) || std::holds_alternative<float Object::*>(field) ||
         std::holds_alternative<int Object::*>(field) ||
         std::holds_alternative<std::optional<double> Object::*>(field) ||
         std::holds_alternative<std::optional<int> Object::*>(field);
}

}  // namespace key_text

template <class Object>
std::vector<KeyText> key_texts(const std::vector<Key<Object>>& keys) {
  const Object object{};
  std::vector<KeyText> texts;
  for (const Key<Object>& key : keys) {
    std::string help;
    if (*key.unit != '\0') help = key.unit;
    if (key_text::is_number<Object>(key.field))
      help += fmt::format("{}{} to {}", help.empty() ? "" : ", ", key.range.low, key.range.high);
    if (const auto* words = std::get_if<Words<Object>>(&key.field))
      for (const std::string& word : words->words) help += (help.empty() ? "" : ", ") + word;
    texts.push_back({key.name, key_text::usual(key, object), help + (help.empty() ? "" : ": ") + key.help});
  }
  return texts;
}

/// Lines of at most 116 columns: name, what is usual, and the help, which goes on below itself.
std::string key_lines(const std::vector<KeyText>& keys);

/// What a number of the table may be, by its key.
struct KeyRange {
  std::string name;
  Range range, slider;
};
template <class Object>
std::vector<KeyRange> key_ranges(const std::vector<Key<Object>>& keys) {
  std::vector<KeyRange> ranges;
  for (const Key<Object>& key : keys)
    if (key_text::is_number<Object>(key.field))
      ranges.push_back({key.name, key.range, key.slider.value_or(key.range)});
  return ranges;
}

}  // namespace freshet::synth
