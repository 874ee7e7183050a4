#include "query/search/candidates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include "freshet/error.h"
#include "platform/likeness.h"
#include "stored/clip_metadata.h"
#include "stored/clip_schema.h"

namespace freshet::query {
namespace {

// From the first frame to the end of the last, by the frames' own times: a header's rate may be a guess, and
// a clip that a labelling has chosen must last as long as it was taken to.
double duration_s(const store::Snapshot& snapshot, store::ClipId id) {
  const store::ClipRecord& clip = snapshot.clip(id);
  if (clip.fps_num <= 0 || clip.fps_den <= 0) return 0;
  const double interval = static_cast<double>(clip.fps_den) / static_cast<double>(clip.fps_num);
  if (!stored::kFrameTime.is_in(snapshot, id)) return clip.frame_count * interval;
  const std::vector<double> times = stored::kFrameTime.read(snapshot, id);
  return times.empty() ? 0 : times.back() - times.front() + interval;
}

// Takes conditions one after another and counts what each leaves.
class Narrowing {
 public:
  Narrowing(const store::Snapshot& snapshot, const stored::PatchTable& table)
      : snapshot_(snapshot), table_(table) {
    filtered_.rows = RowFilter(table.size());
    note("all");
  }

  template <class Keep>
  void clips(const std::string& what, Keep&& keep) {
    for (std::size_t c = 0; c < table_.clips.size(); ++c) {
      if (keep(table_.clips[c], has_rows(c))) continue;
      for (stored::Row row = table_.first_row[c]; row < table_.first_row[c + 1]; ++row)
        filtered_.rows.forbid(row);
    }
    note(what);
  }

  template <class Keep>
  void patches(const std::string& what, Keep&& keep) {
    for (stored::Row row = 0; row < table_.size(); ++row) {
      if (filtered_.rows.allows(row) && !keep(row)) filtered_.rows.forbid(row);
    }
    note(what);
  }

  bool none_left() const { return filtered_.steps.back().patches == 0; }
  Filtered& result() { return filtered_; }

 private:
  bool has_rows(std::size_t c) const {
    for (stored::Row row = table_.first_row[c]; row < table_.first_row[c + 1]; ++row) {
      if (filtered_.rows.allows(row)) return true;
    }
    return false;
  }
  void note(const std::string& what) {
    FilterStep step{what, filtered_.rows.count(), 0};
    for (std::size_t c = 0; c < table_.clips.size(); ++c) step.clips += has_rows(c);
    filtered_.steps.push_back(step);
  }

