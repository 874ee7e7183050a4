// freshet synth sweep: one picture animated with all combinations of some of animate's options.

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "media/video/picture_sink.h"
#include "platform/stopwatch.h"
#include "platform/whole_file.h"
#include "query/labelling/shares.h"
#include "report/sheet_words.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/judging/verdict_report.h"
#include "tools/synth/animate_command.h"
#include "tools/synth/sweep_page.h"
#include "tools/synth/sweep_point.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

struct SweepCommand {
  AnimateCommand shared;  // by all points
  const CLI::App* given = nullptr;
  std::vector<std::string> axes;
  std::string folder;
  bool json = false;
};

std::vector<SweepAxis> parse_axes(const std::vector<std::string>& texts) {
  CLI::App known;
  AnimateCommand options;
  add_varied_to(known, options);
  std::vector<SweepAxis> axes;
  for (const std::string& text : texts) axes.push_back(parse_axis(text, known));
  return axes;
}

/// Bytes of a picture or map, whatever of it there is.
void add(cache::KeyHash& hash, const cv::Mat& values) {
  for (const int value : {values.rows, values.cols, values.type()}) hash.add(value);
  for (int y = 0; y < values.rows; ++y)
    hash.bytes({reinterpret_cast<const std::byte*>(values.ptr(y)),
                static_cast<std::size_t>(values.cols) * values.elemSize()});
}

/// Of what an animation is rendered from, but for its patches.
cache::Key key_of(const SweepPoint& point, const AnimateInputs& inputs) {
  cache::KeyHash hash;
  for (const std::string& word : point.rendering_words()) hash.add(word);
  for (const cv::Mat& map :
       {inputs.loaded.picture, inputs.loaded.still.deep, inputs.loaded.matte, inputs.options.outline.held,
        inputs.asked.guide.direction, inputs.asked.guide.speed})
    add(hash, map);
  return hash.key();
}

/// Of pieces, how many show another patch than the first's do; negative where the pieces are others.
double fraction_unlike(const query::Assignment& one, const query::Assignment& first) {
  if (one.pieces.size() != first.pieces.size() || one.piece_scale != first.piece_scale) return -1;
  std::size_t unlike = 0;
  for (std::size_t i = 0; i < one.pieces.size(); ++i) {
    const query::AssignedPiece &a = one.pieces[i], &b = first.pieces[i];
    if (a.corner != b.corner) return -1;
    unlike += one.clips[a.clip].source_hash != first.clips[b.clip].source_hash || a.variant != b.variant ||
              a.patch != b.patch;
  }
  return static_cast<double>(unlike) / static_cast<double>(one.pieces.size());
}

/// Mean over the fluid and its colours, levels of 255.
double mean_difference(const cv::Mat& one, const cv::Mat& other, const cv::Mat& matte) {
  cv::Mat difference;
  cv::absdiff(one, other, difference);
  const cv::Scalar mean = cv::mean(difference, matte);
  return (mean[0] + mean[1] + mean[2]) / 3;
}

/// All points, one after another, with what they share.
class Sweep {
 public:
  Sweep(SweepCommand& command, std::vector<SweepPoint> points, const RunContext& context)
      : command_(command),
        context_(context),
        snapshot_(command.shared.target.open_store(context)),
        points_(std::move(points)) {}

  /// What is wrong with any point is said before the first is made.
  void check() {
    for (SweepPoint& point : points_) {
      AnimateInputs inputs = read_inputs(point.command());
      point.command().output.open(inputs.loaded, inputs.options, inputs.motion_sink());
      if (still_.empty()) still_ = inputs.loaded.picture;
      region_ |= report::shown_region(inputs.loaded.matte);
    }
  }

  void run() {
    // What labellings share lies in a cache, for the time of the sweep where nobody asks for a longer one.
    const fs::path own = fs::path(command_.folder) / ".labels";
    std::unique_ptr<cache::ResultCache> cache = command_.shared.cache.open();
    const bool for_now = cache == nullptr;
    if (for_now) cache = std::make_unique<cache::ResultCache>(own);
    const auto forget = [&] {
      cache.reset();
      std::error_code fault;
      if (for_now) fs::remove_all(own, fault);
    };
    try {
      for (std::size_t i = 0; i < points_.size(); ++i) make(i, *cache);
    } catch (...) {
      forget();
      throw;
    }
    forget();
  }

  const std::vector<SweptAnimation>& animations() const { return animations_; }
  const SweepPoint& point(std::size_t i) const { return points_[i]; }
  const cv::Mat& still() const { return still_; }
  const cv::Rect& region() const { return region_; }
  int frame() const { return frame_; }

 private:
  struct Made {
    query::Assignment assignment;
    cache::Key key;
  };

