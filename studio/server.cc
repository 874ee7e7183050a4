#include "studio/server.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <fstream>
#include <functional>
#include <optional>
#include <sstream>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <httplib.h>
#include <sys/statvfs.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "studio/page_files.h"
#include "studio/request_guard.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

constexpr std::size_t kThreads = 24;
constexpr int kMostListeners = 8;                              // event streams; each keeps a thread
constexpr std::uintmax_t kLeftFree = std::uintmax_t{1} << 30;  // bytes of the disk that uploads leave alone
constexpr int kFarthest = 1 << 20;                             // px
constexpr int kLongest = 4096;                                 // px of a picture that is sent

/// Everything comes from us, scripts too; what is drawn from numbers (blobs) is ours as well.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' blob: data:; "
    "media-src 'self' blob:; font-src 'self'; connect-src 'self'; base-uri 'none'; form-action 'none'; "
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

Words words_of(std::string_view path) {
  Words words;
  while (!path.empty()) {
    const std::size_t slash = path.find('/');
    words.emplace_back(path.substr(0, slash));
    path = slash == std::string_view::npos ? std::string_view() : path.substr(slash + 1);
  }
  return words;
}

std::uint64_t number(const std::string& word) {
  std::uint64_t value = 0;
  const auto [last, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || last != word.data() + word.size())
    throw Error(ErrorKind::kNotFound, word, "it is no number");
  return value;
}

void answer(httplib::Response& response, const std::string& bytes, const char* type = "application/json") {
  response.status = 200;
  response.set_content(bytes, type);
}

/// Results have numbers that never come again: they may be kept.
void answer_for_good(httplib::Response& response, const std::string& bytes, const char* type) {
  answer(response, bytes, type);
  response.set_header("Cache-Control", "private, max-age=86400, immutable");
}

std::string read_text(const httplib::ContentReader& reader) {
  std::string text;
  reader([&](const char* data, std::size_t bytes) {
    text.append(data, bytes);
    return true;
  });
  return text;
}

/// A file that is removed unless it was moved away.
struct Incoming {
  fs::path path;
  ~Incoming() {
    std::error_code fault;
    fs::remove(path, fault);
  }
};

void read_file(const httplib::Request& request, const httplib::ContentReader& reader, const fs::path& path) {
  struct statvfs disk {};
  const auto bytes = static_cast<std::uintmax_t>(number(request.get_header_value("Content-Length")));
  if (::statvfs(path.parent_path().c_str(), &disk) == 0 &&
      bytes + kLeftFree > std::uintmax_t{disk.f_bavail} * disk.f_frsize)
    throw Error(ErrorKind::kIo, path.parent_path().string(), "the disk has no room for it", "Free some");
  std::ofstream file(path, std::ios::binary);
  std::uintmax_t got = 0;
  const bool whole = reader([&](const char* data, std::size_t size) {
    got += size;
    return static_cast<bool>(file.write(data, static_cast<std::streamsize>(size)));
  });
  file.close();
  if (!whole || !file || got != bytes)
    throw Error(ErrorKind::kIo, "upload", "it did not arrive whole", "Send it again");
}

Json json_of(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) throw Error(ErrorKind::kUsage, "request", "a JSON object expected");
  return json;
}

std::string word_of(const Json& json, const char* name) {
  const auto found = json.find(name);
  if (found == json.end()) return {};
  if (!found->is_string()) throw Error(ErrorKind::kUsage, "request", fmt::format("\"{}\" is no text", name));
  return found->get<std::string>();
}

