#include "studio/http/request_guard.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "freshet/error.h"

namespace freshet::studio {
namespace {

/// Takes as long for a wrong token as for the right one.
bool same_text(std::string_view a, std::string_view b) {
  unsigned differ = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < b.size(); ++i)
    differ |= static_cast<unsigned char>(b[i]) ^ static_cast<unsigned char>(i < a.size() ? a[i] : 0);
  return differ == 0;
}

std::string_view token_of(std::string_view path) {
  if (path.empty() || path.front() != '/') return {};
  path.remove_prefix(1);
  return path.substr(0, path.find('/'));
}

}  // namespace

RequestGuard::RequestGuard(std::string token, std::vector<std::string> hosts, LargestBody largest_body)
    : token_(std::move(token)), hosts_(std::move(hosts)), largest_body_(std::move(largest_body)) {}

std::optional<Refusal> RequestGuard::refusal(const RequestHead& head) const {
  if (std::find(hosts_.begin(), hosts_.end(), head.host) == hosts_.end())
    return Refusal{403, "This address is not served here."};
  if (!head.origin.empty() && std::none_of(hosts_.begin(), hosts_.end(), [&](const std::string& host) {
        return head.origin == "http://" + host;
      }))
    return Refusal{403, "Another page asked for this."};
  if (!same_text(token_of(head.path), token_))
    return Refusal{403, "The address lacks its token. Open the one that freshet studio printed."};
  // Opening the page from a link or the address bar is no danger: it answers with the page, and nothing happens.
  const bool opens_page = head.method == "GET" && rest(head.path).empty();
  if (!opens_page && !head.fetch_site.empty() && head.fetch_site != "same-origin" &&
      head.fetch_site != "none")
    return Refusal{403, "Another page asked for this."};
  if (head.method != "GET" && head.method != "POST" && head.method != "PUT" && head.method != "DELETE")
    return Refusal{405, "There is nothing to do so."};
  // A body is the bytes of the file that is sent: httplib would take parts out of it, and blow up what is packed.
  if (head.content_type.starts_with("multipart/"))
    return Refusal{415, "Send the file itself, without multipart/form-data."};
  if (!head.content_encoding.empty() && head.content_encoding != "identity")
    return Refusal{415, "Send it as it is, without Content-Encoding."};
  if (!head.transfer_encoding.empty()) return Refusal{411, "Say how long it is: Content-Length."};
  if (!head.content_length.empty()) {
    std::size_t bytes = 0;
    const char* const end = head.content_length.data() + head.content_length.size();
    const auto [last, fault] = std::from_chars(head.content_length.data(), end, bytes);
    if (fault != std::errc() || last != end) return Refusal{400, "Content-Length is no number."};
    if (bytes > largest_body_(head.method, rest(head.path)))
      return Refusal{413, "It is larger than what is taken here."};
  } else if (head.method == "POST" || head.method == "PUT") {
    return Refusal{411, "Say how long it is: Content-Length."};
  }
  return std::nullopt;
}

std::string_view RequestGuard::rest(std::string_view path) {
  if (path.empty()) return {};
  const std::size_t slash = path.find('/', 1);
  return slash == std::string_view::npos ? std::string_view() : path.substr(slash + 1);
}

std::string fresh_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw Error(ErrorKind::kIo, "random numbers", "the system gave none");
  std::string token;
  for (const unsigned char byte : bytes) {
    token += "0123456789abcdef"[byte >> 4];
    token += "0123456789abcdef"[byte & 15];
  }
  return token;
}

}  // namespace freshet::studio
