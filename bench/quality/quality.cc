// bench/quality/quality.cc — how far is an animated still from what the fluid really did, and which choices bring it
// nearer?
//
//   bench_quality STORE [--clips fall,fire/] [--limit 8] [--hints guess,maps] [--methods all] [--html DIR]
//   bench_quality STORE --held-out FOLDER ...
//
// Leaves one clip out: each clip of the store is decoded from it, its middle frame (reduced to 640 px, for
// the bench's time) is taken for a still, its real motion gives the matte and the hints that a person would
// give (quality_hints.h), and the still is animated from all other clips, in our way and in our rivals'
// (quality_method.h). With --held-out the clips are files that the store does not know. What comes out is
// compared, inside the matte, with what the clip did over as many frames (quality_measures.h). References in
// the same tables: the clip's half before the still against its half after it (ceiling), the still (floor).

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "bench/harness/arguments.h"
#include "bench/harness/machine.h"
#include "bench/quality/prior/optimised_still.h"
#include "bench/quality/prior/transferred_flames.h"
#include "bench/quality/prior/video_example.h"
#include "bench/quality/quality_agreement.h"
#include "bench/quality/quality_asked.h"
#include "bench/quality/quality_case.h"
#include "bench/quality/quality_footage.h"
#include "bench/quality/quality_hints.h"
#include "bench/quality/quality_method.h"
#include "bench/quality/quality_page.h"
#include "bench/quality/quality_report.h"
#include "bench/quality/quality_retrieval.h"
#include "bench/quality/quality_rivals.h"
#include "freshet/error.h"
#include "query/index/exact_index.h"
#include "query/index/index_builder.h"
#include "query/index/search_base.h"
#include "query/labelling/label_request.h"
#include "query/labelling/shares.h"
#include "synth/animate/motion/motion_field.h"
#include "synth/animate/placement/assigned.h"
#include "synth/animate/placement/retiming.h"
#include "synth/judging/colour_drift.h"
#include "synth/judging/critic.h"
#include "synth/takes/pace.h"
#include "synth/takes/take.h"
#include "vision/look/horizon.h"