/// What a page may add to an export: names that `synth animate` knows, and values without surprises.
std::vector<std::string> export_options(const Json& json) {
  static const std::vector<std::pair<std::string, std::string>> kKnown{
      {"layer", "abcdefghijklmnopqrstuvwxyz"},
      {"preset", "abcdefghijklmnopqrstuvwxyz"},
      {"depth", "abcdefghijklmnopqrstuvwxyz0123456789"},
      {"range", "0123456789-"},
      {"width", "0123456789"},
      {"start-number", "0123456789"}};
  std::vector<std::string> options;
  for (const auto& [name, letters] : kKnown) {
    const std::string value = word_of(json, name.c_str());
    if (value.empty()) continue;
    if (value.find_first_not_of(letters) != std::string::npos)
      throw Error(ErrorKind::kUsage, name, "\"" + value + "\" is none of its values");
    options.push_back("--" + name + "=" + value);
  }
  return options;
}

}  // namespace

struct Server::Impl {
  Impl(Studio& made, const ServerOptions& options);

  httplib::Server::HandlerResponse guard_request(const httplib::Request& request,
                                                 httplib::Response& response);
  void get(const httplib::Request& request, httplib::Response& response);
  void change(const httplib::Request& request, httplib::Response& response,
              const httplib::ContentReader& reader);
  void get_project(const Words& words, const httplib::Request& request, httplib::Response& response);
  void change_project(const Words& words, const httplib::Request& request, httplib::Response& response,
                      const httplib::ContentReader& reader);
  void change_store(const Words& words, const httplib::Request& request, httplib::Response& response,
                    const httplib::ContentReader& reader);
  void send_export(const std::string& project, const std::string& name, httplib::Response& response);
  void send_file(const fs::path& path, const char* type, httplib::Response& response);
  void send_events(const httplib::Request& request, httplib::Response& response);
  void guarded(httplib::Response& response, const std::function<void()>& work);

  Studio& studio;
  std::map<std::string, PageFile, std::less<>> page;
  std::string address, token;
  int port = 0;
  std::optional<RequestGuard> door;
  std::atomic<int> listeners{0};
  httplib::Server server;
};

Server::Impl::Impl(Studio& made, const ServerOptions& options)
    : studio(made),
      page(read_page(options.page)),
      address(options.address),
      token(options.token.empty() ? fresh_token() : options.token) {
  server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  // A connection that stays open keeps a thread, and what is left of a body that was refused would be its next request.
  server.set_keep_alive_max_count(1);
  server.set_read_timeout(30);
  server.set_payload_max_length(largest_body("POST", "api/stores/file"));
  server.set_tcp_nodelay(true);
  server.set_default_headers({{"Content-Security-Policy", kPolicy},
                              {"X-Content-Type-Options", "nosniff"},
                              {"Referrer-Policy", "no-referrer"},
                              {"Cross-Origin-Resource-Policy", "same-origin"},
                              {"Cross-Origin-Opener-Policy", "same-origin"}});
  // Without SO_REUSEPORT, which lets a second server take half of the first one's requests.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  port = options.port != 0 ? (server.bind_to_port(address, options.port) ? options.port : -1)
                           : server.bind_to_any_port(address);
  if (port <= 0)
    throw Error(ErrorKind::kIo, fmt::format("{}:{}", address, options.port), "cannot be listened on",
                "Choose another with --port");
  door.emplace(
      token, std::vector<std::string>{fmt::format("{}:{}", address, port), fmt::format("localhost:{}", port),
                                      fmt::format("127.0.0.1:{}", port)});
  server.set_pre_routing_handler(
      [this](const auto& request, auto& response) { return guard_request(request, response); });
  server.Get(".*", [this](const auto& request, auto& response) {
    guarded(response, [&] { get(request, response); });
  });
  const auto handler = [this](const auto& request, auto& response, const auto& reader) {
    guarded(response, [&] { change(request, response, reader); });
  };
  server.Post(".*", httplib::Server::HandlerWithContentReader(handler));
  server.Put(".*", httplib::Server::HandlerWithContentReader(handler));
  server.Delete(".*", httplib::Server::HandlerWithContentReader(handler));
}

