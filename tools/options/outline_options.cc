#include "tools/options/outline_options.h"

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "tools/console/run_context.h"

namespace freshet::tools {

void OutlineOptions::add_to(CLI::App& command) {
  command_ = &command;
  const std::string group = "Outline of the fluid", moving = " (with --boundary moving)";
  command
      .add_option("--boundary", kind_,
                  "static: the matte stands still; moving: the fluid carries it along, with softer rims")
      ->check(CLI::IsMember({"static", "moving"}))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--tau", matte_.tau,
                  "Fraction of the moved matte that is kept each 1/25 s, 0 to 1: with more the outline goes "
                  "further" +
                      moving)
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(in_detail(group));
  command
      .add_option("--background", background_,
                  "Picture of what lies behind the fluid, as large as the target; without it that is guessed "
                  "from around the matte" +
                      moving)
      ->group(group);
  command
      .add_option(
          "--inpaint", inpaint_,
          "How to guess it: navier-stokes, telea, shift-map (pieces of the picture, slow), fsr (slow) "
          "or outward (smooth)" +
              moving)
      ->check(CLI::IsMember({"navier-stokes", "telea", "shift-map", "fsr", "outward"}))
      ->capture_default_str()
      ->group(in_detail(group));
}

void OutlineOptions::check() const {
  if (kind_ == "moving") return;
  for (const char* name : {"--tau", "--background", "--inpaint"})
    if (command_->count(name) > 0)
      throw Error(ErrorKind::kUsage, name, "it belongs to a moving outline", "Add --boundary moving");
}

void OutlineOptions::apply(synth::animate::FrameOptions& options, cv::Size picture) const {
  check();
  if (kind_ == "static") return;
  options.outline.kind = synth::outline::Outline::kMoving;
  options.outline.matte = matte_;
  options.outline.inpaint.method = synth::outline::parse_inpaint_method(inpaint_);
  if (!background_.empty()) {
    const media::Still background = media::read_still(background_);
    for (const std::string& notice : background.notices) say(background_ + ": " + notice);
    if (background.bgr.size() != picture)
      throw Error(ErrorKind::kInput, background_,
                  fmt::format("a background of {} x {} px, and the target has {} x {}", background.bgr.cols,
                              background.bgr.rows, picture.width, picture.height),
                  "Scale or crop it to the target's size");
    options.outline.background = background.deep.empty() ? background.bgr : media::coded_picture(background);
  }
}

}  // namespace freshet::tools
