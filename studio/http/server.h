// studio/http/server.h — the studio over HTTP, for pages on this machine.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "studio/http/connections.h"
#include "studio/studio.h"

namespace freshet::studio {

struct ServerOptions {
  std::string address = "127.0.0.1";  // that it listens on
  int port = 0;                       // 0: any that is free
  std::string token;                  // "": a fresh one
  std::filesystem::path page;         // folder of the built page
  ConnectionLimits limits = {};
};

/// Answers nobody but pages of its own address that know the token (request_guard.h), in the words of routes.h. Every
/// answer forbids a page to load anything from elsewhere. Cost: 24 threads, of which most sleep.
class Server {
 public:
  /// Binds. Throws Error{kIo} when the port is taken, and as read_page.
  Server(Studio& studio, const ServerOptions& options);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server();

  int port() const;
  const std::string& token() const;
  /// "http://127.0.0.1:8470/TOKEN/"
  std::string url() const;
  /// Serves until stop() is called, from whichever thread.
  void serve();
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::studio
