#include "studio/http/server.h"

#include <algorithm>
#include <atomic>
#include <fstream>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "studio/drawing/drawn.h"
#include "tests/studio/http/raw_client.h"
#include "tests/studio/running_studio.h"
#include "tests/tools/sample.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// One for all of them: what each leaves behind does not matter to the others.
class Server : public testing::Test {
 protected:
  static void SetUpTestSuite() { running_ = new RunningStudio; }
  static void TearDownTestSuite() {
    delete running_;
    running_ = nullptr;
  }
  static RunningStudio& running() { return *running_; }
  static int status(const httplib::Result& answer) { return answer ? answer->status : 0; }
  static inline RunningStudio* running_ = nullptr;
};

/// A scribble down the middle of the still, and a line along it.
Json drawing() {
  return {
      {"scribbles", {{{"points", {{96, 20}, {96, 120}}}, {"width", 12}, {"adds", true}, {"area", false}}}},
      {"strokes", {{{"points", {{96, 20}, {100, 120}}}, {"speed", nullptr}}}},
      {"class", "fall"},
      {"frames", 12}};
}

cv::Size jpeg_size(const std::string& bytes) {
  return cv::imdecode(std::vector<char>(bytes.begin(), bytes.end()), cv::IMREAD_COLOR).size();
}

/// A layer of a scene that is all of the picture.
Json whole_layer(const std::string& name, const std::string& motion) {
  return {{"name", name},
          {"motion", motion},
          {"matte", "rest"},
          {"paint", Json::array()},
          {"lines", Json::array()},
          {"plant", "tree"},
          {"shimmer", 0},
          {"waves", 0},
          {"mirrors", false},
          {"roll", 1},
          {"drift", 0},
          {"class", ""},
          {"clip", ""}};
}

TEST_F(Server, ServesItsPageToWhoKnowsTheToken) {
  const httplib::Result page = running().get("");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_NE(page->body.find("<title>page"), std::string::npos);
  EXPECT_NE(page->get_header_value("Content-Security-Policy").find("default-src 'none'"), std::string::npos);
  httplib::Client client("127.0.0.1", running().port());
  EXPECT_EQ(status(client.Get("/")), 403);
  EXPECT_EQ(status(client.Get("/api/home")), 403);
}

TEST_F(Server, TellsThePageWhichFilmsAreRead) {
  const Json home = running().json("api/home"), films = home["films"];
  EXPECT_EQ(home["furthest"], kFurthest);
  EXPECT_EQ(home["widest"], kWidest);
  for (const char* ending : {".mp4", ".mkv", ".ogv", ".mxf"})
    EXPECT_NE(std::ranges::find(films, ending), films.end()) << ending;
  for (const char* ending : {".png", ".webp", ".exr"})
    EXPECT_EQ(std::ranges::find(films, ending), films.end()) << ending;
}

TEST_F(Server, RefusesForeignHostsAndPages) {
  EXPECT_EQ(status(running().get("api/home")), 200);
  EXPECT_EQ(status(running().get("api/home", {{"Host", "evil.example"}})), 403);
  EXPECT_EQ(status(running().get("api/home", {{"Origin", "http://evil.example"}})), 403);
  EXPECT_EQ(status(running().get("api/home", {{"Origin", "http://" + running().host()}})), 200);
  EXPECT_EQ(status(running().get("api/home", {{"Sec-Fetch-Site", "cross-site"}})), 403);
  EXPECT_EQ(status(running().send("POST", "api/stores", "{\"name\":\"a\"}", {{"Origin", "null"}})), 403);
}

TEST_F(Server, LeadsNowhereOutside) {
  const std::string id = running().open_still("outside.png");
  running().folder().file("secret.mp4", "secret");
  fs::create_directories(running().room() / "projects" / id / "exports");
  fs::create_symlink(running().folder() / "secret.mp4",
                     running().room() / "projects" / id / "exports/link.mp4");
  fs::create_directory_symlink(running().folder().path(), running().room() / "projects/linked");
  for (const char* rest :
       {"../../etc/passwd", "page/../../../etc/passwd", "..%2f..%2fetc%2fpasswd",
        "api/projects/../../secret.mp4", "api/projects/%2e%2e/picture", "api/projects/linked",
        "api/projects/linked/picture", "api/projects/outside/exports/..%2fpicture.png",
        "api/projects/outside/exports/link.mp4", "api/projects/outside/exports/%2e%2e",
        "api/stores/..%2f..%2f/clips/0", "index.html/../..", "%00", "//etc/passwd"}) {
    const httplib::Result answer = running().get(rest);
    EXPECT_GE(status(answer), 400) << rest;
    EXPECT_LT(status(answer), 500) << rest;
    EXPECT_TRUE(!answer || answer->body.find("secret\n") == std::string::npos) << rest;
  }
  EXPECT_EQ(
      status(running().send("POST", "api/projects/" + id + "/exports", R"({"name": "../../../x.mp4"})")),
      400);
  EXPECT_EQ(status(running().send("POST", "api/projects/" + id + "/exports",
                                  R"({"name": "x.mp4", "layer": "a --o"})")),
            400);
  Json document = running().json("api/projects/" + id)["document"];
  document["store"] = "/etc/passwd";
  EXPECT_EQ(status(running().send("PUT", "api/projects/" + id + "/document?base=0", document.dump())), 400);
}

TEST_F(Server, RenamesAndCopiesAProjectWithoutItsLinks) {
  const std::string id = running().open_still("to copy.png");
  const fs::path projects = running().room() / "projects";
  running().draw(id, {{"frames", 13}});
  fs::create_directories(projects / id / "exports");
  std::ofstream(projects / id / "exports/made.mp4") << "film";
  fs::create_symlink("/etc/passwd", projects / id / "link.txt");
  EXPECT_EQ(status(running().send("POST", "api/projects/" + id + "/name", R"({"name": "../../out"})")), 200);
  EXPECT_FALSE(fs::exists(projects.parent_path() / "out"));  // a name, not a path
  EXPECT_TRUE(fs::exists(projects / "out/document.json"));
  EXPECT_EQ(status(running().send("POST", "api/projects/out/copies", "{}")), 200);
  EXPECT_EQ(running().json("api/projects/out-2")["document"]["frames"], 13);
  EXPECT_FALSE(fs::exists(projects / "out-2/exports"));
  EXPECT_FALSE(fs::exists(fs::symlink_status(projects / "out-2/link.txt")));
  const std::string other = running().open_still("another.png");
  EXPECT_EQ(status(running().send("POST", "api/projects/out/name", R"({"name": "another"})")), 400);
  EXPECT_EQ(status(running().send("POST", "api/projects/none/name", R"({"name": "some"})")), 404);
  EXPECT_EQ(status(running().send("POST", "api/projects/linked/copies", "{}")), 404);
}

