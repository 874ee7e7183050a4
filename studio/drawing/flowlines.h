// studio/drawing/flowlines.h — a clip that is to go on without an end, and the lines that its fluid rides.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core.hpp>

namespace freshet::studio {

class Fields;

/// Where a line that moves lies later.
struct LinePosition {
  double time = 0;  // s of what is made, above 0; .01..1000
  std::vector<cv::Point2f> points;
  bool operator==(const LinePosition&) const = default;
};

/// A line that particles of the clip ride, px of its frames, in the direction of the flow.
struct ClipLine {
  std::string id;  // of an edited line: its input line's, or that with "-" and something behind it
  std::vector<cv::Point2f> points;    // two or more
  std::vector<float> speeds{};        // times as fast, .05..20, at even distances along it; empty: 1
  std::vector<LinePosition> later{};  // of an edited line that moves, by time; points: where it is at first
  bool operator==(const ClipLine&) const = default;
};

struct Flowlines {
  std::string clip;              // its name in the store; where it was dropped, its file's; empty: none yet
  bool dropped = false;          // it lies in the project's folder: own_clip_path()
  std::vector<ClipLine> lines;   // where it flows; empty: found
  std::vector<ClipLine> edited;  // where it shall flow; empty: as it does
  double join = 0;               // px, as `synth flowlines --join`; 0: as the input lines lie
  bool stretched = false;        // the whole input line onto the edited one
  std::string ground = "none";   // "none", "black", "white"
  int frames = 250;              // 1..20000
  bool loop = false;
  bool moving_camera = false;  // take it though the camera moves
  bool operator==(const Flowlines&) const = default;
};

/// Checks everything, as document_from_json says.
Flowlines read_flowlines(const Fields& fields);
nlohmann::json flowlines_json(const Flowlines& flowlines);

/// Of a clip that was dropped, from the project's folder: "ways/flowlines/clips/fall.mp4".
std::string own_clip_path(const std::string& clip);

/// As `synth flowlines --lines` and --edited read them. Without a page: its units are px of the clip.
std::string clip_lines_svg(const std::vector<ClipLine>& lines);

}  // namespace freshet::studio
