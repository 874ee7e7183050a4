// tests/studio/running_studio.h — a studio that serves in a thread of the test, and a page that asks it.
#pragma once

#include <memory>
#include <string>
#include <thread>

#include <httplib.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "studio/http/server.h"
#include "studio/studio.h"
#include "tests/tools/work_folder.h"

namespace freshet::studio {

class RunningStudio {
 public:
  /// With the sample's store, and a page of one line.
  RunningStudio();
  ~RunningStudio();

  Studio& studio() { return *studio_; }
  const tools::WorkFolder& folder() const { return folder_; }
  std::filesystem::path room() const { return folder_ / "room"; }
  int port() const { return server_->port(); }
  std::string path(const std::string& rest) const { return "/" + server_->token() + "/" + rest; }
  /// 127.0.0.1:PORT
  std::string host() const;

  httplib::Result get(const std::string& rest, const httplib::Headers& headers = {}) const;
  httplib::Result send(const std::string& method, const std::string& rest, const std::string& body,
                       const httplib::Headers& headers = {}) const;
  nlohmann::json json(const std::string& rest) const;
  /// The sample's still as a project. Returns its id.
  std::string open_still(const std::string& name = "still.png") const;
  /// The same of this picture.
  std::string open_still(const std::string& name, const cv::Mat& picture) const;
  /// Saves a changed document; `edit` is laid over what is there. Waits until it has been worked on.
  void draw(const std::string& project, const nlohmann::json& edit);

 private:
  std::string open_file(const std::string& name, const std::string& bytes) const;

  tools::WorkFolder folder_;
  std::unique_ptr<Studio> studio_;
  std::unique_ptr<Server> server_;
  std::thread thread_;
};

}  // namespace freshet::studio
