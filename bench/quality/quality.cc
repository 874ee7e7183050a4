// bench/quality/quality.cc — how far is an animated still from what the fluid really did, and which choices bring it
// nearer?
//
//   bench_quality STORE [--clips fall --clips fire/] [--hints none,strokes] [--ablate all] [--html DIR]
//
// Leaves one clip out: each clip of the store is decoded from it, its middle frame (reduced to 640 px, for
// the bench's time) is taken for a still, its real motion gives the matte and the strokes that a person would
// draw, and the still is animated from all other clips. What comes out is compared, inside the matte, with
// what the clip did over as many frames (quality_measures.h). References in the same table: the clip's half
// before the still against its half after it (ceiling), the still (floor), and labelling by likeness alone.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "bench/harness/machine.h"
#include "bench/quality/quality_case.h"
#include "bench/quality/quality_method.h"
#include "bench/quality/quality_page.h"
#include "bench/quality/quality_report.h"
#include "freshet/error.h"
#include "query/index/search_base.h"
#include "synth/animate/placement/assigned.h"

namespace {

using namespace freshet;

struct Asked {
  std::string store;
  std::vector<std::string> clips;
  std::string class_name;
  bench::CaseOptions sizes;
  std::vector<std::string> hints{"none", "strokes"}, ablate{"looks"}, tries;
  std::string set, json_path, html;
};

struct Hint {
  std::string name;
  bool strokes = false, speed = false;
};

Hint hint_named(const std::string& name) {
  if (name == "none") return {name, false, false};
  if (name == "strokes") return {name, true, false};
  if (name == "strokes+speed") return {name, true, true};
  throw Error(ErrorKind::kUsage, "hint \"" + name + "\"", "none, strokes or strokes+speed expected");
}

/// The defaults with --set, and each variation of them.
std::vector<bench::Method> methods_of(const Asked& asked) {
  bench::Method plain;
  bench::apply_settings(asked.set, plain);
  std::vector<bench::Method> methods{plain};
  const auto add = [&](const std::string& name, const std::string& settings) {
    methods.push_back(plain);
    methods.back().name = name;
    bench::apply_settings(settings, methods.back());
  };
  for (const std::string& name : asked.ablate) {
    if (name == "nothing") continue;
    bool known = name == "all";
    for (const bench::NamedSettings& ablation : bench::ablations()) {
      if (name != "all" && name != ablation.name) continue;
      known = true;
      add(ablation.name, ablation.settings);
    }
    if (!known) throw Error(ErrorKind::kUsage, "--ablate " + name, "no such ablation", "See --help");
  }
  for (const std::string& settings : asked.tries) add(settings, settings);
  return methods;
}

/// Measures that do not tell a film from itself, or a still from a film, would say nothing.
void check_measures() {
  std::mt19937 random(7);
  std::vector<cv::Mat> film;
  cv::Mat grain(128, 192, CV_8U);
  for (int i = 0; i < grain.rows * grain.cols; ++i) grain.data[i] = static_cast<std::uint8_t>(random() % 256);
  for (int t = 0; t < 24; ++t) film.push_back(grain(cv::Rect(t, 0, 128, 128)).clone());
  const bench::Region region{cv::Mat(128, 128, CV_8U, cv::Scalar(255)), {0, 0}, 24};
  const bench::Film truth = bench::measure(film, bench::pair_motions(film), 25, region);
  const bench::Distance same = bench::compare(truth, truth, region);
  const std::vector<cv::Mat> still(film.size(), film[12]);
  const bench::Distance floor =
      bench::compare(bench::measure(still, bench::pair_motions(still), 25, region), truth, region);
  if (same.spectrum_db != 0 || same.angle_deg > 1e-3 || same.speed != 0 || same.texture != 0 ||
      same.flicker != 0 || std::abs(same.ssim - 1) > 1e-4 || floor.spectrum_db < 30 || floor.dead != 1)
    throw Error(ErrorKind::kInput, "the bench itself",
                "a film is not 0 away from itself, or a still not far");
}

/// Class by class in turn, so that what a run has shown when it is broken off is of all classes.
std::vector<store::ClipId> chosen_clips(const store::Snapshot& snapshot, const Asked& asked) {
  std::map<std::string, std::map<std::string, store::ClipId>> by_class;
  for (const store::ClipId id : snapshot.clips()) {
    const store::ClipRecord& clip = snapshot.clip(id);
    const bool wanted = std::any_of(asked.clips.begin(), asked.clips.end(), [&](const std::string& part) {
      return clip.name.find(part) != std::string::npos;
    });
    if ((asked.clips.empty() || wanted) && (asked.class_name.empty() || clip.class_name == asked.class_name))
      by_class[clip.class_name][clip.name] = id;
  }
  std::vector<store::ClipId> clips;
  while (!by_class.empty()) {
    for (auto group = by_class.begin(); group != by_class.end();) {
      clips.push_back(group->second.extract(group->second.begin()).mapped());
      group = group->second.empty() ? by_class.erase(group) : std::next(group);
    }
  }
  if (clips.empty()) throw Error(ErrorKind::kUsage, asked.store, "no clip of it is chosen");
  return clips;
}

/// One clip under all hints and methods.
class Trial {
 public:
  Trial(const store::Snapshot& snapshot, const query::SearchBase& base, const Asked& asked,
        const bench::Case& clip)
      : snapshot_(snapshot), base_(base), asked_(asked), case_(clip) {}