  const store::Snapshot& snapshot_;
  const stored::PatchTable& table_;
  Filtered filtered_;
};

std::string classes_of(const store::Snapshot& snapshot, const stored::PatchTable& table) {
  std::set<std::string> names;
  for (const store::ClipId clip : table.clips) names.insert(snapshot.clip(clip).class_name);
  return fmt::format("{}", fmt::join(names, ", "));
}

void check_range(const char* option, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw Error(ErrorKind::kUsage, option,
              fmt::format("{} is out of range, {} to {} expected", value, low, high));
}

}  // namespace

double parse_direction(const std::string& text) {
  constexpr std::pair<const char*, double> kNames[] = {
      {"right", 0},  {"up-right", 45},   {"up", 90},    {"up-left", 135},
      {"left", 180}, {"down-left", 225}, {"down", 270}, {"down-right", 315}};
  for (const auto& [name, degrees] : kNames) {
    if (text == name) return degrees;
  }
  try {
    std::size_t used = 0;
    const double degrees = std::stod(text, &used);
    if (used == text.size() && degrees >= -360 && degrees <= 360) return degrees;
  } catch (const std::exception&) {
  }
  throw Error(ErrorKind::kUsage, "direction \"" + text + "\"", "not a direction",
              "Use right, up, left, down, up-left, ... or degrees: 0 right, 90 up");
}

void check_names(const store::Snapshot& snapshot, const CandidateOptions& options) {
  std::set<std::string> clips, classes;
  for (const store::ClipId id : snapshot.clips()) {
    const store::ClipRecord clip = snapshot.clip(id);
    clips.insert(clip.name);
    classes.insert(clip.class_name);
  }
  const auto refuse = [&](const std::string& fault, const std::string& remedy) {
    throw Error(ErrorKind::kNotFound, snapshot.path().string(), fault, remedy);
  };
  for (const std::string& name : options.excluded_clips)
    if (!clips.contains(name))
      refuse("it holds no clip named \"" + name + "\" that could be left out",
             did_you_mean(name, clips) + "freshet store info lists its clips");
  if (const std::string& name = options.class_name;
      !name.empty() && name != kAnyClass && !classes.contains(name))
    refuse(
        "no clip of class \"" + name + "\"",
        did_you_mean(name, classes) + fmt::format("The store has the classes {}", fmt::join(classes, ", ")));
}

Filtered filter_rows(const store::Snapshot& snapshot, const stored::PatchTable& table,
                     std::span<const vision::Variant> variants, const CandidateOptions& options) {
  if (options.direction_deg) check_range("direction", *options.direction_deg, -360, 360);
  check_range("direction tolerance", options.direction_tolerance_deg, 0, 180);
  check_range("shortest duration", options.min_duration_s, 0, 1e6);
  check_names(snapshot, options);
  Narrowing narrowing(snapshot, table);

  if (!options.excluded_clips.empty()) {
    narrowing.clips("without excluded clips", [&](store::ClipId id, bool) {
      return std::find(options.excluded_clips.begin(), options.excluded_clips.end(),
                       snapshot.clip(id).name) == options.excluded_clips.end();
    });
    if (narrowing.none_left()) {
      throw Error(ErrorKind::kNotFound, snapshot.path().string(), "all clips with patches are excluded",
                  "Exclude fewer");
    }
  }

  if (!options.class_name.empty() && options.class_name != kAnyClass) {
    narrowing.clips("class " + options.class_name, [&](store::ClipId id, bool) {
      return snapshot.clip(id).class_name == options.class_name;
    });
    if (narrowing.none_left()) {
      throw Error(ErrorKind::kNotFound, snapshot.path().string(),
                  "no patch of class \"" + options.class_name + "\"",
                  "The store has the classes " + classes_of(snapshot, table));
    }
  }

  if (options.min_duration_s > 0) {
    double longest = 0;
    narrowing.clips(fmt::format("at least {:g} s long, or looped", options.min_duration_s),
                    [&](store::ClipId id, bool still_in) {
                      if (!still_in) return false;
                      if (stored::metadata_of(snapshot, id).loop) return true;
                      // Stamps are often whole milliseconds: one is forgiven.
                      const double seconds = duration_s(snapshot, id) + 1e-3;
                      longest = std::max(longest, seconds);
                      if (seconds >= options.min_duration_s) return true;
                      narrowing.result().too_short.push_back(snapshot.clip(id).name);
                      return false;
                    });
    if (narrowing.none_left()) {
      throw Error(
          ErrorKind::kNotFound, snapshot.path().string(),
          fmt::format("no clip of at least {:g} s, which the animation lasts, and none with a loop rule; the "
                      "longest has {:.2f} s",
                      options.min_duration_s, longest),
          "Ask for fewer frames, or ingest longer clips; ingest them again if the store is older than loop "
          "rules");
    }
  }

  if (options.min_scale > 0 || options.max_rotation_deg < 180) {
    narrowing.patches(fmt::format("scale of at least {:g}, turned by {:g} degrees at most", options.min_scale,
                                  options.max_rotation_deg),
                      [&](stored::Row row) {
                        const vision::Variant& variant = variants[table.variant[row]];
                        return variant.scale >= options.min_scale &&
                               std::abs(variant.rotation_deg) <= options.max_rotation_deg;
                      });
    if (narrowing.none_left())
      throw Error(ErrorKind::kNotFound, snapshot.path().string(),
                  fmt::format("no patch has a scale of at least {:g} and is turned by {:g} degrees at most",
                              options.min_scale, options.max_rotation_deg),
                  "Allow smaller scales and larger rotations; freshet store info says which there are");
  }

  if (options.direction_deg) {
    const double wanted = *options.direction_deg * std::numbers::pi / 180;
    const double min_cosine = std::cos(options.direction_tolerance_deg * std::numbers::pi / 180) - 1e-9;
    const double to_u = std::cos(wanted), to_v = -std::sin(wanted);  // y points down in a frame
    narrowing.patches(fmt::format("direction {:g} +- {:g} degrees", *options.direction_deg,
                                  options.direction_tolerance_deg),
                      [&](stored::Row row) {
                        const double u = table.mean_u[row], v = table.mean_v[row], speed = std::hypot(u, v);
                        return speed >= options.min_speed_px_per_s &&
                               u * to_u + v * to_v >= min_cosine * speed;
                      });
    if (narrowing.none_left()) {
      throw Error(ErrorKind::kNotFound, snapshot.path().string(),
                  fmt::format("no patch moves in direction {:g} degrees (0 right, 90 up) within {:g}",
                              *options.direction_deg, options.direction_tolerance_deg),
                  "Allow a greater tolerance, or ingest clips that move so");
    }
  }
  return std::move(narrowing.result());
}

namespace {

// What pieces' tolerances were opened for, in a sentence; empty when none was.
std::string opening_note(const Candidates& candidates, const Target& target, const MotionGuide& guide) {
  std::size_t opened = 0;
  int maximum = 0;
  cv::Rect where;
  for (std::size_t piece = 0; piece < candidates.opened.size(); ++piece) {
    if (candidates.opened[piece] == 0) continue;
    ++opened;
    maximum = std::max(maximum, candidates.opened[piece]);
    where |=
        cv::Rect(target.corners[piece], cv::Size(target.side, target.side)) & cv::Rect({}, target.picture);
  }
  if (opened == 0) return {};
  const auto text_of = [&](int steps) {
    const MotionWindow window = window_of({{1, 0}, 1}, guide, steps);
    std::string text;
    if (!guide.direction.empty())
      text += window.u == 0
                  ? "any direction"
                  : fmt::format("{:.0f} degrees", std::acos(window.min_cosine) * 180 / std::numbers::pi);
    if (!guide.speed.empty())
      text += (text.empty() ? "" : ", ") + (std::isinf(window.max_speed)
                                                ? std::string("any speed")
                                                : fmt::format("a ratio of {:.2g}", 1 / window.min_speed));
    return text;
  };
  return fmt::format(
      "{} of {} pieces had too few candidates that move as asked; their tolerance was opened, at "
      "most to {} (within x {}..{}, y {}..{})",
      opened, target.size(), text_of(maximum), where.x, where.br().x, where.y, where.br().y);
}

// Searches the given pieces, opening the tolerances of those that find too few.
void search_pieces(const CandidateIndex& index, const stored::PatchTable& table, const Target& target,
                   std::size_t k, const RowFilter& filter, const MotionGuide& guide,
                   std::span<const PieceMotion> asked, std::vector<std::size_t> open,
                   std::vector<std::optional<PieceAnswer>>& answers) {
  for (int steps = 0; !open.empty(); ++steps) {
    std::vector<PieceQuery> queries;
    std::vector<MotionWindow> windows;
    for (const std::size_t piece : open) {
      queries.push_back(target.queries[piece]);
      if (!asked.empty()) windows.push_back(window_of(asked[piece], guide, steps));
    }
    SearchFilter search_filter{.rows = &filter, .mean_u = {}, .mean_v = {}, .windows = windows};
    if (!windows.empty()) {
      search_filter.mean_u = table.mean_u;
      search_filter.mean_v = table.mean_v;
    }
    auto found = index.search(queries, k, search_filter);
    std::vector<std::size_t> short_of;
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (found[i].size() < k && !windows.empty() && !windows[i].is_any()) short_of.push_back(open[i]);
      answers[open[i]] = {std::move(found[i]), steps};
    }
    open = std::move(short_of);
  }
}

}  // namespace

