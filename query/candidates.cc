#include "query/candidates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "freshet_error.h"
#include "query/exact_index.h"

namespace freshet::query {
namespace {

// From the first frame to the end of the last, by the frames' own times: a header's rate may be a guess, and
// a clip that a labelling has chosen must last as long as it was taken to.
double duration_s(const store::Snapshot& snapshot, const store::ClipRecord& clip) {
  if (clip.fps_num <= 0 || clip.fps_den <= 0) return 0;
  const double interval = static_cast<double>(clip.fps_den) / static_cast<double>(clip.fps_num);
  const auto id = snapshot.find(clip.name);
  if (!id || !snapshot.has_column(*id, "frame.time")) return clip.frame_count * interval;
  const std::vector<double> times = snapshot.column<double>(*id, "frame.time");
  return times.empty() ? 0 : times.back() - times.front() + interval;
}

// Takes conditions one after another and counts what each leaves.
class Narrowing {
 public:
  Narrowing(const store::Snapshot& snapshot, const PatchTable& table) : snapshot_(snapshot), table_(table) {
    filtered_.rows = RowFilter(table.size());
    note("all");
  }

  template <class Keep>
  void clips(const std::string& what, Keep&& keep) {
    for (std::size_t c = 0; c < table_.clips.size(); ++c) {
      if (keep(snapshot_.clip(table_.clips[c]), has_rows(c))) continue;
      for (Row row = table_.first_row[c]; row < table_.first_row[c + 1]; ++row) filtered_.rows.forbid(row);
    }
    note(what);
  }

  template <class Keep>
  void patches(const std::string& what, Keep&& keep) {
    for (Row row = 0; row < table_.size(); ++row) {
      if (filtered_.rows.allows(row) && !keep(row)) filtered_.rows.forbid(row);
    }
    note(what);
  }

  bool none_left() const { return filtered_.steps.back().patches == 0; }
  Filtered& result() { return filtered_; }

