// studio/http/request_guard.h — who is let in: pages of our own address that know the token, and nobody else.
//
// A server on this machine can be reached by every page that its user has open: by its own address, or by a name that
// was made to point here (DNS rebinding). So a request must name an address that we serve (Host), come from a page of
// that address where it comes from a page at all (Origin, Sec-Fetch-Site), and carry the token, which stands in the
// path: then pictures, event streams and downloads carry it without a cookie, which every port of this machine would
// be sent.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace freshet::studio {

/// What a request says of itself before its body; "" for what it does not say.
struct RequestHead {
  std::string method, path, host, origin, fetch_site, transfer_encoding, content_length, content_type,
      content_encoding;
};

struct Refusal {
  int status = 403;
  std::string text;  // for a person
};

class RequestGuard {
 public:
  /// How long a body may be, bytes, by method and what stands behind the token.
  using LargestBody = std::function<std::size_t(std::string_view method, std::string_view rest)>;

  /// hosts   what a Host may say: "127.0.0.1:8470", "localhost:8470".
  RequestGuard(std::string token, std::vector<std::string> hosts, LargestBody largest_body);
  /// Nothing: let in.
  std::optional<Refusal> refusal(const RequestHead& head) const;
  /// What stands behind the token, "api/home"; the path must have been let in.
  static std::string_view rest(std::string_view path);
  const std::string& token() const { return token_; }

 private:
  std::string token_;
  std::vector<std::string> hosts_;
  LargestBody largest_body_;
};

/// 32 hex digits that nobody can guess. Throws Error{kIo}.
std::string fresh_token();

}  // namespace freshet::studio
