// synth/flowlines/edit.h — edited lines made dense, and each given the input line whose texture it shows.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/flowlines/lines/arc_map.h"
#include "synth/flowlines/lines/flow_line.h"

namespace freshet::synth::flowlines {

struct EditOptions {
  Correspondence correspondence = Correspondence::kEqual;
  double patch_px = 24, spacing_px = 12;
  /// Consecutive lines are joined by interpolated ones where they are nowhere further apart, px. 0: where they are one
  /// sheet of fluid, as their input lines are: within 4 patches, running the same way, copies of two lines, and no more
  /// than twice as far apart as those (mirrored: 1.2 times). A fixed distance joined neighbouring plumes of large
  /// patches.
  double join_px = 0;
  int frames = 30;  // over which overlap errors are averaged (Sec. 4: 30)
};

/// One of the dense edited lines.
struct EditedLine {
  FlowLine line;      // px of the clip's frames
  int input = -1;     // index of the input line
  bool drawn = true;  // not interpolated
  /// The drawn lines between which it lies, and where: of a drawn one it is both.
  std::size_t from = 0, to = 0;
  float share = 0;
  /// 0: as the clip is shown; else a copy, which is shown in a time of its own with all copies of that number, so that
  /// two chimneys do not puff alike at every moment. Copies are told apart by what their names have behind the input
  /// line's ("l4-2" and "foam-2" go together), and the lines of a sheet by that of its first.
  int time = 0;
};

/// Times that copies have, the clip's own among them: more of them share these.
inline constexpr int kTimes = 4;

/// The dense lines when the drawn ones have moved: each between the same two as before.
void follow_drawn(const std::vector<FlowLine>& drawn, std::vector<EditedLine>& dense);

/// An edited line is a copy of the input line that it is named after: "fall", or "fall-2" where there are several
/// (what a drawing program makes of the id of a copied path).
/// inputs    their names.
/// where     names the file in errors.
/// Returns   by edited line the input's index.
/// Throws    Error{kInput} naming the first edited line that has no partner, and some of the names there are.
std::vector<int> partners(const std::vector<FlowLine>& inputs, const std::vector<FlowLine>& edited,
                          const std::string& where);

/// The input lines, and behind them those that join consecutive ones: what interpolated edited lines choose from.
std::vector<FlowLine> dense_inputs(const std::vector<FlowLine>& inputs, const EditOptions& options);

/// The dense set: drawn lines with those interpolated between consecutive ones, and input lines for the latter by
/// pair_lines.
/// inputs   dense. partner   of the drawn ones.
/// frames   CV_8UC3, at least one: of which some are compared.
/// Source   Bhat et al. 2004, Sec. 4, Figs. 6 and 7.
/// Cost     inputs^2 x samples of a line / 9 x frames for each interpolated line. All threads, same result.
std::vector<EditedLine> densify(const std::vector<FlowLine>& inputs, const std::vector<FlowLine>& drawn,
                                const std::vector<int>& partner, const std::vector<cv::Mat>& frames,
                                const EditOptions& options);

}  // namespace freshet::synth::flowlines
