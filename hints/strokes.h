// hints/strokes.h — the strokes with which a person says where the fluid of a picture goes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::hints {

/// One line drawn in the direction of the flow.
struct Stroke {
  /// px, from first to last as the fluid goes. (0, 0) is the outer corner of the picture's upper left pixel,
  /// whose middle is (0.5, 0.5).
  std::vector<cv::Point2f> points;
  std::optional<float> speed_px_per_s{};  // along all of it; of several: where it begins
  std::vector<float> speeds{};            // two or more, at even distances from first to last
  std::string name{};                     // for messages: "stroke 2", "path \"fall\""; may be empty
  /// Of SVG: the element's and its groups' labels and ids, outermost first, and the innermost data-layer.
  std::vector<std::string> names{};
  std::string layer{};
  /// Of SVG, for lines that move: when it lies here, and of which line (an id) this is a position.
  std::optional<float> time_s{};
  std::string line{};
};

/// The speed at a share of its length, 0..1; none where none is said.
std::optional<float> speed_at(const Stroke& stroke, double share);

/// Reads strokes drawn over a picture of this size, in one of two formats, told apart by their content:
///
/// JSON   {"format": "freshet-strokes", "version": 1,
///         "strokes": [{"points": [[x, y], ...], "speed": 80}, ...]}
///        Points in px of the picture as in Stroke; "speed" in px/s, or a list of up to 100 of them as
///        in Stroke, and "name" may be left out.
/// SVG    as drawing programs write it: see read_svg_strokes.
///
/// notices   for a person, when not null: what was left out.
/// Throws    Error{kInput} naming the file, the stroke and the remedy: no such file, neither format,
///           malformed, no stroke at all, a stroke of no length (below half a pixel) or wholly outside the
///           picture, a speed that is not 0 to 100,000 px/s, above 128 MB of SVG or 16 MB of JSON, above
///           10,000 strokes or a million points.
std::vector<Stroke> read_strokes(const std::filesystem::path& path, cv::Size picture,
                                 std::vector<std::string>* notices = nullptr);

}  // namespace freshet::hints
