// Repairs of damaged stores: every clip that the slow twin can read is saved or named, what is saved is true, and the
// index is that of one state or absent.

#include <gtest/gtest.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <random>

#include "store/store.h"
#include "tests/faults/campaign.h"
#include "tests/faults/grown_store.h"
#include "tests/store/rewrite/slow_salvage.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

/// What is wrong with what was made of damaged bytes; empty when nothing is.
std::string judge_repair(const Grown& grown, const std::string& bytes, const Outcome& outcome,
                         const std::string& made) {
  const Campaign& c = campaign();
  if (outcome.signal != 0 || outcome.exit_code < 0 || outcome.exit_code > 3) return "it died: " + outcome.err;
  if (outcome.err.find("unexpected") != std::string::npos) return outcome.err;
  if (!fs::exists(made)) {
    if (outcome.exit_code == 0) return "nothing was made, as if all were well";
    return outcome.err.find("d.store") == std::string::npos ? "its message names no file: " + outcome.err
                                                            : "";
  }
  if (const Outcome verify = c.run({"store", "verify", made}); verify.exit_code != 0)
    return "what was made is no whole store: " + verify.out + verify.err;
  const Holdings held = holdings_of(made);
  const Holdings& whole = grown.states.back();
  std::set<store::ReadableClip> said;
  for (const auto& [clip, hash] : held.clips) {
    said.insert(clip);
    if (!whole.clips.contains(clip) || whole.clips.at(clip) != hash) return clip.name + " is another clip";
  }
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  for (const auto& lost : json["lost"]) said.insert({lost["name"], lost["source"]});
  for (const store::ReadableClip& clip :
       store::SlowSalvage({bytes.begin(), bytes.end()}, {"patch.words"}).clips())
    if (!said.contains(clip)) return clip.name + " can be read, and is neither saved nor named";
  if (outcome.exit_code == 0 && held.clips.size() != whole.clips.size())
    return "clips are missing, as if all were well";
  const bool one_index = std::ranges::any_of(grown.states, [&](const Holdings& state) {
    return state.codebook == held.codebook && std::ranges::all_of(held.words, [&](const auto& words) {
             const auto then = state.words.find(words.first);
             return then != state.words.end() && then->second == words.second;
           });
  });
  return held.codebook == 0 && held.words.empty() ? ""
         : one_index                              ? ""
                                                  : "words of one index, codebook of another";
}

std::string damaged(std::mt19937& random, const Grown& grown, std::string& what) {
  constexpr std::size_t kPage = 4096;
  const std::string& whole = grown.last();
  std::string bytes = whole;
  const std::size_t pages = whole.size() / kPage;
  for (std::uint64_t damages = 1 + random() % 3, i = 0; i < damages; ++i) {
    std::size_t page = random() % pages;
    const std::size_t other = random() % pages;
    // Half of all among the pages of keys: they are few.
    for (int k = 0;
         random() % 2 == 0 && k < 2000 && (whole[page * kPage + 10] != 2 || whole[page * kPage + 11] != 0);
         ++k)
      page = random() % pages;
    const std::string& old = grown.files[random() % grown.files.size()];
    switch (random() % 7) {
      case 0: {
        const std::size_t at = page * kPage + random() % kPage;
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
        what += "bit in byte " + std::to_string(at) + "; ";
        break;
      }
      case 1:
        bytes.replace(page * kPage, kPage, kPage, '\0');
        what += "page " + std::to_string(page) + " zeroed; ";
        break;
      case 2:
        bytes.replace(page * kPage, kPage, whole, other * kPage, kPage);
        bytes.replace(other * kPage, kPage, whole, page * kPage, kPage);
        what += "pages " + std::to_string(page) + " and " + std::to_string(other) + " swapped; ";
        break;
      case 3:
        if ((page + 1) * kPage > old.size()) break;
        bytes.replace(page * kPage, kPage, old, page * kPage, kPage);
        what +=
            "page " + std::to_string(page) + " as in a file of " + std::to_string(old.size()) + " bytes; ";
        break;
      case 4:
        // All of the pages that a run wrote, by chance: those of the past in a whole part of the file.
        for (std::size_t p = page; p < std::min(page + 40, old.size() / kPage); ++p)
          if (random() % 2 == 0) bytes.replace(p * kPage, kPage, old, p * kPage, kPage);
        what += "pages of the past from " + std::to_string(page) + "; ";
        break;
      case 5: {
        const std::size_t meta = random() % 2, count = 1 + random() % 2;
        for (std::size_t m = meta; m < std::min<std::size_t>(2, meta + count); ++m)
          bytes.replace(m * kPage, kPage, old, m * kPage, kPage);
        what += "meta pages of a file of " + std::to_string(old.size()) + " bytes; ";
        break;
      }
      default: {
        const std::size_t at = page * kPage + random() % 40;
        bytes[at] = static_cast<char>(random());
        what += "byte " + std::to_string(at) + "; ";
      }
    }
  }
  if (random() % 4 == 0) {
    bytes.resize(bytes.size() - random() % (random() % 3 == 0 ? bytes.size() : bytes.size() / 3));
    what += "cut to " + std::to_string(bytes.size());
  }
  return bytes;
}

/// What the executable makes of the bytes.
std::string try_repair(const Grown& grown, const std::string& bytes, int* made) {
  const Campaign& c = campaign();
  c.begin_with("", "d.store");
  c.begin_with("", "r.store");
  c.folder.file("d.store", bytes);
  const Outcome outcome = c.run({"store", "repair", "d.store", "-o", "r.store", "--json"});
  const std::string out = c.folder / "r.store";
  if (made != nullptr && fs::exists(out)) ++*made;
  return judge_repair(grown, bytes, outcome, out);
}

TEST(Repairs, OfAWholeStoreSaveAll) { EXPECT_EQ(try_repair(grown(), grown().last(), nullptr), ""); }

TEST(Repairs, HideNoClipAndJoinNoIndexes) {
  int made = 0, tried = 0;
  walk_rounds("repairs", at_full_length() ? 12000 : 15, [&](std::size_t, std::mt19937& random) {
    std::string what;
    const std::string bytes = damaged(random, grown(), what);
    EXPECT_EQ(try_repair(grown(), bytes, &made), "") << what;
    ++tried;
  });
  std::cout << made << " of them gave a store\n";
  EXPECT_GT(made, tried / 2);
}

// All lengths that lack up to 199 pages: the account, which is written last, goes first.
TEST(Repairs, OfAFileThatIsCutHideNoClip) {
  std::vector<std::size_t> cuts;
  for (std::size_t cut = 1; cut < std::min<std::size_t>(200, grown().last().size() / 4096); ++cut)
    if (at_full_length() || cut % 25 == 4) cuts.push_back(cut);
  walk("cuts", cuts, [&](std::size_t cut) {
    const std::string& whole = grown().last();
    EXPECT_EQ(try_repair(grown(), whole.substr(0, whole.size() - cut * 4096), nullptr), "") << cut;
  });
}

TEST(Repairs, AClipThatIsHiddenIsSeen) {
  const Campaign& c = campaign();
  c.begin_with("rest.store", "r.store");
  Outcome planted;
  planted.exit_code = 3;
  planted.out = R"({"lost": []})";
  EXPECT_NE(judge_repair(grown(), grown().last(), planted, c.folder / "r.store"), "");
}

}  // namespace
}  // namespace freshet::tools
