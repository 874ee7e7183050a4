#include "tests/studio/running_studio.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/sample.h"

namespace freshet::studio {

RunningStudio::RunningStudio() {
  std::filesystem::create_directories(folder_ / "page");
  folder_.file("page/index.html", "<!doctype html><title>page</title>");
  studio_ = std::make_unique<Studio>(StudioOptions{
      .folder = folder_ / "room", .stores = {tools::sample().store}, .program = tools::executable()});
  server_ = std::make_unique<Server>(
      *studio_, ServerOptions{.address = "127.0.0.1", .port = 0, .token = "", .page = folder_ / "page"});
  thread_ = std::thread([this] { server_->serve(); });
}

RunningStudio::~RunningStudio() {
  server_->stop();
  thread_.join();
}

std::string RunningStudio::host() const { return "127.0.0.1:" + std::to_string(port()); }

httplib::Result RunningStudio::get(const std::string& rest, const httplib::Headers& headers) const {
  httplib::Client client("127.0.0.1", port());
  client.set_read_timeout(60);
  return client.Get(path(rest), headers);
}

httplib::Result RunningStudio::send(const std::string& method, const std::string& rest,
                                    const std::string& body, const httplib::Headers& headers) const {
  httplib::Client client("127.0.0.1", port());
  client.set_read_timeout(60);
  const std::string to = path(rest), type = "application/octet-stream";
  if (method == "PUT") return client.Put(to, headers, body, type);
  if (method == "DELETE") return client.Delete(to, headers);
  return client.Post(to, headers, body, type);
}

nlohmann::json RunningStudio::json(const std::string& rest) const {
  const httplib::Result answer = get(rest);
  if (!answer) {
    ADD_FAILURE() << rest << " was not answered";
    return {};
  }
  EXPECT_EQ(answer->status, 200) << rest << ": " << answer->body;
  return nlohmann::json::parse(answer->body);
}

std::string RunningStudio::open_still(const std::string& name) const {
  return open_file(name, tools::text_of(tools::sample().still));
}

std::string RunningStudio::open_still(const std::string& name, const cv::Mat& picture) const {
  std::vector<std::uint8_t> png;
  cv::imencode(".png", picture, png);
  return open_file(name, {png.begin(), png.end()});
}

std::string RunningStudio::open_file(const std::string& name, const std::string& bytes) const {
  const httplib::Result answer = send("POST", "api/projects?name=" + name, bytes);
  EXPECT_TRUE(answer && answer->status == 200) << (answer ? answer->body : "no answer");
  return nlohmann::json::parse(answer->body)["id"];
}

void RunningStudio::draw(const std::string& project, const nlohmann::json& edit) {
  const nlohmann::json opened = json("api/projects/" + project);
  nlohmann::json document = opened["document"];
  document.update(edit);
  const std::string base = std::to_string(opened["version"].get<std::uint64_t>());
  const httplib::Result answer =
      send("PUT", "api/projects/" + project + "/document?page=test&base=" + base, document.dump());
  ASSERT_TRUE(answer);
  ASSERT_EQ(answer->status, 200) << answer->body;
  studio_->jobs().wait();
}

}  // namespace freshet::studio
