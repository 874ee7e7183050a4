// freshet synth transfer: a designed motion gets the look of an exemplar.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"
#include "media/video/picture_sink.h"
#include "media/video/video_writer.h"
#include "platform/stopwatch.h"
#include "platform/text.h"
#include "store/store.h"
#include "synth/transfer/files/composite.h"
#include "synth/transfer/files/design_files.h"
#include "synth/transfer/files/exemplar_files.h"
#include "synth/transfer/files/extent.h"
#include "synth/transfer/files/fine_drawing.h"
#include "synth/transfer/files/resume_folder.h"
#include "synth/transfer/transfer.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/options/as_printed.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
namespace transfer = synth::transfer;

constexpr int kDesignFramesSeen = 8;  // to fit the exemplar's size and body to
constexpr const char* kFrameName = "frame_%05d.png";

struct TransferCommand {
  std::string exemplar, store, ground = "none", blend;
  transfer::ExemplarOptions exemplar_options;
  std::optional<double> exemplar_scale;
  fs::path design, alpha, flow, out, background, composite;
  std::string at = "0,0";
  int frames = 0, bits = 8;
  double fps = 25;
  std::string uniformity = "on", initialise = "warped", search = "patchmatch", rotations = "1";
  transfer::TransferOptions options;
  bool restart = false, json = false;
  AsPrinted as_printed;
};

cv::Point parse_place(const std::string& text) {
  cv::Point at;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d,%d%c", &at.x, &at.y, &rest) != 2)
    throw Error(ErrorKind::kUsage, "--at " + text, "it is not X,Y in px", "For example --at 320,40");
  return at;
}

/// Where frames go: straight into a sequence that holds all 16 bits, or, for everything else, into the resume folder
/// until all are there.
class FrameFiles {
 public:
  FrameFiles(const TransferCommand& command, cv::Size size, int frames)
      : out_(command.out), bits_(command.bits) {
    const media::OutputFormat format = media::output_format(out_, frames);
    if (!format.alpha())
      throw Error(ErrorKind::kUsage, out_.string(),
                  "the ending \"" + lower_ending(out_) + "\" names no format with alpha",
                  "Use " + media::written_endings([](const media::FileFormat& each) { return each.alpha; }) +
                      "; --over and --composite make an .mp4");
    if (bits_ == 16 && format.samples() == media::Samples::k8)
      throw Error(ErrorKind::kUsage, "--bits 16", out_.string() + " holds 8 bits per channel",
                  "Use .png, .mkv or .mov");
    direct_ = keeps_frames(format);
    deep_ = bits_ == 16 || !format.holds(media::Depth::k8);
    // The frames of a run that was stopped are its own.
    if (!direct_ || !fs::exists(transfer::ResumeFolder::beside(out_))) check_frames_output(out_, frames);
    if (!direct_) media::PictureSink::check(out_, size, frames, command.fps);
  }
  /// Whether frames that were written are read again without loss.
  static bool keeps_frames(const media::OutputFormat& format) {
    return format.form() == media::OutputFormat::Form::kSequence && format.holds(media::Depth::k16);
  }
  /// The folder is known once the inputs have been read.
  void keep_in(const fs::path& folder) { kept_ = direct_ ? out_ : folder / kFrameName; }

  void write(int frame, const cv::Mat& bgra) const {
    cv::Mat picture;
    bgra.convertTo(picture, CV_16U, 65535);
    // By way of 16 bits, so that a sequence and a video have the same 8.
    if (direct_ && bits_ == 8) picture.convertTo(picture, CV_8U, 1.0 / 257);
    media::write_picture(media::numbered(kept_, frame), picture);
  }
  /// As written: 8 or 16 bits.
  cv::Mat read(int frame) const {
    cv::Mat picture = media::read_deep_picture(media::numbered(kept_, frame)).values;
    if (!deep_) picture.convertTo(picture, CV_8U, 1.0 / 257);
    return picture;
  }
  /// Throws Error{kInput} when one of the first so many is not there any more.
  void require(int frames) const {
    for (int i = 0; i < frames; ++i)
      if (const fs::path file = media::numbered(kept_, i); !fs::exists(file))
        throw Error(ErrorKind::kInput, file.string(), "this frame of the unfinished run is gone",
                    "Begin anew with --restart");
  }
  bool direct() const { return direct_; }

