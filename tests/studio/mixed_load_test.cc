// Several pages of one studio at a time, on more projects than it keeps open, and commands beside it on the same store.

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/studio/running_studio.h"
#include "tests/tools/sample.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kPainters = 3, kRounds = 2;
constexpr int kClipsSent = 1;

/// A studio under load: what its pages do, and what they must not be answered.
class Load {
 public:
  Load() {
    const Json taken = posted("api/stores/file?name=load.freshet", tools::text_of(tools::sample().store));
    store_ = taken["id"];
    path_ = running_.json("api/stores/" + store_)["path"];
    for (int i = 0; i < kPainters; ++i)
      projects_.push_back(running_.open_still(fmt::format("load{}.png", i)));
  }

  RunningStudio& running() { return running_; }
  const std::string& store() const { return path_; }
  const std::vector<std::string>& projects() const { return projects_; }

  /// What is there, or is not there yet; a fault of the studio's is none of the answers.
  httplib::Result asked(const std::string& rest) {
    httplib::Result answer = running_.get(rest);
    EXPECT_TRUE(answer && (answer->status == 200 || answer->status == 404))
        << rest << ": " << (answer ? answer->body : "no answer");
    return answer;
  }

  Json posted(const std::string& rest, const std::string& body = "{}") {
    const httplib::Result answer = running_.send("POST", rest, body);
    EXPECT_TRUE(answer && answer->status == 200) << rest << ": " << (answer ? answer->body : "no answer");
    return answer && answer->status == 200 ? Json::parse(answer->body) : Json::object();
  }

  void stop(const std::string& lane, const Json& job) {
    const httplib::Result answer =
        running_.send("DELETE", fmt::format("api/jobs/{}/{}", lane, job.dump()), "");
    EXPECT_TRUE(answer && answer->status == 200) << lane << job;
  }

  /// A line whose lower end lies elsewhere in each round. A project that was opened anew meanwhile counts anew.
  void draw(const std::string& project, int round) {
    const Json scribble{{"points", {{96, 20}, {96, 120}}}, {"width", 12}, {"adds", true}, {"area", false}};
    for (int attempt = 0; attempt < 20; ++attempt) {
      const Json opened = running_.json("api/projects/" + project);
      Json document = opened["document"];
      document.update({{"store", path_},
                       {"scribbles", {scribble}},
                       {"strokes", {{{"points", {{96, 20}, {90 + 4 * round, 120}}}, {"speed", nullptr}}}},
                       {"class", "fall"},
                       {"frames", 6 + round}});
      const httplib::Result answer = running_.send(
          "PUT", fmt::format("api/projects/{}/document?base={}", project, opened["version"].dump()),
          document.dump());
      ASSERT_TRUE(answer && (answer->status == 200 || answer->status == 409)) << answer->body;
      if (answer->status == 200) return;
    }
    ADD_FAILURE() << project << " is never taken";
  }

  void look(const std::string& project) {
    const std::string at = "api/projects/" + project + "/";
    const Json made = Json::parse(asked(at + "made")->body);
    for (const char* stage : {"small", "full"})
      if (made[stage].is_object())
        for (int frame = 0; frame <= made[stage]["ready"].get<int>(); frame += 3)
          asked(fmt::format("{}reels/{}/{}", at, made[stage]["number"].dump(), frame));
    if (made["matte"].is_object())
      asked(fmt::format("{}mattes/{}/alpha", at, made["matte"]["number"].dump()));
    for (const char* rest : {"field", "pieces", "pieces/1", "pieces/1/0", "standing", "picture?longest=96",
                             "credits", "exports", "takes", "history", "ways/scene"})
      asked(at + rest);
  }

  void paint(const std::string& project) {
    for (int round = 0; round < kRounds; ++round) {
      draw(project, round);
      for (int i = 0; i < 3; ++i) look(project);
      posted(fmt::format("api/projects/{}/layers?from={}", project, round));
      const Json exported = posted("api/projects/" + project + "/exports", R"({"name": "stopped.mkv"})");
      look(project);
      stop("command", exported["job"]);
      if (round == 1) posted("api/projects/" + project + "/takes");
    }
  }

  /// Copies of a project while it is drawn on, under other names, and gone again.
  void keep_house(const std::string& project) {
    for (int round = 0; round < kRounds; ++round) {
      const Json copy = posted("api/projects/" + project + "/copies");
      if (!copy.contains("id")) return;
      const std::string name = fmt::format("renamed{}", round);
      asked("api/projects/" + copy["id"].get<std::string>());  // it begins to move
      posted("api/projects/" + copy["id"].get<std::string>() + "/name", Json{{"name", name}}.dump());
      asked("api/projects/" + name + "/thumbnail");
      const httplib::Result gone = running_.send("DELETE", "api/projects/" + name, "");
      EXPECT_TRUE(gone && gone->status == 200) << name;
      asked("api/home");
    }
  }