httplib::Server::HandlerResponse Server::Impl::guard_request(const httplib::Request& request,
                                                             httplib::Response& response) {
  const RequestHead head{.method = request.method,
                         .path = request.path,
                         .host = request.get_header_value("Host"),
                         .origin = request.get_header_value("Origin"),
                         .fetch_site = request.get_header_value("Sec-Fetch-Site"),
                         .transfer_encoding = request.get_header_value("Transfer-Encoding"),
                         .content_length = request.get_header_value("Content-Length")};
  const bool doubled =
      request.get_header_value_count("Host") > 1 || request.get_header_value_count("Content-Length") > 1;
  const std::optional<Refusal> refusal =
      doubled ? Refusal{400, "A header is there twice."} : door->refusal(head);
  if (!refusal) return httplib::Server::HandlerResponse::Unhandled;
  response.status = refusal->status;
  response.set_content(refusal->text + "\n", "text/plain; charset=utf-8");
  return httplib::Server::HandlerResponse::Handled;
}

void Server::Impl::guarded(httplib::Response& response, const std::function<void()>& work) {
  const auto fail = [&](int status, const std::string& text) {
    response.status = status;
    response.set_content(Json{{"fault", text}}.dump(-1, ' ', false, Json::error_handler_t::replace),
                         "application/json");
  };
  try {
    work();
  } catch (const Error& fault) {
    fail(status_of(fault.kind()), fault.what());
  } catch (const std::bad_alloc&) {
    fail(500, "There is not enough memory for it.");
  } catch (const std::exception& fault) {
    fail(500, std::string("It failed unexpectedly: ") + fault.what());
  }
}

void Server::Impl::get(const httplib::Request& request, httplib::Response& response) {
  const std::string_view rest = RequestGuard::rest(request.path);
  const Words words = words_of(rest);
  if (words.empty() || words[0] != "api") {
    const auto file = page.find(words.empty() ? "index.html" : rest);
    if (file == page.end()) throw Error(ErrorKind::kNotFound, std::string(rest), "there is no such page");
    answer(response, file->second.bytes, file->second.type.c_str());
    response.set_header("Cache-Control", "no-cache");
    return;
  }
  response.set_header("Cache-Control", "no-store");
  if (rest == "api/home") return answer(response, studio.home_json());
  if (rest == "api/jobs") return answer(response, studio.jobs_json());
  if (rest == "api/events") return send_events(request, response);
  if (words.size() >= 3 && words[1] == "projects") return get_project(words, request, response);
  // api/stores/ID/clips/N.jpg
  if (words.size() == 3 && words[1] == "stores") return answer(response, studio.store(words[2])->to_json());
  if (words.size() == 5 && words[1] == "stores" && words[3] == "clips")
    return answer_for_good(response, studio.store(words[2])->strip(number(words[4]), 240), "image/jpeg");
  if (words.size() == 3 && words[1] == "screened")  // api/screened/NUMBER
    return answer_for_good(response, studio.screened_strip(number(words[2])), "image/jpeg");
  throw Error(ErrorKind::kNotFound, std::string(rest), "there is nothing here");
}

