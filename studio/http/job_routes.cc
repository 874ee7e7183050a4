#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <string>

#include "freshet/error.h"
#include "studio/http/routes.h"

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

/// One of those who hear what happens, for as long as it is there.
class Listener {
 public:
  explicit Listener(std::shared_ptr<std::atomic<int>> count) : count_(std::move(count)) {
    constexpr int kMostListeners = 8;  // each keeps a thread
    if (count_->fetch_add(1) < kMostListeners) return;
    --*count_;
    throw Error(ErrorKind::kUsage, "events", "too many pages are open", "Close some");
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener() { --*count_; }

 private:
  std::shared_ptr<std::atomic<int>> count_;
};

void send_events(EventFeed& feed, const std::shared_ptr<std::atomic<int>>& listeners, Call& call) {
  const std::string last = call.header("Last-Event-ID");
  const std::string asked = last.empty() ? call.parameter("after") : last;
  const std::uint64_t first = asked.empty() ? feed.last() : number_of(asked);
  const auto listener = std::make_shared<const Listener>(listeners);
  // Numbers begin anew with a new server: a page that knows a later one is told that all may have changed.
  const auto heard = std::make_shared<std::uint64_t>(std::min(first, feed.last()));
  call.response().status = 200;
  call.response().set_chunked_content_provider(
      "text/event-stream", [&feed, heard, listener](std::size_t, httplib::DataSink& sink) {
        std::string news;
        for (const Event& event : feed.after(*heard, std::chrono::seconds(5))) {
          if (event.number > *heard + 1) news += "event: gap\ndata: {}\n\n";
          news += to_text(event);
          *heard = event.number;
        }
        if (feed.closed()) {
          sink.done();
          return true;
        }
        if (news.empty()) news = ": still here\n\n";
        return sink.write(news.data(), news.size());
      });
}

}  // namespace

std::vector<Route> job_routes(Studio& studio) {
  return {
      {"GET", "api/jobs", kNoBody, [&](Call& call) { call.answer(studio.jobs().to_json()); }},
      {"DELETE", "api/jobs/:lane/:id", kNoBody,
       [&](Call& call) {
         call.answer(Json{{"stopped", studio.jobs().stop(call.value("lane"), call.number("id"))}}.dump());
       }},
      {"GET", "api/events", kNoBody,
       [&studio, listeners = std::make_shared<std::atomic<int>>(0)](Call& call) {
         send_events(studio.jobs().feed(), listeners, call);
       }},
  };
}

}  // namespace freshet::studio
