// media/frame/layout_json.h — a pixel layout as it is kept beside the planes in a store.
#pragma once

#include <string>

#include "media/frame/frame.h"

namespace freshet::media {

/// A JSON object of the layout's fields, one key a field.
std::string to_json(const PixelLayout& layout);
/// Reads the layout from a clip's metadata: a JSON object whose key "layout" holds such an object.
/// Throws Error{kDamaged} when a field is missing, of another type or out of range.
PixelLayout layout_from_json(const std::string& metadata);

}  // namespace freshet::media
