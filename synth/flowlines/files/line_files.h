// synth/flowlines/files/line_files.h — flow lines as drawings: read as strokes are, written for a person to change.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/flowlines/lines/flow_line.h"

namespace freshet::synth::flowlines {

/// Lines drawn over the picture (hints::read_strokes: SVG, or JSON). A line's name is its SVG id; lines without one
/// are named by their place, "line 3". data-speed of an SVG element is how many times as fast its particles ride: one
/// number, or several at even distances along it. Lines of one name with a data-time each are one line that moves.
///
/// notices   for a person: what was left out; what of a line was cut off because it lies outside the picture.
/// Throws    Error{kInput} naming file and line: as read_strokes; a line that leaves the picture and comes back; one
///           shorter than `shortest_px` inside of it; two of one name; a speed that is not .05 to 20.
std::vector<FlowLine> read_lines(const std::filesystem::path& path, cv::Size picture, double shortest_px,
                                 std::vector<std::string>* notices = nullptr);

/// As SVG of the picture's size, a path a line, with its id and speeds. Throws Error{kIo}.
void write_lines(const std::filesystem::path& path, const std::vector<FlowLine>& lines, cv::Size picture);

}  // namespace freshet::synth::flowlines
