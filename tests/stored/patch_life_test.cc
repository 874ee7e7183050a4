#include "stored/patch_life.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "stored/clip_metadata.h"
#include "stored/clip_schema.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::stored {
namespace {

const cv::Size kSource(320, 192);

/// 10 x 6 cells of 32 px, all alike.
vision::CellMap made_cells(const std::array<float, 4>& half_life_s, float contrast) {
  vision::CellMap cells{
      .rows = 6, .columns = 10, .channels = vision::kLifeChannels, .cell = 32, .values = {}};
  for (int i = 0; i < 60; ++i) {
    cells.values.insert(cells.values.end(), half_life_s.begin(), half_life_s.end());
    cells.values.insert(cells.values.end(), 4, contrast);
  }
  return cells;
}
float* at(vision::CellMap& cells, int row, int column) {
  return cells.values.data() + (row * cells.columns + column) * cells.channels;
}

PatchLife life_of(const vision::CellMap& cells, const vision::Variant& variant, cv::Point patch) {
  return patch_life(cells, vision::variant_frame(kSource, variant), variant.scale, patch, 48);
}

TEST(PatchLife, IsTheMeanOfLogarithmsByPower) {
  vision::CellMap cells = made_cells({1, 1, 1, 1}, 0.01f);
  // The patch covers 32 px of column 2 and 16 of column 3, rows alike.
  for (int row = 0; row < 6; ++row) {
    for (int b = 0; b < 4; ++b) at(cells, row, 2)[b] = 0.5f, at(cells, row, 3)[b] = 4;
    at(cells, row, 3)[4 + 1] = 0.02f;
  }
  const PatchLife life = life_of(cells, {}, {64, 60});
  EXPECT_NEAR(std::log2(life.half_life_s[0]), (2 * -1 + 2) / 3.0, 0.02);
  EXPECT_NEAR(std::log2(life.half_life_s[1]), (2 * -1 + 4 * 2) / 6.0, 0.02);
  EXPECT_NEAR(life.power[0], 1e-4, 1e-9);
  EXPECT_NEAR(life.power[1], (2 * 1e-4 + 4e-4) / 3, 1e-9);
}

TEST(PatchLife, LiesWhereItsVariantShowsTheSource) {
  // Every cell its own life: the variant's place tells which are covered.
  vision::CellMap cells = made_cells({1, 1, 1, 1}, 0.01f);
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 10; ++column)
      for (int b = 0; b < 4; ++b) at(cells, row, column)[b] = column < 5 ? 0.25f : 2;
  EXPECT_NEAR(life_of(cells, {}, {0, 0}).half_life_s[2], 0.25, 1e-6);
  EXPECT_NEAR(life_of(cells, {.flip = true}, {0, 0}).half_life_s[2], 2, 1e-6);
  EXPECT_NEAR(life_of(cells, {.scale = 0.5f}, {96, 0}).half_life_s[2], 2, 1e-6);
  EXPECT_NEAR(life_of(cells, {.scale = 0.5f}, {16, 0}).half_life_s[2], 0.25, 1e-6);
  // Turned by a quarter counter-clockwise, the source's left comes to lie at the bottom.
  EXPECT_NEAR(life_of(cells, {.rotation_deg = 90}, {60, 240}).half_life_s[2], 0.25, 1e-6);
  EXPECT_NEAR(life_of(cells, {.rotation_deg = 90}, {60, 20}).half_life_s[2], 2, 1e-6);
}

