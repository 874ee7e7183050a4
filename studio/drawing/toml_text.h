// studio/drawing/toml_text.h — names as TOML writes them, whatever they hold.
#pragma once

#include <string>
#include <vector>

namespace freshet::studio {

/// A basic string: "a \"name\"". text   without control characters (Fields::text).
std::string toml_text(const std::string& text);
/// An array of these.
std::string toml_list(const std::vector<std::string>& texts);

}  // namespace freshet::studio
