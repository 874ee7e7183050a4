// synth/scene/kinds/filmed_ground.h — what lies behind what was filmed without alpha.
#pragma once

#include <string>
#include <vector>

namespace freshet::synth::scene {

/// As transfer::Ground.
enum class FilmedGround { kNone, kBlack, kWhite };

inline const std::vector<std::string>& filmed_grounds() {  // their names
  static const std::vector<std::string> names{"none", "black", "white"};
  return names;
}

}  // namespace freshet::synth::scene
