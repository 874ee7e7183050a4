// Several stores read as one are the store that merging them makes.

#include <gtest/gtest.h>

#include "query/index/index_builder.h"
#include "query/labelling/labelling.h"
#include "store/rewrite/rewrite.h"
#include "stored/stored_codebook.h"
#include "tests/harness/fault.h"
#include "tests/stored/made_store.h"

namespace freshet::query {
namespace {

namespace fs = std::filesystem;

/// Eight stores, one of them with two clips of which another has one too, and one with a clip without patches.
std::vector<fs::path> eight_stores(const ScratchFolder& folder) {
  std::vector<fs::path> files;
  for (int i = 0; i < 8; ++i) {
    std::vector<MadeClip> clips{{.name = fmt::format("{}.mp4", (i * 5) % 8),
                                 .class_name = i % 2 == 0 ? "water" : "fire",
                                 .motion = {static_cast<float>(10 * i), 30},
                                 .texture = static_cast<std::uint64_t>(i + 10)}};
    if (i == 3) clips.push_back({.name = "5.mp4", .motion = {10, 30}, .texture = 11});
    if (i == 6) clips.push_back({.name = "none.mp4", .patches = false});
    files.push_back(folder / fmt::format("{}.store", i));
    made_store(files.back(), clips);
  }
  return files;
}

struct Both {
  store::Snapshot merged, joined;
};
Both merged_and_joined(const ScratchFolder& folder, const std::vector<fs::path>& files) {
  store::merge(files, folder / "merged.store", rebuildable());
  store::Store merged = store::Store::open_write(folder / "merged.store");
  build_index(merged);
  std::string names = "# of one place\n\n";
  for (const fs::path& file : files) names += "  " + file.filename().string() + "\r\n";
  const fs::path list = folder.file("all.stores", names);
  {
    store::Store joined = store::Store::open_write(list);
    EXPECT_TRUE(build_index(joined).words_built);
    EXPECT_FALSE(build_index(joined).words_built);
  }
  return {merged.snapshot(), store::Store::open_read(list).snapshot()};
}

TEST(JoinedStores, AreTheStoreThatMergingThemMakes) {
  const ScratchFolder folder;
  const std::vector<fs::path> files = eight_stores(folder);
  const Both both = merged_and_joined(folder, files);
  EXPECT_EQ(both.joined.digest(), both.merged.digest());
  EXPECT_EQ(both.joined.files(), files);
  EXPECT_TRUE(both.joined.verify().empty());
  EXPECT_EQ(both.joined.clips().size(), 9u);
  for (const store::ClipId id : both.joined.clips()) {
    const store::ClipRecord& record = both.joined.clip(id);
    EXPECT_EQ(record.name, both.merged.clip(id).name);
    EXPECT_EQ(both.joined.find(record.name), id);
    EXPECT_TRUE(store::Store::open_read(both.joined.file_of(id)).snapshot().find(record.name));
  }
}

TEST(JoinedStores, GiveTheCandidatesOfTheMergedStoreForAThousandPieces) {
  const ScratchFolder folder;
  const Both both = merged_and_joined(folder, eight_stores(folder));
  cv::Mat picture;
  cv::cvtColor(made_texture(99, {1200, 624}), picture, cv::COLOR_GRAY2BGR);
  const cv::Mat matte(picture.size(), CV_8U, cv::Scalar(255));
  for (const std::optional<FlannKind> flann :
       {std::optional<FlannKind>(), std::optional(FlannKind::kHierarchical)}) {
    std::vector<CandidateSearch> found;
    std::vector<SearchBase> bases;
    std::vector<double> seconds;
    bases.reserve(2);
    for (const store::Snapshot& snapshot : {both.merged, both.joined}) {
      bases.push_back(open_search(snapshot, {.flann = flann}));
      found.push_back(search_candidates(snapshot, bases.back(), picture, matte, {}));
      seconds.push_back(found.back().seconds.search);
    }
    const Candidates &merged = found[0].candidates, &joined = found[1].candidates;
    ASSERT_GE(merged.pieces(), 1000u);
    ASSERT_EQ(joined.pieces(), merged.pieces());
    for (std::size_t piece = 0; piece < merged.pieces(); ++piece) {
      ASSERT_TRUE(std::ranges::equal(joined.rows_of(piece), merged.rows_of(piece))) << piece;
      ASSERT_TRUE(std::ranges::equal(joined.scores_of(piece), merged.scores_of(piece))) << piece;
    }
    std::printf("%zu pieces, %zu patches; opened merged %.4f s, joined %.4f s; searched %.4f s, %.4f s\n",
                merged.pieces(), bases[0].table.size(), bases[0].seconds, bases[1].seconds, seconds[0],
                seconds[1]);
  }
}

TEST(JoinedStores, AreSearchedOnlyByAnIndexOfThemAll) {
  const ScratchFolder folder;
  const std::vector<fs::path> files = eight_stores(folder);
  merged_and_joined(folder, files);
  fault_of(ErrorKind::kNotFound,
           [&] { stored::read_codebook(store::Store::open_read(std::span(files).first(5)).snapshot()); });
  fault_of(ErrorKind::kNotFound,
           [&] { stored::read_codebook(store::Store::open_read(files[0]).snapshot()); });
  // As after an index that was stopped between two of them: one has another.
  {
    store::Store one = store::Store::open_write(files[4]);
    build_index(one);
  }
  fault_of(ErrorKind::kNotFound, [&] { stored::read_codebook(store::Store::open_read(files).snapshot()); });
}

TEST(JoinedStores, AreRefusedWhereMergingWouldBe) {
  const ScratchFolder folder;
  made_store(folder / "a.store", {{.name = "a.mp4"}});
  vision::Settings others = made_settings();
  others.codebook.words = 41;
  made_store(folder / "b.store", {{.name = "b.mp4"}}, others);
  const auto open = [&](const std::string& name, const std::string& text) {
    return [&folder, name, text] { store::Store::open_read(folder.file(name, text)).snapshot(); };
  };
  EXPECT_NE(fault_of(open("x.stores", "a.store\nb.store\n")).find("b.store: has other settings"),
            std::string::npos);
  EXPECT_NE(fault_of(open("x.stores", "a.store\nc.store\n")).find("c.store"), std::string::npos);
  EXPECT_NE(fault_of(open("x.stores", "# none\n")).find("names no store"), std::string::npos);
  EXPECT_NE(fault_of(open("y.stores", "x.stores\n")).find("another list"), std::string::npos);
  // The clip's source is its name: another store, where that name has another source, is made by hand.
  store::Store c = store::Store::create(folder / "c.store", vision::to_json(made_settings()));
  store::ClipRecord record;
  record.name = "a.mp4";
  record.source_hash = "00000000000000000000000000000001";
  c.add_clip().commit(record);
  EXPECT_NE(fault_of(open("x.stores", "a.store\nc.store\n")).find("comes from another source"),
            std::string::npos);
  fault_of(ErrorKind::kUsage, [&] { store::Store::create(folder / "new.stores", "{}"); });
  folder.file("x.stores", "a.store\nb.store\n");
  store::Store list = store::Store::open_write(folder / "x.stores");
  fault_of(ErrorKind::kUsage, [&] { list.add_clip(); });
}

}  // namespace
}  // namespace freshet::query
