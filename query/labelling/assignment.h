// query/labelling/assignment.h — which patch lies on which piece of a picture, as a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "vision/variant.h"

namespace freshet::query {

/// A clip that an assignment takes patches from: what is needed to find it again, and to credit it.
struct AssignedClip {
  std::string name, class_name, licence;
  std::string source_hash;  // 32 hex digits; decides which clip of a store is meant
  bool operator==(const AssignedClip&) const = default;
};

struct AssignedPiece {
  cv::Point corner;         // px, upper left corner in the picture; may lie outside it
  std::uint32_t clip = 0;   // index into Assignment::clips
  vision::Variant variant;  // by its parameters, so that a store of other variants is noticed, not misread
  cv::Point patch;          // px, upper left corner in the variant's frame
  float score = 0;          // 0..1, intersection / max_score
  bool operator==(const AssignedPiece&) const = default;
};

/// The gap that a labelling should end at, and that its user is told of.
inline constexpr double kGapAimed = 0.01;

struct Assignment {
  cv::Size picture;  // px
  /// Pieces lie on the picture reduced by this (picture_scale.h), and all px below are of that.
  double piece_scale = 1;
  int side = 48, stride = 24;         // px
  std::vector<AssignedClip> clips;    // each used at least once when made by label()
  std::vector<AssignedPiece> pieces;  // on one lattice of `stride`
  std::string minimizer, cost_form;   // how it was made, for a person
  double energy = 0;
  double lower_bound = 0;  // -inf: not known
  /// (energy - bound) / |bound|, how far above the best it can at most be; inf without a bound.
  double gap() const;
  /// True when the gap is known and at most kGapAimed.
  bool reaches_gap() const { return gap() <= kGapAimed; }
  bool operator==(const Assignment&) const = default;
};

/// One JSON object; "format" is "freshet-assignment", "version" 1, or 2 with a "piece_scale" above 1: who
/// knows only version 1 would lay the pieces in a corner.
std::string to_json(const Assignment& assignment);
/// Checks everything: types, ranges, that pieces lie on one lattice and near the picture, that clips exist.
/// Throws Error{kInput} naming `where` and the field.
Assignment assignment_from_json(const std::string& json, const std::string& where);

/// Writes beside the target and renames. Throws Error{kIo}.
void write_assignment(const std::filesystem::path& path, const Assignment& assignment);
/// Files above 256 MB are refused. Throws Error{kInput}.
Assignment read_assignment(const std::filesystem::path& path);

/// The assignment's clips in a store, by source hash, in the order of assignment.clips.
/// Throws Error{kNotFound} naming a clip that the store lacks, Error{kInput} when a patch reaches beyond the
/// frame of its variant.
std::vector<store::ClipId> find_clips(const Assignment& assignment, const store::Snapshot& snapshot);

}  // namespace freshet::query