  std::shared_ptr<const query::SearchBase> base_of(const SearchOptions& search) {
    search.check(snapshot_);
    const query::IndexChoice index = search.index();
    auto& base = bases_[{index.flann ? static_cast<int>(*index.flann) : -1, index.flann_options.checks}];
    if (base == nullptr) base = open_with_progress(snapshot_, search, true);
    return base;
  }

  void make(std::size_t i, cache::ResultCache& cache) {
    SweepPoint& point = points_[i];
    say(fmt::format("animation {} of {}: {}", i + 1, points_.size(), point.title()));
    plan_stages(point.command().stages());
    AnimateInputs inputs = read_inputs(point.command());
    ChosenPatches chosen = choose_patches(
        point.command(), snapshot_, inputs.loaded, inputs.asked,
        [this](const SearchOptions& search) { return base_of(search); }, &cache, context_);
    made_.push_back({std::move(chosen.assignment), key_of(point, inputs)});
    pace_it(snapshot_, inputs, made_.back().assignment,
            kind_of(point.command().search.options().class_name, made_.back().assignment).name);
    const query::Assignment& assignment = made_.back().assignment;
    SweptAnimation& animation = animations_.emplace_back();
    animation.number = fmt::format("{:02}", i + 1);
    animation.title = point.title();
    animation.command = point.command_line();
    animation.energy = assignment.energy;
    animation.gap = assignment.gap();
    animation.clips = assignment.clips.size();
    animation.changed = fraction_unlike(assignment, made_.front().assignment);
    const auto twin = std::find_if(made_.begin(), made_.end() - 1, [&](const Made& before) {
      return before.key == made_.back().key && before.assignment.pieces == assignment.pieces &&
             before.assignment.clips == assignment.clips;
    });
    animation.assignment = animation.number + ".json";
    query::write_assignment(fs::path(command_.folder) / animation.assignment, assignment);
    if (twin != made_.end() - 1)
      take_from(static_cast<std::size_t>(twin - made_.begin()), animation);
    else
      render_point(point, inputs, animation);
    animation.result = result_of(animation);
    say("  " + animation.result);
  }

  void take_from(std::size_t other, SweptAnimation& animation) const {
    const SweptAnimation& of = animations_[other];
    animation.same_as = of.same_as >= 0 ? of.same_as : static_cast<int>(other);
    animation.file = of.file;
    animation.video = of.video;
    animation.difference = of.difference;
  }

  void render_point(SweepPoint& point, AnimateInputs& inputs, SweptAnimation& animation) {
    OutputOptions& names = point.command().output;
    const std::unique_ptr<AnimationFiles> output =
        names.open(inputs.loaded, inputs.options, inputs.motion_sink());
    const synth::animate::AnimateOptions& options = inputs.options;
    const fs::path file = names.name();
    animation.file = file.filename().string();
    animation.video = names.plays_in_browsers() ? animation.file : animation.number + "_page.mp4";
    std::optional<media::PictureSink> page;
    if (animation.video != animation.file)
      page.emplace(file.parent_path() / animation.video, inputs.loaded.picture.size(),
                   options.until - options.from, options.fps);
    output->skip_to_range();
    if (animations_.size() == 1) frame_ = (options.from + options.until) / 2;
    const int kept = std::clamp(frame_, options.from, options.until - 1);
    int at = options.from;
    Progress progress;
    render(
        snapshot_, inputs, stage(snapshot_, inputs, made_.back().assignment), output->picture(),
        [&](const cv::Mat& frame) {
          const cv::Mat shown = output->write(frame);
          if (page) page->write(shown);
          if (at++ == kept) animation.frame = shown.clone();
        },
        progress.callback(), context_);
    output->finish();
    if (page) page->finish();
    progress.finish();
    // Options may be without effect: what came out tells.
    for (std::size_t i = 0; i + 1 < animations_.size(); ++i)
      if (animations_[i].same_as < 0 && same_bytes(file, file.parent_path() / animations_[i].file)) {
        fs::remove(file);
        if (page) fs::remove(file.parent_path() / animation.video);
        animation.frame.release();
        return take_from(i, animation);
      }
    animation.difference = mean_difference(animation.frame, animations_.front().frame, inputs.loaded.matte);
  }

