// media/frame/filmed_ground.h — what lies behind what was filmed without alpha.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "freshet/error.h"

namespace freshet::media {

enum class Ground {
  kNone,   // nothing is known: it is opaque
  kBlack,  // light on black, such as fire
  kWhite,  // dark on white, such as smoke
};
/// Their names, in the order of the enumeration.
inline const std::vector<std::string>& ground_names() {
  static const std::vector<std::string> names{"none", "black", "white"};
  return names;
}

/// Throws Error{kUsage} for what is none of ground_names().
inline Ground parse_ground(std::string_view word) {
  const std::vector<std::string>& names = ground_names();
  const auto found = std::find(names.begin(), names.end(), word);
  if (found == names.end())
    throw Error(ErrorKind::kUsage, "ground \"" + std::string(word) + "\"", "there is no such choice",
                "Give one of none, black, white");
  return static_cast<Ground>(found - names.begin());
}

}  // namespace freshet::media
