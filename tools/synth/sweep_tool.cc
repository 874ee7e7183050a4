// freshet synth sweep: one picture animated with all combinations of some of animate's options.

#include <algorithm>
#include <cmath>
#include <functional>
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
#include "platform/text_file.h"
#include "platform/whole_file.h"
#include "query/labelling/shares.h"
#include "report/sheet_words.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/unfinished_folder.h"
#include "tools/judging/verdict_report.h"
#include "tools/options/shard_option.h"
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
  ShardOption shard;
  bool gather = false, json = false;
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

/// Of all that a point's part depends on, but for what the store holds.
cache::Key key_of_part(const SweepPoint& point, const AnimateInputs& inputs) {
  cache::KeyHash hash;
  hash.add(cache::hex(key_of(point, inputs)));
  for (const std::string& word : point.words())
    if (!word.starts_with("--threads=") && !word.starts_with("--cache")) hash.add(word);
  return hash.key();
}

constexpr const char* kReport = "sweep.json";
constexpr const char* kSheet = "sheet.png";
constexpr const char* kPage = "index.html";
constexpr const char* kStill = "still.png";

/// What is reported of a sweep that lies in its folder with all its files; nothing where it is another's, or a file is
/// missing. The report is written last.
std::optional<nlohmann::json> whole_report(const fs::path& folder, std::vector<SweepPoint> points) {
  constexpr std::size_t kMaxBytes = 4 << 20;
  const auto is_there = [&](const nlohmann::json& name) {
    std::error_code fault;
    return name.is_string() && fs::is_regular_file(folder / name.get<std::string>(), fault) &&
           fs::file_size(folder / name.get<std::string>(), fault) > 0;
  };
  for (const char* name : {kReport, kSheet, kPage, kStill})
    if (!is_there(name)) return std::nullopt;
  nlohmann::json report =
      nlohmann::json::parse(read_text_file(folder / kReport, kMaxBytes, "Remove it"), nullptr, false);
  if (!report.is_object() || !report["animations"].is_array() || report["animations"].size() != points.size())
    return std::nullopt;
  for (std::size_t i = 0; i < points.size(); ++i) {
    nlohmann::json& one = report["animations"][i];
    if (!one.is_object() || !one["result"].is_string()) return std::nullopt;
    for (const char* file : {"file", "video", "assignment"})
      if (!is_there(one[file])) return std::nullopt;
    if (one["key"] != cache::hex(key_of_part(points[i], read_inputs(points[i].command()))))
      return std::nullopt;
  }
  return report;
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

/// One animation of a sweep that several runs share, in a folder of its own, which has its name when all in it is
/// written: NN.mp4, NN_page.mp4 where the page plays another file, NN.json, and what is shown of it.
class Part {
 public:
  Part(const fs::path& sweep, std::size_t point)
      : folder_(sweep / kParts / number_of(point)), name_(number_of(point)) {}
  static constexpr const char* kParts = "parts";
  static constexpr const char* kManifest = "part.json";

  const fs::path& folder() const { return folder_; }
  fs::path assignment() const { return folder_ / (name_ + ".json"); }
  std::string page_video() const { return name_ + "_page.mp4"; }
  cv::Mat frame() const { return media::read_picture(folder_ / kFrame).bgr; }
  int frame_number() const { return manifest()["frame"].get<int>(); }

  /// Throws Error{kUsage} where it is there and another sweep's.
  bool is_made(const cache::Key& key) const {
    if (!fs::exists(folder_)) return false;
    if (manifest()["key"] == cache::hex(key)) return true;
    throw Error(ErrorKind::kUsage, folder_.string(), "was made by another command",
                "Name a new folder, or remove that one");
  }

  /// making   a folder beside it with the animation's files, which takes its name.
  static void seal(const fs::path& making, const Part& part, const cache::Key& key,
                   const query::Assignment& assignment, const cv::Mat& frame, int number) {
    query::write_assignment(making / part.assignment().filename(), assignment);
    media::write_picture(making / kFrame, frame);
    write_whole_file(making / kManifest,
                     nlohmann::json{{"key", cache::hex(key)}, {"frame", number}}.dump() + "\n");
    std::error_code fault;
    fs::rename(making, part.folder_, fault);
    if (fault && !part.is_made(key))  // or another run has made it meanwhile, the same
      throw Error(ErrorKind::kIo, part.folder_.string(), "cannot be made (" + fault.message() + ")",
                  "Check the folder and the disk");
  }

 private:
  static constexpr const char* kFrame = "frame.png";

  nlohmann::json manifest() const {
    nlohmann::json read = nlohmann::json::parse(
        read_text_file(folder_ / kManifest, 4096, "Remove the folder " + folder_.string()), nullptr, false);
    if (!read.is_object() || !read["key"].is_string() || !read["frame"].is_number_integer())
      throw Error(ErrorKind::kInput, (folder_ / kManifest).string(), "is garbled",
                  "Remove the folder " + folder_.string());
    return read;
  }

  fs::path folder_;
  std::string name_;
};

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
      keys_.push_back(tools::key_of_part(point, inputs));
      if (!command_.gather) {
        point.command().output.open(inputs.loaded, inputs.options);
        if (&point == points_.data()) frame_ = (inputs.options.from + inputs.options.until) / 2;
      }
      if (still_.empty()) still_ = inputs.loaded.picture;
      region_ |= report::shown_region(inputs.loaded.matte);
    }
    if (command_.gather) expect_parts();
  }

  void run() {
    with_cache(command_.folder, [&](cache::ResultCache& cache) {
      for (std::size_t i = 0; i < points_.size(); ++i) {
        say_point(i);
        AnimateInputs inputs = read_inputs(points_[i].command());
        query::Assignment assignment = choose(i, inputs, cache);
        const cache::Key key = key_of(points_[i], inputs);
        add(i, inputs.loaded.matte, std::move(assignment), key,
            [&](SweptAnimation& animation, const query::Assignment& chosen) {
              Rendered made = render_point(i, inputs, chosen);
              animation.file = made.file;
              animation.video = made.video;
              animation.frame = made.frame;
            });
      }
    });
  }

  /// The points of a shard, each a Part; those that are there are left. Returns the numbers of those made.
  std::vector<std::string> make_parts(const Shard& shard, const fs::path& making) {
    std::vector<std::string> made;
    with_cache(making, [&](cache::ResultCache& cache) {
      for (std::size_t i = 0; i < points_.size(); ++i) {
        if (!shard.takes(i)) continue;
        const Part part(command_.folder, i);
        if (part.is_made(keys_[i])) continue;
        say_point(i);
        AnimateInputs inputs = read_inputs(points_[i].command());
        const query::Assignment assignment = choose(i, inputs, cache);
        const Rendered rendered = render_point(i, inputs, assignment);
        Part::seal(making / number_of(i), part, keys_[i], assignment, rendered.frame, frame_);
        made.push_back(number_of(i));
      }
    });
    return made;
  }

  /// What run() leaves, from the parts that shards have left.
  void gather() {
    frame_ = Part(command_.folder, 0).frame_number();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Part part(command_.folder, i);
      add(i, read_inputs(points_[i].command()).loaded.matte, query::read_assignment(part.assignment()), {},
          [&](SweptAnimation& animation, const auto&) {
            animation.file = fs::path(points_[i].command().output.name()).filename();
            animation.video =
                fs::exists(part.folder() / part.page_video()) ? part.page_video() : animation.file;
            animation.frame = part.frame();
            for (const std::string& name : {animation.file, animation.video})
              fs::copy_file(part.folder() / name, fs::path(command_.folder) / name,
                            fs::copy_options::overwrite_existing);
          });
    }
  }

  const std::vector<SweptAnimation>& animations() const { return animations_; }
  /// After check().
  const cache::Key& key_of_part(std::size_t i) const { return keys_[i]; }
  const SweepPoint& point(std::size_t i) const { return points_[i]; }
  const cv::Mat& still() const { return still_; }
  const cv::Rect& region() const { return region_; }
  int frame() const { return frame_; }

 private:
  void expect_parts() const {
    std::string missing;
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (!Part(command_.folder, i).is_made(keys_[i]))
        missing += (missing.empty() ? "" : ", ") + number_of(i);
    if (!missing.empty())
      throw Error(ErrorKind::kNotFound, (fs::path(command_.folder) / Part::kParts).string(),
                  "not yet made: " + missing, "Run the command with --shard for them");
  }

  struct Made {
    query::Assignment assignment;
    std::optional<cache::Key>
        key;  // of what it is rendered from; nothing: only its frames tell what it is like
  };
  /// Names of files.
  struct Rendered {
    std::string file, video;
    cv::Mat frame;
  };

  /// What labellings share lies in a cache, for the time of the sweep where nobody asks for a longer one.
  void with_cache(const fs::path& folder, const std::function<void(cache::ResultCache&)>& work) {
    const fs::path own = folder / ".labels";
    std::unique_ptr<cache::ResultCache> cache = command_.shared.cache.open();
    const bool for_now = cache == nullptr;
    if (for_now) cache = std::make_unique<cache::ResultCache>(own);
    const auto forget = [&] {
      cache.reset();
      std::error_code fault;
      if (for_now) fs::remove_all(own, fault);
    };
    try {
      work(*cache);
    } catch (...) {
      forget();
      throw;
    }
    forget();
  }

  std::shared_ptr<const query::SearchBase> base_of(const SearchOptions& search) {
    search.check(snapshot_);
    const query::IndexChoice index = search.index();
    auto& base = bases_[{index.flann ? static_cast<int>(*index.flann) : -1, index.flann_options.checks}];
    if (base == nullptr) base = open_with_progress(snapshot_, search, true);
    return base;
  }

  void say_point(std::size_t i) {
    say(fmt::format("animation {} of {}: {}", i + 1, points_.size(), points_[i].title()));
    plan_stages(points_[i].command().stages());
  }

  query::Assignment choose(std::size_t i, AnimateInputs& inputs, cache::ResultCache& cache) {
    AnimateCommand& command = points_[i].command();
    ChosenPatches chosen = choose_patches(
        command, snapshot_, inputs.loaded, inputs.asked,
        [this](const SearchOptions& search) { return base_of(search); }, &cache, context_);
    pace_it(snapshot_, inputs, chosen.assignment,
            query::shown_kind(command.search.options().class_name, chosen.kind, chosen.assignment).name);
    return std::move(chosen.assignment);
  }

  /// make   gives it its files and a frame, unless they are those of an animation before.
  void add(std::size_t i, const cv::Mat& matte, query::Assignment chosen,
           const std::optional<cache::Key>& key,
           const std::function<void(SweptAnimation&, const query::Assignment&)>& make) {
    SweepPoint& point = points_[i];
    made_.push_back({std::move(chosen), key});
    const query::Assignment& assignment = made_.back().assignment;
    SweptAnimation& animation = animations_.emplace_back();
    animation.number = number_of(i);
    animation.title = point.title();
    animation.command = point.command_line();
    animation.energy = assignment.energy;
    animation.gap = assignment.gap();
    animation.clips = assignment.clips.size();
    animation.changed = fraction_unlike(assignment, made_.front().assignment);
    animation.assignment = animation.number + ".json";
    query::write_assignment(fs::path(command_.folder) / animation.assignment, assignment);
    const auto twin = std::find_if(made_.begin(), made_.end() - 1, [&](const Made& before) {
      return key && before.key == key && before.assignment.pieces == assignment.pieces &&
             before.assignment.clips == assignment.clips;
    });
    if (twin != made_.end() - 1) {
      take_from(static_cast<std::size_t>(twin - made_.begin()), animation);
    } else {
      make(animation, assignment);
      compare(animation, matte);
    }
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

  /// Options may be without effect: what came out tells.
  void compare(SweptAnimation& animation, const cv::Mat& matte) const {
    const fs::path folder = command_.folder;
    for (std::size_t i = 0; i + 1 < animations_.size(); ++i)
      if (animations_[i].same_as < 0 && same_bytes(folder / animation.file, folder / animations_[i].file)) {
        fs::remove(folder / animation.file);
        fs::remove(folder / animation.video);
        animation.frame.release();
        return take_from(i, animation);
      }
    animation.difference = mean_difference(animation.frame, animations_.front().frame, matte);
  }

  Rendered render_point(std::size_t i, AnimateInputs& inputs, const query::Assignment& assignment) {
    OutputOptions& names = points_[i].command().output;
    const std::unique_ptr<AnimationFiles> output = names.open(inputs.loaded, inputs.options);
    const synth::animate::AnimateOptions& options = inputs.options;
    const fs::path file = names.name();
    Rendered made{.file = file.filename().string(), .video = {}, .frame = {}};
    made.video = names.plays_in_browsers() ? made.file : Part(command_.folder, i).page_video();
    std::optional<media::PictureSink> page;
    if (made.video != made.file)
      page.emplace(file.parent_path() / made.video, inputs.loaded.picture.size(),
                   options.until - options.from, options.fps);
    output->skip_to_range();
    const int kept = std::clamp(frame_, options.from, options.until - 1);
    int at = options.from;
    Progress progress;
    render(
        snapshot_, inputs, stage(snapshot_, inputs, assignment), output->picture(),
        [&](const cv::Mat& frame) {
          const cv::Mat shown = output->write(frame);
          if (page) page->write(shown);
          if (at++ == kept) made.frame = shown.clone();
        },
        progress.callback(), context_);
    output->finish();
    if (page) page->finish();
    progress.finish();
    return made;
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
  std::vector<cache::Key> keys_;                                                   // of their parts
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
                    {"key", cache::hex(sweep.key_of_part(i))},
                    {"command", animation.command}});
    if (std::isfinite(animation.gap)) list.back()["gap"] = animation.gap;
    if (animation.changed >= 0) list.back()["changed"] = animation.changed;
    if (animation.difference >= 0) list.back()["difference"] = animation.difference;
    if (animation.same_as >= 0)
      list.back()["same_as"] = sweep.animations()[static_cast<std::size_t>(animation.same_as)].number;
  }
  return {{"animations", list}, {"seconds", seconds}};
}