 private:
  fs::path out_, kept_;
  int bits_;
  bool direct_ = false, deep_ = false;
};

/// A background, where the animation lies on it, and where the two together go.
struct Composite {
  transfer::Background background;
  cv::Point at;
  fs::path out;
  media::Blend blend;

  /// The animation's next frame on it; light ends softly with its frame.
  cv::Mat of(const cv::Mat& picture) {
    const cv::Mat under = background.next();
    if (blend == media::Blend::kOver) return transfer::laid_on(picture, under, blend, at);
    return transfer::laid_on(transfer::ending_softly(picture, under.size(), at), under, blend, at);
  }
};

bool is_light(const TransferCommand& command) { return command.ground == "black"; }

media::Blend blend_of(const TransferCommand& command) {
  if (command.blend.empty()) return is_light(command) ? media::Blend::kScreen : media::Blend::kOver;
  return static_cast<media::Blend>(std::ranges::find(media::kBlends, command.blend) -
                                   std::begin(media::kBlends));
}

std::optional<Composite> open_composite(const TransferCommand& command, cv::Size size, int frames) {
  if (command.background.empty() != command.composite.empty())
    throw Error(ErrorKind::kUsage, command.composite.empty() ? "--over" : "--composite",
                command.composite.empty() ? "nothing says where the composite goes"
                                          : "nothing says what lies behind the animation",
                "Give both --over BACKGROUND and --composite FILE");
  if (command.background.empty()) return std::nullopt;
  Composite composite{.background = transfer::Background(command.background, frames),
                      .at = parse_place(command.at),
                      .out = command.composite,
                      .blend = blend_of(command)};
  if ((cv::Rect(composite.at, size) & cv::Rect({0, 0}, composite.background.size())).empty())
    throw Error(
        ErrorKind::kUsage, "--at " + command.at,
        fmt::format("the animation of {} x {} px lies beside the background of {} x {}", size.width,
                    size.height, composite.background.size().width, composite.background.size().height),
        "Give its top left corner in the background, px");
  check_frames_output(composite.out, frames);
  say_size(composite.out, composite.background.size());
  media::PictureSink::check(composite.out, composite.background.size(), frames, command.fps);
  return composite;
}

/// All that decides the result, by the names of the options.
nlohmann::json job_of(const TransferCommand& command, const transfer::DesignFiles& design,
                      const transfer::ExemplarFiles& exemplar) {
  const transfer::TransferOptions& options = command.options;
  return {{"freshet", FRESHET_VERSION},
          {"design", design.hash()},
          {"exemplar", exemplar.hash()},
          {"frames", design.frames()},
          {"output", media::is_pattern(command.out) ? command.out.filename().string() : "one file"},
          {"bits",
           FrameFiles::keeps_frames(media::output_format(command.out, design.frames())) ? command.bits : 16},
          {"patch", options.patch},
          {"lambda", options.lambda},
          {"eta", options.eta},
          {"curvature", options.curvature},
          {"divergence", options.divergence},
          {"blur-radius", options.radius},
          {"lower", options.lower},
          {"upper", options.upper},
          {"levels", options.levels},
          {"iterations", options.iterations},
          {"passes", options.passes},
          {"uniformity", command.uniformity},
          {"initialise", command.initialise},
          {"search", command.search},
          {"rotations", command.rotations},
          {"stabilise", options.stabilised},
          {"motion-blur", options.motion_blur},
          {"seed", options.seed}};
}

nlohmann::json note_of(const transfer::SegmentUse& use) {
  return {{"sources", use.sources},
          {"targets", use.targets},
          {"least", use.min_uses},
          {"remainder", use.remainder},
          {"uniform", use.uniform()}};
}