void Server::Impl::get_project(const Words& words, const httplib::Request& request,
                               httplib::Response& response) {
  const std::string& id = words[2];
  const std::string what = words.size() > 3 ? words[3] : "";
  if (words.size() == 3) return answer(response, studio.project_json(id));
  if (what == "exports" && words.size() == 4) return answer(response, studio.exports_json(id));
  if (what == "exports" && words.size() == 5) return send_export(id, words[4], response);
  if (what == "ways" && words.size() == 5) return answer(response, studio.way_json(id, words[4]));
  if (what == "ways" && words.size() == 6 && words[5] == "film")
    return send_file(studio.film(id, words[4]), "video/mp4", response);
  if (what == "ways" && words.size() == 7 && words[5] == "files" && words[6] == "film.mp4")
    return send_file(studio.film(id, words[4]), "video/mp4", response);  // as the way's own page calls it
  if (what == "ways" && words.size() == 7 && words[5] == "files")
    return send_file(studio.way_file(id, words[4], words[6]),
                     words[6].ends_with(".html")  ? "text/html; charset=utf-8"
                     : words[6].ends_with(".svg") ? "image/svg+xml"
                     : words[6].ends_with(".mp4") ? "video/mp4"
                                                  : "image/png",
                     response);
  if (what == "clips" && words.size() == 4) return answer(response, studio.clips_json(id));
  if (what == "clips" && words.size() == 5 && words[4] == "frame")
    return answer(
        response,
        studio.clip_frame(id, request.get_param_value("clip"), request.get_param_value("own") == "1"),
        "image/jpeg");
  if (what == "layers" && words.size() == 6 && words[5] == "matte")  // layers/NUMBER/matte
    return answer(response, studio.layer_matte_png(id, number(words[4])), "image/png");
  if (what == "stills" && words.size() == 4) return answer(response, studio.stills_json(id));
  if (what == "stills" && words.size() == 5)
    return answer(response, studio.still_thumbnail(id, words[4]), "image/jpeg");
  if (what == "thumbnail") return answer(response, studio.thumbnail_of(id), "image/jpeg");
  const std::shared_ptr<Easel> easel = studio.easel(id);
  if (what == "picture") {
    const auto asked = [&](const char* name, int low, int other, int high) {
      const std::string word = request.get_param_value(name);
      return word.empty()
                 ? other
                 : std::clamp(static_cast<int>(std::min<std::uint64_t>(number(word), 1u << 30)), low, high);
    };
    const cv::Rect part(asked("x", 0, 0, kFarthest), asked("y", 0, 0, kFarthest),
                        asked("width", 0, 0, kFarthest), asked("height", 0, 0, kFarthest));
    return answer(response, easel->picture_jpeg(part, asked("longest", 16, 2048, kLongest)), "image/jpeg");
  }
  if (what == "history") return answer(response, easel->project().history());
  if (what == "field") return answer(response, easel->field_json());
  if (what == "made") return answer(response, easel->overview_json());
  if (what == "mattes" && words.size() == 6) {  // mattes/NUMBER/alpha
    const std::shared_ptr<const FoundMatte> matte = easel->matte();
    if (!matte || matte->number != number(words[4]))
      throw Error(ErrorKind::kNotFound, "matte", "it is no longer there");
    return answer_for_good(response, easel->matte_png(words[5] == "held" ? matte->held : matte->alpha, 2048),
                           "image/png");
  }
  if (what == "reels" && words.size() == 6) {  // reels/NUMBER/FRAME, reels/NUMBER/outlines
    const std::shared_ptr<const FrameReel> reel = easel->reel(number(words[4]));
    if (reel && words[5] == "outlines") return answer(response, reel->outlines_json());
    const std::optional<std::string> frame =
        reel ? reel->frame(static_cast<int>(std::min<std::uint64_t>(number(words[5]), 1u << 30)))
             : std::nullopt;
    if (!frame) throw Error(ErrorKind::kNotFound, "frame", "it is not there");
    return answer_for_good(response, *frame, "image/jpeg");
  }
  const std::shared_ptr<const LabelledPicture> labelled = easel->labelled();
  if (!labelled) throw Error(ErrorKind::kNotFound, id, "nothing has been chosen for it yet");
  if (what == "pieces" && words.size() == 4) return answer(response, pieces_json(*labelled));
  if (what == "pieces" && words.size() == 5)
    return answer(response, candidates_json(*labelled, number(words[4])));
  if (what == "pieces" && words.size() == 6)
    return answer(response, candidate_strip(*labelled, number(words[4]), number(words[5])), "image/jpeg");
  if (what == "credits") return answer(response, credits(*labelled), "text/plain; charset=utf-8");
  throw Error(ErrorKind::kNotFound, what, "there is nothing here");
}

void Server::Impl::send_export(const std::string& project, const std::string& name,
                               httplib::Response& response) {
  const fs::path path = studio.easel(project)->project().export_path(name);
  if (!fs::is_regular_file(fs::symlink_status(path)))
    throw Error(ErrorKind::kNotFound, name, "there is no such export");
  response.set_header("Content-Disposition", "attachment; filename=\"" + name + "\"");
  send_file(path, "application/octet-stream", response);
}

