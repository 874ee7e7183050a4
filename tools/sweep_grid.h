// tools/sweep_grid.h — the settings that a sweep tries, all with all.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "query/labelling/label_sweep.h"
#include "synth/animate/animate.h"
#include "tools/options/search_options.h"

namespace freshet::tools {

/// One --sweep: what is varied, and its values as they were written.
struct SweepAxis {
  std::string name;
  std::vector<std::string> values;
};

/// "sigma=100,1000". Throws Error{kUsage} saying what is wrong with the text: no "=", no such name, no value,
/// one that is no number, out of range or given twice.
SweepAxis parse_axis(const std::string& text);

/// Names of what can be swept, with what their values may be, for --help and messages.
std::string sweepable_names();

/// One combination.
struct SweepPoint {
  std::vector<std::pair<std::string, std::string>> settings;  // name and value of each axis
  query::LabelVariation labelling;
  synth::animate::AnimateOptions rendering;
  /// "sigma=100 rho=2"
  std::string title() const;
};

inline constexpr std::size_t kMaxPoints = 64;

/// The product of all axes, the last one changing fastest; what is not swept is as in labelling and
/// rendering. Throws Error{kUsage} when an axis is given twice, or there are more than kMaxPoints.
std::vector<SweepPoint> make_grid(const std::vector<SweepAxis>& axes, const SolverOptions& labelling,
                                  const synth::animate::AnimateOptions& rendering);

}  // namespace freshet::tools
