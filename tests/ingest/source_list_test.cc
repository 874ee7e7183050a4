#include "ingest/source_list.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::ingest {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> names(const std::vector<Source>& sources) {
  std::vector<std::string> list;
  for (const Source& source : sources) list.push_back(source.name);
  return list;
}

TEST(ListSources, NamesClipsRelativeToTheFolderAndClassesByTheFolderTheyLieIn) {
  const ScratchFolder folder;
  folder.file("clips/water/f10.mp4", "x");
  folder.file("clips/water/f9.mp4", "x");
  folder.file("clips/fire/deep/a.mkv", "x");
  folder.file("clips/fire/notes.txt", "x");
  folder.file("clips/fire/.hidden.mp4", "x");
  const fs::path given[] = {folder / "clips"};
  const std::vector<Source> sources = list_sources(given);
  EXPECT_EQ(names(sources), (std::vector<std::string>{"fire/deep/a.mkv", "water/f9.mp4", "water/f10.mp4"}));
  EXPECT_EQ(sources[0].class_name, "deep");
  EXPECT_EQ(sources[1].class_name, "water");
}

TEST(ListSources, AFileGivenDirectlyGoesByItsFileNameWhateverItsEnding) {
  const ScratchFolder folder;
  const fs::path given[] = {folder.file("smoke/strange.ending", "x")};
  const std::vector<Source> sources = list_sources(given);
  ASSERT_EQ(sources.size(), 1u);
  EXPECT_EQ(sources[0].name, "strange.ending");
  EXPECT_EQ(sources[0].class_name, "smoke");
}

TEST(ListSources, IsTheSameForAnyOrderOfPathsAndListsAPathOnce) {
  const ScratchFolder folder;
  folder.file("a/1.mp4", "x");
  folder.file("b/2.mp4", "x");
  const fs::path one[] = {folder / "a", folder / "b", folder / "a"};
  const fs::path two[] = {folder / "b/", folder / "./a"};
  EXPECT_EQ(list_sources(one), list_sources(two));
  EXPECT_EQ(list_sources(one).size(), 2u);
}

TEST(ListSources, ShardsAreDisjointAndTogetherTheWhole) {
  const ScratchFolder folder;
  for (int i = 0; i < 11; ++i) folder.file(fmt::format("clip{}.mp4", i), std::to_string(i));
  const fs::path given[] = {folder.path()};
  std::multiset<std::string> all;
  for (int i = 1; i <= 3; ++i) {
    for (const Source& source : list_sources(given, {i, 3})) all.insert(source.name);
  }
  const std::vector<std::string> whole = names(list_sources(given));
  EXPECT_EQ(all, std::multiset<std::string>(whole.begin(), whole.end()));
  EXPECT_EQ(names(list_sources(given, {2, 4})),
            (std::vector<std::string>{"clip1.mp4", "clip5.mp4", "clip9.mp4"}));
  EXPECT_THROW(list_sources(given, {0, 3}), Error);
  EXPECT_THROW(list_sources(given, {4, 3}), Error);
}

TEST(ListSources, EqualContentsAreOfOneShard) {
  const ScratchFolder folder;
  for (int i = 0; i < 12; ++i) folder.file(fmt::format("{}.mp4", i), std::to_string(i % 4));
  const fs::path given[] = {folder.path()};
  EXPECT_EQ(names(list_sources(given, {1, 3})),
            (std::vector<std::string>{"0.mp4", "3.mp4", "4.mp4", "7.mp4", "8.mp4", "11.mp4"}));
  EXPECT_EQ(names(list_sources(given, {3, 3})), (std::vector<std::string>{"2.mp4", "6.mp4", "10.mp4"}));
}

TEST(ListSources, TakesEightNumberedPicturesOfOneSizeForAClip) {
  const ScratchFolder folder;
  fs::create_directories(folder / "fire/burst");
  const cv::Mat picture(20, 30, CV_8UC3, cv::Scalar(1, 2, 3));
  for (int i = 1; i < kMinSequence; ++i)
    media::write_picture(folder / fmt::format("fire/burst/f{}.png", i), picture);
  const fs::path given[] = {folder.path()};
  EXPECT_THROW(list_sources(given), Error);
  media::write_picture(folder / "fire/burst/f8.png", picture);
  ASSERT_EQ(names(list_sources(given)), std::vector<std::string>{"fire/burst"});
  EXPECT_EQ(list_sources(given)[0].class_name, "fire");

  media::write_picture(folder / "fire/burst/f8.png", cv::Mat(20, 31, CV_8UC3, cv::Scalar(1, 2, 3)));
  EXPECT_THROW(list_sources(given), Error) << "photographs of different sizes are no clip";
  media::write_picture(folder / "fire/burst/f8.png", picture);
  folder.file("fire/burst/take.mp4", "x");
  EXPECT_EQ(names(list_sources(given)), std::vector<std::string>{"fire/burst/take.mp4"});
}

TEST(ListSources, SaysWhatIsMissing) {
  const ScratchFolder folder;
  const fs::path missing[] = {folder / "nothing"};
  const fs::path empty[] = {folder.path()};
  const std::string fault = fault_of(ErrorKind::kInput, [&] { list_sources(missing); });
  EXPECT_NE(fault.find("nothing"), std::string::npos);
  EXPECT_THROW(list_sources(empty), Error);
  EXPECT_THROW(list_sources({}), Error);
}

TEST(SourceHash, IsOfBytesAndNotOfNames) {
  const ScratchFolder folder;
  const std::string one = source_hash(folder.file("one.mp4", "same"));
  EXPECT_EQ(one.size(), 32u);
  EXPECT_EQ(one, source_hash(folder.file("two.mp4", "same")));
  EXPECT_NE(one, source_hash(folder.file("three.mp4", "samf")));
  EXPECT_EQ(source_hash(folder.file("empty", "")), "99aa06d3014798d86001c324468d497f")
      << "XXH3-128 of nothing";
  EXPECT_THROW(source_hash(folder / "missing"), Error);
}

TEST(SourceHash, OfASequenceIsOfItsPicturesNamesAndBytes) {
  const ScratchFolder folder;
  folder.file("a/f1.png", "x"), folder.file("a/f2.png", "y");
  folder.file("b/f1.png", "x"), folder.file("b/f2.png", "y"), folder.file("b/notes.txt", "z");
  folder.file("c/f1.png", "xy"), folder.file("c/f2.png", "");
  folder.file("d/f1.png", "x"), folder.file("d/f3.png", "y");
  EXPECT_EQ(source_hash(folder / "a"), source_hash(folder / "b"));
  EXPECT_NE(source_hash(folder / "a"), source_hash(folder / "c"));
  EXPECT_NE(source_hash(folder / "a"), source_hash(folder / "d"));
}

}  // namespace
}  // namespace freshet::ingest