nlohmann::json note_of(const transfer::TransferredFrame& frame) {
  const transfer::TransferSeconds& s = frame.seconds;
  return {{"frame", frame.index},
          {"boundary", note_of(frame.boundary)},
          {"interior", note_of(frame.interior)},
          {"violations", frame.violations},
          {"mean_distance", frame.mean_distance},
          {"remarks", frame.remarks},
          {"seconds",
           {{"prepare", s.prepare},
            {"search", s.search},
            {"assign", s.assign},
            {"vote", s.vote},
            {"blur", s.blur}}}};
}

/// What holds of all frames.
nlohmann::json summary_of(const nlohmann::json& notes) {
  int uniform = 0;
  std::int64_t violations = 0;
  double distance = 0;
  nlohmann::json seconds = nlohmann::json::object();
  for (const nlohmann::json& note : notes) {
    uniform += note["boundary"]["uniform"].get<bool>() && note["interior"]["uniform"].get<bool>();
    violations += note["violations"].get<std::int64_t>();
    distance += note["mean_distance"].get<double>();
    for (const auto& [stage, value] : note["seconds"].items())
      seconds[stage] = seconds.value(stage, 0.0) + value.get<double>();
  }
  return {{"uniform_frames", uniform},
          {"violations", violations},
          {"mean_distance", distance / static_cast<double>(std::max<std::size_t>(1, notes.size()))},
          {"seconds", seconds}};
}

transfer::TransferOptions engine_options(const TransferCommand& command) {
  transfer::TransferOptions options = command.options;
  options.retrieval =
      command.uniformity == "off" ? transfer::Retrieval::kNearest : transfer::Retrieval::kUniform;
  if (command.uniformity == "off") options.vote_power = 0.6;  // as Kwatra et al. vote
  options.start = command.initialise == "random" ? transfer::Start::kRandom : transfer::Start::kWarped;
  options.search = command.search == "exact" ? transfer::Search::kExact : transfer::Search::kPatchMatch;
  options.quarter_turns = command.rotations == "4" ? 4 : 1;
  return options;
}

transfer::ExemplarFiles open_exemplar(const TransferCommand& command, int frames) {
  transfer::ExemplarOptions options = command.exemplar_options;
  options.ground = media::parse_ground(command.ground);
  options.patch = command.options.patch;
  options.radius = command.options.radius;
  options.lower = command.options.lower;
  options.frames = frames;
  options.motion = transfer::needs_motion(command.options);
  options.scale = command.exemplar_scale.value_or(1);
  if (command.store.empty()) return {command.exemplar, options};
  return {store::Store::open_read(command.store).snapshot(), command.exemplar, options};
}

/// Size and body of the look, as far as they are not given.
void fit(const TransferCommand& command, transfer::DesignFiles& design, transfer::ExemplarFiles& exemplar) {
  const transfer::Extent extent = transfer::mean_extent(design.frames(), kDesignFramesSeen, command.options,
                                                        [&](int i) { return design.read(i).alpha; });
  if (!command.exemplar_scale) exemplar.fit_scale(extent, command.options);
  exemplar.fit_body(extent, command.options);
  if (const double scale = exemplar.options().scale; !command.exemplar_scale && scale < 1)
    say(
        fmt::format("{}: it has {:.1f} times the design's fluid, and is used at {:.2f} of its size; "
                    "--exemplar-scale 1 keeps it",
                    command.exemplar, 1 / (scale * scale), scale));
}

