// studio/http/call.h — one request that was let in, and the answer to it; and the table of what can be asked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <httplib.h>
#include <nlohmann/json.hpp>

#include "studio/beneath.h"

namespace freshet::studio {

using PathValues = std::map<std::string, std::string, std::less<>>;

/// What a path has in place of a pattern's words with a colon: "fall" for "id" of "api/projects/:id". Nothing: it is
/// another path. A value is one word, never empty; it may hold anything that a browser may send.
std::optional<PathValues> match_path(std::string_view pattern, std::string_view path);

/// Everything throws Error{kNotFound} for a path or number that names nothing, Error{kUsage} for what is no answer.
class Call {
 public:
  /// reader   of the body; null: there is none. All must outlive this.
  Call(const httplib::Request& request, httplib::Response& response, const httplib::ContentReader* reader,
       PathValues values);

  const std::string& value(std::string_view name) const { return values_.find(name)->second; }
  std::uint64_t number(std::string_view name) const;
  /// "" where it was not given.
  std::string parameter(const char* name) const { return request_.get_param_value(name); }
  std::uint64_t number_parameter(const char* name) const;
  std::string header(const char* name) const { return request_.get_header_value(name); }

  /// The body.
  std::string text() const;
  nlohmann::json object() const;
  /// Into a file. Throws Error{kIo} where it does not arrive whole, or the disk has no room.
  void receive(const std::filesystem::path& file) const;

  void answer(const std::string& bytes, const char* type = "application/json");
  /// Results have numbers that never come again: they may be kept.
  void answer_for_good(const std::string& bytes, const char* type);
  void answer_file(std::shared_ptr<const OpenFile> file, const char* type);
  httplib::Response& response() { return response_; }

 private:
  const httplib::Request& request_;
  httplib::Response& response_;
  const httplib::ContentReader* reader_;
  PathValues values_;
};

inline constexpr std::size_t kNoBody = 0, kTextBody = 16u << 20, kPictureBody = std::size_t{512} << 20,
                             kClipBody = std::size_t{2} << 30, kStoreBody = std::size_t{4} << 30;

struct Route {
  std::string_view method, path;  // behind the token: "GET", "api/projects/:id/ways/:way/film"
  std::size_t max_body;           // bytes
  std::function<void(Call&)> handler;
};

/// Of an object's text; "" where it is not there. Throws Error{kUsage} for what is no text.
std::string word_of(const nlohmann::json& json, const char* name);

/// A decimal number, and nothing else. Throws Error{kNotFound}.
std::uint64_t number_of(const std::string& word);

}  // namespace freshet::studio