/// One shard of a sweep. What is gathered already has its parts no more, and is not made again.
void run_shard(SweepCommand& command, const std::vector<SweepAxis>& axes, const RunContext& context) {
  const Shard shard = command.shard.read();
  const SayOnce once;
  std::vector<std::string> made;
  if (!whole_report(command.folder, make_points(axes, *command.given, command.folder))) {
    const UnfinishedFolder making(fs::path(command.folder) / Part::kParts, ".making-");
    Sweep sweep(command, make_points(axes, *command.given, making.path().string(), true), context);
    sweep.check();
    made = sweep.make_parts(shard, making.path());
  }
  if (command.json)
    fmt::print("{}\n", nlohmann::json{{"made", made}}.dump(2));
  else
    for (const std::string& number : made)
      fmt::print("{}\n", (fs::path(command.folder) / Part::kParts / number).string());
}

/// Page, sheet and report of a sweep whose animations lie in its folder.
nlohmann::json show(const Sweep& sweep, const SweepCommand& command, const std::vector<SweepAxis>& axes,
                    const Stopwatch& watch) {
  const fs::path folder = command.folder;
  SweepWords words{.title = "Sweep of " + command.shared.target.picture.filename().string(),
                   .axes = {},
                   .still = kStill,
                   .size = sweep.still().size(),
                   .region = sweep.region(),
                   .fps = command.shared.duration.fps,
                   .frame = sweep.frame()};
  for (const SweepAxis& axis : axes)
    words.axes.push_back(
        fmt::format("{} ({}): {}.", axis.name, fmt::join(axis.values, ", "), axis.description));
  media::write_picture(folder / kStill, sweep.still());
  media::write_picture(folder / kSheet, sweep_sheet(words, sweep.still(), sweep.animations()));
  write_whole_file(folder / kPage, sweep_page(words, sweep.animations()));
  return report_of(sweep, watch.seconds());
}