void say_what_was_found(const TransferCommand& command, const transfer::DesignFiles& design,
                        const transfer::ExemplarFiles& exemplar) {
  for (const std::string& notice : exemplar.notices()) say(notice);
  if (exemplar.opaque())
    say(command.exemplar +
        ": it has no transparency and is taken to be opaque: its look has no boundary. Give a mask with "
        "--exemplar-alpha, or --ground black where it is light on black");
  transfer::check_outline(design, exemplar, command.alpha);
  if (const double share = static_cast<double>(design.size().area()) / exemplar.size().area(); share < 0.5)
    say(
        fmt::format("{}: the exemplar has {:.1f} times the design's pixels, of which only some can be seen; "
                    "--exemplar-scale {:.2f} shows it whole",
                    command.exemplar, 1 / share, exemplar.options().scale * std::sqrt(share)));
  if (design.empty_frames() > 0)
    say(fmt::format("{}: {} of {} masks are black everywhere; those frames are transparent",
                    command.alpha.string(), design.empty_frames(), design.frames()));
  if (const auto loop = exemplar.loop())
    say(fmt::format(
        "{}: {} frames for an animation of {}: looped from frame {} to {}, with a cross-fade of {}",
        command.exemplar, exemplar.frames(), design.frames(), loop->from, loop->to, loop->fade));
}

/// With the design's folder taken apart.
TransferCommand with_design(TransferCommand command) {
  if (!command.design.empty()) {
    if (command.alpha.empty()) command.alpha = command.design / "alpha";
    if (command.flow.empty()) command.flow = command.design / "flow";
  }
  if (command.alpha.empty() || command.flow.empty())
    throw Error(ErrorKind::kUsage, "synth transfer", "the design is missing",
                "Give --design FOLDER, or both --alpha-sequence and --flow-sequence");
  return command;
}

/// From the files that a command names to those that it asks for.
class TransferRun {
 public:
  TransferRun(const TransferCommand& command, RunContext& context)
      : command_(with_design(command)),
        context_(context),
        options_(checked(engine_options(command))),
        design_(command_.alpha, command_.flow, command_.frames),
        exemplar_(open_exemplar(command_, design_.frames())) {}

  void run() {
    check();
    const transfer::ResumeFolder kept(transfer::ResumeFolder::beside(command_.out),
                                      job_of(command_, design_, exemplar_), command_.restart);
    files_->keep_in(kept.path());
    make_frames(kept);
    assemble();
    progress_.finish();
    kept.remove();
    keeps_when_stopped({});
    print();
  }

 private:
  static transfer::TransferOptions checked(const transfer::TransferOptions& options) {
    transfer::check(options);
    return options;
  }

  /// All that can be refused, before the work begins.
  void check() {
    check(design_, "checking the design");
    files_.emplace(command_, design_.size(), design_.frames());
    if (auto opened = open_composite(command_, design_.size(), design_.frames()))
      composite_.emplace(std::move(*opened));
    fit(command_, design_, exemplar_);
    check(exemplar_, "checking the exemplar");
    transfer::check_guides(exemplar_, command_.options, command_.exemplar);
    progress_.finish();
    say_what_was_found(command_, design_, exemplar_);
  }
  template <class Files>
  void check(Files& files, const char* stage) {
    files.check([&](std::size_t done, std::size_t of) { progress_.show(stage, done, of, "frames"); },
                context_.stop);
  }

  /// From where an unfinished run was left.
  void make_frames(const transfer::ResumeFolder& kept) {
    transfer::Transfer engine([this](int t) { return exemplar_.at(t); }, options_);
    notes_ = kept.resume(engine);
    resumed_ = engine.frame();
    files_->require(resumed_);
    if (resumed_ > 0) say(fmt::format("{}: {} frames are there; going on", kept.path().string(), resumed_));
    remember_what_is_kept(kept, resumed_);
    std::set<std::string> said;
    for (int i = resumed_; i < design_.frames(); ++i) {
      const auto stop_or_show = [&](double = 0) { show("transfer", i); };
      stop_or_show();
      const transfer::TargetFrame target = design_.read(i);
      const transfer::TransferredFrame frame = engine.next(target, stop_or_show);
      for (const std::string& remark : frame.remarks)
        if (said.insert(remark).second) say(fmt::format("frame {}: {}", i, remark));
      const TimedScope writing(write_s_);
      files_->write(i, is_light(command_) ? light_of(frame, target) : frame.bgra);
      notes_.push_back(note_of(frame));
      kept.keep(engine, notes_);
      remember_what_is_kept(kept, i + 1);
    }
  }

