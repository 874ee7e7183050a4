// synth/toml/section.h — tables of a TOML file that a person edits, read so that every mistake is named.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <toml++/toml.h>

#include "synth/field/grid.h"
#include "synth/toml/range.h"

namespace freshet::synth {

/// One table of the file. Keys are asked for by name; done() refuses those that nobody asked for. It borrows the file's
/// path and table. All that it throws is an Error{kInput} "FILE:LINE: TABLE.KEY: FAULT. REMEDY".
class Section {
 public:
  Section(const std::filesystem::path& file, const toml::table& table, std::string name)
      : file_(&file), table_(&table), name_(std::move(name)) {}

  [[noreturn]] void refuse(const toml::node& at, const std::string& key, const std::string& fault,
                           const std::string& remedy = {}) const;
  /// The same of a key that was found.
  [[noreturn]] void refuse(const std::string& key, const std::string& fault,
                           const std::string& remedy = {}) const;
  [[noreturn]] void refuse_whole(const std::string& fault, const std::string& remedy = {}) const;

  /// The key's value; null when the table has none. The key is known from now on.
  const toml::node* find(const std::string& key);
  bool has(const std::string& key) const { return table_->get(key) != nullptr; }

  double number(const toml::node& node, const std::string& key, Range range) const;
  template <typename T>
  void read(const std::string& key, T& value, Range range) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    if (std::is_integral_v<T>) expect_whole(*node, key);
    value = static_cast<T>(number(*node, key, range));
  }
  template <typename T>
  void read(const std::string& key, std::optional<T>& value, Range range) {
    if (find(key) == nullptr) return;
    T found{};
    read(key, found, range);
    value = found;
  }
  bool read(const std::string& key, Vec2& value, Range range);
  void read(const std::string& key, Rgb& value);

  /// Values without a range. A path that the file names lies beside it.
  void read(const std::string& key, bool& value, Range);
  void read(const std::string& key, std::string& value, Range);
  void read(const std::string& key, std::filesystem::path& value, Range);
  void read(const std::string& key, std::vector<std::string>& value, Range);

  std::optional<std::string> text(const std::string& key);
  /// One of several words; its place among them.
  std::optional<std::size_t> word(const std::string& key, const std::vector<std::string>& words);
  bool flag(const std::string& key, bool otherwise);
  std::vector<double> numbers(const toml::node& node, const std::string& key, std::size_t count,
                              Range range) const;
  Vec2 pair(const toml::node& node, const std::string& key, Range range) const;
  /// A list of texts, at most 256; empty where the key is not there.
  std::vector<std::string> texts(const std::string& key);
  /// A list of lists, each of `width` numbers, or one such list alone.
  std::vector<std::vector<double>> rows(const std::string& key, std::size_t width, Range range);
  /// A list of lists, each of a time and `width` values; times must grow.
  std::vector<std::vector<double>> knots(const toml::node& node, const std::string& key, std::size_t width,
                                         Range range) const;

  std::optional<Section> table(const std::string& key);
  /// Of [[key]], at most `most`.
  std::vector<Section> tables(const std::string& key, std::size_t most = 64);

  /// Throws for a key that nobody asked for, and lists those there are.
  void done() const;

  const std::filesystem::path& file() const { return *file_; }
  /// A path that the file names: relative ones lie beside it.
  std::filesystem::path beside(const std::string& name) const;
  void rename(const std::string& name) { name_ += " (" + name + ")"; }

 private:
  void expect_whole(const toml::node& node, const std::string& key) const;

  const std::filesystem::path* file_;
  const toml::table* table_;
  std::string name_;
  std::vector<std::string> known_;
};

/// The line of a key or text with a NUL in it, which would cut a path or a message short there; 0: there is none.
unsigned line_with_nul(const toml::node& node);

/// A file of tables, parsed.
class TomlText {
 public:
  /// name     stands for the file in messages. remedy   what a person should give instead of what is no TOML.
  /// Throws   Error{kInput}: no TOML, nested deeper than anything that is meant, a NUL in a text.
  TomlText(std::string_view text, const std::filesystem::path& name, const std::string& remedy);
  TomlText(const TomlText&) = delete;
  TomlText& operator=(const TomlText&) = delete;
  /// All of the file; borrows this.
  Section root() const& { return Section(name_, table_, ""); }
  Section root() const&& = delete;

 private:
  std::filesystem::path name_;
  toml::table table_;
};

/// The text of such a file. Throws Error{kInput} for what is no regular file of at most 4 MiB.
std::string toml_file_text(const std::filesystem::path& path, const std::string& remedy);

}  // namespace freshet::synth