TEST_F(Server, TakesAreOfTheAnimationThatIsThere) {
  const std::string id = running().open_still("taken.png"), at = "api/projects/" + id + "/takes";
  EXPECT_TRUE(running().json(at).is_null());
  running().draw(id, drawing());
  EXPECT_EQ(status(running().send("POST", at, "{}")), 200);
  running().studio().jobs().previews().wait();
  const Json takes = running().json(at);
  ASSERT_GE(takes["takes"].size(), 3U);
  EXPECT_TRUE(takes["takes"][0]["change"].empty());
  EXPECT_FALSE(takes["takes"][1]["change"].empty());
  const httplib::Result strip = running().get(at + "/" + takes["number"].dump() + "/1");
  ASSERT_EQ(status(strip), 200);
  const cv::Mat frames =
      cv::imdecode(std::vector<char>(strip->body.begin(), strip->body.end()), cv::IMREAD_COLOR);
  EXPECT_GT(frames.cols, 4 * frames.rows);  // side by side
  EXPECT_EQ(status(running().get(at + "/" + takes["number"].dump() + "/99")), 404);
  EXPECT_EQ(status(running().get(at + "/1/0")), 404);
}

/// The answer to a head, whose body may never be sent.
std::string answer_to(int port, const std::string& head) {
  const RawClient client(port);
  return client.send(head) ? client.read_all() : "";
}

TEST_F(Server, RefusesTooMuchBeforeItIsSent) {
  const auto head = [&](const std::string& rest, const std::string& more) {
    return "POST " + running().path(rest) + " HTTP/1.1\r\nHost: " + running().host() + "\r\n" + more + "\r\n";
  };
  const std::string five_gb = "Content-Length: 5368709120\r\n";
  EXPECT_NE(answer_to(running().port(), head("api/projects?name=a.png", five_gb)).find(" 413 "),
            std::string::npos);
  EXPECT_NE(answer_to(running().port(), head("api/stores/x/clips", five_gb)).find(" 413 "),
            std::string::npos);
  EXPECT_NE(answer_to(running().port(), head("api/stores", "Content-Length: 20000000\r\n")).find(" 413 "),
            std::string::npos);
  EXPECT_NE(answer_to(running().port(), head("nowhere", "Content-Length: 20000000\r\n")).find(" 413 "),
            std::string::npos);
  EXPECT_NE(answer_to(running().port(), head("api/stores", "Transfer-Encoding: chunked\r\n")).find(" 411 "),
            std::string::npos);
}

TEST_F(Server, SlowConnectionsHoldNobodyUp) {
  std::vector<RawClient> slow;
  for (int i = 0; i < 100; ++i) slow.emplace_back(running().port()).send("GET /x HTTP/1.1\r\nX: ");
  httplib::Client client("127.0.0.1", running().port());
  client.set_read_timeout(5);
  for (int i = 0; i < 10; ++i) {
    for (const RawClient& one : slow) one.send("a");
    EXPECT_EQ(status(client.Get(running().path("api/home"))), 200);
  }
}

TEST_F(Server, AFloodOfHeadersIsCutOff) {
  const RawClient client(running().port());
  client.send("GET /x HTTP/1.1\r\n");
  const std::string header = "X: " + std::string(4000, 'a') + "\r\n";
  std::size_t sent = 0;
  while (sent < (32u << 20) && client.send(header)) sent += header.size();
  EXPECT_LT(sent, 8u << 20) << "the rest of what was sent lies in sockets";
}