  void send_clips() {
    const std::string clip = tools::text_of(tools::sample().clips / "fall/1.mkv"),
                      at = "api/stores/" + store_;
    for (int i = 0; i < kClipsSent; ++i) {
      const std::string name = fmt::format("sent{}.mkv", i);
      running_.send("POST", fmt::format("{}/clips?class=fall&name={}", at, name), clip + name);
      const Json ingest = posted(at + "/ingest", R"({"licence": ""})");
      for (bool busy = true; busy;) {
        busy = false;
        for (const Json& job : running_.json("api/jobs"))
          busy |= job["id"] == ingest["job"] && (job["state"] == "running" || job["state"] == "waiting");
        asked(at);
        asked(at + "/clips/0");
      }
    }
  }

  /// Until the studio is ended; numbers grow by one, which none of a page's events are lost by.
  void listen() {
    httplib::Client client("127.0.0.1", running_.port());
    std::string heard;
    client.Get(running_.path("api/events?after=0"), [&](const char* bytes, std::size_t size) {
      heard.append(bytes, size);
      return heard.find("event: the-end") == std::string::npos;
    });
    EXPECT_EQ(heard.find("event: gap"), std::string::npos);
    std::istringstream lines(heard);
    std::uint64_t last = 0;
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with("id: ")) {
        EXPECT_EQ(std::stoull(line.substr(4)), last + 1);
        ++last;
      }
    EXPECT_GT(last, 100u);
  }

  /// Commands that read the store while clips are added to it.
  void run_beside(const std::atomic<bool>& over) {
    const std::string still = tools::sample().still, matte = tools::sample().matte;
    do {
      for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
               {"query", "label", path_, still, "--matte", matte, "--overwrite", "-o", "beside.json"},
               {"synth", "animate", path_, still, "--matte", matte, "--frames", "4", "--overwrite", "-o",
                "beside.mkv"}}) {
        const tools::Outcome outcome = running_.folder().freshet(command);
        const bool outdated =
            outcome.err.find("clips have been added since its index was built") != std::string::npos;
        EXPECT_TRUE(outcome.exit_code == 0 || (outcome.exit_code == 1 && outdated)) << outcome.err;
      }
    } while (!over);
  }

 private:
  RunningStudio running_;
  std::string store_, path_;
  std::vector<std::string> projects_;
};

TEST(MixedLoad, LeavesWhatAQuietStudioMakes) {
  Load load;
  RunningStudio& running = load.running();
  std::vector<std::thread> pages;
  std::atomic<bool> over{false};
  std::thread listener([&] { load.listen(); }), beside([&] { load.run_beside(over); });
  for (const std::string& project : load.projects()) pages.emplace_back([&] { load.paint(project); });
  pages.emplace_back([&] { load.keep_house(load.projects().front()); });
  pages.emplace_back([&] { load.send_clips(); });
  for (std::thread& page : pages) page.join();
  running.studio().jobs().wait();
  over = true;
  beside.join();

  // All at once again, and nothing is stopped: each exports what it has drawn.
  std::vector<Json> exported;
  for (const std::string& project : load.projects()) load.draw(project, kRounds);
  for (const std::string& project : load.projects())
    exported.push_back(load.posted("api/projects/" + project + "/exports", R"({"name": "film.mkv"})"));
  running.studio().jobs().wait();
  for (const Json& job : running.json("api/jobs"))
    for (const Json& of : exported) {
      if (job["id"] == of["job"]) {
        EXPECT_EQ(job["state"], "done") << job;
      }
    }
  for (const std::string& project : load.projects()) {
    const fs::path folder = running.room() / "projects" / project;
    const tools::Outcome again =
        running.folder().run({"sh", "-c",
                              "cd '" + folder.string() + "' && exec " + tools::executable() +
                                  " synth animate --config project.toml --overwrite -o again.mkv"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_TRUE(tools::text_of(folder / "exports/film.mkv") == tools::text_of(folder / "again.mkv"))
        << project;
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(running.room() / "projects"))
    EXPECT_TRUE(std::ranges::count(load.projects(), entry.path().filename().string()) == 1) << entry.path();
  const tools::Outcome verified = running.folder().freshet({"store", "verify", load.store()});
  EXPECT_EQ(verified.exit_code, 0) << verified.err;
  EXPECT_EQ(store::Store::open_read(load.store()).snapshot().clips().size(),
            store::Store::open_read(tools::sample().store).snapshot().clips().size() + kClipsSent);
  running.studio().jobs().feed().publish("the-end", "{}");
  listener.join();
}

}  // namespace
}  // namespace freshet::studio