  bench::Judged judge(const Hint& hint, const bench::Method& method) {
    bench::Judged judged{case_.name, case_.class_name,
                         hint.name + (method.name.empty() ? "" : ", " + method.name)};
    const double start = bench::wall_seconds();
    const synth::animate::Placement& placement = placed(hint, method);
    judged.label_s = bench::wall_seconds() - start;
    synth::animate::AnimateOptions options = method.animate;
    options.frames = static_cast<int>(case_.truth.size());
    options.fps = case_.fps;
    if (hint.strokes && !case_.strokes.empty())
      bench::guide_by(case_.strokes, case_.still.size(), hint.speed, options.guide);
    std::vector<cv::Mat> made;
    synth::animate::animate(snapshot_, base_.settings, case_.still, case_.matte, placement, options,
                            [&](const cv::Mat& frame) { made.push_back(frame.clone()); });
    judged.render_s = bench::wall_seconds() - start - judged.label_s;
    const std::vector<cv::Mat> luma = bench::luma_of(made);
    judged.distance = bench::compare(bench::measure(luma, bench::pair_motions(luma), case_.fps, case_.region),
                                     case_.film, case_.region);
    if (!asked_.html.empty())
      judged.video = bench::write_panels(asked_.html, case_, made, judged.method, hint.strokes);
    return judged;
  }

 private:
  const synth::animate::Placement& placed(const Hint& hint, const bench::Method& method) {
    const std::string key = hint.name + "/" + method.labels_settings;
    if (const auto known = placements_.find(key); known != placements_.end()) return known->second;
    query::LabelOptions options = method.label;
    options.candidates.excluded_clips = case_.same_scene;
    options.candidates.min_duration_s = static_cast<double>(case_.truth.size()) / case_.fps;
    if (method.same_class) options.candidates.class_name = case_.class_name;
    if (hint.strokes && !case_.strokes.empty())
      bench::guide_by(case_.strokes, case_.still.size(), hint.speed, options.guide);
    const query::Labelling labelling = query::label(snapshot_, base_, case_.still, case_.matte, options);
    return placements_.emplace(key, synth::animate::placement_from(labelling.assignment, snapshot_))
        .first->second;
  }

