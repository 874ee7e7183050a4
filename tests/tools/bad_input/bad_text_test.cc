// Files of text that a command is given: pipes, endless and absurdly nested ones.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

class BadText : public testing::Test {
 protected:
  /// Every command that takes such a file, with NAME in its place. A timeout kills what waits for ever.
  std::vector<std::vector<std::string>> commands(const std::string& toml, const std::string& json,
                                                 const std::string& drawing) const {
    const std::string store = sample().store, still = sample().still;
    return {{"--config", toml, "store", "info", store},
            {"synth", "simulate", toml, "-o", "out.mkv"},
            {"query", "label", store, still, "--strokes", json},
            {"query", "label", store, still, "--strokes", drawing},
            {"synth", "animate", store, still, "--whole", "--assignment", json, "-o", "out.mkv"},
            {"synth", "matte", still, "--marks", json, "-o", "matte.png"}};
  }
  void expect_refusals(const std::vector<std::vector<std::string>>& all, const std::string& fault) {
    for (const auto& arguments : all) {
      std::vector<std::string> command{"timeout", "-s", "KILL", "60", executable()};
      command.insert(command.end(), arguments.begin(), arguments.end());
      const Outcome outcome = folder_.run(command);
      const std::string name = arguments[0] + " " + arguments[1];
      EXPECT_EQ(outcome.signal, 0) << name;
      EXPECT_TRUE(outcome.exit_code == 1 || outcome.exit_code == 2) << name << ": " << outcome.exit_code;
      EXPECT_EQ(outcome.err.rfind("freshet: ", 0), 0U) << name << ": " << outcome.err;
      EXPECT_NE(outcome.err.find(fault), std::string::npos) << name << ": " << outcome.err;
      EXPECT_EQ(outcome.err.find("unexpected"), std::string::npos) << name << ": " << outcome.err;
    }
  }
  WorkFolder folder_;
};

TEST_F(BadText, APipeIsNotWaitedFor) {
  for (const char* name : {"p.toml", "p.json", "p.svg"})
    ASSERT_EQ(::mkfifo((folder_ / name).c_str(), 0600), 0);
  expect_refusals(commands("p.toml", "p.json", "p.svg"), " file");
  ASSERT_EQ(::mkfifo((folder_ / "p.store").c_str(), 0600), 0);
  expect_refusals({{"store", "info", "p.store"}, {"ingest", "p.store", sample().clips}}, "is not a file");
}

TEST_F(BadText, AnEndlessFileIsNotRead) {
  for (const char* name : {"z.toml", "z.json", "z.svg"})
    std::filesystem::create_symlink("/dev/zero", folder_ / name);
  expect_refusals(commands("z.toml", "z.json", "z.svg"), " file");
}

TEST_F(BadText, AbsurdNestingIsRefusedByName) {
  std::string dotted = "a";
  for (int i = 0; i < 50000; ++i) dotted += ".a";
  const std::string open(300000, '['), close(300000, ']');
  std::string groups = "<svg xmlns=\"http://www.w3.org/2000/svg\">";
  for (int i = 0; i < 200000; ++i) groups += "<g>";
  folder_.file("deep.svg", groups);
  folder_.file("deep.json",
               R"({"format": "freshet-strokes", "version": 1, "strokes": )" + open + close + "}");
  for (const std::string& toml : {dotted + " = 1\n", "[" + dotted + "]\n", "[[" + dotted + "]]\n",
                                  "x = " + open + close, "x = {" + dotted + " = 1}\n"}) {
    folder_.file("deep.toml", toml);
    std::vector<std::vector<std::string>> all = commands("deep.toml", "deep.json", "deep.svg");
    if (toml.starts_with("a")) {
      expect_refusals({all[0], all[1], all[2], all[4], all[5]}, "levels deep");
      expect_refusals({all[3]}, "deep.svg");
    } else {
      expect_refusals({all[0], all[1]}, "levels deep");
    }
  }
}

TEST_F(BadText, ANulHidesNeitherFaultNorRemedy) {
  folder_.file("scene.toml",
               "picture = \"still.png\"\nframes = 3\n[[layer]]\nname = \"a\"\nmotion = \"clouds\"\n"
               "matte = \"p\\u0000x\"\n");
  folder_.file("key.toml", "\"pic\\u0000ture\" = \"still.png\"\n");
  folder_.file("run.toml", "[synth.simulate]\noutput = \"out\\u0000.mkv\"\n");
  expect_refusals({{"synth", "scene", "scene.toml", "-o", "out.mkv"}},
                  "scene.toml:6: a text in it has a NUL (\\u0000). Remove it");
  expect_refusals({{"synth", "simulate", "key.toml", "-o", "out.mkv"}}, "key.toml:1: a text in it has a NUL");
  expect_refusals({{"--config", "run.toml", "synth", "simulate", "river"}}, "the text in line 2 has a NUL");
}

TEST_F(BadText, AMessageStaysReadable) {
  folder_.file("scene.toml",
               "picture = \"" + std::string(1 << 20, 'A') +
                   "\"\nframes = 3\n[[layer]]\nname = \"a\"\nmatte = \"rest\"\nmotion = \"clouds\"\n");
  const Outcome outcome = folder_.freshet({"synth", "scene", "scene.toml", "-o", "out.mkv"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err.rfind("freshet: ", 0), 0U);
  EXPECT_LT(outcome.err.size(), 5000U);
  EXPECT_NE(outcome.err.find("bytes more"), std::string::npos);
}

TEST_F(BadText, EntitiesOfADrawingAreNotExpanded) {
  std::string bomb = "<?xml version=\"1.0\"?><!DOCTYPE svg [<!ENTITY a \"aaaaaaaaaa\">";
  for (char c = 'b'; c < 'm'; ++c) {
    bomb += std::string("<!ENTITY ") + c + " \"";
    for (int i = 0; i < 10; ++i) bomb += std::string("&") + static_cast<char>(c - 1) + ";";
    bomb += "\">";
  }
  bomb += "]><svg xmlns=\"http://www.w3.org/2000/svg\"><path d=\"&l;\"/></svg>";
  folder_.file("bomb.svg", bomb);
  expect_refusals({{"query", "label", sample().store, sample().still, "--strokes", "bomb.svg"}}, "bomb.svg");
}

}  // namespace
}  // namespace freshet::tools
