// Stores that are signed, and clips whose makers are credited.
#include <cstdlib>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/sample.h"
#include "tests/tools/work_folder.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

/// A folder with a signed store, and the keys of its maker and of somebody else.
class Signed : public WorkFolder {
 public:
  Signed() : store_(copy_of_store(*this, "signed.store")) {
    for (const char* who : {"maker", "other"}) minisign(fmt::format("-G -W -p {0}.pub -s {0}.key", who));
    minisign("-S -W -s maker.key -t water -m signed.store");
  }
  void minisign(const std::string& words) const {
    const std::string line =
        fmt::format("cd '{}' && minisign {} > /dev/null 2>&1", fs::path(*this / "").string(), words);
    ASSERT_EQ(std::system(line.c_str()), 0) << line;
  }
  Outcome verify(const std::string& key) const {
    return freshet({"store", "verify", "signed.store", "--signed-by", key});
  }
  void spoil(const std::string& name, std::size_t at) const {
    std::string bytes = text_of(*this / name);
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    file(name, bytes);
  }

 private:
  fs::path store_;
};

TEST(SignedStore, ItsMakersKeyOpensIt) {
  const Signed folder;
  EXPECT_EQ(folder.verify("maker.pub").exit_code, 0);
  std::istringstream lines(text_of(folder / "maker.pub"));
  std::string comment, key;
  std::getline(lines, comment), std::getline(lines, key);
  EXPECT_EQ(folder.verify(key).exit_code, 0);
  const Outcome outcome =
      folder.freshet({"synth", "animate", "signed.store", sample().still.string(), "--matte",
                      sample().matte.string(), "--frames", "2", "-o", "a.mkv", "--signed-by", "maker.pub"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST(SignedStore, AnotherStoreKeyOrSignatureIsRefused) {
  const auto fault = [](const Signed& folder, const std::string& key = "maker.pub") {
    const Outcome outcome = folder.verify(key);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
    return outcome.err;
  };
  const Signed folder;
  EXPECT_THAT(fault(folder, "other.pub"), HasSubstr("another key signed it"));
  EXPECT_THAT(fault(folder, "maker.key"), HasSubstr("no public key"));
  EXPECT_THAT(fault(folder, "none.pub"), HasSubstr("none.pub: it cannot be read"));
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"store", "verify", "signed.store", "--signed-by", ""},
        {"query", "candidates", "signed.store", sample().still.string(), "--whole", "--signed-by", ""}}) {
    const Outcome outcome = folder.freshet(command);  // a variable that is not set
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("--signed-by: an empty key would be anybody's"));
  }
  const std::string good = text_of(folder / "signed.store"), mark = text_of(folder / "signed.store.minisig");
  folder.spoil("signed.store", good.size() - 9);
  EXPECT_THAT(fault(folder), HasSubstr("not those that were signed"));
  folder.file("signed.store", good);
  folder.spoil("signed.store.minisig", mark.find("water"));
  EXPECT_THAT(fault(folder), HasSubstr("its comment is not the one"));
  for (std::size_t cut = 0; cut + 1 < mark.size(); cut += 37) {
    folder.file("signed.store.minisig", mark.substr(0, cut));
    EXPECT_EQ(folder.verify("maker.pub").exit_code, 1) << cut;
  }
  folder.file("signed.store.minisig", mark);
  EXPECT_EQ(folder.verify("maker.pub").exit_code, 0);
  folder.minisign("-S -l -W -s maker.key -m signed.store");
  EXPECT_THAT(fault(folder), HasSubstr("Sign it anew"));
  fs::remove(folder / "signed.store.minisig");
  EXPECT_THAT(fault(folder), HasSubstr("signed.store.minisig: it cannot be read"));
}

TEST(Credits, AFilmNamesWhoseClipsItShows) {
  const WorkFolder folder;
  folder.file("sources.toml",
              "[[clip]]\nname = \"fall\"\nlicence = \"CC BY 4.0\"\nauthor = \"Ada\"\n"
              "[[clip]]\nname = \"fall/2.mkv\"\nauthor = \"Bo\"\nsource = \"https://example.org/2\"\n");
  Outcome outcome = folder.freshet({"ingest", "my.store", sample().clips.string(), "--licence", "ours",
                                    "--sources", "sources.toml", "--words", "16"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto credits = [&](const std::string& name, const std::string& kind) {
    const Outcome made = folder.freshet({"synth", "animate", "my.store", sample().still.string(), "--matte",
                                         sample().matte.string(), "--class", kind, "--frames", "2", "-o",
                                         "a.mkv", "--overwrite", "--credits", name});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return text_of(folder / name);
  };
  double shares = 0;
  for (const json& each : json::parse(credits("credits.json", "fall"))) {
    const bool second = each["clip"] == "fall/2.mkv";
    EXPECT_EQ(each["author"], second ? "Bo" : "Ada");
    EXPECT_EQ(each["licence"], second ? "ours" : "CC BY 4.0") << "the row that names the clip alone counts";
    EXPECT_EQ(each["source"], second ? "https://example.org/2" : "");
    shares += each["share"].get<double>();
  }
  EXPECT_NEAR(shares, 1, 1e-9);
  EXPECT_EQ(credits("credits.txt", "river"),
            "The motion comes from these clips:\nriver/1.mkv (100 %): author not said, ours\n");
  folder.file("sources.toml", "[[clip]]\nname = \"fall\"\nlicense = \"CC0\"\n");
  outcome = folder.freshet({"ingest", "my.store", sample().clips.string(), "--sources", "sources.toml"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("license"));
}

}  // namespace
}  // namespace freshet::tools
