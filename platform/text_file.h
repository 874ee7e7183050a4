// platform/text_file.h — text that someone else wrote: only from regular files, and within limits.
#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include "freshet/error.h"

namespace freshet {

/// The bytes of a regular file. What is no such file is refused without waiting: a pipe that nobody writes to
/// would hold a command for ever.
/// Throws Error{kInput} that names the file, when it is not there, no regular file, longer than max_bytes, or
/// cannot be read.
/// remedy   what a person should give instead.
inline std::string read_text_file(const std::filesystem::path& path, std::size_t max_bytes,
                                  const std::string& remedy) {
  const auto fail = [&](const std::string& fault) {
    throw Error(ErrorKind::kInput, path.string(), fault, remedy);
  };
  const int fd = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0 && errno == ENOENT) fail("there is no such file");
  if (fd < 0) fail(std::string("cannot be opened (") + std::strerror(errno) + ")");
  struct Close {
    int fd;
    ~Close() { ::close(fd); }
  } const close{fd};
  struct stat status {};
  if (::fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) fail("is not a regular file");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > max_bytes)
    fail("has " + std::to_string(size) + " bytes, at most " + std::to_string(max_bytes) + " expected");
  std::string text(size, '\0');
  for (std::size_t done = 0; done < size;) {
    const ssize_t got = ::read(fd, text.data() + done, size - done);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0)
      fail(got == 0 ? "has been cut while it was read"
                    : std::string("cannot be read (") + std::strerror(errno) + ")");
    done += static_cast<std::size_t>(got);
  }
  return text;
}

/// How deep a text's parts lie in each other, whether or not it is well formed. Parsers and the destructors of
/// what they make call themselves for each level: 50,000 levels end a process.
/// JSON: brackets outside of strings.
inline std::size_t json_nesting(std::string_view text) {
  std::size_t depth = 0, deepest = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      while (++i < text.size() && text[i] != '"')
        if (text[i] == '\\') ++i;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return deepest;
}

/// TOML: brackets, and the dots of keys and tables' names.
inline std::size_t toml_nesting(std::string_view text) {
  std::size_t depth = 0, dots = 0, deepest = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      const std::string_view fence =
          text.substr(i, 3) == std::string(3, c) ? text.substr(i, 3) : text.substr(i, 1);
      i += fence.size();
      while (i < text.size() && text.substr(i, fence.size()) != fence &&
             (fence.size() == 3 || text[i] != '\n'))
        i += c == '"' && text[i] == '\\' ? 2 : 1;
      i += fence.size() - 1;
    } else if (c == '#') {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else if (c == '.') {
      ++dots;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    } else if (c == '=' || c == ',' || c == '\n') {
      dots = 0;
    }
    deepest = std::max(deepest, depth + dots);
  }
  return deepest;
}

/// Throws Error{kInput} for a text that is nested deeper than anything that is meant.
inline void expect_nesting(std::size_t found, std::size_t deepest, const std::string& where,
                           const std::string& remedy) {
  if (found <= deepest) return;
  throw Error(
      ErrorKind::kInput, where,
      "is nested " + std::to_string(found) + " levels deep, at most " + std::to_string(deepest) + " expected",
      remedy);
}

}  // namespace freshet
