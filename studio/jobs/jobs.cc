#include "studio/jobs/jobs.h"

#include <nlohmann/json.hpp>

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

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

Jobs::Jobs()
    : previews_(std::make_unique<JobQueue>(watcher("preview"))),
      commands_(std::make_unique<JobQueue>(watcher("command"))) {}

JobQueue::Watcher Jobs::watcher(const char* lane) {
  return [this, lane](const JobView& view) { feed_.publish("job", json_text(view_json(view, lane))); };
}

std::string Jobs::to_json() const {
  Json json = Json::array();
  for (const JobView& view : previews_->jobs()) json.push_back(view_json(view, "preview"));
  for (const JobView& view : commands_->jobs()) json.push_back(view_json(view, "command"));
  return json_text(json);
}

bool Jobs::stop(const std::string& lane, JobId id) {
  return lane == "preview" ? previews_->stop(id) : commands_->stop(id);
}

void Jobs::wait() {
  previews_->wait();
  commands_->wait();
}

void Jobs::end() {
  feed_.close();
  commands_.reset();
  previews_.reset();
}

}  // namespace freshet::studio