  const store::Snapshot& snapshot_;
  const query::SearchBase& base_;
  const Asked& asked_;
  const bench::Case& case_;
  std::map<std::string, synth::animate::Placement> placements_;  // by all that labels depend on
};

void write_json(const Asked& asked, const std::vector<bench::Judged>& judged) {
  nlohmann::json json = bench::to_json(judged);
  json["machine"] = bench::to_json(bench::this_machine());
  json["width"] = asked.sizes.width;
  json["frames"] = asked.sizes.frames;
  json["set"] = asked.set;
  std::ofstream(asked.json_path) << json.dump(1) << '\n';
}

int run(const Asked& asked) {
  check_measures();
  std::vector<Hint> hints;
  for (const std::string& name : asked.hints)
    if (name != "nothing") hints.push_back(hint_named(name));
  const std::vector<bench::Method> methods = methods_of(asked);
  if (!asked.html.empty()) std::filesystem::create_directories(asked.html);

  const double start = bench::wall_seconds();
  const store::Snapshot snapshot = store::Store::open_read(asked.store).snapshot();
  const query::SearchBase base = query::open_search(snapshot);
  const std::vector<store::ClipId> clips = chosen_clips(snapshot, asked);
  fmt::print("{}\n{} clips; stills of {} px, {} frames at most{}\n\n",
             bench::to_string(bench::this_machine()), clips.size(), asked.sizes.width, asked.sizes.frames,
             asked.set.empty() ? "" : "; " + asked.set);
  std::vector<bench::Judged> judged;
  for (std::size_t c = 0; c < clips.size(); ++c) {
    const std::string& name = snapshot.clip(clips[c]).name;
    std::string why;
    const auto clip = bench::make_case(snapshot, base.settings, clips[c], asked.sizes, why);
    fmt::print(stderr, "[{}/{}] {}, {:.0f} s{}\n", c + 1, clips.size(), name, bench::wall_seconds() - start,
               clip ? "" : ": left out, " + why);
    if (!clip) continue;
    if (clip->same_scene.size() > 1)
      fmt::print(stderr, "  left out together: {}\n", fmt::join(clip->same_scene, ", "));
    if (clip->strokes.empty()) fmt::print(stderr, "  nothing flows: no strokes\n");
    judged.push_back({name, clip->class_name, "real", bench::compare(clip->film, clip->film, clip->region)});
    if (clip->half) judged.push_back({name, clip->class_name, "ceiling", *clip->half});
    judged.push_back({name, clip->class_name, "floor", clip->frozen});
    Trial trial(snapshot, base, asked, *clip);
    for (const Hint& hint : hints) {
      for (const bench::Method& method : methods) {
        try {
          judged.push_back(trial.judge(hint, method));
        } catch (const Error& fault) {
          fmt::print(stderr, "  {} {}: {}\n", hint.name, method.name, fault.what());
        }
      }
    }
    // After each clip: a run that is broken off has shown something.
    if (!asked.html.empty()) bench::write_page(asked.html, judged, "Animated stills beside what was filmed");
    if (!asked.json_path.empty()) write_json(asked, judged);
  }
  fmt::print("{}\n{}", bench::clip_table(judged), bench::summary_table(judged));
  fmt::print("\n{:.0f} s, {:.0f} s of CPU\n", bench::wall_seconds() - start, bench::process_seconds());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  Asked asked;
  CLI::App app(
      "Animates a still of each clip of a store from the other clips, and measures how far the result is "
      "from what the clip did");
  std::string ablations = "Rows with one choice changed, of all or nothing or:";
  for (const bench::NamedSettings& ablation : bench::ablations())
    ablations += fmt::format("\n{} ({}): {}", ablation.name, ablation.settings, ablation.what);
  app.add_option("store", asked.store, "Store of the clips, indexed")->required();
  app.add_option("--clips", asked.clips, "Only clips whose names contain one of these [all]")->delimiter(',');
  app.add_option("--class", asked.class_name, "Only clips of this class [all]");
  app.add_option("--width", asked.sizes.width, "Longer side that a clip is reduced to, px")
      ->check(CLI::Range(64, 8192))
      ->capture_default_str();
  app.add_option("--frames", asked.sizes.frames, "Frames to animate; no more than the clip has")
      ->check(CLI::Range(24, 1000))
      ->capture_default_str();
  app.add_option("--hints", asked.hints,
                 "none, strokes (direction alone), strokes+speed; nothing: the references alone")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--ablate", asked.ablate, ablations)->delimiter(',')->capture_default_str();
  app.add_option("--try", asked.tries, "One more row, with settings as in --set; may be repeated");
  app.add_option("--set", asked.set, "Settings of all rows, key=value key=value:\n" + bench::setting_keys());
  app.add_option("--json", asked.json_path, "Figures as JSON");
  app.add_option("--html", asked.html,
                 "Folder for a page that plays the films; it holds footage, do not share it");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(asked);
  } catch (const freshet::Error& fault) {
    fmt::print(stderr, "{}\n", fault.what());
    return 1;
  }
}
