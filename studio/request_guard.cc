#include "studio/request_guard.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "freshet/error.h"

namespace freshet::studio {
namespace {

constexpr std::size_t kTextBytes = 16u << 20, kPictureBytes = std::size_t{512} << 20,
                      kClipBytes = std::size_t{2} << 30, kStoreBytes = std::size_t{4} << 30;

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

RequestGuard::RequestGuard(std::string token, std::vector<std::string> hosts)
    : token_(std::move(token)), hosts_(std::move(hosts)) {}

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
  if (!head.transfer_encoding.empty()) return Refusal{411, "Say how long it is: Content-Length."};
  if (!head.content_length.empty()) {
    std::size_t bytes = 0;
    const char* const end = head.content_length.data() + head.content_length.size();
    const auto [last, fault] = std::from_chars(head.content_length.data(), end, bytes);
    if (fault != std::errc() || last != end) return Refusal{400, "Content-Length is no number."};
    if (bytes > largest_body(head.method, rest(head.path)))
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

std::size_t largest_body(std::string_view method, std::string_view rest) {
  if (method != "POST" && method != "PUT") return 0;
  if (rest == "api/projects" || rest.ends_with("/matte") || rest.ends_with("/stills")) return kPictureBytes;
  if (rest == "api/stores/file") return kStoreBytes;
  if (rest == "api/clips" || rest.ends_with("/clips")) return kClipBytes;
  return kTextBytes;
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
