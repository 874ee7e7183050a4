#include "tests/faults/aimed_damage.h"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>

#include "store/records/record.h"

namespace freshet::tools {

namespace {

using Entry = LmdbFile::Entry;
using Wanted = std::function<bool(const Entry&)>;

std::size_t below(Aim& aim, std::size_t end) {
  return std::uniform_int_distribution<std::size_t>(0, end - 1)(aim.random);
}
bool coin(Aim& aim, double share = .5) { return std::bernoulli_distribution(share)(aim.random); }

template <class T>
const T& one_of(Aim& aim, const std::vector<T>& all) {
  return all[below(aim, all.size())];
}

void say(Aim& aim, std::size_t at) { aim.what += " byte " + std::to_string(at); }

void flip(Aim& aim, std::size_t at) {
  if (at >= aim.bytes.size()) return;
  const std::size_t bit = below(aim, 8);
  aim.bytes[at] = static_cast<char>(aim.bytes[at] ^ (1 << bit));
  say(aim, at);
  aim.what += " bit " + std::to_string(bit);
}

/// Numbers at which readers stumble, and any.
std::uint64_t odd_number(Aim& aim) {
  const std::uint64_t pages = aim.stores.whole.bytes.size() / kPage;
  const std::array<std::uint64_t, 14> numbers{0,
                                              1,
                                              2,
                                              3,
                                              below(aim, pages + 100),
                                              pages,
                                              pages - 1,
                                              pages + 1,
                                              0xffff,
                                              0xffffffff,
                                              kNoPage,
                                              1ull << 47,
                                              1ull << 63,
                                              (std::uint64_t{aim.random()} << 32) | aim.random()};
  return numbers[below(aim, numbers.size())];
}

void put(Aim& aim, std::size_t at, std::size_t bytes, std::uint64_t value) {
  if (at + bytes > aim.bytes.size()) return;
  put_number(aim.bytes, at, bytes, value);
  say(aim, at);
  aim.what += " = " + std::to_string(value);
}

void exchange(Aim& aim, std::size_t a, std::size_t b, std::size_t bytes) {
  std::swap_ranges(aim.bytes.begin() + static_cast<std::ptrdiff_t>(a),
                   aim.bytes.begin() + static_cast<std::ptrdiff_t>(a + bytes),
                   aim.bytes.begin() + static_cast<std::ptrdiff_t>(b));
  say(aim, a);
  say(aim, b);
}

/// The bytes of another file from `from` on, at `at`.
void copy_from(Aim& aim, const std::string& file, std::size_t from, std::size_t at, std::size_t bytes) {
  if (from + bytes > file.size() || at + bytes > aim.bytes.size()) return;
  aim.bytes.replace(at, bytes, file, from, bytes);
  say(aim, at);
}

std::optional<Entry> an_entry(Aim& aim, const Wanted& wanted) {
  std::vector<Entry> fit;
  std::ranges::copy_if(aim.stores.whole.entries, std::back_inserter(fit), wanted);
  if (fit.empty()) return std::nullopt;
  return one_of(aim, fit);
}

bool any_record(const Entry& entry) { return entry.is_record(); }
bool inside(const Entry& entry) { return entry.is_record() && (entry.flags & (kBigData | kSubTree)) == 0; }

const LmdbFile& a_past(Aim& aim) { return one_of(aim, aim.stores.past); }

std::string a_table(Aim& aim) {
  const std::vector<std::string> tables{"meta", "clips", "tiles", "columns", "blobs"};
  return one_of(aim, tables);
}

/// Fields of a meta page and their lengths.
constexpr std::array<std::pair<std::size_t, std::size_t>, 21> kMetaFields{
    {{16, 4}, {20, 4}, {24, 8}, {32, 8}, {40, 4}, {44, 2},  {46, 2},  {48, 8},  {56, 8},  {64, 8}, {72, 8},
     {80, 8}, {88, 4}, {92, 2}, {94, 2}, {96, 8}, {104, 8}, {112, 8}, {120, 8}, {128, 8}, {136, 8}}};

std::vector<Entry> free_entries(Aim& aim) {
  std::vector<Entry> found;
  std::ranges::copy_if(aim.stores.whole.entries, std::back_inserter(found), [](const Entry& each) {
    return each.leaf && each.tree == "free" && each.value_bytes >= 16;
  });
  return found;
}

/// The pages of a file that its trees lead to, in no order.
std::vector<std::size_t> pages_in_use(const LmdbFile& file) {
  std::vector<std::size_t> pages;
  for (const auto& page : file.pages) pages.push_back(page.number);
  for (const auto& long_value : file.apart)
    for (std::size_t i = 0; i < long_value.count; ++i) pages.push_back(long_value.first + i);
  return pages;
}

void meta_bit(Aim& aim) { flip(aim, below(aim, 2) * kPage + below(aim, 152)); }

void meta_number(Aim& aim) {
  const auto& [at, bytes] = kMetaFields[below(aim, kMetaFields.size())];
  put(aim, below(aim, 2) * kPage + at, bytes, odd_number(aim));
}

void meta_in_both(Aim& aim) {
  const auto& [at, bytes] = kMetaFields[below(aim, kMetaFields.size())];
  const std::uint64_t value = odd_number(aim);
  for (const std::size_t page : {std::size_t{0}, kPage}) put(aim, page + at, bytes, value);
}

void page_header_bit(Aim& aim) {
  flip(aim, one_of(aim, aim.stores.whole.pages).number * kPage + below(aim, kPageHeader));
}

void page_header_number(Aim& aim) {
  constexpr std::array<std::pair<std::size_t, std::size_t>, 5> fields{
      {{0, 8}, {8, 2}, {10, 2}, {12, 2}, {14, 2}}};
  const auto& [at, bytes] = fields[below(aim, fields.size())];
  put(aim, one_of(aim, aim.stores.whole.pages).number * kPage + at, bytes, odd_number(aim));
}

void entry_offset(Aim& aim) {
  const std::size_t page = one_of(aim, aim.stores.whole.pages).number * kPage;
  const std::size_t count = (number_at(aim.bytes, page + 12, 2) - kPageHeader) / 2;
  const std::size_t at = page + kPageHeader + 2 * below(aim, count);
  if (coin(aim)) return flip(aim, at + below(aim, 2));
  exchange(aim, at, page + kPageHeader + 2 * below(aim, count), 2);
}

void entry_header(Aim& aim) { flip(aim, one_of(aim, aim.stores.whole.entries).at + below(aim, 8)); }

void entry_flags(Aim& aim) {
  const std::vector<std::uint64_t> flags{0, 1, 2, 3, 4, 5, 6, 7, 8, 0x10, 0x4000, 0xffff};
  put(aim, one_of(aim, aim.stores.whole.entries).at + 4, 2, one_of(aim, flags));
}

void key_byte(Aim& aim) {
  if (const auto e = an_entry(aim, [](const Entry& each) { return each.key_bytes > 0; }))
    flip(aim, e->key() + below(aim, e->key_bytes));
}

void keys_exchanged(Aim& aim) {
  const auto a = an_entry(aim, any_record);
  const auto b = an_entry(aim, [&](const Entry& each) {
    return each.is_record() && each.key_bytes == a->key_bytes && each.at != a->at;
  });
  if (b) exchange(aim, a->key(), b->key(), a->key_bytes);
}

void long_value_header(Aim& aim) {
  const std::size_t at = one_of(aim, aim.stores.whole.apart).first * kPage;
  if (coin(aim)) return flip(aim, at + below(aim, kPageHeader));
  put(aim, at + 12, 4, odd_number(aim));
}

void long_value_pointer(Aim& aim) {
  const auto e = an_entry(aim, [](const Entry& each) { return each.apart(); });
  if (!e) return;
  const std::array<std::uint64_t, 3> pages{odd_number(aim), one_of(aim, aim.stores.whole.apart).first,
                                           one_of(aim, aim.stores.whole.pages).number};
  put(aim, e->value, 8, pages[below(aim, 3)]);
}

void long_values_exchanged(Aim& aim) {
  const auto a = an_entry(aim, [](const Entry& each) { return each.is_record() && each.apart(); });
  if (!a) return;
  const auto b = an_entry(aim, [&](const Entry& each) {
    return each.is_record() && each.apart() && each.tree == a->tree && each.at != a->at;
  });
  if (!b) return;
  exchange(aim, a->value, b->value, 8);
  exchange(aim, a->at, b->at, 4);  // their lengths
}

void values_exchanged(Aim& aim) {
  const auto a = an_entry(aim, inside);
  const auto b = an_entry(aim, [&](const Entry& each) {
    return inside(each) && each.tree == a->tree && each.value_bytes == a->value_bytes && each.at != a->at;
  });
  if (b) exchange(aim, a->value, b->value, a->value_bytes);
}

void record_header(Aim& aim) {
  if (const auto e = an_entry(aim, [](const Entry& each) {
        return each.is_record() && each.value_bytes >= store::kRecordHeaderBytes;
      }))
    flip(aim, aim.stores.whole.value_at(*e) + below(aim, store::kRecordHeaderBytes));
}

void payload_bit(Aim& aim) {
  if (const auto e = an_entry(aim, [](const Entry& each) {
        return each.is_record() && each.value_bytes > store::kRecordHeaderBytes;
      }))
    flip(aim, aim.stores.whole.value_at(*e) + store::kRecordHeaderBytes +
                  below(aim, e->value_bytes - store::kRecordHeaderBytes));
}

std::size_t a_tree(Aim& aim) {
  std::vector<std::size_t> places;
  for (const auto& [name, at] : aim.stores.whole.trees) places.push_back(at);
  return one_of(aim, places);
}

void tree_record(Aim& aim) {
  if (coin(aim)) return flip(aim, a_tree(aim) + below(aim, kTreeBytes));
  constexpr std::array<std::pair<std::size_t, std::size_t>, 7> fields{
      {{4, 2}, {6, 2}, {8, 8}, {16, 8}, {24, 8}, {32, 8}, {40, 8}}};
  const auto& [at, bytes] = fields[below(aim, fields.size())];
  put(aim, a_tree(aim) + at, bytes, odd_number(aim));
}

void trees_exchanged(Aim& aim) {
  const auto& trees = aim.stores.whole.trees;
  exchange(aim, trees.at(a_table(aim)), trees.at(a_table(aim)), kTreeBytes);
}

void tree_of_the_past(Aim& aim) {
  const LmdbFile& past = a_past(aim);
  const std::string table = a_table(aim);
  if (past.trees.contains(table))
    copy_from(aim, past.bytes, past.trees.at(table), aim.stores.whole.trees.at(table), kTreeBytes);
}

void free_list(Aim& aim) {
  const std::vector<Entry> lists = free_entries(aim);
  if (lists.empty()) return;
  const Entry list = one_of(aim, lists);
  const std::size_t at = aim.stores.whole.value_at(list);
  if (coin(aim, .3)) return flip(aim, at + below(aim, list.value_bytes));
  if (coin(aim)) return flip(aim, list.key() + below(aim, list.key_bytes));
  const std::array<std::uint64_t, 3> pages{odd_number(aim), one_of(aim, aim.stores.whole.apart).first,
                                           one_of(aim, aim.stores.whole.pages).number};
  put(aim, at + 8 * below(aim, list.value_bytes / 8), 8, pages[below(aim, 3)]);
}

/// One page fewer in a list, or another page in its place, in order: LMDB cannot tell.
void free_list_in_order(Aim& aim) {
  const std::vector<Entry> lists = free_entries(aim);
  if (lists.empty()) return;
  const std::size_t at = aim.stores.whole.value_at(one_of(aim, lists));
  const std::size_t count = number_at(aim.bytes, at, 8);
  if (count == 0) return;
  if (coin(aim, .4)) return put(aim, at, 8, below(aim, count));
  const std::size_t i = below(aim, count);
  const std::uint64_t above = i > 0 ? number_at(aim.bytes, at + 8 * i, 8) : aim.bytes.size() / kPage,
                      under = i + 1 < count ? number_at(aim.bytes, at + 8 * (i + 2), 8) : 1;
  if (above - under > 2) put(aim, at + 8 * (i + 1), 8, under + 1 + below(aim, above - under - 1));
}

void branch_child(Aim& aim) {
  const Wanted branch = [](const Entry& each) { return !each.leaf; };
  const auto a = an_entry(aim, branch), b = an_entry(aim, branch);
  if (!a) return;
  if (coin(aim)) return exchange(aim, a->at, b->at, 6);
  put(aim, a->at, 6,
      coin(aim) ? odd_number(aim) & 0xffffffffffff : one_of(aim, aim.stores.whole.pages).number);
}

void pages_exchanged(Aim& aim) {
  const std::vector<std::size_t> pages = pages_in_use(aim.stores.whole);
  const bool keys = coin(aim);
  const std::size_t a = keys ? one_of(aim, aim.stores.whole.pages).number : one_of(aim, pages),
                    b = keys ? one_of(aim, aim.stores.whole.pages).number : one_of(aim, pages);
  exchange(aim, a * kPage, b * kPage, kPage);
  if (!keys || coin(aim, .3)) return;
  put(aim, a * kPage, 8, a);
  put(aim, b * kPage, 8, b);
}

void page_of_another_store(Aim& aim) {
  const std::size_t page = one_of(aim, pages_in_use(aim.stores.whole));
  copy_from(aim, aim.stores.other.bytes, page * kPage, page * kPage, kPage);
}

/// A record's value as another file has it, where key and length are the same and the bytes are not.
void record_from(Aim& aim, const LmdbFile& file) {
  std::vector<std::pair<Entry, std::string>> differ;
  for (const Entry& mine : aim.stores.whole.entries) {
    if (!mine.is_record()) continue;
    for (const Entry& theirs : file.entries)
      if (theirs.is_record() && theirs.tree == mine.tree && theirs.value_bytes == mine.value_bytes &&
          file.key_of(theirs) == aim.stores.whole.key_of(mine))
        if (std::string value = file.value_of(theirs); value != aim.stores.whole.value_of(mine))
          differ.emplace_back(mine, std::move(value));
  }
  if (differ.empty()) return;
  const auto& [entry, value] = one_of(aim, differ);
  copy_from(aim, value, 0, aim.stores.whole.value_at(entry), value.size());
}

void record_of_another_store(Aim& aim) { record_from(aim, aim.stores.other); }
void record_of_the_past(Aim& aim) { record_from(aim, a_past(aim)); }

void page_of_the_past(Aim& aim) {
  const LmdbFile& past = a_past(aim);
  const std::size_t page = 2 + below(aim, past.bytes.size() / kPage - 2);
  copy_from(aim, past.bytes, page * kPage, page * kPage, kPage);
}

void all_of_a_tree_of_the_past(Aim& aim) {
  const LmdbFile& past = a_past(aim);
  const std::string table = a_table(aim);
  if (!past.trees.contains(table)) return;
  for (const auto& page : past.pages)
    if (page.tree == table) copy_from(aim, past.bytes, page.number * kPage, page.number * kPage, kPage);
  for (const auto& value : past.apart)
    if (value.tree == table)
      for (std::size_t i = value.first; i < value.first + value.count; ++i)
        copy_from(aim, past.bytes, i * kPage, i * kPage, kPage);
  copy_from(aim, past.bytes, past.trees.at(table), aim.stores.whole.trees.at(table), kTreeBytes);
  aim.what = " all pages of " + table;
}

void meta_of_the_past(Aim& aim) {
  const LmdbFile& past = a_past(aim);
  const std::size_t which = below(aim, 3);
  for (const std::size_t page : {std::size_t{0}, std::size_t{1}})
    if (which == 2 || which == page) copy_from(aim, past.bytes, page * kPage, page * kPage, kPage);
}

void cut_or_grown(Aim& aim) {
  const std::size_t kind = below(aim, 4);
  if (kind == 0) aim.bytes.resize(below(aim, aim.bytes.size()));
  if (kind == 1) aim.bytes.resize(kPage * (1 + below(aim, aim.bytes.size() / kPage - 1)));
  if (kind == 2) aim.bytes.append(kPage * (1 + below(aim, 8)), '\0');
  if (kind == 3)
    for (std::size_t i = 1 + below(aim, 9998); i > 0; --i)
      aim.bytes.push_back(static_cast<char>(below(aim, 256)));
  aim.what += " " + std::to_string(aim.bytes.size()) + " bytes long";
}

void last_page(Aim& aim) {
  const std::uint64_t last = aim.stores.whole.last;
  const std::vector<std::uint64_t> pages{last - 1, last + 1, last + 100, 2, 1ull << 40, below(aim, last)};
  put(aim, aim.stores.whole.live * kPage + 136, 8, one_of(aim, pages));
}

/// An entry of a leaf taken out and all counts mended: a record is lost, and LMDB cannot see it.
void entry_taken_out(Aim& aim) {
  const auto e = an_entry(aim, any_record);
  const std::size_t page = e->page * kPage;
  const std::size_t lower = number_at(aim.bytes, page + 12, 2), upper = number_at(aim.bytes, page + 14, 2);
  const std::size_t count = (lower - kPageHeader) / 2, offset = e->at - page;
  if (count < 2) return;
  const std::size_t size = (8 + e->key_bytes + (e->apart() ? 8 : e->value_bytes) + 1) & ~std::size_t{1};
  std::vector<std::size_t> offsets;
  for (std::size_t i = 0; i < count; ++i)
    if (i != e->index) offsets.push_back(number_at(aim.bytes, page + kPageHeader + 2 * i, 2));
  const std::string body = aim.bytes.substr(page + upper, offset - upper);
  aim.bytes.replace(page + upper + size, body.size(), body);
  for (std::size_t i = 0; i < offsets.size(); ++i)
    put_number(aim.bytes, page + kPageHeader + 2 * i, 2,
               offsets[i] < offset ? offsets[i] + size : offsets[i]);
  put_number(aim.bytes, page + 12, 2, lower - 2);
  put_number(aim.bytes, page + 14, 2, upper + size);
  const std::size_t tree = aim.stores.whole.trees.at(e->tree);
  put_number(aim.bytes, tree + 32, 8, number_at(aim.bytes, tree + 32, 8) - 1);
  if (e->apart())
    put_number(aim.bytes, tree + 24, 8,
               number_at(aim.bytes, tree + 24, 8) - store::lmdb::pages_of(e->value_bytes, kPage));
  aim.what += " entry " + std::to_string(e->index) + " of page " + std::to_string(e->page);
}

void several_bits(Aim& aim) {
  std::vector<std::size_t> pages{0, 1};
  for (const auto& page : aim.stores.whole.pages) pages.push_back(page.number);
  for (std::size_t i = 2 + below(aim, 18); i > 0; --i)
    flip(aim, one_of(aim, pages) * kPage + below(aim, kPage));
}

constexpr AimedDamage kDamages[] = {
    {"meta bit", meta_bit, true},
    {"meta number", meta_number, true},
    {"meta number in both", meta_in_both, true},
    {"page header bit", page_header_bit},
    {"page header number", page_header_number},
    {"entry offset", entry_offset},
    {"entry header", entry_header},
    {"entry flags", entry_flags},
    {"key byte", key_byte},
    {"keys exchanged", keys_exchanged},
    {"long value's header", long_value_header},
    {"long value's pointer", long_value_pointer},
    {"long values exchanged", long_values_exchanged},
    {"values exchanged", values_exchanged},
    {"record header", record_header},
    {"payload bit", payload_bit},
    {"tree's record", tree_record, true},  // the free list's and the main one's lie on a meta page
    {"trees exchanged", trees_exchanged},
    {"tree of the past", tree_of_the_past},
    {"free list", free_list},
    {"free list in order", free_list_in_order},
    {"branch's child", branch_child},
    {"pages exchanged", pages_exchanged},
    {"page of another store", page_of_another_store},
    {"record of another store", record_of_another_store},
    {"page of the past", page_of_the_past},
    {"all of a tree of the past", all_of_a_tree_of_the_past},
    {"record of the past", record_of_the_past},
    {"meta of the past", meta_of_the_past, true},
    {"cut or grown", cut_or_grown},
    {"last page", last_page},
    {"entry taken out", entry_taken_out},
    {"several bits", several_bits, true},
};

}  // namespace

std::span<const AimedDamage> aimed_damages() { return kDamages; }

}  // namespace freshet::tools