  cv::Mat light_of(const transfer::TransferredFrame& frame, const transfer::TargetFrame& target) const {
    cv::Mat light = transfer::light_alone(frame.bgra);
    transfer::draw_light(transfer::fine_drawing(target, options_), light);
    return light;
  }

  /// What is one file of all frames: the animation, unless it is a sequence, and the composite.
  void assemble() {
    const int frames = design_.frames();
    std::optional<media::PictureSink> sink, composed;
    if (!files_->direct()) sink.emplace(command_.out, design_.size(), frames, command_.fps);
    if (composite_) composed.emplace(composite_->out, composite_->background.size(), frames, command_.fps);
    for (int i = 0; (sink || composed) && i < frames; ++i) {
      const cv::Mat picture = files_->read(i);
      if (sink) sink->write(picture);
      if (composed) composed->write(composite_->of(picture));
      show("writing", i + 1);
    }
    if (sink) sink->finish();
    if (composed) composed->finish();
  }

  void print() const {
    const nlohmann::json summary = summary_of(notes_);
    if (command_.json) {
      fmt::print("{}\n", report(summary).dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
      return;
    }
    const auto stage = [&](const char* name) { return summary["seconds"].value(name, 0.0); };
    say(
        fmt::format("{} frames of {} x {} in {:.1f} s (prepare {:.1f}, search {:.1f}, assign {:.1f}, vote "
                    "{:.1f}, blur {:.1f}); patches used uniformly in {} frames, {} violations",
                    design_.frames(), design_.size().width, design_.size().height, total_.seconds(),
                    stage("prepare"), stage("search"), stage("assign"), stage("vote"), stage("blur"),
                    summary["uniform_frames"].get<int>(), summary["violations"].get<std::int64_t>()));
    fmt::print("{}\n", command_.out.string());
    if (composite_) fmt::print("{}\n", composite_->out.string());
  }

  nlohmann::json report(nlohmann::json report) const {
    report["output"] = command_.out.string();
    if (composite_) report["composite"] = composite_->out.string();
    report["frames"] = design_.frames();
    report["width"] = design_.size().width;
    report["height"] = design_.size().height;
    report["resumed_frames"] = resumed_;
    report["exemplar"] = {{"frames", exemplar_.frames()},
                          {"width", exemplar_.size().width},
                          {"height", exemplar_.size().height},
                          {"opaque", exemplar_.opaque()}};
    if (const auto loop = exemplar_.loop())
      report["exemplar"]["loop"] = {{"from", loop->from}, {"to", loop->to}, {"fade", loop->fade}};
    report["seconds"]["write"] = write_s_;
    report["seconds"]["total"] = total_.seconds();
    report["by_frame"] = notes_;
    return report;
  }

  void show(const char* stage, int done) {
    if (context_.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "transfer", "stopped");
    progress_.show(stage, static_cast<std::size_t>(done), static_cast<std::size_t>(design_.frames()),
                   "frames");
  }
  void remember_what_is_kept(const transfer::ResumeFolder& kept, int frames) const {
    keeps_when_stopped(fmt::format("{} of {} frames are kept in {}; the same command goes on from there",
                                   frames, design_.frames(), kept.path().string()));
  }

  const Stopwatch total_;
  const TransferCommand command_;
  RunContext& context_;
  const transfer::TransferOptions options_;
  Progress progress_;
  transfer::DesignFiles design_;
  transfer::ExemplarFiles exemplar_;
  std::optional<FrameFiles> files_;
  std::optional<Composite> composite_;
  nlohmann::json notes_;  // of each frame
  int resumed_ = 0;
  double write_s_ = 0;
};

void add_inputs(CLI::App& sub, TransferCommand& command) {
  const std::string look = "Look", design = "Design", output = "Output";
  sub.add_option(
         "--exemplar", command.exemplar,
         "What the fluid shall look like: a picture with alpha, a folder or a pattern of such, a video, "
         "or, with --store, the name of a clip. Frame i of the animation looks like frame i; where the "
         "exemplar is shorter, it loops")
      ->required()
      ->group(look);
  sub.add_option("--store", command.store, "The store that holds the exemplar [none: it is a file]")
      ->group(look);
  sub.add_option("--exemplar-alpha", command.exemplar_options.alpha,
                 "Masks of the exemplar, white where the fluid is: one picture, or as many frames as it has "
                 "(folder, pattern, video) [its own alpha; without any it is opaque]")
      ->group(look);
  sub.add_option(
         "--ground", command.ground,
         "What the exemplar stands on, where it has no alpha: black (light, such as fire: for add and "
         "screen; its body is found, or given with --exemplar-alpha), white (dark on white: for "
         "over), or none")
      ->check(CLI::IsMember(media::ground_names()))
      ->capture_default_str()
      ->group(look);
  sub.add_option("--exemplar-scale", command.exemplar_scale,
                 "Size of the exemplar's structure in the animation, of its own: at 1 px stay px [smaller "
                 "than that where it has more fluid than the design, with an outline]")
      ->check(CLI::Range(0.05, 4.0))
      ->group(look);
  sub.add_flag("--stabilise", command.options.stabilised,
               "Take the exemplar's own motion out of it, so that the design alone moves its texture; for "
               "videos that move faster than the design, or another way. Textures become softer [off]")
      ->group(look);
  sub.add_option("--design", command.design,
                 "A folder that freshet synth simulate left: its alpha/ and flow/")
      ->group(design);
  sub.add_option(
         "--alpha-sequence", command.alpha,
         "Where the fluid is, frame by frame: grey pictures or their alpha (a folder, masks/%05d.png, "
         "masks.####.png), or a video")
      ->group(design);
  sub.add_option("--flow-sequence", command.flow,
                 "How it moves, px to the next frame: .flo (y down) or .exr (y up; channels forward.u and "
                 "forward.v, as "
                 "synth simulate writes them, or u and v, x and y), a folder or a pattern")
      ->group(design);
  sub.add_option("--frames", command.frames, "Only so many of the first frames [all]")
      ->check(CLI::Range(1, 1000000))
      ->group(design);
  sub.add_option(
         "-o,--output", command.out,
         "The animation with alpha: frames/%05d.png (or .tif), .mkv (FFV1, lossless), .mov (ProRes 4444), "
         ".webp or .apng, with colours straight, or frames/%05d.exr, premultiplied. A run that was stopped "
         "goes on where it was: it keeps a folder that "
         "ends in .resume beside the output")
      ->required()
      ->group(output);
  sub.add_option("--bits", command.bits,
                 "Bits per channel of .png, .tif and .mkv: 8 or 16; ProRes and EXR have their own")
      ->check(CLI::IsMember({8, 16}))
      ->capture_default_str()
      ->group(output);
  sub.add_option("--fps", command.fps, "Frames per second of a video")
      ->check(CLI::Range(1.0, 240.0))
      ->capture_default_str()
      ->group(output);
  sub.add_option("--over", command.background,
                 "Background of the composite: a picture, or as many frames (folder, pattern, video)")
      ->group(output);
  sub.add_option("--composite", command.composite,
                 "Also write the animation over the background (.mp4, .mkv, ...)")
      ->group(output);
  sub.add_option("--blend", command.blend,
                 "How it joins the background: over, or as light: add, screen [screen for --ground black, "
                 "else over]")
      ->check(CLI::IsMember(std::vector<std::string>{std::begin(media::kBlends), std::end(media::kBlends)}))
      ->group(output);
  sub.add_option("--at", command.at, "Where the animation's top left corner lies in the background, px")
      ->type_name("X,Y")
      ->capture_default_str()
      ->group(output);
  sub.add_flag("--restart", command.restart, "Discard an unfinished run and start again [off]")
      ->group(output);
}

}  // namespace

