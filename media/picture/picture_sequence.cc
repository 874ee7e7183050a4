#include "media/picture/picture_sequence.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <string_view>

#include "freshet/error.h"
#include "media/frame/file_format.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

struct Pattern {
  std::string before, after;
  int width = 0;  // of a number with leading zeros
  bool padded = false;
};

// A run of two or more #, as compositors write it: one might well be part of a name.
std::optional<Pattern> parse_hashes(const std::string& name) {
  const std::size_t first = name.find('#');
  if (first == std::string::npos) return std::nullopt;
  const std::size_t end = std::min(name.find_first_not_of('#', first), name.size());
  if (end - first < 2 || end - first > 18 || name.find('#', end) != std::string::npos) return std::nullopt;
  return Pattern{.before = name.substr(0, first),
                 .after = name.substr(end),
                 .width = static_cast<int>(end - first),
                 .padded = true};
}

std::optional<Pattern> parse(const std::string& name) {
  if (name.find('%') == std::string::npos) return parse_hashes(name);
  const std::size_t percent = name.find('%');
  if (percent == std::string::npos || name.find('%', percent + 1) != std::string::npos) return std::nullopt;
  std::size_t end = percent + 1;
  while (end < name.size() && is_digit(name[end])) ++end;
  if (end >= name.size() || name[end] != 'd' || end - percent > 3) return std::nullopt;
  Pattern pattern;
  pattern.before = name.substr(0, percent);
  pattern.after = name.substr(end + 1);
  pattern.padded = name[percent + 1] == '0';
  for (std::size_t i = percent + 1; i < end; ++i) pattern.width = 10 * pattern.width + (name[i] - '0');
  return pattern;
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::error_code fault;
  std::vector<fs::path> files;
  fs::directory_iterator entry(folder, fault);
  if (fault)
    throw Error(ErrorKind::kInput, folder.string(), "the folder cannot be read (" + fault.message() + ")",
                "Check the name and its permissions");
  for (; entry != fs::directory_iterator(); entry.increment(fault)) {
    if (fault) break;
    std::error_code of_entry;
    if (entry->is_regular_file(of_entry)) files.push_back(entry->path());
  }
  return files;
}

}  // namespace

bool is_pattern(const fs::path& path) { return parse(path.filename().string()).has_value(); }

fs::path numbered(const fs::path& path, std::int64_t number) {
  const Pattern pattern = parse(path.filename().string()).value();
  std::string digits = std::to_string(number);
  const std::size_t missing =
      std::max<std::size_t>(static_cast<std::size_t>(pattern.width), digits.size()) - digits.size();
  digits.insert(0, missing, pattern.padded ? '0' : ' ');
  return path.parent_path() / (pattern.before + digits + pattern.after);
}

PictureSequence find_pattern(const fs::path& path) {
  const Pattern pattern = parse(path.filename().string()).value();
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code fault;
  if (!fs::is_directory(folder, fault)) return {};
  std::vector<std::pair<std::int64_t, fs::path>> found;
  for (const fs::path& file : files_in(folder)) {
    const std::string name = file.filename().string();
    if (name.size() <= pattern.before.size() + pattern.after.size()) continue;
    if (!name.starts_with(pattern.before) || !name.ends_with(pattern.after)) continue;
    const std::string digits =
        name.substr(pattern.before.size(), name.size() - pattern.before.size() - pattern.after.size());
    if (digits.size() > 18 || !std::all_of(digits.begin(), digits.end(), is_digit)) continue;
    const std::int64_t number = std::stoll(digits);
    if (numbered(path, number).filename() == name) found.emplace_back(number, path.parent_path() / name);
  }
  std::sort(found.begin(), found.end());
  PictureSequence sequence;
  for (auto& [number, file] : found) {
    sequence.numbers.push_back(number);
    sequence.files.push_back(std::move(file));
  }
  return sequence;
}

PictureSequence list_pattern(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder)) files_in(folder);  // which says why
  PictureSequence sequence = find_pattern(path);
  if (sequence.files.empty())
    throw Error(ErrorKind::kInput, path.string(), "no file in " + folder.string() + " matches this pattern",
                "Name the files as in " + numbered(path, 1).filename().string());
  return sequence;
}

PictureSequence list_folder(const fs::path& folder, bool (*wanted)(const fs::path&)) {
  PictureSequence sequence;
  for (fs::path& file : files_in(folder))
    if (wanted(file) && !file.filename().string().starts_with('.')) sequence.files.push_back(std::move(file));
  std::sort(sequence.files.begin(), sequence.files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  sequence.numbers.resize(sequence.files.size());
  std::iota(sequence.numbers.begin(), sequence.numbers.end(), std::int64_t{0});
  return sequence;
}

PictureSequence list_folder(const fs::path& folder) {
  PictureSequence sequence = list_folder(folder, looks_like_picture);
  if (sequence.files.empty())
    throw Error(ErrorKind::kInput, folder.string(), "the folder holds no pictures",
                "Name a video, or a folder of pictures of equal size");
  return sequence;
}

std::optional<fs::path> first_missing(const PictureSequence& sequence) {
  std::optional<Pattern> common;
  std::int64_t next = 0;
  for (const fs::path& file : sequence.files) {
    const std::string name = file.filename().string();
    // The last number before the ending.
    std::size_t end = file.stem().string().size();
    while (end > 0 && !is_digit(name[end - 1])) --end;
    std::size_t begin = end;
    while (begin > 0 && is_digit(name[begin - 1])) --begin;
    if (begin == end || end - begin > 18) return std::nullopt;
    const std::int64_t number = std::stoll(name.substr(begin, end - begin));
    const Pattern pattern{.before = name.substr(0, begin),
                          .after = name.substr(end),
                          .width = static_cast<int>(end - begin),
                          .padded = name[begin] == '0'};
    if (!common) {
      common = pattern;
      next = number;
    }
    if (pattern.before != common->before || pattern.after != common->after || number < next)
      return std::nullopt;
    if (number > next) {
      std::string digits = std::to_string(next);
      const auto width = static_cast<std::size_t>(common->padded || pattern.padded ? common->width : 0);
      if (digits.size() < width) digits.insert(0, width - digits.size(), '0');
      return file.parent_path() / (common->before + digits + common->after);
    }
    ++next;
  }
  return std::nullopt;
}

bool natural_less(std::string_view a, std::string_view b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i, ++j;
      continue;
    }
    const auto number = [](std::string_view text, std::size_t& at) {
      while (at < text.size() && text[at] == '0') ++at;
      const std::size_t begin = at;
      while (at < text.size() && is_digit(text[at])) ++at;
      return text.substr(begin, at - begin);
    };
    const std::string_view left = number(a, i), right = number(b, j);
    if (left.size() != right.size()) return left.size() < right.size();
    if (left != right) return left < right;
  }
  if (i < a.size() || j < b.size()) return j < b.size();
  return a < b;  // equal except for leading zeros
}

}  // namespace freshet::media
