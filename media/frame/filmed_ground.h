// media/frame/filmed_ground.h — what lies behind what was filmed without alpha.
#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>

#include "freshet/error.h"

namespace freshet::media {

enum class Ground {
  kNone,   // nothing is known: it is opaque
  kBlack,  // light on black, such as fire
  kWhite,  // dark on white, such as smoke
};
inline constexpr const char* kGrounds[] = {"none", "black", "white"};  // their names

/// Throws Error{kUsage} for what is none of kGrounds.
inline Ground parse_ground(std::string_view word) {
  const auto* found = std::find(std::begin(kGrounds), std::end(kGrounds), word);
  if (found == std::end(kGrounds))
    throw Error(ErrorKind::kUsage, "ground \"" + std::string(word) + "\"", "there is no such choice",
                "Give one of none, black, white");
  return static_cast<Ground>(found - std::begin(kGrounds));
}

}  // namespace freshet::media
