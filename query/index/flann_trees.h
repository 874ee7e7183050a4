// query/index/flann_trees.h — whether FLANN may be given the bytes of its own trees.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "query/index/flann_index.h"

namespace freshet::query {

/// FLANN 1.9.2 believes what it reads: counts that it allocates, and numbers of rows and features that it follows. Here
/// the fields are walked in the order in which FLANN's classes serialise them: every number lies inside what there is,
/// every inner node has as many children as the index has branches, and every tree has each row once.
///
/// bytes     as FLANN's serialize() gives them to an archive, one after another; no header of ours, no compression.
/// rows      of the histograms; at least 1.
/// bins      of each.
/// Returns   what is wrong; empty when the trees may be loaded and searched.
/// Cost      one pass; a bit of memory a row.
std::string fault_of_flann_trees(FlannKind kind, std::span<const std::byte> bytes, std::size_t rows,
                                 std::size_t bins);

}  // namespace freshet::query
