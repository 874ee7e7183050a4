#include "tools/options/outline_options.h"

#include <vector>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "tools/console/output_names.h"
#include "tools/console/run_context.h"

namespace freshet::tools {

void OutlineOptions::add_to(CLI::App& command) {
  command_ = &command;
  const std::string group = "Outline of the fluid", moving = " (with --boundary moving)";
  command
      .add_option("--boundary", kind_,
                  "static: the matte stands still; moving: the fluid carries it along, for fire and smoke")
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
      ->group(group);
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
      ->group(group);
  command
      .add_option("--matte-out", matte_out_,
                  "Also write every frame's matte, in grey: mattes/%05d.png, or a video" + moving)
      ->group(group);
}

void OutlineOptions::check() const {
  if (kind_ == "moving") return;
  for (const char* name : {"--tau", "--background", "--inpaint", "--matte-out"})
    if (command_->count(name) > 0)
      throw Error(ErrorKind::kUsage, name, "it belongs to a moving outline", "Add --boundary moving");
}

void OutlineOptions::apply(synth::animate::AnimateOptions& options, cv::Size picture) {
  check();
  if (kind_ == "static") return;
  options.boundary.boundary = synth::animate::Boundary::kMoving;
  options.boundary.matte = matte_;
  options.boundary.inpaint.method = synth::animate::parse_inpaint_method(inpaint_);
  if (!background_.empty()) {
    const media::Picture background = media::read_picture(background_);
    for (const std::string& notice : background.notices) say(background_ + ": " + notice);
    if (background.bgr.size() != picture)
      throw Error(ErrorKind::kInput, background_,
                  fmt::format("a background of {} x {} px, and the target has {} x {}", background.bgr.cols,
                              background.bgr.rows, picture.width, picture.height),
                  "Scale or crop it to the target's size");
    options.boundary.background = background.bgr;
  }
  if (matte_out_.empty()) return;
  check_frames_output(matte_out_, options.frames);
  sink_ = std::make_unique<media::PictureSink>(matte_out_, picture, options.frames, options.fps);
  options.matte_sink = [sink = sink_.get(), grey = cv::Mat(),
                        colour = cv::Mat()](const cv::Mat& matte) mutable {
    matte.convertTo(grey, CV_8U, 255);
    cv::merge(std::vector<cv::Mat>(3, grey), colour);
    sink->write(colour);
  };
}

void OutlineOptions::finish() {
  if (sink_) sink_->finish();
}

}  // namespace freshet::tools