void run_sweep(SweepCommand& command, const RunContext& context) {
  const Stopwatch watch;
  const std::vector<SweepAxis> axes = parse_axes(command.axes);
  if (command.shard.given()) return run_shard(command, axes, context);
  const fs::path folder = command.folder;
  const auto points = [&] { return make_points(axes, *command.given, command.folder); };
  const std::vector<SweepPoint> all = points();  // what is wrong with them is said first
  if (!command.gather) check_folder_output(folder);
  std::optional<nlohmann::json> report;
  {
    const SayOnce once;
    if (command.gather) report = whole_report(folder, points());
    if (!report) {
      Sweep sweep(command, points(), context);
      sweep.check();
      std::error_code ignored;
      fs::remove(folder / kReport, ignored);  // until all is there again
      command.gather ? sweep.gather() : sweep.run();
      report = show(sweep, command, axes, watch);
      write_whole_file(folder / kReport,
                       report->dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    }
  }
  if (command.gather) fs::remove_all(folder / Part::kParts);
  if (command.json) {
    fmt::print("{}\n", report->dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    return;
  }
  for (std::size_t i = 0; i < all.size(); ++i)
    fmt::print("{}  {}: {}\n", number_of(i), all[i].title(),
               (*report)["animations"][i]["result"].get<std::string>());
  fmt::print("{}\n{}\n", (folder / kSheet).string(), (folder / kPage).string());
}

}  // namespace

void add_sweep(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<SweepCommand>();
  CLI::App* sub = synth_command.add_subcommand(
      "sweep", "Animate a picture with every combination of given animate options, side by side");
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
  command->shard.add_to(
      *sub,
      "Make only part I of N of the animations, each in a folder of its own below DIR/parts, and no page. "
      "What is there is left, so an interrupted run can be repeated [all]");
  sub->add_flag("--gather", command->gather, "Make the page and the sheet of what all shards have left [off]")
      ->excludes("--shard");
  sub->add_flag("--json", command->json, "Print the result as JSON");
  command->given = sub;
  sub->callback([command, &context] { run_sweep(*command, context); });
}

}  // namespace freshet::tools
