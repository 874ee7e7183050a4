#include "tools/options/output_options.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/picture/motion_file.h"
#include "media/picture/picture_sequence.h"
#include "platform/text.h"
#include "synth/outline/moving_outline.h"
#include "tools/console/run_context.h"

namespace freshet::tools {
namespace {

constexpr int kSocialSide = 1920;
constexpr const char* kGroup = "Output";

[[noreturn]] void refuse(const std::string& option, const std::string& fault, const std::string& remedy) {
  throw Error(ErrorKind::kUsage, option, fault, remedy);
}

std::string ending_of_preset(const std::string& preset) {
  return preset == "edit" ? ".mov" : preset == "archive" ? ".mkv" : ".mp4";
}

}  // namespace

void OutputOptions::add_frames_to(CLI::App& command) {
  command.add_option("-o,--output", out_,
                     "The animation: " + frames_endings() + " such as shot/f.%04d.exr or shot/f.####.png");
  command
      .add_option(
          "--depth", depth_,
          "Bits per channel: 8, 10 (.mp4, .mov), 16 (.png, .tif, .mkv), half or float (.exr: linear light); "
          "auto: the picture's, where the format holds them")
      ->check(CLI::IsMember({"auto", "8", "10", "16", "half", "float"}))
      ->capture_default_str()
      ->group(kGroup);
  command
      .add_option("--preset", preset_,
                  "By purpose: web (.mp4, small), social (.mp4, longest side 1920 px, to be coded again by "
                  "the site), "
                  "edit (.mov: ProRes 4444), archive (.mkv: FFV1, 16 bits) [none]")
      ->check(CLI::IsMember({"web", "social", "edit", "archive"}))
      ->group(kGroup);
  command.add_option("--start-number", first_number_, "Number of the first frame (film shots: 1001)")
      ->check(CLI::Range(0, 100000000))
      ->capture_default_str()
      ->group(kGroup);
  command
      .add_option("--range", range_,
                  "Write only these frames, by their numbers, the same as if all were written [all]")
      ->type_name("A-B")
      ->group(kGroup);
  add_overwrite(command);
}

void OutputOptions::add_to(CLI::App& command) {
  add_fluid_to(command, {"whole", "fluid", "light"},
               ", light (what a moving fluid adds to its background, on black: for add)");
  command
      .add_option(
          "--motion-out", motion_out_,
          "Also write the motion, px to the next frame: motion/%05d.flo (y down), or motion/%05d.exr (y up); "
          "may be given twice")
      ->group(kGroup);
}

void OutputOptions::add_fluid_to(CLI::App& command) { add_fluid_to(command, {"whole", "fluid"}, ""); }

void OutputOptions::add_fluid_to(CLI::App& command, const std::vector<std::string>& layers,
                                 const std::string& more) {
  add_frames_to(command);
  command.get_option("--output")->required();
  command
      .add_option("--width", width_,
                  "Width of what is written, px, its height in proportion: frames are made as large as the "
                  "picture, and reduced or enlarged then [the picture's]")
      ->check(CLI::Range(16, 16384))
      ->group(kGroup);
  command
      .add_option(
          "--layer", layer_,
          "whole (the picture with the fluid in it), fluid (the fluid alone with alpha, to lie over the "
          "picture)" +
              more)
      ->check(CLI::IsMember(layers))
      ->capture_default_str()
      ->group(kGroup);
  command
      .add_option(
          "--alpha", alpha_,
          "Colours of --layer fluid: straight, or premultiplied (times alpha) [.exr premultiplied, else "
          "straight]")
      ->check(CLI::IsMember({"straight", "premultiplied"}))
      ->group(kGroup);
  command
      .add_option("--matte-out", matte_out_,
                  "Also write every frame's matte, in grey: mattes/%05d.png, or a video")
      ->group(kGroup);
}

FrameNumbers OutputOptions::numbers(int frames) const {
  FrameNumbers all{.first = first_number_, .last = first_number_ + frames - 1, .from = 0, .to = 0};
  all.from = all.first;
  all.to = all.last;
  if (range_.empty()) return all;
  long long from = 0, to = 0;
  char rest = 0;
  const int read = std::sscanf(range_.c_str(), "%lld-%lld%c", &from, &to, &rest);
  if (read == 1 && range_.find('-') == std::string::npos) to = from;
  if (read != 2 && !(read == 1 && to == from))
    refuse("--range " + range_, "it is not A-B", "For example --range 1010-1020");
  if (from > to || from < all.first || to > all.last)
    refuse("--range " + range_, fmt::format("the frames are numbered {} to {}", all.first, all.last),
           "Name some of these, or say another --start-number or more --frames");
  all.from = from;
  all.to = to;
  return all;
}

void OutputOptions::add_ending() {
  out_ += preset_.empty() && layer_ == "fluid" ? ".webp" : ending_of_preset(preset_);
}

bool OutputOptions::plays_in_browsers() const {
  return media::output_format(out_).coding() == media::Coding::kH264 && file_options_.bits != 10;
}

cv::Size OutputOptions::apply_preset(cv::Size size) {
  if (preset_.empty()) return size;
  const std::string ending = ending_of_preset(preset_);
  if (lower_ending(out_) != ending)
    refuse("--preset " + preset_, fmt::format("it makes {} files, and {} is none", ending, out_),
           "Name the output so, or leave the preset out");
  if (preset_ == "web") file_options_.crf = 20;
  if (preset_ == "social") {
    file_options_.crf = 14;
    if (const int longest = std::max(size.width, size.height); width_ == 0 && longest > kSocialSide) {
      const double by = static_cast<double>(kSocialSide) / longest;
      const cv::Size smaller(2 * cvRound(size.width * by / 2), 2 * cvRound(size.height * by / 2));
      say(fmt::format("{}: reduced from {} x {} to {} x {} px for --preset social", out_, size.width,
                      size.height, smaller.width, smaller.height));
      size = smaller;
    }
  }
  if (preset_ == "archive" && depth_ == "auto") depth_ = "16";
  return size;
}

media::Samples OutputOptions::choose_samples(const media::OutputFormat& format, bool deep) {
  using media::Depth;
  if (depth_ == "auto") {
    // ProRes has more than 8 bits, and 16 of alpha: for what is blended they are not wasted.
    const bool keeps = deep || format.light() || !format.holds(Depth::k8);
    return keeps ? format.samples() : media::Samples::k8;
  }
  const Depth depth = *std::ranges::find(media::kDepths, depth_, [](Depth each) { return to_string(each); });
  if (!format.holds(depth))
    refuse("--depth " + depth_, fmt::format("{} does not hold it: {}", out_, format.depths_text()),
           "Leave --depth out, or use " +
               media::written_endings([&](const media::FileFormat& each) { return each.depths.has(depth); }));
  if (format.light()) {
    file_options_.exr = depth == Depth::kFloat ? media::ExrSamples::kFloat : media::ExrSamples::kHalf;
    return media::Samples::kLight;
  }
  if (depth == Depth::k10) file_options_.bits = 10;
  if (depth == Depth::k10 && format.coding() == media::Coding::kH264)
    say(out_ + ": H.264 of 10 bits, which browsers and most phones do not show");
  return depth == Depth::k8 ? media::Samples::k8 : media::Samples::k16;
}

std::unique_ptr<AnimationFiles> OutputOptions::open(const TargetFiles::Loaded& loaded,
                                                    synth::animate::FrameOptions& options) {
  if (out_.empty()) throw CLI::RequiredError("--output");
  auto files = std::make_unique<AnimationFiles>();
  const FrameNumbers numbered = numbers(options.frames);
  const int count = static_cast<int>(numbered.to - numbered.from + 1);
  const media::OutputFormat format = media::output_format(out_, count);
  cv::Size size = apply_preset(loaded.picture.size());
  if (width_ > 0) {
    const double by = static_cast<double>(width_) / loaded.picture.cols;
    size = {width_, std::max(1, cvRound(by * loaded.picture.rows))};
    if (!motion_out_.empty())
      refuse("--motion-out", "it is in px of the picture, and --width asks for another size",
             "Leave one of them out");
  }
  const bool deep = !loaded.still.deep.empty();
  const media::Samples samples = choose_samples(format, deep);
  const bool moving = options.moving();
  if (layer_ == "fluid" && !format.alpha())
    refuse("--layer fluid", out_ + " holds no alpha", "Use .mov, .webp, or a sequence of .exr or .png");
  if (layer_ == "light" && !moving)
    refuse("--layer light", "only a fluid with a moving outline has a background that it adds to",
           "Add --boundary moving, or ask for --layer fluid");
  if (!alpha_.empty() && layer_ != "fluid")
    refuse("--alpha", "the whole picture has none", "Add --layer fluid");
  const media::AlphaForm alpha = alpha_ == "premultiplied" || (alpha_.empty() && format.light())
                                     ? media::AlphaForm::kPremultiplied
                                     : media::AlphaForm::kStraight;
  for (const std::string& pattern : motion_out_)
    if (!media::is_pattern(pattern) || !media::looks_like_motion(pattern))
      refuse("--motion-out " + pattern, "it is no numbered sequence of .flo or .exr",
             "For example --motion-out motion/%05d.exr");

  check_frames_output(out_, numbered);
  check_frames_output(matte_out_, numbered);
  for (const std::string& pattern : motion_out_) check_frames_output(pattern, numbered);
  say_size(out_, size);
  file_options_.first_number = numbered.from;
  files->numbers_ = numbered;
  files->frame_ = files->matte_frame_ = files->motion_frame_ = numbered.first;
  files->size_ = size;
  files->colours_ =
      alpha == media::AlphaForm::kStraight ? media::Colours::kStraight : media::Colours::kPremultiplied;
  files->motion_out_ = motion_out_;
  files->sink_.emplace(out_, size, count, options.fps, file_options_);
  if (!matte_out_.empty()) {
    media::VideoWriterOptions mattes;
    mattes.first_number = numbered.from;
    files->matte_size_ = width_ > 0 ? size : loaded.picture.size();
    files->matte_sink_.emplace(matte_out_, files->matte_size_, count, options.fps, mattes);
    options.matte_sink = [to = files.get()](const cv::Mat& matte) { to->write_matte(matte); };
  }
  if (!motion_out_.empty())
    options.motion_sink = [to = files.get()](const cv::Mat& motion) { to->write_motion(motion); };

  options.from = static_cast<int>(numbered.from - numbered.first);
  options.until = static_cast<int>(numbered.to - numbered.first + 1);
  files->picture_ = loaded.picture;
  if (layer_ == "whole" && samples == media::Samples::k8 && !deep) return files;
  files->picture_ = media::coded_picture(loaded.still);
  options.form = synth::animate::FrameForm::kFluid;
  const cv::Mat below =
      moving ? synth::outline::behind_fluid(files->picture_, loaded.matte, options.outline) : files->picture_;
  const media::Layer layer = layer_ == "fluid"   ? media::Layer::kFluid
                             : layer_ == "light" ? media::Layer::kLight
                                                 : media::Layer::kWhole;
  files->layers_.emplace(below, deep ? loaded.still.deep : loaded.picture, loaded.matte, layer, alpha,
                         samples);
  return files;
}

std::vector<std::string> OutputOptions::files() const {
  std::vector<std::string> files{out_, matte_out_};
  files.insert(files.end(), motion_out_.begin(), motion_out_.end());
  std::erase(files, "");
  return files;
}

cv::Mat AnimationFiles::write(const cv::Mat& frame) {
  if (wanted(frame_++)) {
    sink_->write(media::resized(layers_ ? layers_->frame(frame) : frame, size_, colours_));
  }
  return layers_ ? layers_->shown(frame) : frame;
}

void AnimationFiles::write_matte(const cv::Mat& matte) {
  if (!wanted(matte_frame_++)) return;
  cv::Mat grey, colour;
  matte.convertTo(grey, CV_8U, 255);
  cv::merge(std::vector<cv::Mat>(3, grey), colour);
  matte_sink_->write(media::resized(colour, matte_size_));
}

void AnimationFiles::write_motion(const cv::Mat& motion) {
  const std::int64_t number = motion_frame_++;
  for (const std::string& pattern : motion_out_)
    if (wanted(number)) media::write_motion(media::numbered(pattern, number), motion);
}

void AnimationFiles::finish() {
  sink_->finish();
  if (matte_sink_) matte_sink_->finish();
}

}  // namespace freshet::tools