 private:
  bool has_rows(std::size_t c) const {
    for (Row row = table_.first_row[c]; row < table_.first_row[c + 1]; ++row) {
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
  const PatchTable& table_;
  Filtered filtered_;
};

std::string classes_of(const store::Snapshot& snapshot, const PatchTable& table) {
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

Filtered filter_rows(const store::Snapshot& snapshot, const PatchTable& table,
                     const CandidateOptions& options) {
  if (options.direction_deg) check_range("direction", *options.direction_deg, -360, 360);
  check_range("direction tolerance", options.direction_tolerance_deg, 0, 180);
  check_range("shortest duration", options.min_duration_s, 0, 1e6);
  Narrowing narrowing(snapshot, table);

  if (!options.excluded_clips.empty()) {
    for (const std::string& name : options.excluded_clips) {
      if (!snapshot.find(name)) {
        throw Error(ErrorKind::kNotFound, snapshot.path().string(),
                    "it holds no clip named \"" + name + "\" that could be left out",
                    "freshet store info lists its clips");
      }
    }
    narrowing.clips("without excluded clips", [&](const store::ClipRecord& clip, bool) {
      return std::find(options.excluded_clips.begin(), options.excluded_clips.end(), clip.name) ==
             options.excluded_clips.end();
    });
    if (narrowing.none_left()) {
      throw Error(ErrorKind::kNotFound, snapshot.path().string(), "all clips with patches are excluded",
                  "Exclude fewer");
    }
  }

  if (!options.class_name.empty()) {
    narrowing.clips("class " + options.class_name, [&](const store::ClipRecord& clip, bool) {
      return clip.class_name == options.class_name;
    });
    if (narrowing.none_left()) {
      throw Error(ErrorKind::kNotFound, snapshot.path().string(),
                  "no patch of class \"" + options.class_name + "\"",
                  "The store has the classes " + classes_of(snapshot, table));
    }
  }

  if (options.min_duration_s > 0) {
    double longest = 0;
    narrowing.clips(fmt::format("at least {:g} s long", options.min_duration_s),
                    [&](const store::ClipRecord& clip, bool still_in) {
                      if (!still_in) return false;
                      // Stamps are often whole milliseconds: one is forgiven.
                      const double seconds = duration_s(snapshot, clip) + 1e-3;
                      longest = std::max(longest, seconds);
                      if (seconds >= options.min_duration_s) return true;
                      narrowing.result().too_short.push_back(clip.name);
                      return false;
                    });
    if (narrowing.none_left()) {
      throw Error(
          ErrorKind::kNotFound, snapshot.path().string(),
          fmt::format("no clip of at least {:g} s, which the animation lasts; the longest has {:.2f} s",
                      options.min_duration_s, longest),
          "Ask for fewer frames, or ingest longer clips");
    }
  }

  if (options.direction_deg) {
    const double wanted = *options.direction_deg * std::numbers::pi / 180;
    const double least_cosine = std::cos(options.direction_tolerance_deg * std::numbers::pi / 180) - 1e-9;
    const double to_u = std::cos(wanted), to_v = -std::sin(wanted);  // y points down in a frame
    narrowing.patches(fmt::format("direction {:g} +- {:g} degrees", *options.direction_deg,
                                  options.direction_tolerance_deg),
                      [&](Row row) {
                        const double u = table.mean_u[row], v = table.mean_v[row], speed = std::hypot(u, v);
                        return speed >= options.min_speed_px_per_s &&
                               u * to_u + v * to_v >= least_cosine * speed;
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

std::unique_ptr<CandidateIndex> open_index(const store::Snapshot& snapshot, const PatchTable& table,
                                           int word_count, const CandidateOptions& options) {
  if (!options.flann) return std::make_unique<ExactIndex>(table.words, word_count);
  const auto bytes = snapshot.blob(blob_name(*options.flann));
  if (!bytes) {
    throw Error(
        ErrorKind::kNotFound, snapshot.path().string(),
        std::string("it has no FLANN index ") + name_of(*options.flann),
        std::string("Run freshet index --flann ") + name_of(*options.flann) + ", or use exact search");
  }
  FlannOptions flann_options = options.flann_options;
  flann_options.kind = *options.flann;
  return std::make_unique<FlannIndex>(table.words, word_count, *bytes, flann_options);
}

Candidates find_candidates(const CandidateIndex& index, std::span<const PieceQuery> queries, std::size_t k,
                           const RowFilter& filter) {
  if (k < 1 || k > 65535) {
    throw Error(ErrorKind::kUsage, "number of candidates",
                fmt::format("{} is out of range, 1 to 65535 expected", k));
  }
  const auto answers = index.search(queries, k, &filter);
  Candidates candidates;
  candidates.k = k;
  candidates.rows.assign(queries.size() * k, kNoRow);
  candidates.scores.assign(queries.size() * k, 0);
  std::size_t short_of = 0;
  for (std::size_t piece = 0; piece < queries.size(); ++piece) {
    if (answers[piece].empty()) {
      throw Error(ErrorKind::kNotFound, "candidates", fmt::format("the index found none for piece {}", piece),
                  "Use exact search, more checks, or fewer conditions");
    }
    const auto full = static_cast<float>(mass(queries[piece]));
    for (std::size_t i = 0; i < answers[piece].size(); ++i) {
      candidates.rows[piece * k + i] = answers[piece][i].row;
      candidates.scores[piece * k + i] = static_cast<float>(answers[piece][i].score) / full;
    }
    candidates.counts.push_back(static_cast<std::uint32_t>(answers[piece].size()));
    short_of += answers[piece].size() < k;
  }
  if (short_of > 0) {
    candidates.notes.push_back(
        fmt::format("{} of {} pieces have fewer than {} candidates", short_of, queries.size(), k));
  }
  return candidates;
}

}  // namespace freshet::query