void Server::Impl::send_file(const fs::path& path, const char* type, httplib::Response& response) {
  const auto file = std::make_shared<std::ifstream>(path, std::ios::binary);
  const auto bytes = static_cast<std::size_t>(fs::file_size(path));
  if (!*file) throw Error(ErrorKind::kIo, path.filename().string(), "it cannot be read");
  // Its status is left to whoever reads the range that was asked for: a film is sought in.
  response.set_content_provider(
      bytes, type, [file](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        std::array<char, 65536> buffer;
        file->seekg(static_cast<std::streamoff>(offset));
        file->read(buffer.data(), static_cast<std::streamsize>(std::min(length, buffer.size())));
        const auto got = static_cast<std::size_t>(file->gcount());
        return got > 0 && sink.write(buffer.data(), got);
      });
}

void Server::Impl::send_events(const httplib::Request& request, httplib::Response& response) {
  if (listeners.fetch_add(1) >= kMostListeners) {
    --listeners;
    throw Error(ErrorKind::kUsage, "events", "too many pages are open", "Close some");
  }
  const std::string asked = request.has_header("Last-Event-ID") ? request.get_header_value("Last-Event-ID")
                                                                : request.get_param_value("after");
  const std::uint64_t first = asked.empty() ? studio.feed().last() : number(asked);
  // Numbers begin anew with a new server: a page that knows a later one is told that all may have changed.
  auto heard = std::make_shared<std::uint64_t>(std::min(first, studio.feed().last()));
  response.status = 200;
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, heard](std::size_t, httplib::DataSink& sink) {
        std::string news;
        for (const Event& event : studio.feed().after(*heard, std::chrono::seconds(5))) {
          if (event.number > *heard + 1) news += "event: gap\ndata: {}\n\n";
          news += to_text(event);
          *heard = event.number;
        }
        if (studio.feed().closed()) {
          sink.done();
          return true;
        }
        if (news.empty()) news = ": still here\n\n";
        return sink.write(news.data(), news.size());
      },
      [this](bool) { --listeners; });
}

void Server::Impl::change(const httplib::Request& request, httplib::Response& response,
                          const httplib::ContentReader& reader) {
  const std::string_view rest = RequestGuard::rest(request.path);
  const Words words = words_of(rest);
  response.set_header("Cache-Control", "no-store");
  const bool posts = request.method == "POST";
  if (posts && rest == "api/projects") {
    const Incoming incoming{studio.incoming_file()};
    read_file(request, reader, incoming.path);
    return answer(response,
                  Json{{"id", studio.open_picture(incoming.path, request.get_param_value("name"))}}.dump());
  }
  if (posts && rest == "api/clips") {
    const Incoming incoming{studio.incoming_file()};
    read_file(request, reader, incoming.path);
    return answer(response,
                  Json{{"id", studio.open_clip(incoming.path, request.get_param_value("name"))}}.dump());
  }
  if (posts && rest == "api/stores/file") {
    const Incoming incoming{studio.incoming_file()};
    read_file(request, reader, incoming.path);
    return answer(response,
                  Json{{"id", studio.open_store(incoming.path, request.get_param_value("name"))}}.dump());
  }
  if (posts && rest == "api/stores")
    return answer(response,
                  Json{{"id", studio.new_store(word_of(json_of(read_text(reader)), "name"))}}.dump());
  if (words.size() >= 3 && words[0] == "api" && words[1] == "projects")
    return change_project(words, request, response, reader);
  if (posts && words.size() == 4 && words[0] == "api" && words[1] == "stores")
    return change_store(words, request, response, reader);
  if (request.method == "DELETE" && words.size() == 4 && words[0] == "api" && words[1] == "jobs")
    return answer(response, Json{{"stopped", studio.stop_job(words[2], number(words[3]))}}.dump());
  throw Error(ErrorKind::kNotFound, std::string(rest), "there is nothing here");
}

