// tests/studio/http/raw_client.h — a connection that sends whatever bytes a test wants, as slowly as it wants.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstdint>
#include <string>

namespace freshet::studio {

class RawClient {
 public:
  /// To this machine; is_open() says whether it came about.
  explicit RawClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{20, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    open_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
  }
  RawClient(RawClient&& other) noexcept : socket_(other.socket_), open_(other.open_) { other.socket_ = -1; }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  ~RawClient() {
    if (socket_ >= 0) ::close(socket_);
  }

  bool is_open() const { return open_; }
  /// False: the other end has closed, or takes nothing.
  bool send(const std::string& bytes) const {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t put = ::send(socket_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      if (put <= 0) return false;
      done += static_cast<std::size_t>(put);
    }
    return true;
  }
  /// Until the other end closes.
  std::string read_all() const {
    std::string answer;
    char buffer[4096];
    for (ssize_t got = 0; (got = ::recv(socket_, buffer, sizeof buffer, 0)) > 0;)
      answer.append(buffer, static_cast<std::size_t>(got));
    return answer;
  }
  /// So many bytes, or those that come before the other end closes.
  std::size_t read(char* into, std::size_t size) const {
    const ssize_t got = ::recv(socket_, into, size, MSG_WAITALL);
    return got < 0 ? 0 : static_cast<std::size_t>(got);
  }
  /// Whether it has said something or closed within a moment.
  bool has_answer(int wait_ms) const {
    const timeval wait{wait_ms / 1000, wait_ms % 1000 * 1000};
    fd_set set;
    FD_ZERO(&set);
    FD_SET(socket_, &set);
    timeval left = wait;
    return ::select(socket_ + 1, &set, nullptr, nullptr, &left) > 0;
  }

 private:
  int socket_;
  bool open_ = false;
};

}  // namespace freshet::studio
