// media/frame/blend.h — how a picture joins what lies behind it.
#pragma once

namespace freshet::media {

/// On the values as they are coded, as compositing programs do unless told not to. With L = the picture's colour times
/// its alpha, and B behind:
enum class Blend {
  kOver,    // L + (1 - alpha) B
  kAdd,     // L + B, at most white: light
  kScreen,  // L + B - L B: light that does not burn out
};
inline constexpr const char* kBlends[] = {"over", "add", "screen"};  // their names

}  // namespace freshet::media
