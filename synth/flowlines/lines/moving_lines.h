// synth/flowlines/lines/moving_lines.h — edited lines that lie elsewhere at other times.
#pragma once

#include <string>
#include <vector>

#include "synth/flowlines/lines/flow_line.h"

namespace freshet::synth::flowlines {

/// Lines by name, each with its positions in time. Between two positions a line goes evenly from the one to the other,
/// share of its length by share; before the first and after the last it stays. In a loop it goes on from the last
/// position to the first.
class MovingLines {
 public:
  /// lines     positions have times; of one name there may be several.
  /// loop_s    seconds until all comes again; 0: never.
  /// where     names the file in errors.
  /// Throws    Error{kInput} naming the line: two positions at one time, one without a time beside others, one at or
  ///           after the loop's end.
  MovingLines(const std::vector<FlowLine>& lines, double loop_s, const std::string& where);

  bool moves() const;
  /// The lines at a time, in the order in which their names came first.
  std::vector<FlowLine> at(double seconds) const;

 private:
  std::vector<std::vector<FlowLine>> positions_;  // by line, in the order of time
  double loop_s_;
};

/// Halfway lines: `share` of the way from one to the other, speeds too; the name is the second's.
FlowLine between(const FlowLine& from, const FlowLine& to, float share);

}  // namespace freshet::synth::flowlines
