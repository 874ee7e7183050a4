#include "tools/options/play_options.h"

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "tools/console/run_context.h"

namespace freshet::tools {

void PlayOptions::add_to(CLI::App& command) {
  const std::string group = "Time";
  command
      .add_flag("--loop", loop_,
                "An animation without an end: the last frame runs into the first with no seam [off]")
      ->group(group);
  command
      .add_option_function<std::string>(
          "--speed",
          [this](const std::string& given) {
            const bool number = CLI::detail::lexical_cast(given, speed_);
            pace_ = number ? "" : given;
            if (!number) speed_ = 1;
          },
          "How fast everything plays: 1 as filmed, 0.5 slow motion, 2 twice as fast; slow, natural, fast: as "
          "the "
          "kind of fluid goes at the picture's size; auto: half-way from as filmed to natural, or as filmed "
          "where speeds are asked or the class is none of water, fire, smoke and clouds")
      ->check(CLI::IsMember({"auto", "slow", "natural", "fast"}) | CLI::Range(0.05, 20.0))
      ->default_str("auto")
      ->group(group);
  command
      .add_option("--retiming-map", map_,
                  "Grey picture of the same size, times --speed: black 0.5, mid-grey (128) 1, white 2 [none]")
      ->group(group);
  command
      .add_option("--memory", memory_mb_,
                  "MB that frames in the making may take; more of them are made in batches, the same to the "
                  "bit. Large pictures need more by themselves (2.3 GB at 3840 x 2160)")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
}

void PlayOptions::apply(synth::animate::FrameOptions& options) const {
  if (loop_ && options.frames < 2)
    throw Error(ErrorKind::kUsage, "--loop", "one frame is no animation to go round",
                "Ask for 2 --frames or more");
  options.loop = loop_;
  options.memory_bytes = static_cast<std::size_t>(memory_mb_) << 20;
}

synth::animate::Playing PlayOptions::read(cv::Size picture) const {
  synth::animate::Playing playing{.factor = speed_};
  if (!map_.empty()) {
    const media::Picture read = media::read_picture(map_);
    for (const std::string& notice : read.notices) say(map_.string() + ": " + notice);
    if (read.bgr.size() != picture)
      throw Error(ErrorKind::kInput, map_.string(),
                  fmt::format("it has {} x {} px, the picture {} x {}", read.bgr.cols, read.bgr.rows,
                              picture.width, picture.height),
                  "Give a map of the picture's size");
    playing.map = read.bgr;
  }
  return playing;
}

}  // namespace freshet::tools
