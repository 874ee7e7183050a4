#include "studio/stores.h"

#include <memory>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "studio/studio.h"
#include "tests/tools/sample.h"

namespace freshet::studio {
namespace {

TEST(Stores, AListIsOpenedAsOneAndTakesNoClips) {
  const tools::WorkFolder folder;
  for (const char* part : {"1/2", "2/2"}) {
    const std::string name = std::string("part") + part[0] + ".store";
    ASSERT_EQ(
        folder.freshet({"ingest", name, tools::sample().clips, "--shard", part, "--no-index"}).exit_code, 0);
  }
  const std::filesystem::path list = folder.file("all.stores", "part1.store\npart2.store\n");
  ASSERT_EQ(folder.freshet({"index", list}).exit_code, 0);

  Studio studio({.folder = folder / "room", .stores = {list}, .program = tools::executable()});
  const std::shared_ptr<OpenedStore> joined = studio.stores().at(list);
  ASSERT_NE(joined, nullptr);
  const OpenedStore whole(tools::sample().store);
  const auto named = [](const OpenedStore& store) {
    std::set<std::string> names;
    const nlohmann::json json = nlohmann::json::parse(store.to_json());
    EXPECT_FALSE(json.contains("fault")) << json;
    for (const nlohmann::json& clip : json["clips"]) names.insert(clip["name"].get<std::string>());
    return names;
  };
  EXPECT_EQ(named(*joined), named(whole));
  EXPECT_EQ(joined->base({})->base.table.clip.size(), whole.base({})->base.table.clip.size());
  EXPECT_FALSE(joined->strip(2, 64).empty());
  try {
    studio.stores().clip_path(joined->id(), "fall", "new.mkv");
    FAIL() << "a clip was taken";
  } catch (const Error& fault) {
    EXPECT_NE(std::string(fault.what()).find("all.stores: is a list of stores"), std::string::npos);
  }
}

}  // namespace
}  // namespace freshet::studio
