#include "stored/patch_table.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "freshet/error.h"
#include "stored/clip_schema.h"
#include "stored/store_settings.h"
#include "vision/settings.h"

namespace freshet::stored {
namespace {

constexpr std::array kColumns{kPatchVariant.name, kPatchX.name,        kPatchY.name,
                              kPatchWords.name,   kPatchCoverage.name, kPatchMotion.name};

[[noreturn]] void fail(const store::ClipRecord& record, const std::string& fault) {
  throw Error(ErrorKind::kDamaged, record.name, fault, "Run freshet store verify");
}

/// Before anything is as long as the clip says: the columns' own records tell how many rows there are.
void check_rows(const store::Snapshot& snapshot, store::ClipId clip, const char* column) {
  const store::ClipRecord& record = snapshot.clip(clip);
  if (const std::uint64_t rows = snapshot.column_rows(clip, column); rows != record.rows)
    fail(record, std::string("column ") + column + " has " + std::to_string(rows) + " rows, the clip " +
                     std::to_string(record.rows));
}

template <class T>
std::vector<T> rows_of(const store::Snapshot& snapshot, store::ClipId clip, const Column<T>& column) {
  check_rows(snapshot, clip, column.name);
  return column.read(snapshot, clip);
}

template <class T>
void put(std::vector<T>& table, Row first, const std::vector<T>& values) {
  std::ranges::copy(values, table.begin() + first);
}

/// One clip's rows of the table.
void read_clip(const store::Snapshot& snapshot, const vision::Settings& settings,
               std::span<const vision::Variant> variants, std::size_t index, PatchTable& table) {
  const store::ClipId clip = table.clips[index];
  const Row first = table.first_row[index], end = table.first_row[index + 1];
  if (first == end) return;
  const ClipPatches patches = read_clip_patches(snapshot, settings, variants, clip);
  put(table.variant, first, patches.variant);
  put(table.x, first, patches.x);
  put(table.y, first, patches.y);
  check_rows(snapshot, clip, kPatchWords.name);
  const vision::OwnWordMaps words =
      kPatchWords.read(snapshot, clip, vision::word_bytes(settings.codebook.words));
  table.words.set(first, words);
  put(table.coverage, first, rows_of(snapshot, clip, kPatchCoverage));
  const auto motion = rows_of(snapshot, clip, kPatchMotion);
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const auto& [u, v] = motion[i];
    if (!std::isfinite(u) || !std::isfinite(v))
      fail(snapshot.clip(clip), "a patch whose motion is no number");
    table.mean_u[first + i] = u;
    table.mean_v[first + i] = v;
  }
  std::fill(table.clip.begin() + first, table.clip.begin() + end, static_cast<std::uint32_t>(index));
}

}  // namespace

ClipPatches read_clip_patches(const store::Snapshot& snapshot, const vision::Settings& settings,
                              std::span<const vision::Variant> variants, store::ClipId clip) {
  const store::ClipRecord& record = snapshot.clip(clip);
  ClipPatches patches;
  if (record.rows == 0) return patches;
  patches.variant = rows_of(snapshot, clip, kPatchVariant);
  patches.x = rows_of(snapshot, clip, kPatchX);
  patches.y = rows_of(snapshot, clip, kPatchY);
  // No patch may reach beyond its variant's frame, whatever the file says.
  std::vector<std::optional<cv::Size>> sizes(variants.size());
  const cv::Size source(static_cast<int>(record.width), static_cast<int>(record.height));
  for (std::size_t row = 0; row < patches.variant.size(); ++row) {
    const std::size_t variant = patches.variant[row];
    if (variant >= variants.size()) fail(record, "a patch of variant " + std::to_string(variant));
    if (!sizes[variant]) sizes[variant] = vision::variant_frame(source, variants[variant]).size;
    if (patches.x[row] + settings.grid.patch > sizes[variant]->width ||
        patches.y[row] + settings.grid.patch > sizes[variant]->height) {
      fail(record, "patch " + std::to_string(row) + " reaches beyond its frame");
    }
  }
  return patches;
}

PatchTable read_patch_table(const store::Snapshot& snapshot) {
  const vision::Settings settings = settings_of(snapshot);
  const std::vector<vision::Variant> variants = settings.variants();
  PatchTable table;
  table.words = vision::OwnWordMaps(vision::word_bytes(settings.codebook.words));
  table.first_row.push_back(0);
  std::uint64_t rows = 0;
  for (const store::ClipId clip : snapshot.clips()) rows += snapshot.clip(clip).rows;
  if (rows == 0) {
    throw Error(ErrorKind::kNotFound, snapshot.path().string(), "it holds no patches",
                "Ingest clips of moving fluid first");
  }
  if (rows >= kNoRow) {
    throw Error(ErrorKind::kUsage, snapshot.path().string(),
                std::to_string(rows) + " patches, more than 32 bits can number", "Split it into several");
  }
  for (const store::ClipId clip : snapshot.clips()) {
    const store::ClipRecord& record = snapshot.clip(clip);
    if (record.rows != 0 && !kPatchWords.is_in(snapshot, clip)) {
      throw Error(ErrorKind::kNotFound, snapshot.path().string(), "clip " + record.name + " has no index",
                  "Run freshet index");
    }
    table.clips.push_back(clip);
    table.first_row.push_back(table.first_row.back() + static_cast<Row>(record.rows));
  }
  for (const store::ClipId clip : table.clips)
    for (const char* column : kColumns) snapshot.prefetch_column(clip, column);
  for (const store::ClipId clip : table.clips) {
    if (snapshot.clip(clip).rows == 0) continue;
    for (const char* column : kColumns) check_rows(snapshot, clip, column);
  }
  // Half a gigabyte for some million patches: cleared by several threads, as it is read.
  oneapi::tbb::parallel_invoke([&] { table.words.resize(rows); }, [&] { table.clip.resize(rows); },
                               [&] { table.mean_u.resize(rows); }, [&] { table.mean_v.resize(rows); },
                               [&] { table.coverage.resize(rows); },
                               [&] {
                                 table.variant.resize(rows);
                                 table.x.resize(rows);
                                 table.y.resize(rows);
                               });
  oneapi::tbb::parallel_for(std::size_t{0}, table.clips.size(),
                            [&](std::size_t i) { read_clip(snapshot, settings, variants, i, table); });
  return table;
}

}  // namespace freshet::stored
