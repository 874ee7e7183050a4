// studio/http/connections.h — connections that a server accepts, and the heads of their requests, within limits.
//
// One thread reads all heads as their bytes come; a thread of the pool is taken for a request whose head is whole. So
// who sends slowly, or much, or opens many connections, keeps no thread and little memory, and is the first to be
// closed when others come.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <string>

namespace freshet::studio {

/// Bounds on what is taken before a head is whole, and so before anybody can know the token.
struct ConnectionLimits {
  std::chrono::milliseconds head_deadline{10'000};  // from the connection to the end of the head
  std::size_t max_head_bytes = 32u << 10;
  std::size_t max_headers = 100;
  std::size_t max_heads_per_peer = 64;  // that are not whole; above it the peer's oldest is closed
  std::size_t max_connections = 512;    // heads and requests; above it the oldest head is closed
};

/// An accepted socket, non-blocking, closed at the end.
class Connection {
 public:
  /// open   counted down at the end.
  Connection(int socket, std::string peer, std::atomic<std::size_t>& open);
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection();

  int socket() const { return socket_; }
  const std::string& peer() const { return peer_; }  // its address
  /// The head, and what came of the body with it.
  std::string& received() { return received_; }

 private:
  int socket_;
  std::string peer_, received_;
  std::atomic<std::size_t>& open_;
};

class Connections {
 public:
  /// Called in the thread that serves; it hands over to others.
  using Handler = std::function<void(std::shared_ptr<Connection>)>;

  /// Listens. address   a name or number. port   0: any that is free.
  /// Throws Error{kIo} where that cannot be listened on.
  Connections(const std::string& address, int port, ConnectionLimits limits = {});
  Connections(const Connections&) = delete;
  Connections& operator=(const Connections&) = delete;
  /// serve() has returned, and every Connection is gone.
  ~Connections();

  int port() const { return port_; }
  int socket() const { return listening_; }
  /// Accepts until stop() is called, from whichever thread.
  void serve(const Handler& handler);
  void stop();

 private:
  struct Head {
    std::shared_ptr<Connection> connection;
    std::chrono::steady_clock::time_point deadline;
  };
  void accept_all(const Handler& handler);
  /// Of those that meet the condition. False: there is none.
  bool close_oldest(const std::function<bool(const Head&)>& condition);
  /// Whether it stays: neither whole and handed over, nor closed.
  bool read_head(Head& head, const Handler& handler) const;

  ConnectionLimits limits_;
  int listening_ = -1, wake_ = -1, port_ = 0;
  std::atomic<std::size_t> open_{0};
  std::list<Head> heads_;  // not whole; the oldest first
};

}  // namespace freshet::studio