namespace {

using namespace freshet;

struct Asked {
  std::string store;
  std::vector<std::string> clips;
  std::string class_name;
  std::vector<std::filesystem::path> held_out;
  std::size_t limit = 0;   // of clips; 0: none
  std::vector<int> words;  // of codebooks made here
  bench::CaseOptions sizes;
  int frames_made = 0;  // at least; beyond the truth's only reversals are measured
  bool loop = false;
  std::vector<std::string> hints{"guess", "direction", "strokes+speed", "maps"};
  std::vector<std::string> methods{"ours", "paper", "eulerian", "eulerian-varying"}, ablate{"nothing"}, tries;
  std::string set, json_path, html, films;
};

/// Of a table of settings, those named (or all), each on top of `plain`.
void add_named(const std::vector<std::string>& names, const std::vector<bench::NamedSettings>& table,
               const char* option, const bench::Method& plain, std::vector<bench::Method>& methods) {
  for (const std::string& name : names) {
    bool known = name == "all" || name == "nothing";
    for (const bench::NamedSettings& one : table) {
      if (name != "all" && name != one.name) continue;
      known = true;
      methods.push_back(plain);
      methods.back().name = one.name;
      bench::apply_settings(one.settings, methods.back());
    }
    if (!known)
      throw Error(ErrorKind::kUsage, fmt::format("{} {}", option, name), "no such name", "See --help");
  }
}

std::vector<bench::Method> methods_of(const Asked& asked) {
  bench::Method plain;
  bench::apply_settings(asked.set, plain);
  std::vector<bench::Method> methods;
  add_named(asked.methods, bench::methods(), "--methods", plain, methods);
  add_named(asked.ablate, bench::ablations(), "--ablate", plain, methods);
  for (const std::string& settings : asked.tries) {
    methods.push_back(plain);
    methods.back().name = settings;
    bench::apply_settings(settings, methods.back());
  }
  return methods;
}

/// Measures that do not tell a film from itself, or a still from a film, would say nothing.
void check_measures() {
  std::mt19937 random(7);
  std::vector<cv::Mat> film;
  cv::Mat grain(128, 192, CV_8U);
  for (int i = 0; i < grain.rows * grain.cols; ++i) grain.data[i] = static_cast<std::uint8_t>(random() % 256);
  for (int t = 0; t < 32; ++t) film.push_back(grain(cv::Rect(t, 0, 128, 128)).clone());
  const bench::Region region{cv::Mat(128, 128, CV_8U, cv::Scalar(255)), {0, 0}, 24};
  bench::Film truth = bench::measure(film, bench::pair_motions(film), 25, region);
  truth.halves_apart.fill(1);
  const bench::Distance same = bench::compare(truth, truth, region);
  const std::vector<cv::Mat> still(film.size(), film[12]);
  const bench::Distance floor =
      bench::compare(bench::measure(still, bench::pair_motions(still), 25, region), truth, region);
  if (same.spectrum_db != 0 || same.angle_deg > 1e-3 || same.speed != 0 || same.texture != 0 ||
      same.flicker != 0 || std::abs(same.ssim - 1) > 1e-4 || same.lifetime != 0 || same.ribbon != 0 ||
      same.patches[0] != 0 || floor.spectrum_db < 30 || floor.dead != 1 || !(floor.lifetime > 0.1))
    throw Error(ErrorKind::kInput, "the bench itself",
                "a film is not 0 away from itself, or a still not far");
}

/// A clip to be judged, by where it comes from.
struct Chosen {
  std::string name, class_name;
  std::function<bench::Footage()> read;
};

/// Class by class in turn, so that what a run has shown when it is broken off, or limited, is of all classes.
std::vector<Chosen> chosen_clips(const store::Snapshot& snapshot, const Asked& asked) {
  std::map<std::string, std::map<std::string, Chosen>> by_class;
  const auto add = [&](const std::string& name, const std::string& class_name,
                       std::function<bench::Footage()> read) {
    const bool wanted = std::any_of(asked.clips.begin(), asked.clips.end(), [&](const std::string& part) {
      return name.find(part) != std::string::npos;
    });
    if ((asked.clips.empty() || wanted) && (asked.class_name.empty() || class_name == asked.class_name))
      by_class[class_name][name] = {name, class_name, std::move(read)};
  };
  if (asked.held_out.empty()) {
    for (const store::ClipId id : snapshot.clips())
      add(snapshot.clip(id).name, snapshot.clip(id).class_name,
          [&snapshot, &asked, id] { return bench::stored_footage(snapshot, id, asked.sizes); });
  } else {
    for (const ingest::Source& source : ingest::list_sources(asked.held_out))
      add(source.name, source.class_name,
          [&snapshot, &asked, source] { return bench::held_out_footage(snapshot, source, asked.sizes); });
  }
  std::vector<Chosen> clips;
  while (!by_class.empty()) {
    for (auto group = by_class.begin(); group != by_class.end();) {
      clips.push_back(group->second.extract(group->second.begin()).mapped());
      group = group->second.empty() ? by_class.erase(group) : std::next(group);
    }
  }
  if (clips.empty()) throw Error(ErrorKind::kUsage, asked.store, "no clip is chosen");
  if (asked.limit > 0 && clips.size() > asked.limit) clips.resize(asked.limit);
  return clips;
}

/// What the critic says, who does not know what the clip did.
synth::judging::Verdict critic_of(const bench::Case& clip, std::span<const cv::Mat> frames,
                                  const synth::judging::Asked& asked) {
  synth::judging::Evidence film(clip.still, clip.matte, clip.fps);
  for (const cv::Mat& frame : frames) film.add(frame);
  return synth::judging::judge(film, clip.class_name, asked);
}

/// One clip under all hints and methods.
class Trial {
 public:
  Trial(const store::Snapshot& snapshot, const query::SearchBase& base, const Asked& asked,
        const bench::Case& clip)
      : snapshot_(snapshot), base_(base), asked_(asked), case_(clip) {}

  /// A rival that needs no labels.
  bench::Judged judge_unlabelled(const bench::Method& method) const {
    const double start = bench::wall_seconds();
    const bool transferred = method.renderer == bench::Renderer::kTransfer;
    const std::vector<cv::Mat> made =
        transferred ? transferred_flames(method) : carried_along_truth(method.renderer);
    bench::Judged judged{case_.name, case_.class_name,
                         (transferred ? "no hint, " : "true motion, ") + method.name};
    judged.render_s = bench::wall_seconds() - start;
    compare(made, bench::true_direction(case_), false, judged);
    return judged;
  }

