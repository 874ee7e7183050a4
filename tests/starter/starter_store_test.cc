#include "starter/starter_store.h"

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <future>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "freshet/error.h"
#include "store/store.h"

namespace freshet::starter {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTiny = R"(size = [128, 96]
frames = 12
[[clip]]
name = "water/sea"
clip = "sea"
[[clip]]
name = "fire/fast"
clip = "fire"
speed = 2.5
zoom = 1.5
)";

class StarterStore : public ::testing::Test {
 protected:
  fs::path folder_ = fs::temp_directory_path() / ("freshet-starter-" + std::to_string(::getpid()));
  Recipe tiny_ = parse_recipe(kTiny, "tiny.toml");

  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
      names.insert(entry.path().filename().string());
    return names;
  }
  std::string digest_with(int threads) const {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
    const fs::path file = folder_ / std::to_string(threads);
    EXPECT_TRUE(make_store(file, tiny_));
    return store::Store::open_read(file).snapshot().digest();
  }
};

// Who changes a simulator, ingest or the index puts the new digest here and raises kVersion in recipe.cc: stores in
// people's caches are then made anew.
TEST_F(StarterStore, HasTheDigestThatItHadOnOtherMachines) {
  EXPECT_EQ(digest_with(1), "a58f73f0358f5c0cd0436c6888549aee");
  EXPECT_EQ(digest_with(2), "a58f73f0358f5c0cd0436c6888549aee");
}

TEST_F(StarterStore, HoldsEachClipOfTheRecipeUnderItsNameAndClass) {
  ASSERT_TRUE(make_store(folder_ / "a.store", tiny_));
  const store::Snapshot snapshot = store::Store::open_read(folder_ / "a.store").snapshot();
  std::set<std::string> clips;
  for (const store::ClipId id : snapshot.clips())
    clips.insert(snapshot.clip(id).class_name + ":" + snapshot.clip(id).name);
  EXPECT_EQ(clips, (std::set<std::string>{"fire:fire/fast.y4m", "water:water/sea.y4m"}));
}

TEST_F(StarterStore, IsMadeOnceByWhoeverComesFirst) {
  const auto make = [&] { return make_store(folder_ / "a.store", tiny_); };
  std::future<bool> one = std::async(std::launch::async, make), other = std::async(std::launch::async, make);
  EXPECT_EQ(static_cast<int>(one.get()) + static_cast<int>(other.get()), 1);
  EXPECT_FALSE(make());
  EXPECT_EQ(files(), std::set<std::string>{"a.store"});
}

TEST_F(StarterStore, IsBegunAnewAfterAKill) {
  for (const char* name : {"a.store.unfinished", "a.store.unfinished-lock", "a.store.making"})
    std::ofstream(folder_ / name) << "left behind";
  fs::create_directories(folder_ / "a.store.clips/fire");
  EXPECT_TRUE(make_store(folder_ / "a.store", tiny_));
  EXPECT_EQ(files(), std::set<std::string>{"a.store"});
}

TEST_F(StarterStore, LeavesNothingWhenStoppedAtAnyStage) {
  for (const std::size_t at : {std::size_t{1}, std::size_t{13}, std::size_t{30}, std::size_t{48}}) {
    std::stop_source stop;
    const Job job{.progress =
                      [&](const Progress& progress) {
                        if (progress.done >= at) stop.request_stop();
                      },
                  .stop = stop.get_token()};
    try {
      make_store(folder_ / "a.store", tiny_, job);
      FAIL() << at;
    } catch (const Error& fault) {
      EXPECT_EQ(fault.kind(), ErrorKind::kCancelled);
    }
    EXPECT_TRUE(files().empty()) << at;
  }
}

TEST(StarterRecipe, NamesAnotherStoreWhereItSaysAnotherThing) {
  const Recipe own = own_recipe();
  EXPECT_GE(own.clips.size(), 15U);
  EXPECT_NE(own.hash(), parse_recipe(own.text + "\n", "longer.toml").hash());
  EXPECT_NE(kept_name("f", own).string().find(own.hash()), std::string::npos);
}

TEST(StarterRecipe, RefusesWhatIsWrongByLine) {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"", "no clip"},
      {"[[clip]]\nclip = \"sea\"", "does not say its class"},
      {"[[clip]]\nname = \"../x\"\nclip = \"sea\"", "does not say its class"},
      {"[[clip]]\nname = \"water/x\"", "names no clip"},
      {"[[clip]]\nname = \"water/x\"\nclip = \"lava\"", "lava"},
      {"[[clip]]\nname = \"water/x\"\nclip = \"sea\"\nspeed = 11", "speed"},
      {"[[clip]]\nname = \"water/x\"\nclip = \"sea\"\nsize = [65, 64]", "odd"},
      {"[[clip]]\nname = \"water/x\"\nclip = \"sea\"\n[[clip]]\nname = \"water/x\"\nclip = \"sea\"",
       "another clip"}};
  for (const auto& [text, fault] : wrong) {
    try {
      parse_recipe(text, "mine.toml");
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(fault), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("mine.toml"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace freshet::starter
