// hints/svg_strokes.h — strokes from the drawings that Inkscape, Illustrator and others save as SVG.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core.hpp>

#include "hints/strokes.h"

namespace freshet::hints {

/// Every subpath of a <path>, every <line>, <polyline> and <polygon> is a stroke, from its first point to its
/// last; a closed one ends where it began. Transforms of elements, groups and nested documents apply. An
/// element's or its group's attribute data-speed is the stroke's speed, in px/s of the picture, or several at even
/// distances along it; data-time in seconds and data-of, a line's id, say that this is where that line lies then, as
/// the positions in an <animate attributeName="d"> do; data-layer is its
/// layer.
///
/// Left out are what is hidden (display, visibility, opacity 0; as attribute, style or by a style sheet's
/// class or id) and what is only there to be referred to (defs, clip paths, masks, markers, patterns,
/// symbols). Other shapes have no beginning; they are left out with a notice.
///
/// Onto the picture: when the drawing shows an <image> of the picture's proportions, that image is the
/// picture, wherever it lies; else the page (width, height, viewBox) is; a drawing without any page is in px.
///
/// Curves become chains no further than 0.1 px from them. The document type and its entities are not read.
/// Strokes outside the picture are the caller's to judge.
///
/// text      the whole document.
/// Throws    Error{kInput} naming `where`, the element and the fault: not XML, not SVG, a page of other
///           proportions (by more than 2 %), a path, number, transform or length that is malformed, elements
///           nested deeper than 200.
std::vector<Stroke> read_svg_strokes(std::string_view text, const std::string& where, cv::Size picture,
                                     std::vector<std::string>* notices);

}  // namespace freshet::hints