  bench::Judged judge(const bench::NamedHint& hint, const bench::Method& method) {
    bench::Judged judged{case_.name, case_.class_name, fmt::format("{}, {}", hint.name, method.name)};
    const double start = bench::wall_seconds();
    const Labelled& labels = labelled(hint, method);
    judged.label_s = bench::wall_seconds() - start;
    const std::vector<cv::Mat> made =
        method.renderer == bench::Renderer::kAnimate ? animated(labels, method) : by_rival(labels, method);
    judged.render_s = bench::wall_seconds() - start - judged.label_s;
    const bool strokes = hint.hint == bench::Hint::kStrokes || hint.hint == bench::Hint::kStrokesSpeed;
    compare(made, labels.asked.direction, strokes, judged, labels.asked.rendering.speed);
    if (method.renderer == bench::Renderer::kAnimate) {
      judged.distance.clip_share = labels.shares.clip;
      judged.distance.patch_share = labels.shares.patch;
    }
    return judged;
  }

 private:
  struct Labelled {
    bench::AskedOf asked;
    query::Assignment assignment;
    synth::animate::Placement placement;
    query::LargestShares shares;
  };

  std::vector<cv::Mat> carried_along_truth(bench::Renderer renderer) const {
    std::vector<cv::Mat> flow;
    if (renderer == bench::Renderer::kCarried)
      flow.push_back(case_.motion / case_.fps);
    else
      for (const bench::PairMotion& motion : case_.motions) flow.push_back(motion.fine);
    return bench::carry_still(case_.still, case_.matte, flow, static_cast<int>(case_.truth.size()));
  }

  std::vector<cv::Mat> transferred_flames(const bench::Method& method) const {
    if (case_.class_name != "fire")
      throw Error(
          ErrorKind::kInput, case_.name,
          fmt::format("{} is for clips of class fire, and this is {}", method.name, case_.class_name));
    std::vector<store::ClipId> clips;
    for (const store::ClipId id : snapshot_.clips()) {
      const store::ClipRecord& clip = snapshot_.clip(id);
      const bool excluded = !method.own && std::find(case_.same_scene.begin(), case_.same_scene.end(),
                                                     clip.name) != case_.same_scene.end();
      if (clip.class_name == "fire" && !excluded) clips.push_back(id);
    }
    cv::Mat picture, fluid;
    case_.still.convertTo(picture, CV_32F, 1 / 255.0);
    case_.matte.convertTo(fluid, CV_32F, 1 / 255.0);
    const bench::FlameDesign design =
        bench::design_of_flames(snapshot_, base_.settings.flow_step, picture, fluid, clips,
                                static_cast<int>(case_.truth.size()), case_.fps);
    for (const store::ClipId id : design.clips)
      fmt::print(stderr, "  design: {}, fit {:.2f}\n", snapshot_.clip(id).name, design.fit);
    return bench::transfer_flames(case_.still, case_.matte, design.still, design.levels);
  }

  std::vector<cv::Mat> animated(const Labelled& labels, const bench::Method& method) const {
    synth::animate::AnimateOptions options = method.animate;
    auto* forms = std::get_if<synth::animate::FormsOptions>(&options.method);
    if (forms == nullptr && options.for_fires) forms = &*options.for_fires;
    if (forms != nullptr && !method.own) forms->excluded = case_.same_scene;
    options.frames = std::max(static_cast<int>(case_.truth.size()), asked_.loop ? 0 : asked_.frames_made);
    options.fps = case_.fps;
    options.loop = asked_.loop;
    query::MotionGuide guide = labels.asked.rendering;
    if (method.horizon && case_.class_name == "water")
      guide.horizon = vision::horizon_of_water(case_.still, case_.matte, case_.class_name);
    synth::animate::Placement placement = labels.placement;
    synth::animate::Playing playing;
    synth::takes::apply({.speed = method.speed.value_or(1)}, 0, options, guide, playing);
    if (!method.speed && guide.speed.empty()) playing.factor = pace_of(labels.assignment);
    if (playing.factor != 1) synth::animate::retime(placement, playing.factor, {}, case_.still.size());
    options.guide = guide;
    std::vector<cv::Mat> made;
    synth::animate::animate(snapshot_, base_.settings, case_.still, case_.matte, placement, options,
                            [&](const cv::Mat& frame) { made.push_back(frame.clone()); });
    return made;
  }

