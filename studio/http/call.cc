#include "studio/http/call.h"

#include <sys/statvfs.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <memory>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::uintmax_t kLeftFree = std::uintmax_t{1} << 30;  // bytes of the disk that uploads leave alone

/// The word before the first slash, which is taken off with it.
std::string_view take_word(std::string_view& path) {
  const std::size_t slash = path.find('/');
  const std::string_view word = path.substr(0, slash);
  path = slash == std::string_view::npos ? std::string_view() : path.substr(slash + 1);
  return word;
}

}  // namespace

std::optional<PathValues> match_path(std::string_view pattern, std::string_view path) {
  if (std::count(pattern.begin(), pattern.end(), '/') != std::count(path.begin(), path.end(), '/'))
    return std::nullopt;
  PathValues values;
  while (!pattern.empty()) {
    const std::string_view expected = take_word(pattern), found = take_word(path);
    if (expected.starts_with(':') && !found.empty())
      values.emplace(expected.substr(1), found);
    else if (expected != found)
      return std::nullopt;
  }
  return values;
}

std::uint64_t number_of(const std::string& word) {
  std::uint64_t value = 0;
  const auto [last, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || last != word.data() + word.size())
    throw Error(ErrorKind::kNotFound, word, "it is no number");
  return value;
}

std::string word_of(const Json& json, const char* name) {
  const auto found = json.find(name);
  if (found == json.end()) return {};
  if (!found->is_string()) throw Error(ErrorKind::kUsage, "request", fmt::format("\"{}\" is no text", name));
  const auto& word = found->get_ref<const std::string&>();
  // It would end a file's name, and the message about it, there.
  if (word.find('\0') != std::string::npos)
    throw Error(ErrorKind::kUsage, "request", fmt::format("\"{}\" has a NUL in it", name), "Remove it");
  return word;
}

Call::Call(const httplib::Request& request, httplib::Response& response, const httplib::ContentReader* reader,
           PathValues values)
    : request_(request), response_(response), reader_(reader), values_(std::move(values)) {}

std::uint64_t Call::number(std::string_view name) const { return number_of(value(name)); }
std::uint64_t Call::number_parameter(const char* name) const { return number_of(parameter(name)); }

std::string Call::text() const {
  std::string text;
  if (reader_ != nullptr)
    (*reader_)([&](const char* data, std::size_t bytes) {
      text.append(data, bytes);
      return true;
    });
  return text;
}

Json Call::object() const {
  Json json = Json::parse(text(), nullptr, false);
  if (!json.is_object()) throw Error(ErrorKind::kUsage, "request", "a JSON object expected");
  return json;
}

void Call::receive(const fs::path& path) const {
  struct statvfs disk {};
  const auto bytes = static_cast<std::uintmax_t>(number_of(header("Content-Length")));
  if (::statvfs(path.parent_path().c_str(), &disk) == 0 &&
      bytes + kLeftFree > std::uintmax_t{disk.f_bavail} * disk.f_frsize)
    throw Error(ErrorKind::kIo, path.parent_path().string(), "the disk has no room for it", "Free some");
  std::ofstream file(path, std::ios::binary);
  std::uintmax_t got = 0;
  const bool whole = reader_ != nullptr && (*reader_)([&](const char* data, std::size_t size) {
                       got += size;
                       return static_cast<bool>(file.write(data, static_cast<std::streamsize>(size)));
                     });
  file.close();
  if (!whole || !file || got != bytes)
    throw Error(ErrorKind::kIo, "upload", "it did not arrive whole", "Send it again");
}

void Call::answer(const std::string& bytes, const char* type) {
  response_.status = 200;
  response_.set_content(bytes, type);
}

void Call::answer_for_good(const std::string& bytes, const char* type) {
  answer(bytes, type);
  response_.headers.erase("Cache-Control");
  response_.set_header("Cache-Control", "private, max-age=86400, immutable");
}

void Call::answer_file(std::shared_ptr<const OpenFile> file, const char* type) {
  const auto bytes = static_cast<std::size_t>(file->bytes());
  // Its status is left to whoever reads the range that was asked for: a film is sought in.
  response_.set_content_provider(
      bytes, type, [file = std::move(file)](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        std::array<char, 65536> buffer;
        const std::size_t got = file->read(buffer.data(), std::min(length, buffer.size()), offset);
        return got > 0 && sink.write(buffer.data(), got);
      });
}

}  // namespace freshet::studio
