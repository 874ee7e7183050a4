#include "studio/ways/way.h"

#include <algorithm>
#include <array>

#include "freshet/error.h"

namespace freshet::studio {

extern const Way kDesignWay;     // design_way.cc: a motion that is simulated, and given the look of a clip
extern const Way kStillsWay;     // stills_way.cc: a moving scene from stills
extern const Way kFlowlinesWay;  // flowlines_way.cc: a clip that goes on without an end
extern const Way kLinesWay;      // flowlines_way.cc: the lines that are found in the clip
extern const Way kSceneWay;      // scene_way.cc: layers under one wind
extern const Way kSweepWay;      // sweep_way.cc: the animation under several settings

const Way& way_of(std::string_view name) {
  static const std::array<const Way*, 6> kWays{&kDesignWay, &kStillsWay, &kFlowlinesWay,
                                               &kLinesWay,  &kSceneWay,  &kSweepWay};
  const auto* const found =
      std::find_if(kWays.begin(), kWays.end(), [&](const Way* way) { return way->name == name; });
  if (found == kWays.end()) throw Error(ErrorKind::kNotFound, std::string(name), "there is no such way");
  return **found;
}

}  // namespace freshet::studio
