#include "tools/options/hold_options.h"

#include <fmt/format.h>

#include "media/picture/picture.h"
#include "synth/matte/held.h"
#include "tools/console/run_context.h"
#include "vision/look/standing.h"

namespace freshet::tools {

void HoldOptions::add_to(CLI::App& command) {
  command.add_option(
      "--hold", hold_,
      "Picture, white where something stands in front of the fluid or in it: it keeps still; or auto: what "
      "looks as if it stood, rims of the matte, round things and the picture's own frame [none]");
}

cv::Mat HoldOptions::take_out(TargetFiles::Loaded& loaded) const {
  if (hold_.empty()) return {};
  const bool guessed = hold_ == "auto";
  const std::string where = guessed ? "--hold auto" : hold_;
  cv::Mat held;
  if (guessed) {
    held = vision::what_stands(loaded.picture, loaded.matte);
    if (cv::countNonZero(held) == 0) {
      say(where + ": nothing in the matte looks as if it stood");
      return {};
    }
  } else {
    const media::Matte read = media::read_matte(hold_, loaded.picture.size());
    for (const std::string& notice : read.notices) say(where + ": " + notice);
    held = read.alpha;
  }
  const double before = cv::sum(loaded.matte)[0];
  loaded.whole_matte = loaded.matte;
  loaded.matte = synth::matte::less_held(loaded.matte, held, where);
  say(fmt::format("{}: {:.0f} % of the matte is held back{}", where,
                  100 * (1 - cv::sum(loaded.matte)[0] / before),
                  guessed ? ", which is a guess: give a picture of what stands, or leave --hold out" : ""));
  return held;
}

}  // namespace freshet::tools