TEST_F(Server, BadPlacesInTheEventsCostNothing) {
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(status(running().get("api/events", {{"Last-Event-ID", "x"}})), 404);
    EXPECT_EQ(status(running().get("api/events?after=-1")), 404);
  }
  const RawClient page(running().port());
  page.send("GET " + running().path("api/events?after=0") + " HTTP/1.1\r\nHost: " + running().host() +
            "\r\n\r\n");
  running().open_still("event.png");
  char head[16] = {};
  EXPECT_TRUE(page.has_answer(10'000));
  EXPECT_EQ(page.read(head, 12), 12u);
  EXPECT_EQ(std::string(head, 12), "HTTP/1.1 200");
}

TEST_F(Server, PagesThatAreClosedMakeRoomForOthers) {
  const std::string head =
      "GET " + running().path("api/events") + " HTTP/1.1\r\nHost: " + running().host() + "\r\n\r\n";
  const auto is_heard = [&](const RawClient& page) {
    char answer[12] = {};
    return page.read(answer, 12) == 12 && std::string(answer, 12) == "HTTP/1.1 200";
  };
  std::vector<RawClient> pages;
  int heard_at_once = 0;
  for (int i = 0; i < 9; ++i) {
    pages.emplace_back(running().port()).send(head);
    heard_at_once += is_heard(pages.back());
  }
  EXPECT_GE(heard_at_once, 6) << "pages of other tests may linger";
  EXPECT_LE(heard_at_once, 8);
  EXPECT_NE(answer_to(running().port(), head).find(" 400 "), std::string::npos) << "one too many";
  pages.clear();
  bool heard = false;
  for (int tries = 0; tries < 30 && !heard; ++tries) {  // who is gone is seen when something is sent to him
    ::usleep(500'000);
    const RawClient page(running().port());
    page.send(head);
    heard = is_heard(page);
  }
  EXPECT_TRUE(heard);
}

TEST_F(Server, TakesABodyOnlyAsItIs) {
  const std::string head = "POST " + running().path("api/projects?name=a.png") +
                           " HTTP/1.1\r\nHost: " + running().host() + "\r\nContent-Length: 5\r\n";
  for (const char* header :
       {"Content-Type: multipart/form-data; boundary=x", "Content-Type: multipart/form-data",
        "Content-Encoding: gzip", "Content-Encoding: br"})
    EXPECT_NE(answer_to(running().port(), head + header + "\r\n\r\nAAAAA").find(" 415 "), std::string::npos)
        << header;
  EXPECT_NE(answer_to(running().port(),
                      head + "Content-Type: a/b\r\nContent-Type: multipart/form-data\r\n\r\nAAAAA")
                .find(" 400 "),
            std::string::npos);
}

TEST_F(Server, RefusesWhatIsNoPicture) {
  EXPECT_EQ(status(running().send("POST", "api/projects?name=a.png", "no picture")), 400);
  EXPECT_EQ(status(running().send("POST", "api/projects?name=a.sh", "#!/bin/sh")), 400);
  EXPECT_TRUE(fs::is_empty(running().room() / "incoming"));
}

TEST_F(Server, FaultsNameThePersonsFile) {
  const std::string png = tools::text_of(tools::sample().still);
  for (const std::string& bytes : {std::string("no picture"), png.substr(0, png.size() / 2)}) {
    const httplib::Result answer = running().send("POST", "api/projects?name=My%20fall.png", bytes);
    ASSERT_EQ(status(answer), 400);
    const std::string fault = Json::parse(answer->body)["fault"];
    EXPECT_TRUE(fault.starts_with("My fall.png: ")) << fault;
    EXPECT_EQ(fault.find(running().room().string()), std::string::npos) << fault;
  }
}

TEST_F(Server, WhatIsAskedOfAWayBeforeItIsDrawnIsNoFault) {
  const std::string id = running().open_still("undrawn.png");
  for (const char* way : {"design", "flowlines", "lines", "scene", "sweep"}) {
    const Json found = running().json("api/projects/" + id + "/ways/" + way);
    EXPECT_FALSE(found["lacks"].get<std::string>().empty()) << way;
    EXPECT_EQ(found["film"], Json()) << way;
    EXPECT_EQ(status(running().send("POST", "api/projects/" + id + "/ways/" + way, "{}")), 400) << way;
  }
  EXPECT_EQ(running().json("api/projects/" + id + "/ways/stills")["lacks"], "");
  EXPECT_EQ(status(running().get("api/projects/" + id + "/ways/elsewhere")), 404);
}

TEST_F(Server, StillsAreTakenShownAndRemoved) {
  const std::string id = running().open_still();
  const std::string at = "api/projects/" + id + "/stills";
  const std::string still = tools::text_of(tools::sample().still);
  EXPECT_EQ(status(running().send("POST", at + "?name=..%2f..%2fA%20B.PNG", still)), 200);
  EXPECT_EQ(status(running().send("POST", at + "?name=a-b.png", still)), 200);        // the same one again
  EXPECT_EQ(status(running().send("POST", at + "?name=a-b.png", still + "x")), 200);  // another one
  EXPECT_EQ(running().json(at), Json({"a-b-2.png", "a-b.png"}));
  EXPECT_EQ(status(running().send("POST", at + "?name=a.sh", "#!/bin/sh")), 400);
  EXPECT_EQ(running().get(at + "/a-b.png")->get_header_value("Content-Type"), "image/jpeg");
  EXPECT_EQ(jpeg_size(running().get(at + "/a-b.png")->body).width, 160);
  EXPECT_EQ(jpeg_size(running().get(at + "/a-b.png?whole=1")->body),
            cv::imread(tools::sample().still).size());
  EXPECT_EQ(status(running().get(at + "/..%2f..%2f..%2fpicture.png")), 404);
  const std::string files = "api/projects/" + id + "/ways/stills/files/";
  for (const char* name : {"regions.png", "film.mp4", "edits.toml", "..%2f..%2fdocument.json"})
    EXPECT_EQ(status(running().get(files + name)), 404) << name;
  EXPECT_EQ(status(running().send("DELETE", at, "")), 200);
  EXPECT_EQ(running().json(at), Json::array());
}

TEST_F(Server, ClipsAreTakenShownAndMadeEndless) {
  const std::string clip = tools::text_of(tools::sample().clips / "fall/1.mkv");
  const std::string id = Json::parse(running().send("POST", "api/clips?name=A%20Fall.mkv", clip)->body)["id"];
  EXPECT_EQ(running().json("api/projects/" + id)["document"]["flowlines"]["clip"], "a-fall.mkv");
  EXPECT_EQ(Json::parse(running().send("POST", "api/clips?name=A%20Fall.mkv", clip)->body)["id"], id);
  const std::string at = "api/projects/" + id + "/clips";
  EXPECT_EQ(running().json(at), Json({"a-fall.mkv"}));
  EXPECT_EQ(status(running().send("POST", at + "?name=..%2f..%2fa.mkv", clip)), 200);
  EXPECT_EQ(status(running().send("POST", at + "?name=a.sh", "#!/bin/sh")), 400);
  EXPECT_EQ(status(running().send("POST", "api/clips?name=a.mkv", "no clip")), 400);
  EXPECT_EQ(status(running().send("POST", "api/projects/" + id + "/clips?name=a.mkv", "no clip")), 400);
  EXPECT_EQ(running().json(at), Json({"a-fall.mkv", "a.mkv"}));
  EXPECT_TRUE(fs::is_empty(running().room() / "incoming"));
  const httplib::Result frame = running().get(at + "/frame?clip=a.mkv&own=1");
  EXPECT_EQ(status(frame), 200);
  EXPECT_EQ(frame->get_header_value("Content-Type"), "image/jpeg");
  EXPECT_EQ(status(running().get(at + "/frame?clip=fall/1.mkv")), 200);  // of the store
  for (const char* clip_name : {"b.mkv", "..%2f..%2fpicture.png", "..%2fclips%2fa.mkv", ""})
    EXPECT_EQ(status(running().get(at + "/frame?own=1&clip=" + clip_name)), 404) << clip_name;

  running().draw(id, {{"flowlines",
                       {{"clip", "a.mkv"},
                        {"dropped", true},
                        {"lines", Json::array()},
                        {"edited", Json::array()},
                        {"join", 0},
                        {"stretched", false},
                        {"ground", "none"},
                        {"frames", 20},
                        {"loop", false},
                        {"moving_camera", false}}}});
  const std::string ways = "api/projects/" + id + "/ways/";
  for (const char* way : {"lines", "flowlines"}) {
    EXPECT_EQ(running().json(ways + way)["made"], Json()) << way;
    EXPECT_EQ(status(running().send("POST", ways + way, "{}")), 200);
    running().studio().jobs().wait();
    EXPECT_TRUE(running().json(ways + way)["made"].is_string()) << running().json("api/jobs");
  }
  const std::string found = running().json(ways + "lines")["shown"][0];
  EXPECT_NE(running().get(ways + "lines/files/" + found)->body.find("<path id=\"l1\""), std::string::npos);
  EXPECT_EQ(running().json(ways + "lines")["film"], Json());
  EXPECT_EQ(status(running().get(ways + "lines/film")), 404);
  EXPECT_EQ(running().get(ways + "flowlines/film")->get_header_value("Content-Type"), "video/mp4");
  // As another kind of file, by the same command.
  const httplib::Result exported =
      running().send("POST", ways + "flowlines/exports", R"({"name": "endless.mkv"})");
  ASSERT_EQ(status(exported), 200) << exported->body;
  running().studio().jobs().wait();
  const fs::path project = running().room() / "projects" / id;
  EXPECT_GT(fs::file_size(project / "exports/endless.mkv"), 1000u) << running().json("api/jobs");
  EXPECT_NE(Json::parse(exported->body)["command"].get<std::string>().find("-o exports/endless.mkv"),
            std::string::npos);
  EXPECT_EQ(status(running().send("POST", ways + "flowlines/exports", R"({"name": "../a.mkv"})")), 400);
  EXPECT_EQ(status(running().send("POST", ways + "lines/exports", R"({"name": "a.mkv"})")), 400);
  EXPECT_EQ(status(running().send("POST", ways + "flowlines/exports", R"({"name": "a.mov", "alone": true})")),
            400);
  EXPECT_EQ(running().json(ways + "flowlines")["alone"], "");
  // A browser seeks in it by asking for a part.
  const std::string film = running().get(ways + "flowlines/film")->body;
  const httplib::Result part = running().get(ways + "flowlines/film", {{"Range", "bytes=100-299"}});
  EXPECT_EQ(status(part), 206);
  EXPECT_EQ(part->body, film.substr(100, 200));
}

/// What became of the last job of a way.
std::string fault_of(RunningStudio& running, const std::string& id, const std::string& way) {
  std::string fault = "it was not run";
  const httplib::Result answer = running.send("POST", "api/projects/" + id + "/ways/" + way, "{}");
  if (!answer || answer->status != 200) return answer ? answer->body : "no answer";
  running.studio().jobs().wait();
  for (const Json& job : running.json("api/jobs"))
    if (job["id"] == Json::parse(answer->body)["job"] && job["lane"] == "command") fault = job["fault"];
  return fault;
}

/// The smoke that a document designs.
Json smoke(const Json& document, const std::string& look) {
  Json design = document["design"];
  design["frames"] = 2;
  design["look"] = look;
  design["sources"] = {{{"points", {{80, 80}}}, {"width", 20}, {"adds", true}, {"area", false}}};
  return {{"design", design}};
}

TEST_F(Server, CommandsFollowNoLinkOfAProject) {
  const std::string id = running().open_still("planted.png");
  const fs::path project = running().room() / "projects" / id;
  running().draw(id, smoke(running().json("api/projects/" + id)["document"], ""));
  const tools::WorkFolder outside;
  fs::create_directories(project / "ways/design");
  fs::create_directory_symlink(outside.path(), project / "ways/design/motion");
  EXPECT_NE(fault_of(running(), id, "design").find("symbolic link"), std::string::npos);
  EXPECT_TRUE(fs::is_empty(outside.path())) << "nothing was written outside";
  fs::remove(project / "ways/design/motion");
  EXPECT_EQ(fault_of(running(), id, "design"), "");

  fs::copy_file(tools::sample().clips / "fall/1.mkv", outside / "private.mkv");
  fs::create_directories(project / "ways/flowlines/clips");
  fs::create_symlink(outside / "private.mkv", project / "ways/flowlines/clips/leak.mkv");
  Json flowlines = running().json("api/projects/" + id)["document"]["flowlines"];
  flowlines.update({{"clip", "leak.mkv"}, {"dropped", true}, {"frames", 4}});
  running().draw(id, {{"flowlines", flowlines}});
  EXPECT_NE(fault_of(running(), id, "flowlines").find("symbolic link"), std::string::npos);
  EXPECT_EQ(status(running().get("api/projects/" + id + "/ways/flowlines/film")), 404);
}

TEST_F(Server, ADocumentOpensNoStoreThatIsNotOpen) {
  const tools::WorkFolder elsewhere;
  const fs::path store = tools::copy_of_store(elsewhere, "unopened.store");
  const std::string id = running().open_still("unopened.png");
  Json document = running().json("api/projects/" + id)["document"];
  document.update(smoke(document, "fall/1.mkv"));
  document["store"] = store.string();
  document["flowlines"].update({{"clip", "fall/1.mkv"}, {"dropped", false}, {"frames", 4}});
  document["sweep"]["axes"] = {{{"setting", "speed"}, {"values", {"1", "2"}}}};
  document["scene"]["layers"] = Json::array({whole_layer("fall", "patches")});
  // A page cannot say this, a file can: in a folder that came from somebody else.
  const fs::path planted = running().room() / "projects/planted-store";
  fs::create_directory(planted);
  for (const fs::directory_entry& entry : fs::directory_iterator(running().room() / "projects" / id)) {
    std::error_code gone;  // what is being written has another name by now
    fs::copy(entry, planted / entry.path().filename(), fs::copy_options::recursive, gone);
  }
  std::ofstream(planted / "document.json") << document.dump();
  for (const char* way : {"design", "flowlines", "lines", "scene", "sweep"})
    EXPECT_NE(fault_of(running(), "planted-store", way).find("not open"), std::string::npos) << way;
}

TEST_F(Server, ProjectsThatMakeRoomForOthersAreWholeMeanwhile) {
  std::vector<std::thread> pages;
  std::atomic<int> answered{0};
  for (const char* name : {"one.png", "two.png", "three.png", "four.png"})  // two are kept open
    pages.emplace_back([&answered, id = running().open_still(name)] {
      for (int i = 0; i < 25; ++i)
        answered += status(running().get("api/projects/" + id + "/ways/stills")) == 200 &&
                    status(running().get("api/projects/" + id + "/exports")) == 200;
    });
  for (std::thread& page : pages) page.join();
  EXPECT_EQ(answered, 100);
}

TEST_F(Server, GivesNamesAsTheyAre) {
  // A store whose clip's name is a page: the answer is JSON, and never taken for anything else.
  const std::string store = Json::parse(
      running().send("POST", "api/stores", R"({"name": "<script>alert(1)</script>"})")->body)["id"];
  const httplib::Result home = running().get("api/home");
  EXPECT_EQ(home->get_header_value("Content-Type"), "application/json");
  EXPECT_EQ(home->get_header_value("X-Content-Type-Options"), "nosniff");
  EXPECT_EQ(home->body.find("<script>"), std::string::npos);  // of its name a file was to be made
  EXPECT_EQ(
      status(running().send("POST", "api/stores/" + store + "/clips?class=..&name=..%2f..%2fa.mp4", "x")),
      200);
  EXPECT_FALSE(fs::exists(running().room() / "a.mp4"));
  EXPECT_EQ(status(running().send("POST", "api/stores/" + store + "/clips?class=a&name=a.sh", "x")), 400);
}

TEST_F(Server, ShowsItMovingAndWhy) {
  const std::string id = running().open_still("moving.png");
  running().draw(id, drawing());
  const Json made = running().json("api/projects/" + id)["made"];
  EXPECT_EQ(made["problem"], "");
  ASSERT_TRUE(made["matte"].is_object()) << made;
  ASSERT_TRUE(made["full"].is_object()) << made;
  EXPECT_EQ(made["full"]["ready"], 12);
  EXPECT_EQ(made["full"]["width"], tools::kWidth);
  const httplib::Result frame = running().get(
      fmt::format("api/projects/{}/reels/{}/11", id, made["full"]["number"].get<std::uint64_t>()));
  EXPECT_EQ(status(frame), 200);
  EXPECT_EQ(frame->get_header_value("Content-Type"), "image/jpeg");
  EXPECT_EQ(running().json("api/projects/" + id + "/field")["source"], "strokes");
  const Json pieces = running().json("api/projects/" + id + "/pieces");
  ASSERT_GT(pieces["pieces"].size(), 4u);
  EXPECT_EQ(status(running().get("api/projects/" + id + "/pieces/0/0")), 200);
  EXPECT_EQ(status(running().get("api/projects/" + id + "/pieces/100000")), 404);
}

/// Changes a document, and does not wait for what becomes of it.
void change(RunningStudio& running, const std::string& id, const Json& edit) {
  const Json opened = running.json("api/projects/" + id);
  Json document = opened["document"];
  document.update(edit);
  const httplib::Result answer =
      running.send("PUT", fmt::format("api/projects/{}/document?base={}", id, opened["version"].get<int>()),
                   document.dump());
  ASSERT_TRUE(answer);
  ASSERT_EQ(answer->status, 200) << answer->body;
}

TEST_F(Server, AChangeThatIsTakenBackLeavesTheAnimationThatStood) {
  const std::string id = running().open_still("back.png");
  running().draw(id, drawing());
  const Json before = running().json("api/projects/" + id)["made"];
  for (const char* stage : {"small", "full"}) {
    // Taken back as soon as a new reel of this stage has begun: the worst moment.
    change(running(), id, {{"speed", 0.5}, {"frames", 400}});
    const auto begun = [&] {
      return running().json("api/projects/" + id + "/made")[stage]["number"] != before[stage]["number"];
    };
    for (int tries = 0; !begun() && tries < 2000; ++tries) ::usleep(10'000);
    ASSERT_TRUE(begun()) << stage;
    const std::uint64_t news = running().studio().jobs().feed().last();
    change(running(), id, {{"speed", 1}, {"frames", 12}});
    running().studio().jobs().wait();
    Json settled;
    for (const Event& event : running().studio().jobs().feed().after(news, std::chrono::milliseconds(0)))
      if (event.type == "settled") settled = Json::parse(event.data);
    ASSERT_TRUE(settled["reel"].is_object()) << stage;
    EXPECT_EQ(settled["reel"]["total"], 12) << stage;
    EXPECT_EQ(settled["reel"]["ready"], 12) << stage;
    EXPECT_EQ(running().json("api/projects/" + id + "/made")["full"], settled["reel"]) << stage;
  }
}

TEST_F(Server, APinnedPieceHasItsPatch) {
  const std::string id = running().open_still("pinned.png");
  running().draw(id, drawing());
  const Json before = running().json("api/projects/" + id + "/pieces/3");
  const Json& other = before["candidates"][before["chosen"] == 5 ? 6 : 5];
  running().draw(id, {{"pins",
                       {{{"x", before["x"]},
                         {"y", before["y"]},
                         {"clip", other["clip"]},
                         {"variant", other["variant"]},
                         {"patch_x", other["x"]},
                         {"patch_y", other["y"]}}}}});
  const Json after = running().json("api/projects/" + id + "/pieces/3");
  EXPECT_TRUE(after["pinned"]);
  ASSERT_EQ(after["candidates"].size(), 1u);
  for (const char* what : {"clip", "variant", "x", "y", "score"})
    EXPECT_EQ(after["candidates"][0][what], other[what]) << what;
}

/// A film that was exported, and the command line that the answer names.
struct Exported {
  fs::path folder;
  std::string command;
};

Exported exported(RunningStudio& running, const std::string& id, const std::string& name, Json asked) {
  asked["name"] = name;
  const httplib::Result answer = running.send("POST", "api/projects/" + id + "/exports", asked.dump());
  if (!answer || answer->status != 200) throw std::runtime_error(answer ? answer->body : "no answer");
  running.studio().jobs().wait();
  const Json told = Json::parse(answer->body);
  for (const Json& job : running.json("api/jobs"))
    if (job["id"] == told["job"]) {
      EXPECT_NE(job["state"], "failed") << job;
    }
  return {told["folder"].get<std::string>(), told["command"]};
}

tools::Outcome made_again(RunningStudio& running, const Exported& film, const std::string& options = {}) {
  std::string line = film.command + options;
  line.replace(0, std::string("freshet").size(), tools::executable());
  return running.folder().run({"sh", "-c", "cd '" + film.folder.string() + "' && " + line});
}

/// What it exports, and what the command line makes of it again, are the same bytes.
void expect_same_bytes(RunningStudio& running, const std::string& id, const std::string& name,
                       const Json& asked) {
  const Exported film = exported(running, id, name, asked);
  const fs::path file = film.folder / "exports" / name;
  const std::string made = tools::text_of(file);
  ASSERT_FALSE(made.empty());
  fs::rename(file, film.folder / "exports" / ("studio-" + name));
  const tools::Outcome outcome = made_again(running, film);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(tools::text_of(file) == made, true) << "the bytes of " << name << " differ";
}

TEST_F(Server, WhatItExportsTheCommandLineMakesAgain) {
  const std::string id = running().open_still("exported.png");
  running().draw(id, drawing());
  expect_same_bytes(running(), id, "whole.mkv", Json::object());
  expect_same_bytes(running(), id, "fluid.mov", {{"layer", "fluid"}});
  // Held back, slower, and with a piece pinned.
  const Json piece = running().json("api/projects/" + id + "/pieces/2");
  const Json& other = piece["candidates"][piece["chosen"] == 4 ? 3 : 4];
  running().draw(id, {{"held", {{{"points", {{90, 60}}}, {"width", 20}, {"adds", true}, {"area", false}}}},
                      {"speed", 0.5},
                      {"pins",
                       {{{"x", piece["x"]},
                         {"y", piece["y"]},
                         {"clip", other["clip"]},
                         {"variant", other["variant"]},
                         {"patch_x", other["x"]},
                         {"patch_y", other["y"]}}}}});
  expect_same_bytes(running(), id, "pinned.mkv", Json::object());
  EXPECT_NE(tools::text_of(running().room() / "projects" / id / "project.toml").find("assignment.json"),
            std::string::npos);
}

TEST_F(Server, AProjectThatMakesRoomForOthersIsOpenedOnceAndExported) {
  const std::string before = running().open_still("before.png"), id = running().open_still("worked.png"),
                    others[] = {running().open_still("room.png"), running().open_still("more-room.png")};
  const auto made = [&](const std::string& project) {
    return running().json("api/projects/" + project + "/made");
  };
  Json long_one = drawing();
  long_one["frames"] = 1500;
  change(running(), before, long_one);
  change(running(), id, drawing());  // it waits
  for (const std::string& other : others) made(other);
  made(id);
  running().studio().jobs().previews().stop_key(before);
  running().studio().jobs().wait();
  EXPECT_EQ(made(id)["full"]["ready"], 12);
  for (const std::string& other : others) made(other);
  EXPECT_FALSE(tools::text_of(exported(running(), id, "late.mkv", Json::object()).folder / "exports/late.mkv")
                   .empty());
}

TEST_F(Server, PaintedPaceIsTheCommandLinesToo) {
  const std::string id = running().open_still("paced.png");
  running().draw(id, drawing());
  expect_same_bytes(running(), id, "filmed.mkv", Json::object());
  const auto tempo = [](double factor) {
    return Json{{"tempo", {{{"points", {{96, 0}, {96, 144}}}, {"width", 200}, {"factor", factor}}}}};
  };
  running().draw(id, tempo(0.5));
  expect_same_bytes(running(), id, "slow.mkv", Json::object());
  const fs::path exports = running().room() / "projects" / id / "exports";
  EXPECT_FALSE(tools::text_of(exports / "filmed.mkv") == tools::text_of(exports / "slow.mkv"));
  running().draw(id, {{"tempo", Json::array()}});
  running().draw(id, {{"speed", 0.5}});
  expect_same_bytes(running(), id, "half.mkv", Json::object());
  EXPECT_TRUE(tools::text_of(exports / "slow.mkv") == tools::text_of(exports / "half.mkv"));
}

TEST_F(Server, AHorizonIsTheCommandLinesTooUnlessItIsRefused) {
  const std::string id = running().open_still("horizon.png");
  Json drawn = drawing();
  drawn["scribbles"] = Json::array();
  drawn["paint"] = {
      {{"points", {{0, 72}, {192, 72}, {192, 144}, {0, 144}}}, {"width", 1}, {"adds", true}, {"area", true}}};
  drawn["class"] = "";
  running().draw(id, drawn);
  EXPECT_EQ(running().json("api/projects/" + id)["document"]["horizon"], "auto");
  expect_same_bytes(running(), id, "auto.mkv", Json::object());
  running().draw(id, {{"horizon", "none"}});
  expect_same_bytes(running(), id, "none.mkv", Json::object());
  const fs::path exports = running().room() / "projects" / id / "exports";
  EXPECT_FALSE(tools::text_of(exports / "auto.mkv") == tools::text_of(exports / "none.mkv"));
}

TEST_F(Server, APaceThatIsChosenIsTheCommandLinesToo) {
  const std::string id = running().open_still("chosen.png");
  running().draw(id, drawing());
  const Exported film = exported(running(), id, "filmed.mkv", Json::object());
  const Json paces = running().json("api/projects/" + id + "/pieces")["paces"];
  for (const char* const pace :
       {"slow", "natural", "fast"}) {  // auto is as filmed: nobody knows a fall's pace
    SCOPED_TRACE(pace);
    const tools::Outcome made = made_again(running(), film, std::string(" --overwrite --speed ") + pace);
    EXPECT_EQ(made.exit_code, 0) << made.err;
    EXPECT_NE(made.err.find(fmt::format("plays at {:.2f}", paces[pace].get<double>())), std::string::npos)
        << made.err << paces;
  }
}

TEST_F(Server, ABrushedDirectionIsTheCommandLinesToo) {
  const std::string id = running().open_still("brushed.png");
  Json drawn = drawing();
  drawn["strokes"] = Json::array();
  drawn["directions"] = {{{"points", {{60, 30}, {130, 90}}}, {"width", 40}, {"adds", true}, {"area", false}}};
  running().draw(id, drawn);
  EXPECT_EQ(running().json("api/projects/" + id + "/field")["source"], "strokes");
  expect_same_bytes(running(), id, "brushed.mkv", {{"width", "128"}});
  // Beside the picture there is nothing to direct.
  drawn["directions"][0]["points"] = {{-600, 30}, {-300, 90}};
  running().draw(id, drawn);
  EXPECT_EQ(running().json("api/projects/" + id)["made"]["problem"], "");
  expect_same_bytes(running(), id, "guessed.mkv", Json::object());
}

TEST_F(Server, ASequenceIsAFolderOfPictures) {
  const std::string id = running().open_still("sequence.png");
  running().draw(id, drawing());
  const httplib::Result answer = running().send(
      "POST", "api/projects/" + id + "/exports",
      R"({"name": "fluid.exr", "layer": "fluid", "depth": "half", "range": "1003-1005", "start-number": "1001"})");
  ASSERT_EQ(status(answer), 200) << answer->body;
  running().studio().jobs().wait();
  const fs::path folder = running().room() / "projects" / id / "exports/fluid";
  for (const char* name : {"fluid.1003.exr", "fluid.1004.exr", "fluid.1005.exr"})
    EXPECT_TRUE(fs::exists(folder / name)) << name;
  const Json files = running().json("api/projects/" + id + "/exports")["files"];
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(files[0]["pictures"], 3);
  fs::create_directory_symlink(running().folder().path(),
                               running().room() / "projects" / id / "exports/away");
  EXPECT_EQ(status(running().send("POST", "api/projects/" + id + "/exports", R"({"name": "away.png"})")),
            400);
}

TEST_F(Server, WhatCanBeUndoneIsKept) {
  const std::string id = running().open_still("undone.png"), rest = "api/projects/" + id + "/history";
  EXPECT_EQ(running().get(rest)->body, "null");
  const std::string steps = R"({"of":"1","at":1,"steps":[[]]})";
  EXPECT_EQ(status(running().send("PUT", rest, steps)), 200);
  EXPECT_EQ(running().get(rest)->body, steps);
  EXPECT_EQ(status(running().send("PUT", rest, "{")), 400);
  EXPECT_EQ(status(running().send("PUT", rest, std::string(50'000, '['))), 400);
  EXPECT_EQ(status(running().send("PUT", rest, '"' + std::string(5u << 20, 'x') + '"')), 400);
  EXPECT_EQ(running().get(rest)->body, steps);
}

TEST_F(Server, WhatLooksAsIfItStoodIsOfferedUntilItIsHeld) {
  // Dark, rough banks, and blue water between them, of which the matte takes in a rim of the bank.
  cv::Mat picture(240, 320, CV_8UC3), rough(picture.size(), CV_8U);
  cv::RNG(1).fill(rough, cv::RNG::UNIFORM, 0, 90);
  cv::merge(std::vector<cv::Mat>{rough, rough + 25, rough + 15}, picture);
  picture.colRange(100, 220).setTo(cv::Scalar(170, 140, 110));
  const std::string id = running().open_still("stream.png", picture), at = "api/projects/" + id + "/standing";
  EXPECT_EQ(status(running().get(at)), 404) << "there is no matte yet";
  const Json area{
      {"points", {{100, 0}, {226, 0}, {226, 240}, {100, 240}}}, {"width", 0}, {"adds", true}, {"area", true}};
  running().draw(id, {{"paint", {area}}});
  const Json offered = running().json(at);
  ASSERT_GE(offered.size(), 1U);
  std::vector<cv::Point2f> outline;
  Json points = Json::array();
  for (std::size_t i = 0; i + 1 < offered[0].size(); i += 2) {
    outline.emplace_back(offered[0][i].get<float>(), offered[0][i + 1].get<float>());
    points.push_back({offered[0][i], offered[0][i + 1]});
  }
  EXPECT_GT(cv::pointPolygonTest(outline, {223, 120}, false), 0);
  EXPECT_LT(cv::pointPolygonTest(outline, {160, 120}, false), 0);
  running().draw(id, {{"held", {{{"points", points}, {"width", 0}, {"adds", true}, {"area", true}}}}});
  for (const Json& left : running().json(at)) EXPECT_NE(left, offered[0]) << "it is held";
}

TEST_F(Server, AClickHoldsWhatLiesThereUpToItsSizeAndLetsItGo) {
  cv::Mat picture(240, 320, CV_8UC3, cv::Scalar(170, 140, 110));
  cv::circle(picture, {200, 120}, 20, cv::Scalar(40, 90, 60), cv::FILLED);
  const std::string id = running().open_still("lily.png", picture), at = "api/projects/" + id + "/standing";
  const auto click = [&](int x, int y, double size, const Json& held) {
    return running().send("POST", at, Json{{"x", x}, {"y", y}, {"size", size}, {"held", held}}.dump());
  };
  const Json nothing = Json::array();
  EXPECT_EQ(status(click(200, 120, 1, nothing)), 404) << "there is no matte yet";
  const auto area = [](const Json& points) {
    return Json{{"points", points}, {"width", 0}, {"adds", true}, {"area", true}};
  };
  running().draw(id, {{"paint", {area({{0, 0}, {320, 0}, {320, 240}, {0, 240}})}}});
  const auto taken = [](const Json& answer) {
    cv::Mat drawn = cv::Mat::zeros(240, 320, CV_8U);
    for (const Json& outline : answer["outlines"]) {
      std::vector<cv::Point> points;
      for (std::size_t i = 0; i + 1 < outline.size(); i += 2)
        points.emplace_back(static_cast<int>(outline[i].get<float>()),
                            static_cast<int>(outline[i + 1].get<float>()));
      cv::fillPoly(drawn, points, 255);
    }
    return drawn;
  };
  const Json lily = Json::parse(click(205, 125, 1, nothing)->body);
  EXPECT_EQ(lily["holds"], true);
  EXPECT_NEAR(cv::countNonZero(taken(lily)), .02 * 320 * 240, 150);
  EXPECT_NE(taken(lily).at<std::uint8_t>(110, 190), 0) << "across the lily";
  EXPECT_EQ(taken(lily).at<std::uint8_t>(125, 226), 0) << "the water beside it is as near to the click";
  EXPECT_NEAR(cv::countNonZero(taken(Json::parse(click(60, 60, 3, nothing)->body))), .06 * 320 * 240, 300);

  // What is held: both halves of the picture's middle, each by a click of its own; the right one is let go.
  const Json left = area({{100, 60}, {160, 60}, {160, 180}, {100, 180}}),
             right = area({{160, 60}, {220, 60}, {220, 180}, {160, 180}});
  const Json answer = Json::parse(click(175, 120, 50, {left, right})->body);
  EXPECT_EQ(answer["holds"], false);
  EXPECT_NE(taken(answer).at<std::uint8_t>(120, 176), 0);
  EXPECT_EQ(taken(answer).at<std::uint8_t>(120, 130), 0) << "nearer to the other click's middle";
  EXPECT_EQ(taken(answer).at<std::uint8_t>(30, 176), 0) << "was not held";

  EXPECT_EQ(status(click(400, 120, 1, nothing)), 404);
  EXPECT_EQ(status(click(10, 10, 0, nothing)), 400);
  EXPECT_EQ(status(running().send("POST", at, R"({"x": 1, "y": 1, "size": 1})")), 400);
}

TEST_F(Server, ALayersScribblesAreAMatteAtOnce) {
  const std::string id = running().open_still("scribbled.png");
  const std::string at = "api/projects/" + id + "/layers/";
  Json scene = running().json("api/projects/" + id)["document"]["scene"];
  const auto scribble = [](double x, bool adds) {
    return Json{{"points", {{x, 30}, {x, 110}}}, {"width", 8}, {"adds", adds}, {"area", false}};
  };
  scene["layers"] = Json::array(
      {{{"name", "fall"},
        {"motion", "patches"},
        {"matte", "scribbled"},
        {"paint", {scribble(90, true), scribble(8, false)}}},
       {{"name", "rest"}, {"motion", "still"}, {"matte", "scribbled"}, {"paint", {scribble(8, false)}}}});
  for (Json& layer : scene["layers"]) {
    Json whole = whole_layer("", "");
    whole.update(layer);
    layer = whole;
  }
  running().draw(id, {{"scene", scene}});
  const httplib::Result found = running().get(at + "0/matte");
  ASSERT_EQ(status(found), 200) << found->body;
  const std::vector<std::uint8_t> bytes(found->body.begin(), found->body.end());
  const cv::Mat matte = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  ASSERT_EQ(matte.type(), CV_8UC4);
  EXPECT_GT(matte.at<cv::Vec4b>(70, 90)[3], 200) << "on the scribble";
  EXPECT_LT(matte.at<cv::Vec4b>(70, 8)[3], 50) << "beside it";
  EXPECT_EQ(status(running().get(at + "1/matte")), 404) << "nothing is scribbled on it";
  EXPECT_EQ(status(running().get(at + "2/matte")), 404);
  EXPECT_EQ(status(running().get(at + "x/matte")), 404);
}

TEST_F(Server, ASceneIsExportedWithItsLayers) {
  const std::string id = running().open_still("layered.png");
  Json scene = running().json("api/projects/" + id)["document"]["scene"];
  scene["frames"] = 3;
  scene["layers"] = Json::array({whole_layer("land", "still")});
  running().draw(id, {{"scene", scene}});
  const std::string way = "api/projects/" + id + "/ways/scene";
  EXPECT_EQ(running().json(way)["alone"], "layers");
  const httplib::Result exported =
      running().send("POST", way + "/exports", R"({"name": "all.exr", "alone": true})");
  ASSERT_EQ(status(exported), 200) << exported->body;
  EXPECT_NE(Json::parse(exported->body)["command"].get<std::string>().find("--layers-out"),
            std::string::npos);
  running().studio().jobs().wait();
  const fs::path exports = running().room() / "projects" / id / "exports/all";
  EXPECT_GT(fs::file_size(exports / "all.0002.exr"), 1000u) << running().json("api/jobs");
}

TEST_F(Server, AStoreGrowsByWhatIsSent) {
  const std::string store =
      Json::parse(running().send("POST", "api/stores", R"({"name": "sent"})")->body)["id"];
  const std::string clip = tools::text_of(tools::sample().clips / "fall/1.mkv");
  ASSERT_EQ(status(running().send("POST", "api/stores/" + store + "/clips?class=fall&name=one.mkv", clip)),
            200);
  ASSERT_EQ(
      status(running().send("POST", "api/stores/" + store + "/ingest", R"({"licence": "ours; -o /x"})")),
      200);
  running().studio().jobs().wait();
  const Json found = running().json("api/stores/" + store);
  ASSERT_EQ(found["clips"].size(), 1u) << found << running().json("api/jobs");
  EXPECT_EQ(found["clips"][0]["licence"], "ours; -o /x");
  EXPECT_EQ(status(running().get("api/stores/" + store + "/clips/0")), 200);
}

TEST_F(Server, AnIngestThatStopsAnotherTakesItsClipsToo) {
  const std::string store =
      Json::parse(running().send("POST", "api/stores", R"({"name": "twice"})")->body)["id"];
  const std::string clip = tools::text_of(tools::sample().clips / "fall/1.mkv");
  for (const char* name : {"one.mkv", "two.mkv"}) {
    const std::string at = "api/stores/" + store;
    ASSERT_EQ(status(running().send("POST", at + "/clips?class=" + name + "&name=" + name, clip + name)),
              200);
    ASSERT_EQ(status(running().send("POST", at + "/ingest", R"({"licence": ""})")), 200);
  }
  running().studio().jobs().wait();
  EXPECT_EQ(running().json("api/stores/" + store)["clips"].size(), 2u) << running().json("api/jobs");
}

TEST_F(Server, AStoreIsTakenOver) {
  const std::string bytes = tools::text_of(tools::sample().store);
  const auto given = [&](const std::string& name, const std::string& body) {
    return running().send("POST", "api/stores/file?name=" + name, body);
  };
  const httplib::Result taken = given("..%2F..%2Fmine.freshet", bytes);
  ASSERT_EQ(status(taken), 200) << taken->body;
  const std::string id = Json::parse(taken->body)["id"];
  EXPECT_EQ(running().json("api/stores/" + id)["clips"].size(),
            store::Store::open_read(tools::sample().store).snapshot().clips().size());
  EXPECT_TRUE(fs::exists(running().room() / "stores/mine.freshet"));
  EXPECT_EQ(Json::parse(given("mine.freshet", bytes)->body)["id"], id) << "it is there once";
  EXPECT_EQ(status(given("none.freshet", "no store")), 400);
  EXPECT_EQ(status(given("cut.freshet", bytes.substr(0, bytes.size() / 2))), 400);
  EXPECT_FALSE(fs::exists(running().room() / "stores/none.freshet"));
  for (const fs::directory_entry& entry : fs::directory_iterator(running().room() / "incoming"))
    EXPECT_TRUE(entry.is_directory()) << entry.path();
}

TEST_F(Server, WhatIsRefusedIsShownWithItsReasons) {
  const std::string store =
      Json::parse(running().send("POST", "api/stores", R"({"name": "refused"})")->body)["id"];
  const std::string at = "api/stores/" + store;
  const tools::WorkFolder folder;
  ASSERT_EQ(
      folder
          .freshet({"synth", "simulate", "waterfall", "--size", "96x72", "--frames", "3", "-o", "short.mkv"})
          .exit_code,
      0);
  ASSERT_EQ(status(running().send("POST", at + "/clips?class=fall&name=short.mkv",
                                  tools::text_of(folder / "short.mkv"))),
            200);
  ASSERT_EQ(status(running().send("POST", at + "/clips?class=fall&name=broken.mkv", "no video")), 200);
  const std::uint64_t before = running().studio().jobs().feed().last();
  ASSERT_EQ(status(running().send("POST", at + "/ingest", R"({"licence": ""})")), 200);
  running().studio().jobs().wait();
  Json clips;
  for (const Event& event : running().studio().jobs().feed().after(before, std::chrono::milliseconds(0)))
    if (event.type == "ingested") clips = Json::parse(event.data)["report"]["clips"];
  ASSERT_EQ(clips.size(), 2u) << running().json("api/jobs");
  for (const Json& clip : clips) {
    EXPECT_NE(clip["outcome"], "added") << clip;
    EXPECT_FALSE(clip["reasons"].empty()) << clip;
    const bool is_video = clip["name"] == "fall/short.mkv";
    ASSERT_EQ(clip.contains("strip"), is_video) << clip;
    if (!is_video) continue;
    const auto number = clip["strip"].get<std::uint64_t>();
    EXPECT_EQ(status(running().get(fmt::format("api/screened/{}", number))), 200);
  }
  EXPECT_EQ(status(running().get("api/screened/1")), 404);
}

TEST_F(Server, AJobIsStopped) {
  const std::string id = running().open_still("stopped.png");
  Json long_one = drawing();
  long_one["frames"] = 1500;
  change(running(), id, long_one);
  std::uint64_t job = 0;
  for (const Json& each : running().json("api/jobs"))
    if (each["lane"] == "preview" && each["key"] == id &&
        (each["state"] == "running" || each["state"] == "waiting"))
      job = each["id"];
  ASSERT_NE(job, 0u);
  EXPECT_EQ(
      Json::parse(running().send("DELETE", fmt::format("api/jobs/preview/{}", job), "")->body)["stopped"],
      true);
  running().studio().jobs().wait();
  for (const Json& each : running().json("api/jobs")) {
    if (each["lane"] != "preview" || each["id"] != job) continue;
    EXPECT_EQ(each["state"], "stopped");
  }
}

}  // namespace
}  // namespace freshet::studio
