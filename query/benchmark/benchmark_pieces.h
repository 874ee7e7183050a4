// query/benchmark/benchmark_pieces.h — what a search benchmark asks for: pieces of pictures.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "query/index/search_base.h"
#include "query/search/target.h"

namespace freshet::query {

struct BenchmarkPicture {
  std::string name;
  cv::Mat picture;  // CV_8UC3
  cv::Mat matte;    // CV_8U, same size
};

struct BenchmarkPieces {
  std::vector<BenchmarkPicture> pictures;
  std::string held_out;             // the clip whose average image is the picture; empty: pictures were given
  std::vector<stored::Row> rows;    // that are searched, ascending: the table's, without that clip's
  std::vector<PieceQuery> queries;  // `max_pieces` at most, evenly spread over all pictures' pieces
  std::vector<std::size_t> pieces;  // how many each picture has in all
};

/// Of the pictures, cut as labelling cuts them. Without any: of the average image of the clip with the median
/// number of patches. That clip's own patches are then left out, so that nothing is found because it is the
/// same footage; the only clip of a store is not left out.
/// rows     of those, this many evenly spread; 0: all.
/// Throws   Error{kUsage} when there are fewer.
BenchmarkPieces benchmark_pieces(const store::Snapshot& snapshot, const SearchBase& base,
                                 std::vector<BenchmarkPicture> pictures, std::size_t max_pieces,
                                 std::size_t rows);

/// `count` of the rows, evenly spread, in their order; all when there are no more.
std::vector<stored::Row> evenly(std::span<const stored::Row> rows, std::size_t count);

}  // namespace freshet::query