  /// A rival goes as asked; where nothing is asked of direction or speed, as our labels do.
  std::vector<cv::Mat> by_rival(const Labelled& labels, const bench::Method& method) {
    const query::MotionGuide& guide = labels.asked.rendering;
    cv::Mat fluid;
    case_.matte.convertTo(fluid, CV_32F, 1 / 255.0);
    const double factor = guide.speed.empty() ? pace_of(labels.assignment) : 1;
    const cv::Mat motion = synth::animate::apply_guide(
        synth::animate::motion_field(snapshot_, base_.settings, labels.placement, case_.still.size()) *
            factor,
        guide, fluid);
    const int frames = static_cast<int>(case_.truth.size());
    if (method.renderer == bench::Renderer::kOptimised)
      return bench::optimise_still(case_.still, case_.matte, motion / case_.fps, frames);
    if (!example_) example_ = example();  // the same for all hints
    return bench::animate_by_example(case_.still, case_.matte, motion, case_.fps, *example_, frames);
  }

  /// The clip that has the best candidate of most pieces, for the person who chooses one; played at the still's rate.
  bench::VideoExample example() const {
    query::LabelOptions options;
    options.candidates.excluded_clips = case_.same_scene;
    options.candidates.class_name = case_.class_name;
    const query::CandidateSearch search =
        query::search_candidates(snapshot_, base_, case_.still, case_.matte, options);
    std::vector<int> best_of(base_.table.clips.size());
    for (std::size_t piece = 0; piece < search.target.size(); ++piece)
      if (const auto rows = search.candidates.rows_of(piece); !rows.empty())
        ++best_of[base_.table.clip[rows.front()]];
    const auto chosen = std::max_element(best_of.begin(), best_of.end()) - best_of.begin();
    const bench::Footage footage =
        bench::stored_footage(snapshot_, base_.table.clips[static_cast<std::size_t>(chosen)], asked_.sizes);
    fmt::print(stderr, "  example: {}\n", footage.name);
    std::vector<cv::Mat> frames;
    for (double at = 0; at < static_cast<double>(footage.frames.size()); at += footage.fps / case_.fps)
      frames.push_back(footage.frames[static_cast<std::size_t>(at)]);
    const std::vector<bench::PairMotion> motions = bench::pair_motions(bench::luma_of(frames));
    cv::Mat flow = cv::Mat::zeros(motions[0].fine.size(), CV_32FC2);
    for (const bench::PairMotion& motion : motions) flow += motion.fine;
    return bench::decompose(frames, flow / static_cast<double>(motions.size()));
  }

  double pace_of(const query::Assignment& assignment) const {
    return synth::takes::factor_of(
        "auto", query::largest_class(assignment).name,
        synth::takes::filmed_speed(snapshot_, base_.settings, assignment, case_.matte), case_.still.size());
  }

  const Labelled& labelled(const bench::NamedHint& hint, const bench::Method& method) {
    const std::string key = fmt::format("{}/{}", hint.name, method.labels_settings);
    if (const auto known = labelled_.find(key); known != labelled_.end()) return known->second;
    query::LabelOptions options = method.label;
    if (!method.own) options.candidates.excluded_clips = case_.same_scene;
    options.candidates.min_duration_s = static_cast<double>(case_.truth.size()) / case_.fps;
    if (method.same_class) options.candidates.class_name = case_.class_name;
    bench::AskedOf asked = bench::ask(hint.hint, case_, snapshot_, base_, options);
    if (hint.hint == bench::Hint::kGuess && !asked.labels.direction.empty())
      query::adopt_guess(asked.labels, options);
    else
      options.guide = asked.labels;
    options.candidates.direction_deg = asked.direction_deg;
    query::let_looks_choose_flames(case_.matte, options);
    const query::Labelling labelling = query::label(snapshot_, base_, case_.still, case_.matte, options);
    return labelled_
        .emplace(key, Labelled{std::move(asked), labelling.assignment,
                               synth::animate::placement_from(labelling.assignment, snapshot_),
                               query::largest_shares(labelling.assignment)})
        .first->second;
  }

