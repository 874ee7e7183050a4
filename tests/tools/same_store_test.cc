// One digest for the same clips, however they came into the store.

#include <gtest/gtest.h>

#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

TEST(SameStore, ThreadsAndOrderDoNotMatter) {
  const WorkFolder folder;
  const std::string a = sample().clips / "fall/1.mkv", b = sample().clips / "fall/2.mkv",
                    c = sample().clips / "river/1.mkv";
  // By themselves, clips of equal file names would clash.
  fs::copy_file(c, folder / "3.mkv");
  ASSERT_EQ(folder.freshet({"ingest", "one.store", "-j", "1", a, b, "3.mkv"}).exit_code, 0);
  ASSERT_EQ(folder.freshet({"ingest", "two.store", "-j", "2", "3.mkv", b, a}).exit_code, 0);
  EXPECT_EQ(digest(folder / "one.store"), digest(folder / "two.store"));
  EXPECT_NE(digest(folder / "one.store"), sample_digest()) << "names are content";
}

TEST(SameStore, ASecondIngestAddsNothing) {
  const WorkFolder folder;
  const fs::path store = copy_of_store(folder);
  const Outcome outcome = folder.freshet({"ingest", store, sample().clips});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("0 added, 3 already there, 0 refused, 0 failed"), std::string::npos)
      << outcome.out;
  EXPECT_EQ(digest(store), sample_digest());
}

TEST(SameStore, PartsMakeTheWhole) {
  const WorkFolder folder;
  for (const char* part : {"2/2", "1/2"}) {
    const Outcome outcome = folder.freshet({"ingest", "a.store", sample().clips, "--shard", part});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  EXPECT_EQ(digest(folder / "a.store"), sample_digest());
}

TEST(SameStore, SealedPartsMakeTheWholeAndAreMadeOnce) {
  const WorkFolder folder;
  const auto ingest = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"ingest", "all.store", sample().clips});
    return folder.freshet(more);
  };
  // More shards than clips: one is empty.
  for (const char* shard : {"4/4", "1/4", "3/4"}) {
    const Outcome outcome = ingest({"--shard", shard, "--seal"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  const Outcome early = ingest({"--gather"});
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_NE(early.err.find("shards of 4 that are not yet sealed: 2"), std::string::npos) << early.err;
  ASSERT_EQ(ingest({"--shard", "2/4", "--seal"}).exit_code, 0);
  const auto stamp = [&] { return fs::last_write_time(folder / "all.store.parts/2-of-4.json"); };
  fs::file_time_type made = stamp();
  EXPECT_EQ(ingest({"--shard", "2/4", "--seal"}).exit_code, 0);
  EXPECT_EQ(stamp(), made);
  // Other options, and another list of clips, are another command's.
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
           {"--shard", "2/4", "--seal", "--licence", "CC0"}, {"--gather", "--licence", "CC0"}}) {
    const Outcome other = ingest(more);
    EXPECT_EQ(other.exit_code, 2);
    EXPECT_NE(other.err.find("made by a command with other clips or options"), std::string::npos)
        << other.err;
  }
  // A part that is cut or exchanged is seen.
  const std::string part = text_of(folder / "all.store.parts/2-of-4.store");
  folder.file("all.store.parts/2-of-4.store", part.substr(0, part.size() / 2));
  EXPECT_NE(ingest({"--gather"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder / "all.store"));
  fs::remove(folder / "all.store.parts/2-of-4.store");
  EXPECT_EQ(ingest({"--gather"}).exit_code, 3);
  folder.file("all.store.parts/2-of-4.store", part);
  const std::string report = text_of(folder / "all.store.parts/2-of-4.json");
  for (const char* garbled : {"", "[]", R"({"stored": 1, "clips": [1]})"}) {
    folder.file("all.store.parts/2-of-4.json", garbled);
    EXPECT_NE(ingest({"--gather"}).err.find("2-of-4.json: is garbled. Remove it"), std::string::npos)
        << garbled;
  }
  folder.file("all.store.parts/2-of-4.json", report);
  made = stamp();
  folder.file("all.store.parts/2-of-4.store.making.gone.7", "what a killed run left");
  folder.file("all.store.merging", "what a killed run left");

  const Outcome gathered = ingest({"--gather"});
  ASSERT_EQ(gathered.exit_code, 0) << gathered.err;
  EXPECT_NE(gathered.out.find("4 shards, 3 added, 0 already there, 0 refused, 0 failed"), std::string::npos)
      << gathered.out;
  EXPECT_EQ(digest(folder / "all.store"), sample_digest());
  EXPECT_NE(folder.freshet({"store", "info", "all.store"}).out.find("index: ready"), std::string::npos);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / "all.store.parts"))
    EXPECT_TRUE(entry.path().extension() == ".store" || entry.path().extension() == ".json") << entry.path();
  // Again, and nothing is done.
  EXPECT_EQ(ingest({"--shard", "2/4", "--seal"}).exit_code, 0);
  EXPECT_EQ(ingest({"--gather"}).out, gathered.out);
  EXPECT_EQ(stamp(), made);
  fs::remove_all(folder / "all.store.parts");
  const Outcome in_the_way = ingest({"--shard", "2/4", "--seal"});
  EXPECT_EQ(in_the_way.exit_code, 2);
  EXPECT_NE(in_the_way.err.find("all.store: is there already"), std::string::npos) << in_the_way.err;
  EXPECT_EQ(folder.freshet({"ingest", "new.store", sample().clips, "--seal"}).exit_code, 2);
}

