#include "studio/jobs/jobs.h"

#include <algorithm>
#include <iterator>

#include <nlohmann/json.hpp>

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

constexpr const char* kLanes[] = {"preview", "live", "command"};  // as a page calls them

Json view_json(const JobView& view, const char* lane) {
  return {{"lane", lane},
          {"id", view.id},
          {"key", view.key},
          {"title", view.title},
          {"state", to_string(view.state)},
          {"stage", view.progress.stage},
          {"done", view.progress.done},
          {"of", view.progress.of},
          {"fault", view.fault}};
}

}  // namespace

std::string json_text(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

Jobs::Jobs() {
  for (std::size_t i = 0; i < lanes_.size(); ++i)
    lanes_[i] = std::make_unique<JobQueue>([this, name = kLanes[i]](const JobView& view) {
      feed_.publish("job", json_text(view_json(view, name)));
    });
}

std::string Jobs::to_json() const {
  Json json = Json::array();
  for (std::size_t i = 0; i < lanes_.size(); ++i)
    for (const JobView& view : lanes_[i]->jobs()) json.push_back(view_json(view, kLanes[i]));
  return json_text(json);
}

bool Jobs::stop(const std::string& lane, JobId id) {
  const auto* const found = std::find(std::begin(kLanes), std::end(kLanes), lane);
  return found != std::end(kLanes) && lanes_[static_cast<std::size_t>(found - kLanes)]->stop(id);
}

void Jobs::wait() {
  for (const auto& lane : lanes_) lane->wait();
}

void Jobs::end() {
  feed_.close();
  for (auto lane = lanes_.rbegin(); lane != lanes_.rend(); ++lane) lane->reset();
}

}  // namespace freshet::studio