TEST(PatchLife, BandsOfAScaledPatchAreCoarserOnesOfTheSource) {
  vision::CellMap cells = made_cells({0.1f, 0.2f, 0.4f, 1.6f}, 0);
  for (int i = 0; i < 60; ++i)
    for (int b = 0; b < 4; ++b) cells.values[i * 8 + 4 + b] = 0.01f * static_cast<float>(b + 1);
  const PatchLife whole = life_of(cells, {}, {0, 0}), half = life_of(cells, {.scale = 0.5f}, {0, 0}),
                  between = life_of(cells, {.scale = std::sqrt(0.5f)}, {0, 0});
  const std::array expected{0.1, 0.2, 0.4, 1.6}, shifted{0.2, 0.4, 1.6, 1.6};
  for (int b = 0; b < 4; ++b) {
    EXPECT_NEAR(whole.half_life_s[b], expected[b], 1e-6) << b;
    EXPECT_NEAR(half.half_life_s[b], shifted[b], 1e-6) << b;
    EXPECT_NEAR(between.half_life_s[b], std::sqrt(expected[b] * shifted[b]), 1e-5) << b;
  }
  EXPECT_NEAR(half.power[0], 4e-4, 1e-9);
  // An enlarged one shows finer detail than the source has: its finest band is the source's.
  EXPECT_NEAR(life_of(cells, {.scale = 2}, {0, 0}).half_life_s[0], 0.1, 1e-6);
  EXPECT_NEAR(life_of(cells, {.scale = 2}, {0, 0}).half_life_s[1], 0.1, 1e-6);
}

TEST(PatchLife, OfCellsThatSayNothingIsNotKnown) {
  vision::CellMap cells = made_cells({0, 0, 0.5f, 0}, 0);
  const PatchLife life = life_of(cells, {}, {10, 10});
  for (const int b : {0, 1, 3}) EXPECT_EQ(life.half_life_s[b], 0) << b;
  EXPECT_NEAR(life.half_life_s[2], 0.5, 1e-6);  // without power, cells count alike
  EXPECT_EQ(life.power[2], 0);
  EXPECT_NEAR(life_of(cells, {.scale = std::sqrt(0.5f)}, {0, 0}).half_life_s[1], 0.5, 1e-6);
}

/// A store of one clip with such a column.
struct OneColumn {
  ScratchFolder folder;
  store::Snapshot snapshot;
  store::ClipId id{};

  OneColumn(const vision::CellMap* cells, int channels) {
    store::Store store = store::Store::create(folder.path() / "a.store", "{}");
    store::ClipWriter writer = store.add_clip();
    const cv::Mat frame(kSource, CV_8U, cv::Scalar(0));
    begin_stream(writer, store::Stream::kFrames, {frame});
    append(writer, store::Stream::kFrames, {frame});
    store::ClipRecord record;
    record.name = "a", record.source_hash = "b", record.width = 320, record.height = 192, record.fps_num = 25;
    const CellShape shape{.rows = 6, .columns = 10, .channels = channels, .cell = 32};
    record.metadata = to_json(ClipMetadata{.cells = {.life = shape}});
    if (cells)
      writer.column_bytes(kLifeCells, std::as_bytes(std::span(cells->values)),
                          static_cast<std::uint32_t>(channels) * sizeof(float));
    id = writer.commit(record);
    snapshot = store.snapshot();
  }
};

TEST(LifeCells, ComeBackAndAreMissingInOlderStores) {
  const vision::CellMap made = made_cells({0.1f, 0.2f, 0.4f, 1.6f}, 0.01f);
  const OneColumn with(&made, 8), without(nullptr, 8);
  const auto read = life_cells(with.snapshot, with.id);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->values, made.values);
  EXPECT_EQ(read->rows, 6);
  EXPECT_FALSE(life_cells(without.snapshot, without.id));
}

TEST(LifeCells, ThatCannotBeAreRefused) {
  for (const float wrong : {-0.1f, 6.5f, std::nanf("")}) {
    const vision::CellMap made = made_cells({0.1f, wrong, 0.4f, 1.6f}, 0.01f);
    const OneColumn store(&made, 8);
    EXPECT_THROW(life_cells(store.snapshot, store.id), Error) << wrong;
  }
  const vision::CellMap made = made_cells({0.1f, 0.2f, 0.4f, 1.6f}, 0.01f);
  const OneColumn store(&made, 4);
  EXPECT_THROW(life_cells(store.snapshot, store.id), Error);
}

}  // namespace
}  // namespace freshet::stored