Candidates find_candidates(const CandidateIndex& index, const stored::PatchTable& table, const Target& target,
                           const cv::Mat& matte, std::size_t k, const RowFilter& filter,
                           const MotionGuide& guide, std::vector<std::optional<PieceAnswer>>* answers) {
  if (k < 1 || k > 65535) {
    throw Error(ErrorKind::kUsage, "number of candidates",
                fmt::format("{} is out of range, 1 to 65535 expected", k));
  }
  const std::size_t pieces = target.size();
  Candidates candidates;
  candidates.k = k;
  std::vector<std::optional<PieceAnswer>> own(answers == nullptr ? pieces : 0);
  if (answers == nullptr) answers = &own;
  assert(answers->size() == pieces);
  if (!guide.empty()) candidates.asked = asked_motion(guide, target, matte);
  std::vector<std::size_t> open;  // pieces still to be searched
  for (std::size_t piece = 0; piece < pieces; ++piece)
    if (!(*answers)[piece]) open.push_back(piece);
  search_pieces(index, table, target, k, filter, guide, candidates.asked, std::move(open), *answers);
  if (!guide.empty()) {
    for (const auto& answer : *answers) candidates.opened.push_back(answer->opened);
    if (std::string note = opening_note(candidates, target, guide); !note.empty())
      candidates.notes.push_back(std::move(note));
  }
  candidates.rows.assign(pieces * k, stored::kNoRow);
  candidates.scores.assign(pieces * k, 0);
  std::size_t short_of = 0;
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const std::vector<ScoredPatch>& scored_patches = (*answers)[piece]->scored_patches;
    if (scored_patches.empty()) {
      throw Error(ErrorKind::kNotFound, "candidates", fmt::format("the index found none for piece {}", piece),
                  "Use exact search, more checks, or fewer conditions");
    }
    const auto full = static_cast<float>(max_score(target.queries[piece]));
    for (std::size_t i = 0; i < scored_patches.size(); ++i) {
      candidates.rows[piece * k + i] = scored_patches[i].row;
      candidates.scores[piece * k + i] = static_cast<float>(scored_patches[i].score) / full;
    }
    candidates.counts.push_back(static_cast<std::uint32_t>(scored_patches.size()));
    short_of += scored_patches.size() < k;
  }
  if (short_of > 0) {
    candidates.notes.push_back(
        fmt::format("{} of {} pieces have fewer than {} candidates", short_of, pieces, k));
  }
  return candidates;
}

}  // namespace freshet::query
