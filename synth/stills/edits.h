// synth/stills/edits.h — what a person changes about an animation, in a small TOML file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/stills/partial_order.h"
#include "synth/stills/region.h"

namespace freshet::synth::stills {

/// Of one region, or of all ("*"). Stills are named by their files.
struct RegionEdits {
  std::string region = "*";
  std::optional<double> speed;         // times as fast
  std::optional<double> step_s;        // s from still to still, in the mean
  std::optional<double> sigma;         // of Eq. 2
  std::optional<double> irregularity;  // 0..1
  std::optional<bool> slow_turns;
  std::optional<RegionKind> kind;
  std::optional<int> split;                           // parts
  std::vector<std::vector<std::string>> refuse = {};  // paths that are not walked, either way
  std::vector<std::vector<std::string>> turn = {};    // paths that are walked in this order only
  std::vector<std::vector<std::string>> order = {};   // paths that are added
  std::vector<std::vector<std::string>> cut = {};     // edges: two stills each
  std::vector<std::string> sequence = {};             // shown in this order; nothing is drawn
};

/// A pin's reach where none is said, a share of the stills' longer side.
inline constexpr double kPinReach = .08;

/// Where something of one still lies in another.
struct StillPin {
  std::string from, to;  // the stills' files
  cv::Point2d at, goes;  // px of the upright files, in the one and in the other; (0, 0) is the middle of the
                         // upper left pixel
  std::optional<double> reach;  // px: farther from it flow stays as it was found; nothing: kPinReach
};

/// A thing that passes in front of others.
struct FrontEdit {
  std::string name;
  std::filesystem::path mattes;  // the folder of its mattes, one a still
};

struct StillsEdits {
  std::vector<RegionEdits> regions;
  std::vector<FrontEdit> fronts;  // nearest first
  std::vector<StillPin> pins;
};

/// Reads them. All keys are explained by edit_keys().
/// Throws   Error{kInput} naming file, line and key: no TOML, an unknown key, a value of another kind or out
///          of range.
StillsEdits read_edits(const std::filesystem::path& path);
/// Every key with unit and range, for a person.
std::string edit_keys();

/// All that holds for one region, later ones over earlier ones; those of a part's parent hold for it.
RegionEdits edits_of(const std::vector<RegionEdits>& all, const Region& region);

/// The still of this name. Throws Error{kInput} that lists the names.
int still_named(const std::string& name, const std::vector<std::string>& names, const std::string& where);

/// A path after the edits; one that is meant by a list of names holds these stills in this order, or in the
/// reverse.
std::vector<Path> edited_paths(const std::vector<Path>& paths, const RegionEdits& edits,
                               const std::vector<std::string>& names);

}  // namespace freshet::synth::stills
