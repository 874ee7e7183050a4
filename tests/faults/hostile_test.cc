// Stores made by somebody who means harm: every hash and sum is right, and what they bind is not.

#include <gtest/gtest.h>
#include <xxhash.h>

#include <cmath>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "store/records/identity.h"
#include "store/records/record.h"
#include "tests/faults/campaign.h"
#include "tests/store/raw_file.h"
#include "tests/store/sealed_tables.h"

namespace freshet::tools {
namespace {

using nlohmann::json;
using store::Bytes;
using store::ClipId;
using store::SealedTables;
using store::StoredClip;

struct Hostile {
  SealedTables& tables;
  std::mt19937& random;
  std::string what = {};

  std::size_t below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
  }
  template <class T>
  T one_of(const std::vector<T>& all) {
    return all[below(all.size())];
  }
  std::pair<ClipId, StoredClip> a_clip() {
    const auto clips = tables.clips();
    return *std::next(clips.begin(), static_cast<std::ptrdiff_t>(below(clips.size())));
  }
};

/// The records of a whole store as they lie in its file, under the store's own id.
SealedTables tables_of(const std::filesystem::path& file) {
  const auto as_bytes = [](const std::string& text) {
    const store::ByteSpan span = store::bytes_of(text);
    return Bytes(span.begin(), span.end());
  };
  std::uint64_t id = 0;
  std::array<SealedTables::Records, store::kTables> tables;
  store::each_record(file, [&](const std::string& table, const std::string& key, const std::string& value) {
    if (table == "meta" && key == store::kIdentityKey)
      id = store::parse_identity(store::bytes_of(value)).value();
    tables[static_cast<std::size_t>(std::ranges::find(store::kTableNames, table) - store::kTableNames)]
        .emplace(as_bytes(key), as_bytes(value));
    return false;
  });
  return SealedTables(id, std::move(tables));
}

std::string text(const char* begin, std::size_t size) { return {begin, size}; }

/// A value that no reader expects, for a number or for anything.
json odd(Hostile& h) {
  const std::vector<json> odd{-1,
                              0,
                              1,
                              2,
                              -0.5,
                              1e-300,
                              1e18,
                              1e300,
                              2147483648LL,
                              4294967296LL,
                              9223372036854775807LL,
                              65536,
                              255,
                              "x",
                              nullptr,
                              json::array(),
                              json::object(),
                              true,
                              std::string(3000, 'A'),
                              text("\0", 1),
                              "../../etc/passwd",
                              "<script>alert(1)</script>",
                              "\x1b[2J",
                              std::vector<int>(200, 7)};
  return h.one_of(odd);
}

/// Somewhere in the document something is lost, doubled, or another thing.
std::string odd_document(Hostile& h, const std::string& document) {
  json parsed = json::parse(document);
  std::vector<json::json_pointer> places;
  const json flat = parsed.flatten();
  for (const auto& [path, value] : flat.items())
    for (json::json_pointer at(path); !at.empty(); at = at.parent_pointer()) places.push_back(at);
  if (places.empty()) return "[]";
  const json::json_pointer at = h.one_of(places);
  h.what += " " + at.to_string();
  json& old = parsed[at];
  if (h.below(8) == 0) {
    json& parent = parsed[at.parent_pointer()];
    if (parent.is_object())
      parent.erase(at.back());
    else
      parent.clear();
  } else if (old.is_array() && h.below(2) == 0) {
    const std::size_t length = h.one_of<std::size_t>({0, 1, 3, 100000});
    json many = json::array();
    for (std::size_t i = 0; i < length && !old.empty(); ++i) many.push_back(old[i % old.size()]);
    old = many;
  } else {
    old = odd(h);
  }
  std::string changed = parsed.dump(-1, ' ', false, json::error_handler_t::ignore);
  if (h.below(20) == 0) changed += " 1e999";
  return changed;
}

void metadata(Hostile& h) {
  auto [id, clip] = h.a_clip();
  clip.record.metadata = odd_document(h, clip.record.metadata);
  h.tables.set_clip(id, clip);
}

void settings(Hostile& h) { h.tables.set_settings(odd_document(h, h.tables.settings())); }

void no_document(Hostile& h) {
  const std::vector<std::string> texts{
      "", "{", "[]", "null", std::string(200000, '['), "\xff\xfe{}", "{\"a\":1e999}"};
  const std::string chosen = h.one_of(texts);
  if (h.below(3) == 0) return h.tables.set_settings(chosen);
  auto [id, clip] = h.a_clip();
  clip.record.metadata = chosen;
  h.tables.set_clip(id, clip);
}

void clip_number(Hostile& h) {
  auto [id, clip] = h.a_clip();
  const std::vector<std::uint32_t> sizes{0, 1, 3, 97, 1000000, 65535, 65536, 2147483648U, 4294967295U};
  const std::vector<std::int64_t> rates{0, -1, -30, INT64_MAX, INT64_MIN, 1};
  switch (h.below(6)) {
    case 0:
      clip.record.width = h.one_of(sizes);
      break;
    case 1:
      clip.record.height = h.one_of(sizes);
      break;
    case 2:
      clip.record.frame_count = h.one_of(sizes);
      break;
    case 3:
      clip.record.fps_num = h.one_of(rates);
      break;
    case 4:
      clip.record.fps_den = h.one_of(rates);
      break;
    default:
      clip.record.rows =
          h.one_of<std::uint64_t>({0, 1, clip.record.rows + 1, 1ull << 31, 1ull << 40, 1ull << 63});
  }
  h.tables.set_clip(id, clip);
}

void clip_text(Hostile& h) {
  auto [id, clip] = h.a_clip();
  std::string* const fields[] = {&clip.record.name, &clip.record.class_name, &clip.record.licence,
                                 &clip.record.source_hash, &clip.record.pixel_format};
  const std::vector<std::string> texts{"",
                                       "/etc/passwd",
                                       "../../x.mp4",
                                       text("a\0b", 3),
                                       "\x1b]0;title\x07\x1b[2J",
                                       "\xff\xfe\xc0\x80",
                                       "<img src=x onerror=alert(1)>",
                                       std::string(200000, 'x'),
                                       "--overwrite",
                                       "%s%n%d{}{0}",
                                       "a\nb\r\nfreshet: done",
                                       "gray16le",
                                       "rgb24",
                                       "yuv444p10le",
                                       "nosuch",
                                       "pal8",
                                       "bayer_rggb16le"};
  *fields[h.below(5)] = h.one_of(texts);
  h.tables.set_clip(id, clip);
}

void planes(Hostile& h) {
  auto [id, clip] = h.a_clip();
  store::StreamShape& shape = store::stream_shape(clip.record, h.below(store::kStreams));
  if (shape.planes.empty()) return;
  store::PlaneShape& plane = shape.planes[h.below(shape.planes.size())];
  switch (h.below(5)) {
    case 0:
      plane.width = h.one_of<std::uint32_t>({0, 1, 95, 97, 127, 65536});
      break;
    case 1:
      plane.height = h.one_of<std::uint32_t>({0, 1, 95, 97, 127, 65536});
      break;
    case 2:
      plane.bytes_per_sample = h.one_of<std::uint8_t>({0, 1, 2, 3, 255});
      break;
    case 3:
      shape.frames = h.one_of<std::uint32_t>({0, 1, shape.frames - 1, shape.frames + 1, 1U << 31, ~0U});
      break;
    default:
      if (h.below(2) == 0)
        shape.planes.pop_back();
      else
        shape.planes.push_back(plane);
  }
  h.tables.set_clip(id, clip);
}

template <class T>
void strew(Hostile& h, Bytes& bytes, T value) {
  const std::size_t count = bytes.size() / sizeof(T);
  if (count == 0) return;
  const bool all = h.below(5) < 2;
  for (std::size_t i = 0; i < (all ? count : 1 + count / 50); ++i)
    std::memcpy(&bytes[(all ? i : h.below(count)) * sizeof(T)], &value, sizeof(T));
}

void odd_values(Hostile& h, Bytes& bytes, std::uint32_t element_bytes) {
  switch (h.below(8)) {
    case 0:
      bytes.resize(bytes.size() - std::min<std::size_t>(bytes.size(), element_bytes));
      break;
    case 1:
      bytes.insert(bytes.end(), bytes.begin(),
                   bytes.begin() + std::min<std::ptrdiff_t>(element_bytes, std::ssize(bytes)));
      break;
    case 2:
      for (std::byte& byte : bytes) byte = static_cast<std::byte>(h.below(256));
      break;
    case 3:
      strew<std::uint8_t>(h, bytes, h.one_of<std::uint8_t>({255, 254, 20, 21, 18, 3, 0}));
      break;
    case 4:
      strew<std::uint16_t>(h, bytes, h.one_of<std::uint16_t>({0xffff, 0x7fff, 1000, 145, 97, 0}));
      break;
    case 5:
      strew<double>(h, bytes, h.one_of<double>({0, -1, NAN, 1e300, INFINITY}));
      break;
    default:
      strew<float>(h, bytes, h.one_of<float>({NAN, INFINITY, -INFINITY, -1, 0, 1e30F, -1e30F, 1e-40F, 7}));
  }
}

void column(Hostile& h) {
  const auto [drawn, with] = h.a_clip();
  const auto chosen =
      *std::next(with.columns.begin(), static_cast<std::ptrdiff_t>(h.below(with.columns.size())));
  h.what += " " + chosen.first;
  const bool everywhere = h.below(3) == 0;
  for (auto& [id, clip] : h.tables.clips()) {
    if (!clip.columns.contains(chosen.first) || (!everywhere && id != drawn)) continue;
    Bytes bytes = h.tables.column(id, chosen.first);
    odd_values(h, bytes, chosen.second.element_bytes);
    StoredClip changed = clip;
    h.tables.set_column(id, changed, chosen.first, bytes, chosen.second.element_bytes);
    h.tables.set_clip(id, changed);
  }
}

void column_shape(Hostile& h) {
  auto [id, clip] = h.a_clip();
  const std::string name =
      std::next(clip.columns.begin(), static_cast<std::ptrdiff_t>(h.below(clip.columns.size())))->first;
  h.what += " " + name;
  h.tables.set_column(id, clip, name,
                      h.below(2) == 0 ? std::nullopt : std::optional(h.tables.column(id, name)), 1);
  h.tables.set_clip(id, clip);
}

/// All patch columns longer or shorter alike.
void rows(Hostile& h) {
  auto [id, clip] = h.a_clip();
  clip.record.rows = h.one_of<std::size_t>({0, 1, 5, 300});
  for (const auto& [name, account] : std::map(clip.columns)) {
    if (!name.starts_with(store::kPatchColumns)) continue;
    const Bytes old = h.tables.column(id, name);
    const std::size_t size = clip.record.rows * account.element_bytes;
    Bytes bytes;
    while (bytes.size() < size && !old.empty()) bytes.insert(bytes.end(), old.begin(), old.end());
    bytes.resize(size);
    h.tables.set_column(id, clip, name, bytes, account.element_bytes);
  }
  h.tables.set_clip(id, clip);
}

void put_in(Bytes& bytes, std::size_t at, std::uint64_t value, std::size_t size) {
  if (at + size <= bytes.size()) std::memcpy(&bytes[at], &value, size);
}

void codebook(Hostile& h) {
  Bytes bytes = h.tables.blob("codebook");
  switch (h.below(7)) {
    case 0:
      put_in(bytes, 8, h.one_of<std::uint64_t>({0, 1, 19, 21, 256, 257, 1U << 31, ~0U}), 4);
      break;
    case 1:
      put_in(bytes, 12, h.one_of<std::uint64_t>({0, 1, 127, 129, 1U << 31, ~0U}), 4);
      break;
    case 2:
      put_in(bytes, 16, h.random(), 8);
      break;
    case 3:
      bytes.resize(h.below(bytes.size()));
      break;
    case 4:
      bytes.resize(bytes.size() + 1 + h.below(9999));
      break;
    case 5:
      bytes.clear();
      break;
    default:
      for (std::size_t i = 24; i + 4 <= bytes.size(); i += 4 * (1 + h.below(20))) {
        const float value = h.one_of<float>({NAN, INFINITY, 1e38F, 0, -5});
        std::memcpy(&bytes[i], &value, sizeof value);
      }
  }
  h.tables.set_blob("codebook", bytes, 1, 0);
}

void two_clips_of_one_name(Hostile& h) {
  auto [a, clip] = h.a_clip();
  const auto [b, other] = h.a_clip();
  if (h.below(2) == 0)
    clip.record.name = other.record.name;
  else
    clip.record.source_hash = other.record.source_hash;
  h.tables.set_clip(a, clip);
}

void another_blob(Hostile& h) {
  const std::vector<std::string> names{"flann-kdtree",        "flann-kmeans", "x",
                                       std::string(400, 'x'), "../../x",      "a\nb"};
  Bytes bytes(h.one_of<std::size_t>({0, 100, 5000}));
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(h.below(256));
  h.tables.set_blob(h.one_of(names), bytes, 1, static_cast<std::uint8_t>(h.below(2)));
}

constexpr std::size_t kFlannHeader = 64, kFlannHash = 32;  // query/index/flann_index.cc

/// FLANN's bytes garbled, under a right hash.
void flann(Hostile& h) {
  Bytes bytes = h.tables.blob("flann-hierarchical");
  ASSERT_GT(bytes.size(), kFlannHeader);
  const std::size_t size = bytes.size() - kFlannHeader;
  const std::size_t at = kFlannHeader + h.below(h.below(2) == 0 ? std::min<std::size_t>(size, 400) : size);
  switch (h.below(4)) {
    case 0:
      for (std::size_t i = h.one_of<std::size_t>({1, 1, 2, 5}); i > 0; --i)
        bytes[kFlannHeader + h.below(size)] =
            static_cast<std::byte>(h.one_of<std::size_t>({0, 255, 127, 128, h.below(256)}));
      break;
    case 1:
      put_in(bytes, at,
             h.one_of<std::uint64_t>({~0ull, 1ull << 63, 1ull << 32, (1ull << 31) - 1, 1000000, 0}), 8);
      break;
    case 2:
      bytes.resize(at);
      break;
    default:
      put_in(bytes, at, h.one_of<std::uint64_t>({~0U, (1U << 31) - 1, 100000, 278, 0}), 4);
  }
  put_in(bytes, kFlannHash, XXH3_64bits(bytes.data() + kFlannHeader, bytes.size() - kFlannHeader), 8);
  put_in(bytes, kFlannHash + 8, bytes.size() - kFlannHeader, 8);
  h.tables.set_blob("flann-hierarchical", bytes, 1, store::kOutsideDigest);
}

struct Kind {
  const char* name;
  void (*apply)(Hostile&);
};
constexpr Kind kKinds[] = {{"metadata", metadata},
                           {"settings", settings},
                           {"no document", no_document},
                           {"clip's number", clip_number},
                           {"clip's text", clip_text},
                           {"planes", planes},
                           {"column", column},
                           {"column's shape", column_shape},
                           {"rows", rows},
                           {"codebook", codebook},
                           {"two clips of one name", two_clips_of_one_name},
                           {"another blob", another_blob}};

using Command = std::vector<std::string>;

/// Commands that read a store, and some that write it.
const std::vector<Command>& doors() {
  static const std::vector<Command> all{
      {"store", "verify", "h.store"},
      {"store", "info", "h.store"},
      {"store", "info", "h.store", "--json"},
      {"store", "digest", "h.store"},
      {"store", "framemd5", "h.store", "clip2.mkv"},
      {"store", "export", "h.store", "clip2.mkv", "-o", "h.mkv", "--overwrite"},
      {"query", "candidates", "h.store", "still.png", "--whole", "--frames", "8"},
      {"query", "label", "h.store", "still.png", "--whole", "--direction", "down", "--frames", "8", "-o",
       "h.json", "--overwrite"},
      {"synth", "animate", "h.store", "still.png", "--whole", "--direction", "down", "--frames", "4",
       "--overwrite", "-o", "h.mkv"},
      {"synth", "animate", "h.store", "still.png", "--whole", "--hint", "none", "--frames", "20", "--loop",
       "--method", "paper", "--overwrite", "-o", "h.mkv"},
      {"store", "repair", "h.store", "-o", "hr.store"},
      {"store", "compact", "h.store"},
      {"store", "remove", "h.store", "clip2.mkv"},
      {"index", "--rebuild", "h.store"},
      {"index", "--flann", "kdtree", "--", "h.store"},
      {"ingest", "h.store", "--no-index", "--force", "clip1.mkv"}};
  return all;
}

/// Whether a terminal would take it for text, and a program for UTF-8.
bool is_plain_text(const std::string& said) {
  if (std::ranges::any_of(said, [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return (byte < 32 && c != '\n' && c != '\t' && c != '\r') || byte == 127;
      }))
    return false;
  try {
    json(said).dump();  // strict on UTF-8
  } catch (const json::exception&) {
    return false;
  }
  return true;
}

std::string judge(const Command& command, const Outcome& outcome) {
  Outcome judged = outcome;
  if (judged.exit_code == 3 && !judged.err.empty()) judged.exit_code = 1;
  if (judged.exit_code == 3 && !judged.out.empty()) judged.exit_code = 0;  // a report
  if (const std::string wrong = judge_file(judged); !wrong.empty()) return wrong;
  if (!is_plain_text(outcome.out) || !is_plain_text(outcome.err)) return "it says what is no text";
  if (outcome.err.size() > 20000) return "a message of " + std::to_string(outcome.err.size()) + " bytes";
  if (outcome.exit_code == 0 && command.back() == "--json" && !json::accept(outcome.out))
    return "it says no JSON";
  return "";
}

/// The store under the name h.store, and what `tried` of the commands make of it.
void expect_harmless(const SealedTables& hostile, const std::vector<Command>& commands,
                     const std::string& what, std::map<std::string, int>& codes) {
  const Campaign& c = campaign();
  SealedTables writable = hostile;
  for (const Command& command : commands) {
    c.begin_with("", "h.store");
    std::filesystem::remove(c.folder / "hr.store");
    writable.write(c.folder / "h.store");
    const Outcome outcome = c.run(command);
    EXPECT_EQ(judge(command, outcome), "") << what << ": " << command[0] << " " << command[1];
    ++codes[std::to_string(outcome.exit_code)];
  }
}

void make_still() {
  cv::Mat still(96, 96, CV_8UC3);
  cv::randu(still, 0, 255);
  cv::imwrite((campaign().folder / "still.png").string(), still);
}

SealedTables whole(bool with_flann) {
  const Campaign& c = campaign();
  c.begin_with("indexed.store", "h.store");
  if (with_flann) {
    EXPECT_EQ(c.run({"index", "--flann", "hierarchical", "--", "h.store"}).exit_code, 0);
  }
  return tables_of(c.folder / "h.store");
}

TEST(Hostile, AStoreThatIsSealedAgainAnswersAsBefore) {
  SealedTables tables = whole(false);
  campaign().begin_with("", "h.store");
  tables.write(campaign().folder / "h.store");
  EXPECT_EQ(digest(campaign().folder / "h.store"), campaign().indexed);
}

TEST(Hostile, StoresWithRightHashesAreTakenOrRefused) {
  make_still();
  const SealedTables made = whole(false);
  std::map<std::string, std::map<std::string, int>> codes;
  const std::size_t kinds = std::size(kKinds);
  walk_rounds("hostile stores", at_full_length() ? 4000 : kinds,
              [&](std::size_t round, std::mt19937& random) {
                const Kind& tried = kKinds[round % kinds];
                SealedTables tables = made;
                Hostile hostile{tables, random};
                tried.apply(hostile);
                std::vector<Command> commands{doors()[hostile.below(3)]};
                while (commands.size() < 4) commands.push_back(hostile.one_of(doors()));
                expect_harmless(tables, commands, tried.name + hostile.what, codes[tried.name]);
              });
  for (const auto& [name, counts] : codes) {
    std::cout << name << ":";
    for (const auto& [code, count] : counts) std::cout << " exit " << code << " " << count << " times";
    std::cout << "\n";
  }
}

TEST(Hostile, GarbledTreesOfFlannAreTakenOrRefused) {
  make_still();
  const SealedTables made = whole(true);
  std::map<std::string, int> untouched;
  std::map<std::string, int> codes;
  const Command search{"query",    "candidates", "h.store", "still.png",         "--whole",
                       "--frames", "8",          "--index", "flann-hierarchical"};
  expect_harmless(made, {search}, "FLANN, whole", untouched);
  EXPECT_EQ(untouched["0"], 1);
  walk_rounds("FLANN's bytes", at_full_length() ? 17000 : 15, [&](std::size_t, std::mt19937& random) {
    SealedTables tables = made;
    Hostile hostile{tables, random};
    flann(hostile);
    expect_harmless(tables, {search}, "FLANN", codes);
  });
  for (const auto& [code, count] : codes) std::cout << "exit " << code << ": " << count << "\n";
}

TEST(Hostile, AnAnswerThatIsNoTextIsSeen) {
  Outcome planted;
  planted.exit_code = 0;
  planted.out = "name \x1b[2J";
  EXPECT_NE(judge({"store", "info"}, planted), "");
  planted.out = "\xff";
  EXPECT_NE(judge({"store", "info"}, planted), "");
  planted.out = "{";
  EXPECT_NE(judge({"store", "info", "--json"}, planted), "");
}

}  // namespace
}  // namespace freshet::tools
