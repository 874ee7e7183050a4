// freshet query bench.

#include <gtest/gtest.h>

#include <filesystem>

#include <nlohmann/json.hpp>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Outcome bench(const WorkFolder& folder, std::vector<std::string> more) {
  std::vector<std::string> arguments{"query", "bench", sample().store, "--pieces", "12", "--seconds", "0.01"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return folder.freshet(arguments);
}

TEST(Bench, WritesATableJsonAndAPageOfThePicturesPieces) {
  const WorkFolder folder;
  const Outcome outcome =
      bench(folder, {"--pictures", sample().still.string() + ":" + sample().matte.string(), "--index",
                     "exact,flann-hierarchical", "--json", "r.json", "--page", "p.html"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* expected : {"recall@1", "flann-hierarchical", "checks 128", "still", "r.json", "p.html"})
    EXPECT_NE(outcome.out.find(expected), std::string::npos) << expected << "\n" << outcome.out;
  const json report = json::parse(text_of(folder / "r.json"));
  ASSERT_EQ(report["indexes"].size(), 2U);
  EXPECT_EQ(report["pictures"][0]["name"], "still");
  EXPECT_EQ(report["wrong"], 0);
  EXPECT_EQ(report["indexes"][0]["settings"][0]["recall_100"], 1);
  EXPECT_TRUE(report["indexes"][1]["settings"][0].contains("energy_loss"));
  EXPECT_GE(report["indexes"][1]["filters"].size(), 1U);
  const std::string page = text_of(folder / "p.html");
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_NE(page.find("sample.store"), std::string::npos);
  EXPECT_EQ(digest(sample().store), sample_digest());
}

TEST(Bench, WithoutPicturesTakesAClipOfTheStoreAndPrintsJson) {
  const WorkFolder folder;
  const Outcome outcome = bench(folder, {"--index", "exact", "--no-label", "--no-filters", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json report = json::parse(outcome.out);
  EXPECT_EQ(report["held_out_clip"], report["pictures"][0]["name"]);
  EXPECT_LT(report["rows"], report["patches"]);
  EXPECT_FALSE(report.contains("labelled"));
  EXPECT_TRUE(report["indexes"][0]["filters"].empty());
  EXPECT_TRUE(fs::is_empty(folder.path()) || !fs::exists(folder / "--no-label"));
}

TEST(Bench, SaysWhatIsWrong) {
  const WorkFolder folder;
  struct Wrong {
    std::vector<std::string> arguments;
    int exit_code;
    const char* message;
  };
  for (const Wrong& wrong : std::initializer_list<Wrong>{
           {{"query", "bench", "no.store"}, 1, "no.store"},
           {{"query", "bench"}, 2, "STORE is required"},
           {{"query", "bench", sample().store, "--pictures", "no.png"}, 1, "no.png"},
           {{"query", "bench", sample().store, "--pictures", sample().still.string() + ":no.png"},
            1,
            "no.png"},
           {{"query", "bench", sample().store, "--rows", "100000000"}, 2, "patches to search among"},
           {{"query", "bench", sample().store, "--rows", "0"}, 2, "--rows"},
           {{"query", "bench", sample().store, "--index", "best"}, 2, "There are exact, scan"},
           {{"query", "bench", sample().store, "--page", (sample().still / "p.html").string()},
            1,
            "cannot be made"},
           {{"query", "bench", sample().still}, 1, "still.png"}}) {
    const Outcome outcome = folder.freshet(wrong.arguments);
    EXPECT_EQ(outcome.exit_code, wrong.exit_code) << wrong.message << ": " << outcome.err;
    EXPECT_NE(outcome.err.find(wrong.message), std::string::npos) << wrong.message << ": " << outcome.err;
    EXPECT_TRUE(outcome.out.empty()) << wrong.message;
  }
}

}  // namespace
}  // namespace freshet::tools