  /// All measures of what was made, and its place on the page.
  /// asked_speed   px/s, negative where none was asked; may be empty.
  void compare(std::vector<cv::Mat> made, const cv::Mat& asked_direction, bool strokes, bench::Judged& judged,
               const cv::Mat& asked_speed = {}) const {
    const std::vector<cv::Mat> luma = bench::luma_of(made);
    const std::vector<bench::PairMotion> motions = bench::pair_motions(luma);
    const std::size_t frames = case_.truth.size();
    const bench::Film film = bench::measure(std::span(luma).first(frames),
                                            std::span(motions).first(frames - 1), case_.fps, case_.region);
    judged.distance = bench::compare(film, case_.film, case_.region);
    judged.distance.drift =
        synth::judging::colour_drift(std::span<const cv::Mat>(made).first(frames), case_.still, case_.matte);
    judged.verdict = critic_of(case_, std::span<const cv::Mat>(made).first(frames),
                               {.direction = asked_direction, .speed = asked_speed});
    judged.distance.faults = judged.verdict.faults;
    judged.lifetime = film.lifetime;
    judged.distance.start = bench::detail_correlation(luma[0], bench::luma_of({case_.still})[0], case_.matte);
    const bench::Reversals back =
        bench::reversals(bench::motion_by_second(motions, case_.fps), asked_direction, case_.matte);
    judged.distance.back_seconds = back.seconds;
    judged.distance.back_blocks = back.blocks;
    if (asked_.loop)
      judged.distance.loop = bench::motion_after_loop(luma, static_cast<int>(frames), case_.matte);
    made.resize(frames);
    if (!asked_.films.empty()) bench::write_film(asked_.films, case_, judged.method, made);
    if (!asked_.html.empty())
      judged.video = bench::write_panels(asked_.html, case_, made, judged.method, strokes);
  }

