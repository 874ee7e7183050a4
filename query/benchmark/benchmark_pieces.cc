#include "query/benchmark/benchmark_pieces.h"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "query/search/picture_scale.h"
#include "stored/average_image.h"

namespace freshet::query {
namespace {

// Of the clips that have patches, the one with the median number of them.
std::size_t median_clip(const stored::PatchTable& table) {
  std::vector<std::size_t> clips;
  const auto rows_of = [&](std::size_t clip) { return table.first_row[clip + 1] - table.first_row[clip]; };
  for (std::size_t clip = 0; clip < table.clips.size(); ++clip)
    if (rows_of(clip) > 0) clips.push_back(clip);
  std::stable_sort(clips.begin(), clips.end(),
                   [&](std::size_t a, std::size_t b) { return rows_of(a) < rows_of(b); });
  return clips[clips.size() / 2];
}

}  // namespace

std::vector<stored::Row> evenly(std::span<const stored::Row> rows, std::size_t count) {
  if (count >= rows.size()) return {rows.begin(), rows.end()};
  std::vector<stored::Row> some(count);
  for (std::size_t i = 0; i < count; ++i) some[i] = rows[i * rows.size() / count];
  return some;
}

BenchmarkPieces benchmark_pieces(const store::Snapshot& snapshot, const SearchBase& base,
                                 std::vector<BenchmarkPicture> pictures, std::size_t max_pieces,
                                 std::size_t rows) {
  BenchmarkPieces made;
  made.pictures = std::move(pictures);
  const stored::PatchTable& table = base.table;
  stored::Row left_out = 0, until = 0;
  if (made.pictures.empty()) {
    const std::size_t clip = median_clip(table);
    made.held_out = snapshot.clip(table.clips[clip]).name;
    BenchmarkPicture own{made.held_out, {}, {}};
    cv::cvtColor(stored::average_image(snapshot, table.clips[clip]), own.picture, cv::COLOR_GRAY2BGR);
    own.matte = cv::Mat(own.picture.size(), CV_8U, cv::Scalar(255));
    made.pictures.push_back(std::move(own));
    if (table.first_row[clip + 1] - table.first_row[clip] < table.size()) {
      left_out = table.first_row[clip];
      until = table.first_row[clip + 1];
    }
  }
  for (stored::Row row = 0; row < table.size(); ++row)
    if (row < left_out || row >= until) made.rows.push_back(row);
  if (rows > made.rows.size())
    throw Error(ErrorKind::kUsage, snapshot.path().string(),
                fmt::format("{} patches to search among, and {} were asked for", made.rows.size(), rows));
  if (rows > 0) made.rows = evenly(made.rows, rows);

  std::vector<PieceQuery> all;
  for (const BenchmarkPicture& one : made.pictures) {
    const double scale = auto_piece_scale(one.picture.size());
    const Target target =
        make_target(reduce(one.picture, scale), reduce(one.matte, scale), base.settings.grid, base.codebook);
    made.pieces.push_back(target.size());
    all.insert(all.end(), target.queries.begin(), target.queries.end());
  }
  const std::size_t count = std::min(max_pieces, all.size());
  for (std::size_t i = 0; i < count; ++i) made.queries.push_back(all[i * all.size() / count]);
  return made;
}

}  // namespace freshet::query
