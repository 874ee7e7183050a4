#include "studio/http/connections.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::studio {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kBacklog = 128;

/// A refusal in as many bytes as a fresh socket takes at once: whoever does not read it holds nobody up.
void refuse(const Connection& connection, int status, const char* reason) {
  const std::string text =
      fmt::format("HTTP/1.1 {} {}\r\nConnection: close\r\nContent-Length: 0\r\n\r\n", status, reason);
  (void)::send(connection.socket(), text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

/// Of a head that was begun. A browser connects ahead of its requests, and takes what comes on such a connection for
/// the answer to the next one: it is closed without a word, after which the browser opens another. A full server, which
/// knows nothing of the connection yet, answers all the same.
void refuse_begun(Connection& connection, int status, const char* reason) {
  if (!connection.received().empty()) refuse(connection, status, reason);
}

int listen_on(const addrinfo& to) {
  const int socket = ::socket(to.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, to.ai_protocol);
  if (socket < 0) return -1;
  // Without SO_REUSEPORT, which lets a second server take half of the first one's requests.
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (::bind(socket, to.ai_addr, to.ai_addrlen) == 0 && ::listen(socket, kBacklog) == 0) return socket;
  ::close(socket);
  return -1;
}

int port_of(int socket) {
  sockaddr_storage at{};
  socklen_t bytes = sizeof at;
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&at), &bytes) != 0) return 0;
  return ntohs(at.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(at).sin6_port
                                        : reinterpret_cast<const sockaddr_in&>(at).sin_port);
}

std::string address_of(const sockaddr_storage& at, socklen_t bytes) {
  std::array<char, NI_MAXHOST> name{};
  const bool is_known = ::getnameinfo(reinterpret_cast<const sockaddr*>(&at), bytes, name.data(), name.size(),
                                      nullptr, 0, NI_NUMERICHOST) == 0;
  return is_known ? name.data() : "";
}

}  // namespace

Connection::Connection(int socket, std::string peer, std::atomic<std::size_t>& open)
    : socket_(socket), peer_(std::move(peer)), open_(open) {
  ++open_;
}

Connection::~Connection() {
  ::shutdown(socket_, SHUT_RDWR);
  ::close(socket_);
  --open_;
}

Connections::Connections(const std::string& address, int port, ConnectionLimits limits) : limits_(limits) {
  addrinfo hints{}, *found = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  if (::getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &found) == 0) {
    for (const addrinfo* to = found; to != nullptr && listening_ < 0; to = to->ai_next)
      listening_ = listen_on(*to);
    ::freeaddrinfo(found);
  }
  wake_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (listening_ < 0 || wake_ < 0) {
    const Error fault(ErrorKind::kIo, fmt::format("{}:{}", address, port), "cannot be listened on",
                      "Choose another with --port");
    for (const int fd : {listening_, wake_})
      if (fd >= 0) ::close(fd);
    throw fault;
  }
  port_ = port_of(listening_);
}

Connections::~Connections() {
  heads_.clear();
  ::close(listening_);
  ::close(wake_);
}

void Connections::stop() {
  const std::uint64_t one = 1;
  (void)!::write(wake_, &one, sizeof one);
}

void Connections::serve(const Handler& handler) {
  std::vector<pollfd> ends;
  for (;;) {
    ends = {{wake_, POLLIN, 0}, {listening_, POLLIN, 0}};
    for (const Head& head : heads_) ends.push_back({head.connection->socket(), POLLIN, 0});
    int wait_ms = -1;
    if (!heads_.empty()) {  // the oldest is the first to be late
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(heads_.front().deadline - Clock::now());
      wait_ms = static_cast<int>(std::max<std::int64_t>(0, left.count()));
    }
    if (::poll(ends.data(), ends.size(), wait_ms) < 0 && errno != EINTR)
      throw Error(ErrorKind::kIo, "poll", std::strerror(errno));
    if ((ends[0].revents & POLLIN) != 0) break;
    std::size_t at = 2;
    for (auto head = heads_.begin(); head != heads_.end(); ++at) {
      bool stays = ends[at].revents == 0 || read_head(*head, handler);
      if (stays && Clock::now() >= head->deadline) {
        refuse_begun(*head->connection, 408, "Request Timeout");
        stays = false;
      }
      head = stays ? std::next(head) : heads_.erase(head);
    }
    if (ends[1].revents != 0) accept_all(handler);
  }
  heads_.clear();
}

void Connections::accept_all(const Handler& handler) {
  for (;;) {
    sockaddr_storage from{};
    socklen_t bytes = sizeof from;
    const int socket =
        ::accept4(listening_, reinterpret_cast<sockaddr*>(&from), &bytes, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (socket < 0) {
      // Out of descriptors or memory: others close meanwhile. What a peer did to its own connection is past.
      if (errno != EAGAIN && errno != ECONNABORTED && errno != EINTR)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      return;
    }
    const int yes = 1;
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    Head head{std::make_shared<Connection>(socket, address_of(from, bytes), open_),
              Clock::now() + limits_.head_deadline};
    if (open_ > limits_.max_connections && !close_oldest([](const Head&) { return true; })) {
      refuse(*head.connection, 503, "Service Unavailable");
      continue;
    }
    // A head that came with its connection, as pages send them, never waits among those that are slow.
    if (!read_head(head, handler)) continue;
    const auto is_of_peer = [&](const Head& other) {
      return other.connection->peer() == head.connection->peer();
    };
    if (static_cast<std::size_t>(std::count_if(heads_.begin(), heads_.end(), is_of_peer)) >=
        limits_.max_heads_per_peer)
      close_oldest(is_of_peer);
    heads_.push_back(std::move(head));
  }
}

bool Connections::close_oldest(const std::function<bool(const Head&)>& condition) {
  const auto oldest = std::find_if(heads_.begin(), heads_.end(), condition);
  if (oldest == heads_.end()) return false;
  refuse_begun(*oldest->connection, 503, "Service Unavailable");
  heads_.erase(oldest);
  return true;
}

bool Connections::read_head(Head& head, const Handler& handler) const {
  std::string& received = head.connection->received();
  std::array<char, 16384> buffer;
  const ssize_t got = ::recv(head.connection->socket(), buffer.data(), buffer.size(), 0);
  if (got < 0) return errno == EAGAIN || errno == EINTR;
  if (got == 0) return false;
  const std::size_t before = received.size();
  received.append(buffer.data(), static_cast<std::size_t>(got));
  // As httplib reads it: lines end with "\n", and the first that is "\r\n" ends the head.
  const std::size_t end = received.find("\n\r\n", before < 2 ? 0 : before - 2);
  const std::string_view seen = std::string_view(received).substr(0, end);
  const auto lines = static_cast<std::size_t>(std::count(seen.begin(), seen.end(), '\n'));
  if (seen.size() > limits_.max_head_bytes || lines > limits_.max_headers) {
    refuse(*head.connection, 431, "Request Header Fields Too Large");
    return false;
  }
  if (end == std::string::npos) return true;
  handler(head.connection);
  return false;
}

}  // namespace freshet::studio