void Server::Impl::change_project(const Words& words, const httplib::Request& request,
                                  httplib::Response& response, const httplib::ContentReader& reader) {
  const std::string& id = words[2];
  const std::string what = words.size() == 4 ? words[3] : "";
  if (request.method == "DELETE" && words.size() == 3) {
    studio.remove_project(id);
    return answer(response, "{}");
  }
  if (request.method == "PUT" && what == "document") {
    const Studio::Saved saved =
        studio.save_document(id, read_text(reader), number(request.get_param_value("base")),
                             request.get_param_value("page").substr(0, 64));
    answer(response, saved.json);
    if (!saved.taken) response.status = 409;
    return;
  }
  if (request.method == "PUT" && what == "history") {
    studio.easel(id)->project().write_history(read_text(reader));
    return answer(response, "{}");
  }
  if (request.method == "POST" && what == "matte") {
    const Incoming incoming{studio.incoming_file()};
    read_file(request, reader, incoming.path);
    studio.give_matte(id, incoming.path);
    return answer(response, "{}");
  }
  if (request.method == "POST" && what == "stills") {
    const Incoming incoming{studio.incoming_file()};
    read_file(request, reader, incoming.path);
    studio.add_still(id, incoming.path, request.get_param_value("name"));
    return answer(response, "{}");
  }
  if (request.method == "POST" && what == "clips") {
    const Incoming incoming{studio.incoming_file()};
    read_file(request, reader, incoming.path);
    return answer(response,
                  Json{{"name", studio.add_clip(id, incoming.path, request.get_param_value("name"))}}.dump());
  }
  if (request.method == "DELETE" && what == "stills") {
    studio.remove_stills(id);
    return answer(response, "{}");
  }
  if (request.method == "POST" && words.size() == 5 && words[3] == "ways")
    return answer(response, Json{{"job", studio.run_way(id, words[4])}}.dump());
  if (request.method == "POST" && what == "exports") {
    const Json asked = json_of(read_text(reader));
    const std::string name = word_of(asked, "name");
    const std::vector<std::string> options = export_options(asked);
    const JobId job = studio.export_animation(id, name, options);
    const std::shared_ptr<Easel> easel = studio.easel(id);  // it is ours while other projects are opened
    const Project& project = easel->project();
    return answer(response,
                  Json{{"job", job},
                       {"folder", project.folder().string()},
                       {"command", to_text(Studio::export_command("freshet", project, name, options))}}
                      .dump());
  }
  throw Error(ErrorKind::kNotFound, what, "there is nothing here");
}

void Server::Impl::change_store(const Words& words, const httplib::Request& request,
                                httplib::Response& response, const httplib::ContentReader& reader) {
  const std::string &id = words[2], &what = words[3];
  if (what == "clips") {
    const Incoming incoming{studio.incoming_file()};
    const fs::path path =
        studio.clip_path(id, request.get_param_value("class"), request.get_param_value("name"));
    read_file(request, reader, incoming.path);
    std::error_code fault;
    fs::rename(incoming.path, path, fault);
    if (fault) throw Error(ErrorKind::kIo, path.string(), "cannot be written");
    return answer(response, "{}");
  }
  if (what == "ingest")
    return answer(
        response,
        Json{{"job", studio.ingest(id, word_of(json_of(read_text(reader)), "licence").substr(0, 500))}}
            .dump());
  throw Error(ErrorKind::kNotFound, what, "there is nothing here");
}

Server::Server(Studio& studio, const ServerOptions& options)
    : impl_(std::make_unique<Impl>(studio, options)) {}
Server::~Server() { stop(); }
int Server::port() const { return impl_->port; }
const std::string& Server::token() const { return impl_->token; }
std::string Server::url() const {
  return fmt::format("http://{}:{}/{}/", impl_->address, impl_->port, impl_->token);
}
void Server::serve() { impl_->server.listen_after_bind(); }

void Server::stop() {
  impl_->studio.feed().close();
  impl_->server.stop();
}

}  // namespace freshet::studio