  const store::Snapshot& snapshot_;
  const query::SearchBase& base_;
  const Asked& asked_;
  const bench::Case& case_;
  std::map<std::string, Labelled> labelled_;  // by all that labels depend on
  std::optional<bench::VideoExample> example_;
};

/// What is found of a still among all other clips, of any class, when nothing is said.
bench::RetrievedCase retrieved(const store::Snapshot& snapshot, const query::SearchBase& base,
                               const bench::Case& clip) {
  query::LabelOptions options;
  options.candidates.excluded_clips = clip.same_scene;
  const double start = bench::process_seconds();
  query::CandidateSearch search = query::search_candidates(snapshot, base, clip.still, clip.matte, options);
  bench::RetrievedCase found;
  found.search_cpu_s = bench::process_seconds() - start;
  found.pieces = search.target.size();
  std::vector<bool> same_class;
  for (const store::ClipId id : base.table.clips)
    same_class.push_back(snapshot.clip(id).class_name == clip.class_name);
  std::vector<std::vector<stored::Row>> best, chosen;
  for (std::size_t piece = 0; piece < found.pieces; ++piece) {
    const auto rows = search.candidates.rows_of(piece);
    const auto count = std::min(rows.size(), static_cast<std::size_t>(options.candidates.k));
    best.emplace_back(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(count));
    found.likeness += search.candidates.scores_of(piece).front() / static_cast<double>(found.pieces);
  }
  const query::Labelling labelling = query::label(snapshot, std::move(search), options);
  for (std::size_t piece = 0; piece < found.pieces; ++piece)
    chosen.push_back({labelling.search.candidates.rows_of(piece)[labelling.labels[piece]]});
  const auto told = [&](const std::vector<std::vector<stored::Row>>& rows) {
    return bench::retrieval_of(labelling.search.target, base.table, rows, same_class, clip.motion,
                               clip.matte);
  };
  found.best = told(best);
  found.labels = told(chosen);
  return found;
}

void write_json(const Asked& asked, const std::vector<bench::Judged>& judged) {
  nlohmann::json json = bench::to_json(judged);
  json["machine"] = bench::to_json(bench::this_machine());
  json["width"] = asked.sizes.width;
  json["frames"] = asked.sizes.frames;
  json["set"] = asked.set;
  std::ofstream(asked.json_path) << json.dump(1) << '\n';
}

/// The rows of a clip that nobody animates.
void add_references(const bench::Case& clip, std::vector<bench::Judged>& judged) {
  const auto add = [&](const char* name, const bench::Distance& distance, const bench::LifetimeCurve& curve) {
    judged.push_back({.clip = clip.name,
                      .class_name = clip.class_name,
                      .method = name,
                      .distance = distance,
                      .lifetime = curve});
  };
  bench::Distance real = bench::compare(clip.film, clip.film, clip.region);
  const bench::Reversals back =
      bench::reversals(clip.film.by_second, bench::true_direction(clip), clip.matte);
  real.drift = synth::judging::colour_drift(clip.truth, clip.still, clip.matte);
  real.back_seconds = back.seconds;
  real.back_blocks = back.blocks;
  add("real", real, clip.film.lifetime);
  // As a film that begins with the clip's first frame, as ours begin with their still.
  synth::judging::Evidence film(clip.truth.front(), clip.matte, clip.fps);
  for (const cv::Mat& frame : clip.truth) film.add(frame);
  judged.back().verdict = synth::judging::judge(film, clip.class_name);
  judged.back().distance.faults = judged.back().verdict.faults;
  if (clip.half) add("ceiling", *clip.half, clip.half_lifetime);
  bench::LifetimeCurve whole;
  whole.fill(1);
  add("floor", clip.frozen, whole);
}

/// A codebook of so many words of the same clips, and the stills that are searched by it.
struct TriedWords {
  query::SearchBase base;
  std::string cost;
  std::vector<bench::RetrievedCase> cases{};
};
TriedWords try_words(store::Store& store, int words) {
  TriedWords tried{query::open_search(store.snapshot()), {}};
  const double start = bench::process_seconds();
  tried.base.settings.codebook.words = words;
  query::TriedCodebook made = query::try_codebook(store, tried.base.settings.codebook);
  const double assigned = bench::process_seconds();
  tried.base.codebook = std::move(made.codebook);
  tried.base.table.words = std::move(made.words);
  auto index = std::make_unique<query::ExactIndex>(tried.base.table.words, tried.base.codebook.words);
  const double rows = static_cast<double>(std::max<std::size_t>(1, index->rows()));
  tried.cost =
      fmt::format("{} words: made in {:.1f} s of CPU, index {:.2f}; {:.0f} bytes a patch, {} of them words",
                  tried.base.codebook.words, assigned - start, bench::process_seconds() - assigned,
                  static_cast<double>(index->bytes() + tried.base.table.words.bytes().size()) / rows,
                  tried.base.table.words.row_bytes());
  tried.base.index = std::move(index);
  return tried;
}

int run(const Asked& asked) {
  check_measures();
  std::vector<bench::NamedHint> hints;
  for (const std::string& name : asked.hints)
    if (name != "nothing") hints.push_back(bench::hint_named(name));
  const std::vector<bench::Method> methods = methods_of(asked);
  if (!asked.html.empty()) std::filesystem::create_directories(asked.html);

  const double start = bench::wall_seconds();
  store::Store store = store::Store::open_read(asked.store);
  const store::Snapshot snapshot = store.snapshot();
  const query::SearchBase base = query::open_search(snapshot);
  std::vector<TriedWords> tried;
  for (const int words : asked.words) tried.push_back(try_words(store, words));
  const std::vector<Chosen> clips = chosen_clips(snapshot, asked);
  fmt::print("{}\n{} {}clips; stills of {} px, {} frames at most{}\n\n",
             bench::to_string(bench::this_machine()), clips.size(), asked.held_out.empty() ? "" : "held-out ",
             asked.sizes.width, asked.sizes.frames, asked.set.empty() ? "" : "; " + asked.set);
  std::vector<bench::Judged> judged;
  std::vector<bench::RetrievedCase> cases;
  for (std::size_t c = 0; c < clips.size(); ++c) {
    std::string why;
    const auto clip = bench::make_case(clips[c].read(), base.settings, why);
    fmt::print(stderr, "[{}/{}] {}, {:.0f} s{}\n", c + 1, clips.size(), clips[c].name,
               bench::wall_seconds() - start, clip ? "" : ": left out, " + why);
    if (!clip) continue;
    if (!clip->same_scene.empty() && clip->same_scene != std::vector{clip->name})
      fmt::print(stderr, "  left out together: {}\n", fmt::join(clip->same_scene, ", "));
    if (clip->strokes.empty()) fmt::print(stderr, "  nothing flows: no strokes\n");
    if (!tried.empty()) cases.push_back(retrieved(snapshot, base, *clip));
    for (TriedWords& one : tried) one.cases.push_back(retrieved(snapshot, one.base, *clip));
    add_references(*clip, judged);
    if (!asked.films.empty()) bench::write_film(asked.films, *clip, "real", clip->truth);
    Trial trial(snapshot, base, asked, *clip);
    const auto attempt = [&](const std::string& what, const auto& judge) {
      try {
        judged.push_back(judge());
      } catch (const Error& fault) {
        fmt::print(stderr, "  {}: {}\n", what, fault.what());
      }
    };
    const auto needs_hint = [](const bench::Method& method) {
      return method.renderer != bench::Renderer::kCarried &&
             method.renderer != bench::Renderer::kCarriedVarying &&
             method.renderer != bench::Renderer::kTransfer;
    };
    for (const bench::Method& method : methods)
      if (!needs_hint(method)) attempt(method.name, [&] { return trial.judge_unlabelled(method); });
    for (const bench::NamedHint& hint : hints)
      for (const bench::Method& method : methods)
        if (needs_hint(method))
          attempt(fmt::format("{} {}", hint.name, method.name), [&] { return trial.judge(hint, method); });
    // After each clip: a run that is broken off has shown something.
    if (!asked.html.empty()) bench::write_page(asked.html, judged, "Animated stills beside what was filmed");
    if (!asked.json_path.empty()) write_json(asked, judged);
  }
  fmt::print("{}\n{}\n{}", bench::clip_table(judged), bench::summary_table(judged),
             bench::agreement_table(bench::agreements(judged)));
  if (!tried.empty()) fmt::print("{}", bench::retrieval_table(cases));
  for (const TriedWords& one : tried) fmt::print("\n{}\n{}", one.cost, bench::retrieval_table(one.cases));
  fmt::print("\n{:.0f} s, {:.0f} s of CPU\n", bench::wall_seconds() - start, bench::process_seconds());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  Asked asked;
  bench::Arguments app(
      "Animates a still of each clip of a store from the other clips, and measures how far the result is "
      "from what the clip did");
  const auto listed = [](std::string text, const std::vector<bench::NamedSettings>& table) {
    for (const bench::NamedSettings& one : table)
      text += fmt::format("\n{} ({}): {}", one.name, one.settings, one.what);
    return text;
  };
  std::string hints = "What is said of the motion; nothing: no row of ours. Of:";
  for (const bench::NamedHint& one : bench::hints()) hints += fmt::format("\n{}: {}", one.name, one.what);
  app.option("store", asked.store, "Store of the clips, indexed").required();
  app.option("--clips", asked.clips, "Only clips whose names contain one of these [all]").split_at(',');
  app.option("--class", asked.class_name, "Only clips of this class [all]");
  app.option("--held-out", asked.held_out, "Judge these videos or folders of videos, not the store's clips");
  app.option("--limit", asked.limit, "Only so many clips, class by class in turn [all]");
  app.option("--words", asked.words,
             "What looks alone tell, by the store's codebook and by others of so many words, made here")
      .between(2, vision::kMaxWords)
      .split_at(',');
  app.option("--width", asked.sizes.width, "Longer side that a clip is reduced to, px").between(64, 8192);
  app.option("--frames", asked.sizes.frames, "Frames to animate; no more than the clip has")
      .between(24, 1000);
  app.option("--frames-made", asked.frames_made,
             "Frames to animate at least; those beyond --frames tell of reversals alone")
      .between(1, 10000);
  app.flag("--loop", asked.loop, "Animate loops, and measure MALF");
  app.option("--hints", asked.hints, hints).split_at(',');
  app.option("--methods", asked.methods,
             listed("Ways to animate, each a row for each hint, of all or nothing or:", bench::methods()))
      .split_at(',');
  app.option("--ablate", asked.ablate,
             listed("Rows with one choice changed, of all or nothing or:", bench::ablations()))
      .split_at(',');
  app.option("--try", asked.tries, "One more row, with settings as in --set; may be repeated");
  app.option("--set", asked.set, "Settings of all rows, key=value key=value:\n" + bench::setting_keys());
  app.option("--json", asked.json_path, "Figures as JSON");
  app.option("--html", asked.html,
             "Folder for a page that plays the films; it holds footage, do not share it");
  app.option("--films", asked.films,
             "Folder for the films at full size, FOLDER/CLIP/METHOD.mp4 and FOLDER/CLIP/real.mp4, as "
             "bench_blind_look takes them");
  app.parse(argc, argv);
  try {
    return run(asked);
  } catch (const freshet::Error& fault) {
    fmt::print(stderr, "{}\n", fault.what());
    return 1;
  }
}
