#include "studio/ways/way.h"

#include <algorithm>
#include <array>

#include "freshet/error.h"

namespace freshet::studio {

const Way& way_of(std::string_view name) {
  static const std::array<const Way*, 6> kWays{&kDesignWay, &kStillsWay, &kFlowlinesWay,
                                               &kLinesWay,  &kSceneWay,  &kSweepWay};
  const auto* const found =
      std::find_if(kWays.begin(), kWays.end(), [&](const Way* way) { return way->name == name; });
  if (found == kWays.end()) throw Error(ErrorKind::kNotFound, std::string(name), "there is no such way");
  return **found;
}

}  // namespace freshet::studio