TEST(SameStore, GatheredClipsStandInTheOrderOfOneIngest) {
  const WorkFolder folder;
  for (const char* shard : {"1/2", "2/2"})  // the first and the third clip, and the second
    ASSERT_EQ(folder.freshet({"ingest", "all.store", sample().clips, "--shard", shard, "--seal"}).exit_code,
              0);
  const Outcome gathered = folder.freshet({"ingest", "all.store", sample().clips, "--gather", "--json"});
  ASSERT_EQ(gathered.exit_code, 0) << gathered.err;
  std::vector<std::string> reported;
  const nlohmann::json report = nlohmann::json::parse(gathered.out);
  for (const nlohmann::json& clip : report["clips"]) reported.push_back(clip["name"]);
  EXPECT_EQ(reported, (std::vector<std::string>{"fall/1.mkv", "fall/2.mkv", "river/1.mkv"}));
  const auto rows = [&](const std::string& store) {
    return nlohmann::json::parse(
        folder.freshet({"query", "candidates", store, sample().still, "--frames", "16", "--json"})
            .out)["pieces"];
  };
  EXPECT_EQ(rows("all.store"), rows(sample().store));
}

TEST(SameStore, SeveralStoresAreSearchedAsOne) {
  const WorkFolder folder;
  for (const char* part : {"1/3", "2/3", "3/3"}) {
    const std::string name = std::string("part") + part[0] + ".store";
    ASSERT_EQ(folder.freshet({"ingest", name, sample().clips, "--shard", part, "--no-index"}).exit_code, 0);
  }
  folder.file("all.stores", "part1.store\npart2.store\npart3.store\n");
  const auto candidates = [&](std::vector<std::string> stores) {
    std::vector<std::string> words{"query", "candidates"};
    words.insert(words.end(), stores.begin(), stores.end());
    words.insert(words.end(), {"--frames", "16", "--json"});
    const Outcome outcome = folder.freshet(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.exit_code == 0 ? nlohmann::json::parse(outcome.out)["pieces"] : nlohmann::json();
  };
  const Outcome early =
      folder.freshet({"query", "candidates", "part1.store", sample().still, "--store", "part2.store"});
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_NE(early.err.find("part1.store: the 2 stores that are searched as one have no index"),
            std::string::npos)
      << early.err;
  ASSERT_EQ(folder.freshet({"index", "all.stores"}).exit_code, 0);
  EXPECT_EQ(digest(folder / "all.stores"), sample_digest());
  const nlohmann::json of_list = candidates({"all.stores", sample().still});
  EXPECT_EQ(candidates({sample().still, "--store", "part1.store", "--store", "part2.store", "--store",
                        "part3.store"}),
            of_list);
  EXPECT_EQ(candidates({"part1.store", sample().still, "--store", "part2.store", "--store", "part3.store"}),
            of_list);
  // As the merged store's, but that each says whose it is.
  nlohmann::json unnamed = of_list;
  std::map<std::string, std::set<std::string>> store_of_clip;
  for (nlohmann::json& piece : unnamed)
    for (nlohmann::json& candidate : piece["candidates"]) {
      store_of_clip[candidate["clip"]].insert(candidate["store"].get<std::string>());
      candidate.erase("store");
    }
  for (const auto& [clip, stores] : store_of_clip) {
    ASSERT_EQ(stores.size(), 1u);
    EXPECT_NE(folder.freshet({"store", "info", *stores.begin()}).out.find(clip), std::string::npos);
  }
  EXPECT_EQ(unnamed, candidates({sample().store, sample().still}));

  const auto animated = [&](const std::string& store, const std::string& out) {
    const Outcome outcome = folder.freshet({"synth", "animate", store, sample().still, "--matte",
                                            sample().matte, "--frames", "6", "-o", out + "/%02d.png"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    std::string all;
    for (int i = 0; i < 6; ++i) all += text_of(folder / fmt::format("{}/{:02}.png", out, i));
    return all;
  };
  EXPECT_TRUE(animated("all.stores", "joined") == animated(sample().store, "merged"));
  // What changes or saves one store says which there are; merging takes what the list names.
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"ingest", "all.stores", sample().clips},
                                             {"ingest", "all.stores", sample().clips, "--dry-run"},
                                             {"store", "compact", "all.stores"},
                                             {"store", "remove", "all.stores", "fall/1.mkv"},
                                             {"store", "repair", "all.stores", "-o", "saved.store"}}) {
    const Outcome outcome = folder.freshet(words);
    EXPECT_EQ(outcome.exit_code, 2) << words[1];
    EXPECT_NE(outcome.err.find("all.stores: is a list of stores, and this works on one. Name one of them:\n"
                               "  part1.store"),
              std::string::npos)
        << outcome.err;
  }
  ASSERT_EQ(folder.freshet({"store", "merge", "all.stores", "-o", "merged.store"}).exit_code, 0);
  ASSERT_EQ(folder.freshet({"index", "merged.store"}).exit_code, 0);
  EXPECT_EQ(digest(folder / "merged.store"), sample_digest());
  folder.file("some.stores", "part2.store\npart3.store\n");
  ASSERT_EQ(folder.freshet({"store", "merge", "part1.store", "some.stores", "-o", "mixed.store"}).exit_code,
            0);
  EXPECT_EQ(folder.freshet({"store", "merge", "part1.store", "-o", "one.store"}).exit_code, 2);
  const Outcome to_list = folder.freshet({"store", "merge", "all.stores", "-o", "new.stores"});
  EXPECT_EQ(to_list.exit_code, 2);
  EXPECT_NE(to_list.err.find("new.stores: a name that ends so is that of a list"), std::string::npos);
  EXPECT_EQ(folder.freshet({"store", "info", "all.stores"}).exit_code, 0);
  EXPECT_EQ(folder.freshet({"store", "verify", "all.stores"}).exit_code, 0);
}

