#include "studio/http/server.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "studio/http/call.h"
#include "studio/http/page_files.h"
#include "studio/http/request_guard.h"
#include "studio/http/routes.h"

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kThreads = 24;
constexpr std::chrono::milliseconds kPatience{30'000};  // for each part of a body, and of an answer

/// Everything comes from us, scripts too; what is drawn from numbers (blobs) is ours as well.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' blob: data:; "
    "media-src 'self' blob:; font-src 'self'; manifest-src 'self'; connect-src 'self'; base-uri 'none'; "
    "form-action 'none'; "
    "frame-ancestors 'none'";

int status_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kNotFound:
      return 404;
    case ErrorKind::kUsage:
    case ErrorKind::kInput:
      return 400;
    default:
      return 500;
  }
}

/// A connection as httplib reads it: first what came with the head, then what comes.
class ConnectionStream : public httplib::Stream {
 public:
  explicit ConnectionStream(Connection& connection) : connection_(connection) {}

  bool is_readable() const override { return taken_ < connection_.received().size() || wait(POLLIN); }
  bool is_writable() const override { return wait(POLLOUT); }

  ssize_t read(char* bytes, std::size_t size) override {
    const std::string& received = connection_.received();
    if (taken_ < received.size()) {
      const std::size_t part = received.copy(bytes, size, taken_);
      taken_ += part;
      return static_cast<ssize_t>(part);
    }
    return wait(POLLIN) ? ::recv(socket(), bytes, size, 0) : -1;
  }
  ssize_t write(const char* bytes, std::size_t size) override {
    return wait(POLLOUT) ? ::send(socket(), bytes, size, MSG_NOSIGNAL) : -1;
  }
  void get_remote_ip_and_port(std::string& address, int& port) const override {
    address = connection_.peer();
    port = 0;
  }
  void get_local_ip_and_port(std::string& address, int& port) const override {
    address.clear();
    port = 0;
  }
  int socket() const override { return connection_.socket(); }

 private:
  bool wait(short event) const {
    pollfd end{socket(), event, 0};
    int ready = 0;
    while ((ready = ::poll(&end, 1, static_cast<int>(kPatience.count()))) < 0 && errno == EINTR) continue;
    return ready > 0;
  }

  Connection& connection_;
  std::size_t taken_ = 0;
};

/// httplib without its listening: of its server, what reads a request and writes the answer.
class Answering : public httplib::Server {
 public:
  /// listening   while it is open, long answers go on.
  explicit Answering(int listening) { svr_sock_ = listening; }
  void answer(Connection& connection) {
    ConnectionStream stream(connection);
    bool closed = false;
    process_request(stream, true, closed, nullptr);
  }
};

}  // namespace

struct Server::Impl {
  Impl(Studio& made, const ServerOptions& options);

  const Route* route_of(std::string_view method, std::string_view rest) const;
  std::size_t largest_body(std::string_view method, std::string_view rest) const;
  httplib::Server::HandlerResponse guard_request(const httplib::Request& request,
                                                 httplib::Response& response) const;
  void handle(const httplib::Request& request, httplib::Response& response,
              const httplib::ContentReader* reader) const;
  void call_route(const httplib::Request& request, httplib::Response& response,
                  const httplib::ContentReader* reader) const;
  void send_page(std::string_view name, httplib::Response& response) const;

  Studio& studio;
  std::map<std::string, PageFile, std::less<>> page;
  std::string address;
  std::vector<Route> routes;
  Connections connections;
  RequestGuard door;
  Answering server;
};

Server::Impl::Impl(Studio& made, const ServerOptions& options)
    : studio(made),
      page(read_page(options.page)),
      address(options.address),
      connections(options.address, options.port, options.limits),
      door(options.token.empty() ? fresh_token() : options.token,
           {fmt::format("{}:{}", address, connections.port()),
            fmt::format("localhost:{}", connections.port()), fmt::format("127.0.0.1:{}", connections.port())},
           [this](std::string_view method, std::string_view rest) { return largest_body(method, rest); }),
      server(connections.socket()) {
  for (auto* const of : {project_routes, way_routes, store_routes, job_routes})
    for (Route& route : of(studio)) routes.push_back(std::move(route));
  server.set_payload_max_length(kStoreBody);
  server.set_default_headers({{"Content-Security-Policy", kPolicy},
                              {"X-Content-Type-Options", "nosniff"},
                              {"Referrer-Policy", "no-referrer"},
                              {"Cross-Origin-Resource-Policy", "same-origin"},
                              {"Cross-Origin-Opener-Policy", "same-origin"}});
  server.set_pre_routing_handler(
      [this](const auto& request, auto& response) { return guard_request(request, response); });
  server.Get(".*", [this](const auto& request, auto& response) { handle(request, response, nullptr); });
  const auto change = [this](const auto& request, auto& response, const auto& reader) {
    handle(request, response, &reader);
  };
  server.Post(".*", httplib::Server::HandlerWithContentReader(change));
  server.Put(".*", httplib::Server::HandlerWithContentReader(change));
  server.Delete(".*", httplib::Server::HandlerWithContentReader(change));
}