void add_transfer(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<TransferCommand>();
  CLI::App* sub = synth_command.add_subcommand(
      "transfer", "Give a designed motion the look of an exemplar (after Jamriska et al. 2015)");
  add_inputs(*sub, *command);
  transfer::TransferOptions& options = command->options;
  const std::string group = "Transfer";
  const auto number = [&](const char* name, auto& value, const char* text, auto minimum, auto maximum) {
    sub->add_option(name, value, text)
        ->check(CLI::Range(minimum, maximum))
        ->capture_default_str()
        ->group(group);
  };
  const auto choice = [&](const char* name, std::string& value, const char* text,
                          std::vector<std::string> values) {
    sub->add_option(name, value, text)->check(CLI::IsMember(values))->capture_default_str()->group(group);
  };
  number("--patch", options.patch, "Side of a patch, px, odd", 3, 9);
  number("--lambda", options.lambda, "Weight of temporal coherence, 0 to 1", 0.0, 1.0);
  number("--eta", options.eta, "Weight of the distance to the outline; less: more varied boundaries", 0.0,
         16.0);
  number("--curvature", options.curvature,
         "Weight of the outline's curvature: patches of tips go to tips, of hollows to hollows; 1 is strong; "
         "more speckles rims",
         0.0, 16.0);
  number("--divergence", options.divergence,
         "Weight of how the flow spreads: patches of a video's spreading fluid go where the design's "
         "spreads; 1 is strong; more speckles rims",
         0.0, 16.0);
  number("--blur-radius", options.radius, "Blur of the masks that finds the boundary, px", 0.5, 50.0);
  number("--lower", options.lower, "Blurred alpha above which a pixel is boundary, 0 to 1", 0.0, 1.0);
  number("--upper", options.upper, "Blurred alpha above which a pixel is interior, 0 to 1", 0.0, 1.0);
  number("--levels", options.levels, "Levels of the pyramid; 0: down to 24 px", 0, 10);
  number("--iterations", options.iterations,
         "Of retrieval and vote, per level; half as many at full size after the first frame", 1, 100);
  number("--passes", options.passes, "Of the search, per retrieval", 1, 100);
  number("--motion-blur", options.motion_blur, "Length of the blur along the motion, frames", 0.0, 4.0);
  choice("--rotations", command->rotations, "Quarter turns of the exemplar that are used: 1 (as it is) or 4",
         {"1", "4"});
  choice("--uniformity", command->uniformity,
         "on: every patch of the exemplar is used as often as every other; off: Kwatra et al. 2005, which "
         "washes out",
         {"on", "off"});
  choice("--initialise", command->initialise,
         "A frame begins from the one before, warped along the motion, or from random patches",
         {"warped", "random"});
  choice("--search", command->search,
         "patchmatch, or exact (every patch with every other; small pictures only)", {"patchmatch", "exact"});
  sub->add_option("--seed", options.seed, "Another seed, another animation of the same kind")
      ->capture_default_str()
      ->group(group);
  sub->add_flag("--json", command->json,
                "Print a report as JSON: uniformity, violations, distance and seconds by stage, by frame");
  add_overwrite(*sub);
  add_threads(*sub);
  command->as_printed.add_to(*sub, "Jamriska et al. 2015",
                             {{"--uniformity", "on", "Sec. 4.1"},
                              {"--search", "exact", "Sec. 4.1"},
                              {"--initialise", "warped", "Sec. 4.3"},
                              {"--rotations", "4", "Sec. 4.5"},
                              {"--exemplar-scale", "1", "Sec. 3"},
                              {"--stabilise", "false", "Sec. 4.3"},
                              {"--curvature", "0", "Eq. 9"},
                              {"--divergence", "0", "Eq. 9"},
                              {"--ground", "none", "Sec. 3"},
                              {"--patch", "5", "Sec. 5"},
                              {"--lambda", "0.2", "Sec. 5"},
                              {"--lower", "0.1", "Sec. 5"},
                              {"--upper", "0.9", "Sec. 5"}});
  sub->callback([command, &context] {
    command->as_printed.apply();
    TransferRun(*command, context).run();
  });
}

}  // namespace freshet::tools
