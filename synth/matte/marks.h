// synth/matte/marks.h — where a person says that fluid is, and where it is not.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::matte {

enum Mark : std::uint8_t { kUnknown = 0, kBackground = 1, kFluid = 2 };

/// A mark for each pixel of a picture: CV_8U, values of Mark.
using Marks = cv::Mat;

/// Reads scribbles: a picture of the same size with strokes in it. White or green means fluid, black or red
/// background, all else unknown. Three ways to draw them, told apart by what the file holds:
///
/// transparent  where it has transparency, only what is at least half opaque counts.
/// painted over where nearly all that has none of the four colours is the picture itself, what has not been
///              painted differs from it by 24 of 255 or less and is unknown, whatever its colour.
/// plain        otherwise: strokes on grey, as a trimap.
///
/// picture  CV_8UC3.
/// notices  for a person, when not null.
/// Throws   Error{kInput} naming the file: unreadable, another size, no stroke in it.
Marks read_scribbles(const std::filesystem::path& path, const cv::Mat& picture,
                     std::vector<std::string>* notices = nullptr);

/// Reads marks from JSON, px of the picture as in hints/strokes.h. Later entries lie over earlier ones.
///
/// {"format": "freshet-marks", "version": 1, "marks": [
///   {"is": "fluid",      "points": [[x, y], ...], "width": 9},
///   {"is": "background", "box": [x, y, width, height]},
///   {"is": "within",     "box": [x, y, width, height]}]}
///
/// points   a line, 7 px wide unless said; one point: a dot.
/// within   no fluid outside of it; several: outside of all.
///
/// Throws   Error{kInput} naming the file, the mark and the remedy: malformed, no mark, a mark outside the
///          picture or without area, above 16 MB, 10,000 marks or a million points.
Marks read_marks(const std::filesystem::path& path, cv::Size picture);

/// No fluid outside of these boxes (px): background wherever nothing was said. Throws Error{kUsage} naming
/// the box when its part inside the picture has no area.
void keep_within(Marks& marks, const std::vector<cv::Rect2d>& boxes, const std::string& where);

/// Lays marks over others: what is not unknown wins.
void lay_over(Marks& below, const Marks& above);

}  // namespace freshet::synth::matte
