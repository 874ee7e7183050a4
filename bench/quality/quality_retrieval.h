// quality_retrieval.h — what the patches that look most like a still tell of it, without a hint: its class, its motion.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "query/search/target.h"
#include "stored/patch_table.h"

namespace freshet::bench {

/// Means over pieces, and over each piece's patches.
struct Retrieval {
  double same_class = 0;  // share of patches from clips of the still's class
  double angle_deg = 0;   // between a patch's mean motion and the piece's true one, where both move
  double speed = 0;       // |log2| of the ratio of their speeds, octaves, where both move
};
/// From here on something moves, px/s.
inline constexpr float kMoves = 2.5f;

/// rows        by piece: its patches.
/// same_class  by clip of the table, whether it is of the still's class.
/// motion      CV_32FC2, px/s, the picture's true mean motion. matte   CV_8U, counted above 127. Both of its size.
/// NaN where nothing can be compared.
Retrieval retrieval_of(const query::Target& target, const stored::PatchTable& table,
                       std::span<const std::vector<stored::Row>> rows, const std::vector<bool>& same_class,
                       const cv::Mat& motion, const cv::Mat& matte);

/// One still, by its best candidates and by the patches that labelling chose among them.
struct RetrievedCase {
  double likeness = 0;  // of each piece's best candidate, 0 to 1, mean
  Retrieval best, labels;
  std::size_t pieces = 0;
  double search_cpu_s = 0;  // of all threads
};
/// Means over stills, without those that have no figure; and what a piece's search costs.
std::string retrieval_table(std::span<const RetrievedCase> cases);

}  // namespace freshet::bench
