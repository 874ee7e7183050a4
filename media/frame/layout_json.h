// media/frame/layout_json.h — a pixel layout as it is kept beside the planes in a store.
#pragma once

#include <optional>

#include <nlohmann/json.hpp>

#include "media/frame/frame.h"

namespace freshet::media {

/// An object of the layout's fields, one key a field.
nlohmann::json to_json(const PixelLayout& layout);
/// Nothing when a field is missing, of another type or out of range.
std::optional<PixelLayout> layout_from_json(const nlohmann::json& json);

}  // namespace freshet::media