TEST(SameStore, AnIndexMadeLaterIsTheSame) {
  const WorkFolder folder;
  ASSERT_EQ(folder.freshet({"ingest", "a.store", sample().clips, "--no-index"}).exit_code, 0);
  const Outcome query = folder.freshet({"query", "candidates", "a.store", sample().still, "--frames", "16"});
  EXPECT_EQ(query.exit_code, 1);
  EXPECT_NE(query.err.find("a.store: it has no index. Run freshet index"), std::string::npos) << query.err;
  ASSERT_EQ(folder.freshet({"index", "a.store"}).exit_code, 0);
  EXPECT_EQ(digest(folder / "a.store"), sample_digest());
}

TEST(SameStore, HoldsAFlannIndexUnlessItIsLeftOut) {
  const WorkFolder folder;
  const fs::path store = copy_of_store(folder);
  const auto find = [&](const std::string& index) {
    return folder.freshet({"query", "candidates", store, sample().still, "--frames", "16", "--index", index});
  };
  const auto has_flann = [&] {
    return folder.freshet({"store", "info", store}).out.find("ready, flann-hierarchical") !=
           std::string::npos;
  };
  EXPECT_TRUE(has_flann());
  EXPECT_EQ(find("flann-hierarchical").exit_code, 0);
  const Outcome kdtree = find("flann-kdtree");
  EXPECT_EQ(kdtree.exit_code, 1) << "the index that was asked for is not the one that answers";

  ASSERT_EQ(folder.freshet({"index", store, "--no-flann"}).exit_code, 0);
  EXPECT_FALSE(has_flann());
  EXPECT_EQ(digest(store), sample_digest());
  const Outcome none = find("flann-hierarchical");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_NE(none.err.find("copy.store: it has no FLANN index hierarchical"), std::string::npos) << none.err;
  EXPECT_NE(folder.freshet({"index", store, "--no-flann", "--flann", "kdtree"}).exit_code, 0);

  // Whose clips change has none until its index is made anew.
  ASSERT_EQ(folder.freshet({"ingest", store, sample().clips}).exit_code, 0);
  EXPECT_TRUE(has_flann());
  ASSERT_EQ(folder.freshet({"store", "compact", store}).exit_code, 0);
  EXPECT_TRUE(has_flann());
  ASSERT_EQ(folder.freshet({"store", "remove", store, "fall/1.mkv"}).exit_code, 0);
  EXPECT_FALSE(has_flann());
  ASSERT_EQ(folder.freshet({"ingest", "none.store", sample().clips, "--no-flann"}).exit_code, 0);
  EXPECT_EQ(digest(folder / "none.store"), sample_digest());
  EXPECT_EQ(folder.freshet({"store", "info", "none.store"}).out.find("flann"), std::string::npos);
}

}  // namespace
}  // namespace freshet::tools
