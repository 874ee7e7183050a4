// media/frame/filmed_ground.h — what lies behind what was filmed without alpha.
#pragma once

namespace freshet::media {

enum class Ground {
  kNone,   // nothing is known: it is opaque
  kBlack,  // light on black, such as fire
  kWhite,  // dark on white, such as smoke
};
inline constexpr const char* kGrounds[] = {"none", "black", "white"};  // their names

}  // namespace freshet::media
