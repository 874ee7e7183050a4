#include "tools/options/hold_options.h"

#include <fmt/format.h>

#include "media/picture/picture.h"
#include "synth/matte/held.h"
#include "tools/console/run_context.h"

namespace freshet::tools {

void HoldOptions::add_to(CLI::App& command) {
  command.add_option(
      "--hold", hold_,
      "Picture, white where something stands in front of the fluid or in it: it keeps still [none]");
}

cv::Mat HoldOptions::take_out(TargetFiles::Loaded& loaded) const {
  if (hold_.empty()) return {};
  const media::Matte held = media::read_matte(hold_, loaded.picture.size());
  for (const std::string& notice : held.notices) say(hold_ + ": " + notice);
  const double before = cv::sum(loaded.matte)[0];
  loaded.matte = synth::matte::less_held(loaded.matte, held.alpha, hold_);
  say(fmt::format("{}: {:.0f} % of the matte is held back", hold_,
                  100 * (1 - cv::sum(loaded.matte)[0] / before)));
  return held.alpha;
}

}  // namespace freshet::tools
