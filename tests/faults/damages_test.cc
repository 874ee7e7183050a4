// Bits, pages and ends that are lost: every command's answer is right, or there is none.

#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "tests/faults/campaign.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

/// What is wrong with the answers that a damaged store gives; empty when each is right, or says that it is damaged.
/// harmless   whether verify is content
std::string judge_damage(const Campaign& c, const std::string& store, const std::string& digest,
                         const std::string& info, bool& harmless) {
  const Outcome verify = c.run({"store", "verify", store}), hash = c.run({"store", "digest", store}),
                shown = c.run({"store", "info", store});
  harmless = verify.exit_code == 0;
  for (const Outcome* outcome : {&verify, &hash, &shown}) {
    if (outcome->signal != 0 || outcome->exit_code < 0 || outcome->exit_code > 3)
      return "it died, " + std::to_string(outcome->exit_code) + ": " + outcome->err;
    if (outcome->exit_code != 0 && outcome->err.find(store) == std::string::npos)
      return "its message names no file: " + outcome->err;
    if (outcome->err.find("unexpected") != std::string::npos) return outcome->err;
  }
  if (hash.exit_code == 0 && hash.out != digest) return "another digest, as if all were well";
  if (shown.exit_code == 0 && shown.out != info) return "other numbers, as if all were well";
  if (verify.exit_code == 0 && hash.exit_code != 0) return "verify is content, digest is not: " + hash.err;
  return "";
}

std::string damaged(std::mt19937& random, const std::string& whole, std::string& what) {
  std::string bytes = whole;
  const std::size_t pages = whole.size() / 4096;
  const std::size_t page = random() % pages, other = random() % pages;
  switch (random() % 6) {
    case 0:
    case 1: {
      // Half of all flips among the pages of keys: they are few.
      std::size_t at = random() % bytes.size();
      for (int i = 0; i < 2000 && random() % 2 == 0; ++i)
        if (at = random() % bytes.size();
            bytes[at / 4096 * 4096 + 10] == 2 && bytes[at / 4096 * 4096 + 11] == 0)
          break;
      const int bit = static_cast<int>(random() % 8);
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit));
      what = "bit " + std::to_string(bit) + " of byte " + std::to_string(at);
      break;
    }
    case 2:
      bytes.replace(page * 4096, 4096, 4096, '\0');
      what = "page " + std::to_string(page) + " zeroed";
      break;
    case 3:
      bytes.replace(page * 4096, 4096, whole, other * 4096, 4096);
      bytes.replace(other * 4096, 4096, whole, page * 4096, 4096);
      what = "pages " + std::to_string(page) + " and " + std::to_string(other) + " swapped";
      break;
    case 4:
      bytes.replace(page * 4096, 4096, whole, other * 4096, 4096);
      what = "page " + std::to_string(other) + " repeated as " + std::to_string(page);
      break;
    default:
      bytes.resize(random() % bytes.size());
      what = "cut to " + std::to_string(bytes.size());
  }
  return bytes;
}

TEST(Damages, AreHarmlessOrReported) {
  const Campaign& c = campaign();
  std::mt19937 random(11);
  const std::string whole = text_of(c.folder / "indexed.store");
  c.begin_with("indexed.store", "d.store");
  const Outcome info = c.run({"store", "info", "d.store"});
  ASSERT_EQ(info.exit_code, 0);
  const int rounds = at_full_length() ? 10000 : 12;
  int harmless = 0, tried = 0;
  walk_rounds("damages", rounds, [&] {
    std::string what;
    c.folder.file("d.store", damaged(random, whole, what));
    bool content = false;
    EXPECT_EQ(judge_damage(c, "d.store", c.indexed, info.out, content), "") << what;
    harmless += content ? 1 : 0;
    ++tried;
  });
  std::cout << harmless << " of them harmless\n";
  EXPECT_LT(harmless, tried / 2);
}

TEST(Damages, AnotherStoreThatIsPlantedIsSeen) {
  const Campaign& c = campaign();
  c.begin_with("indexed.store", "d.store");
  const Outcome info = c.run({"store", "info", "d.store"});
  bool harmless = false;
  EXPECT_EQ(judge_damage(c, "d.store", c.indexed, info.out, harmless), "");
  c.begin_with("all.store", "d.store");
  EXPECT_NE(judge_damage(c, "d.store", c.indexed, info.out, harmless), "");
}

}  // namespace
}  // namespace freshet::tools