const Route* Server::Impl::route_of(std::string_view method, std::string_view rest) const {
  const auto found = std::find_if(routes.begin(), routes.end(), [&](const Route& route) {
    return route.method == method && match_path(route.path, rest);
  });
  return found == routes.end() ? nullptr : &*found;
}

std::size_t Server::Impl::largest_body(std::string_view method, std::string_view rest) const {
  if (const Route* const route = route_of(method, rest)) return route->max_body;
  return method == "POST" || method == "PUT" ? kTextBody : kNoBody;  // of what is answered by 404
}

httplib::Server::HandlerResponse Server::Impl::guard_request(const httplib::Request& request,
                                                             httplib::Response& response) const {
  const auto said = [&](const char* name) { return request.get_header_value(name); };
  const RequestHead head{.method = request.method,
                         .path = request.path,
                         .host = said("Host"),
                         .origin = said("Origin"),
                         .fetch_site = said("Sec-Fetch-Site"),
                         .transfer_encoding = said("Transfer-Encoding"),
                         .content_length = said("Content-Length"),
                         .content_type = said("Content-Type"),
                         .content_encoding = said("Content-Encoding")};
  const auto is_doubled = [&](const char* name) { return request.get_header_value_count(name) > 1; };
  const bool doubled = is_doubled("Host") || is_doubled("Content-Length") || is_doubled("Content-Type") ||
                       is_doubled("Content-Encoding");
  const std::optional<Refusal> refusal =
      doubled ? Refusal{400, "A header is there twice."} : door.refusal(head);
  if (!refusal) return httplib::Server::HandlerResponse::Unhandled;
  response.status = refusal->status;
  response.set_content(refusal->text + "\n", "text/plain; charset=utf-8");
  return httplib::Server::HandlerResponse::Handled;
}

void Server::Impl::handle(const httplib::Request& request, httplib::Response& response,
                          const httplib::ContentReader* reader) const {
  const auto fail = [&](int status, const std::string& text) {
    response.status = status;
    response.set_content(Json{{"fault", text}}.dump(-1, ' ', false, Json::error_handler_t::replace),
                         "application/json");
  };
  try {
    call_route(request, response, reader);
  } catch (const Error& fault) {
    fail(status_of(fault.kind()), fault.what());
  } catch (const std::bad_alloc&) {
    fail(500, "There is not enough memory for it.");
  } catch (const std::exception& fault) {
    fail(500, std::string("It failed unexpectedly: ") + fault.what());
  }
}

void Server::Impl::call_route(const httplib::Request& request, httplib::Response& response,
                              const httplib::ContentReader* reader) const {
  const std::string_view rest = RequestGuard::rest(request.path);
  if (request.method == "GET" && !rest.starts_with("api/")) return send_page(rest, response);
  const Route* const route = route_of(request.method, rest);
  if (route == nullptr) throw Error(ErrorKind::kNotFound, std::string(rest), "there is nothing here");
  response.set_header("Cache-Control", "no-store");
  Call call(request, response, reader, *match_path(route->path, rest));
  route->handler(call);
}

void Server::Impl::send_page(std::string_view name, httplib::Response& response) const {
  const auto file = page.find(name.empty() ? "index.html" : name);
  if (file == page.end()) throw Error(ErrorKind::kNotFound, std::string(name), "there is no such page");
  response.status = 200;
  response.set_content(file->second.bytes, file->second.type);
  response.set_header("Cache-Control", "no-cache");
}

Server::Server(Studio& studio, const ServerOptions& options)
    : impl_(std::make_unique<Impl>(studio, options)) {}
Server::~Server() { stop(); }
int Server::port() const { return impl_->connections.port(); }
const std::string& Server::token() const { return impl_->door.token(); }
std::string Server::url() const { return fmt::format("http://{}:{}/{}/", impl_->address, port(), token()); }

void Server::serve() {
  // A request that has its thread keeps it to the end: one request a connection.
  httplib::ThreadPool threads(kThreads);
  impl_->connections.serve([&](std::shared_ptr<Connection> connection) {
    threads.enqueue([this, connection = std::move(connection)] { impl_->server.answer(*connection); });
  });
  threads.shutdown();
}

void Server::stop() {
  impl_->studio.jobs().feed().close();
  impl_->connections.stop();
}

}  // namespace freshet::studio