  std::string result_of(const SweptAnimation& animation) const {
    if (animation.same_as >= 0)
      return "the same frames as " + animations_[static_cast<std::size_t>(animation.same_as)].number;
    const query::Assignment& assignment = made_.back().assignment;
    std::string text = fmt::format("patches of {} clips, most of {} ({:.0f} %)", animation.clips,
                                   assignment.clips[query::largest_shares(assignment).most_used].name,
                                   100 * query::largest_shares(assignment).clip);
    if (animations_.size() == 1) return text;
    text += animation.changed < 0    ? "; other pieces than in 01"
            : animation.changed == 0 ? "; the same patches as in 01"
                                     : fmt::format("; {:.0f} % of the pieces show other patches than in 01",
                                                   100 * animation.changed);
    return text + fmt::format("; differs from it by {:.1f} of 255 levels", animation.difference);
  }

  SweepCommand& command_;
  const RunContext& context_;
  const store::Snapshot snapshot_;
  std::vector<SweepPoint> points_;
  std::map<std::pair<int, int>, std::shared_ptr<const query::SearchBase>> bases_;  // by index and checks
  std::vector<Made> made_;
  std::vector<SweptAnimation> animations_;
  cv::Mat still_;
  cv::Rect region_;
  int frame_ = 0;
};

nlohmann::json report_of(const Sweep& sweep, double seconds) {
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t i = 0; i < sweep.animations().size(); ++i) {
    const SweptAnimation& animation = sweep.animations()[i];
    nlohmann::json settings;
    for (const auto& [name, value] : sweep.point(i).settings()) settings[name] = value;
    list.push_back({{"settings", settings},
                    {"result", animation.result},
                    {"energy", animation.energy},
                    {"gap_reached", animation.gap <= query::kGapAimed},
                    {"clips", animation.clips},
                    {"file", animation.file},
                    {"video", animation.video},
                    {"assignment", animation.assignment},
                    {"command", animation.command}});
    if (std::isfinite(animation.gap)) list.back()["gap"] = animation.gap;
    if (animation.changed >= 0) list.back()["changed"] = animation.changed;
    if (animation.difference >= 0) list.back()["difference"] = animation.difference;
    if (animation.same_as >= 0)
      list.back()["same_as"] = sweep.animations()[static_cast<std::size_t>(animation.same_as)].number;
  }
  return {{"animations", list}, {"seconds", seconds}};
}

void run_sweep(SweepCommand& command, const RunContext& context) {
  Stopwatch watch;
  const std::vector<SweepAxis> axes = parse_axes(command.axes);
  Sweep sweep(command, make_points(axes, *command.given, command.folder), context);
  check_folder_output(command.folder);
  {
    const SayOnce once;
    sweep.check();
    sweep.run();
  }
  const fs::path folder = command.folder;
  SweepWords words{.title = "Sweep of " + command.shared.target.picture.filename().string(),
                   .axes = {},
                   .still = "still.png",
                   .size = sweep.still().size(),
                   .region = sweep.region(),
                   .fps = command.shared.duration.fps,
                   .frame = sweep.frame()};
  for (const SweepAxis& axis : axes)
    words.axes.push_back(
        fmt::format("{} ({}): {}.", axis.name, fmt::join(axis.values, ", "), axis.description));
  media::write_picture(folder / words.still, sweep.still());
  media::write_picture(folder / "sheet.png", sweep_sheet(words, sweep.still(), sweep.animations()));
  write_whole_file(folder / "index.html", sweep_page(words, sweep.animations()));
  const std::string report =
      report_of(sweep, watch.seconds()).dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
  write_whole_file(folder / "sweep.json", report + "\n");
  if (command.json) {
    fmt::print("{}\n", report);
    return;
  }
  for (const SweptAnimation& animation : sweep.animations())
    fmt::print("{}  {}: {}\n", animation.number, animation.title, animation.result);
  fmt::print("{}\n{}\n", (folder / "sheet.png").string(), (folder / "index.html").string());
}

}  // namespace

void add_sweep(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<SweepCommand>();
  CLI::App* sub = synth_command.add_subcommand(
      "sweep", "Animate a still picture with all combinations of some of animate's options, side by side");
  add_varied_to(*sub, command->shared);
  sub->add_option("--vary", command->axes,
                  "An option of freshet synth animate and its values: speed=0.5,1,2; strokes=a.svg,b.svg; "
                  "exclude=-,a.mp4,a.mp4+b.mp4 (-: without it). May be given several times: all combinations "
                  "are made, " +
                      std::to_string(kMaxPoints) + " at most")
      ->required()
      ->allow_extra_args(false)
      ->type_name("OPTION=VALUES");
  sub->add_option("-o,--output", command->folder,
                  "Folder for index.html, sheet.png, sweep.json, and an animation and an assignment for each "
                  "combination; made when it is not there")
      ->required()
      ->type_name("DIR");
  sub->add_flag("--json", command->json, "Print the result as JSON");
  command->given = sub;
  sub->callback([command, &context] { run_sweep(*command, context); });
}

}  // namespace freshet::tools
