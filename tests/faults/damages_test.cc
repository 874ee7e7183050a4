// Bits, pages and ends that are lost: every command's answer is right, or there is none.

#include <gtest/gtest.h>

#include <iostream>
#include <map>
#include <random>
#include <sstream>

#include "tests/faults/aimed_damage.h"
#include "tests/faults/campaign.h"
#include "tests/faults/grown_store.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

/// What a store info says but for the lines on the file's size.
std::string without_sizes(const std::string& info) {
  std::istringstream lines(info);
  std::string kept;
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with("file ") && line.find("compact would") == std::string::npos) kept += line + "\n";
  return kept;
}

/// What a whole store answers.
struct Answers {
  std::string digest, info;
};

/// What is wrong with the answers that a damaged store gives; empty when each is right, or says that it is damaged.
/// right      the answers of the states that it may be in
/// harmless   whether verify is content
std::string judge_damage(const Campaign& c, const std::string& store, const std::vector<Answers>& right,
                         bool& harmless) {
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
  const bool known = std::ranges::any_of(right, [&](const Answers& state) {
    return (hash.exit_code != 0 || hash.out == state.digest) &&
           (shown.exit_code != 0 || without_sizes(shown.out) == state.info);
  });
  if (!known) return "another digest, or other numbers, as if all were well";
  if (verify.exit_code == 0 && hash.exit_code != 0) return "verify is content, digest is not: " + hash.err;
  return "";
}

Answers answers_of(const Campaign& c, const std::string& store) {
  const Outcome hash = c.run({"store", "digest", store}), info = c.run({"store", "info", store});
  EXPECT_EQ(hash.exit_code + info.exit_code, 0) << hash.err << info.err;
  return {hash.out, without_sizes(info.out)};
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
  const std::string whole = text_of(c.folder / "indexed.store");
  c.begin_with("indexed.store", "d.store");
  const std::vector<Answers> right{answers_of(c, "d.store")};
  int harmless = 0, tried = 0;
  walk_rounds("damages", at_full_length() ? 10000 : 12, [&](std::size_t, std::mt19937& random) {
    std::string what;
    c.folder.file("d.store", damaged(random, whole, what));
    bool content = false;
    EXPECT_EQ(judge_damage(c, "d.store", right, content), "") << what;
    harmless += content ? 1 : 0;
    ++tried;
  });
  std::cout << harmless << " of them harmless\n";
  EXPECT_LT(harmless, tried / 2);
}

// Each kind of tests/faults/aimed_damage.h in its turn. Where meta pages are hit a state of the past is right too.
TEST(Damages, ThatAreAimedAreHarmlessOrReported) {
  const Campaign& c = campaign();
  std::vector<Answers> states;
  for (const std::string& file : grown().files) {
    c.begin_with("", "d.store");
    c.folder.file("d.store", file);
    states.push_back(answers_of(c, "d.store"));
  }
  DamagedStores stores{
      .whole = LmdbFile(grown().last()), .past = {}, .other = LmdbFile(text_of(c.folder / "loose.store"))};
  for (std::size_t i = 0; i + 1 < grown().files.size(); ++i) stores.past.emplace_back(grown().files[i]);
  const std::vector<Answers> last{states.back()};
  struct Count {
    int tried = 0, harmless = 0;
  };
  std::map<std::string, Count> counts;
  const std::size_t kinds = aimed_damages().size();
  walk_rounds("aimed damages", at_full_length() ? 25000 : kinds,
              [&](std::size_t round, std::mt19937& random) {
                const AimedDamage& damage = aimed_damages()[round % kinds];
                Aim aim{stores, random, stores.whole.bytes, {}};
                for (int draws = 0; draws < 20 && aim.bytes == stores.whole.bytes; ++draws) {
                  aim.what.clear();
                  damage.apply(aim);
                }
                c.folder.file("d.store", aim.bytes);
                bool content = false;
                EXPECT_EQ(judge_damage(c, "d.store", damage.may_roll_back ? states : last, content), "")
                    << damage.kind << aim.what;
                ++counts[damage.kind].tried;
                counts[damage.kind].harmless += content ? 1 : 0;
              });
  int harmless = 0, tried = 0;
  for (const auto& [name, count] : counts) {
    std::cout << name << ": " << count.tried << ", harmless " << count.harmless << "\n";
    tried += count.tried;
    harmless += count.harmless;
  }
  EXPECT_LT(harmless, tried / 2);
}

TEST(Damages, AnotherStoreThatIsPlantedIsSeen) {
  const Campaign& c = campaign();
  c.begin_with("indexed.store", "d.store");
  const std::vector<Answers> right{answers_of(c, "d.store")};
  bool harmless = false;
  EXPECT_EQ(judge_damage(c, "d.store", right, harmless), "");
  c.begin_with("all.store", "d.store");
  EXPECT_NE(judge_damage(c, "d.store", right, harmless), "");
}

}  // namespace
}  // namespace freshet::tools
