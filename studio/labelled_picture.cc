#include "studio/labelled_picture.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "hints/stroke_field.h"
#include "hints/svg_strokes.h"
#include "query/labelling/labelling_memo.h"
#include "query/labelling/shares.h"
#include "studio/clip_strip.h"
#include "synth/takes/pace.h"
#include "vision/look/horizon.h"

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kShown = 24;  // candidates of a piece
constexpr int kPatchSide = 96;      // px, of one that is shown playing

std::string text(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// The row of a pin's patch; nothing when the store has none such.
std::optional<stored::Row> row_of(const StoreBase& store, const Pin& pin) {
  const std::optional<store::ClipId> clip = store.snapshot.find(pin.clip);
  if (!clip) return std::nullopt;
  const stored::PatchTable& table = store.base.table;
  const auto at = std::find(table.clips.begin(), table.clips.end(), *clip);
  if (at == table.clips.end()) return std::nullopt;
  const auto index = static_cast<std::size_t>(at - table.clips.begin());
  for (stored::Row row = table.first_row[index]; row < table.first_row[index + 1]; ++row)
    if (table.variant[row] == pin.variant && table.x[row] == pin.patch.x && table.y[row] == pin.patch.y)
      return row;
  return std::nullopt;
}

/// A piece's only candidate from now on.
void pin_candidate(query::Candidates& candidates, std::size_t piece, stored::Row row) {
  const std::size_t first = piece * candidates.k;
  std::size_t from = 0;
  while (from < candidates.counts[piece] && candidates.rows[first + from] != row) ++from;
  const bool known = from < candidates.counts[piece];
  // One that was no candidate is taken as like as the best: a person has seen it, and we have not.
  candidates.scores[first] = candidates.scores[first + (known ? from : 0)];
  if (!candidates.steadiness.empty() && known)
    candidates.steadiness[first] = candidates.steadiness[first + from];
  candidates.rows[first] = row;
  std::fill(candidates.rows.begin() + static_cast<std::ptrdiff_t>(first + 1),
            candidates.rows.begin() + static_cast<std::ptrdiff_t>(first + candidates.k), stored::kNoRow);
  candidates.counts[piece] = 1;
}

std::vector<bool> pin_pieces(const StoreBase& store, const Document& document,
                             query::CandidateSearch& search) {
  std::vector<bool> pinned(search.target.size(), false);
  for (const Pin& pin : document.pins) {
    const auto at = std::find(search.target.corners.begin(), search.target.corners.end(), pin.corner);
    const std::optional<stored::Row> row = row_of(store, pin);
    if (at == search.target.corners.end() || !row)
      continue;  // it sleeps until its piece or its clip is there again
    const auto piece = static_cast<std::size_t>(at - search.target.corners.begin());
    pin_candidate(search.candidates, piece, *row);
    pinned[piece] = true;
  }
  return pinned;
}

cv::Rect patch_of(const LabelledPicture& labelled, stored::Row row) {
  const stored::PatchTable& table = labelled.store->base.table;
  const int side = labelled.labelling.search.target.side;
  return {table.x[row], table.y[row], side, side};
}

Json candidate_json(const LabelledPicture& labelled, stored::Row row, float score) {
  const stored::PatchTable& table = labelled.store->base.table;
  const std::vector<vision::Variant> variants = labelled.store->base.settings.variants();
  const vision::Variant& variant = variants[table.variant[row]];
  const store::ClipRecord& clip = labelled.store->snapshot.clip(table.clips[table.clip[row]]);
  Json corners = Json::array();
  for (const cv::Point2d& corner : patch_in_clip(clip, variant, patch_of(labelled, row)))
    corners.push_back({corner.x, corner.y});
  return {{"clip", clip.name},        {"clip_index", table.clip[row]},
          {"class", clip.class_name}, {"licence", clip.licence},
          {"score", score},           {"variant", table.variant[row]},
          {"scale", variant.scale},   {"rotation", variant.rotation_deg},
          {"flip", variant.flip},     {"x", table.x[row]},
          {"y", table.y[row]},        {"corners", corners}};
}

/// How fast it plays (Document::speed) to be slow, natural or fast, as --speed of the command line has it.
Json paces_json(const LabelledPicture& labelled) {
  const query::Assignment& assignment = labelled.labelling.assignment;
  const std::string kind = query::largest_class(assignment).name;
  Json paces = Json::object();
  paces["auto"] = own_pace(labelled);
  for (const char* const pace : {"slow", "natural", "fast"})
    paces[pace] = synth::takes::factor_of(pace, kind, labelled.filmed_speed, assignment.picture);
  return paces;
}

/// As `looks_like` of the command line.
Json kind_json(const query::KindChoice& kind) {
  return {{"class", kind.look.name()},
          {"share", kind.look.sureness()},
          {"sure", kind.look.sure()},
          {"only", kind.taken.empty() ? Json() : Json(kind.taken)}};
}

}  // namespace

double own_pace(const LabelledPicture& labelled) {
  if (!labelled.request.options.guide.speed.empty()) return 1;
  const query::Assignment& assignment = labelled.labelling.assignment;
  return synth::takes::factor_of("auto", query::largest_class(assignment).name, labelled.filmed_speed,
                                 assignment.picture);
}

query::LabelRequest request_of(const Document& document, cv::Size picture,
                               const std::optional<Horizon>& horizon) {
  query::LabelRequest request{
      .options = {}, .piece_scale = {}, .duration_s = document.frames / document.fps, .guesses = true};
  request.options.candidates.class_name = document.class_name;
  request.options.candidates.excluded_clips = document.excluded_clips;
  request.options.hint_search = query::HintSearch::kWide;
  request.options.guide_costs = query::default_guide_costs(query::HintSearch::kWide);
  request.options.guide.horizon = horizon;
  request.options.guide.tolerance_deg = request.options.candidates.direction_tolerance_deg;
  if (!flow_strokes(document, picture).empty()) {
    // By way of the file that the command line will read, so that both see the same numbers.
    const std::string svg = strokes_svg(document, picture);
    const hints::StrokeField field = hints::interpolate(
        hints::read_svg_strokes(svg, "strokes", picture, nullptr), picture, "strokes", {.horizon = horizon});
    request.options.guide.direction = field.direction;
    request.options.guide.speed = field.speed;
  }
  return request;
}

LabelledPicture label_picture(std::shared_ptr<const StoreBase> store, const cv::Mat& picture,
                              const cv::Mat& matte, const cv::Mat& whole_matte, const Document& document,
                              cache::ResultCache* cache, const Job& job) {
  LabelledPicture labelled{.store = std::move(store),
                           .request = {},
                           .kind = {},
                           .labelling = {},
                           .pinned = {},
                           .notices = {},
                           .filmed_speed = {}};
  const store::Snapshot& snapshot = labelled.store->snapshot;
  const query::SearchBase& base = labelled.store->base;
  std::optional<query::LabellingMemo> memo;
  if (cache != nullptr) memo.emplace(*cache, snapshot, base);
  query::LabellingMemo* const known = memo ? &*memo : nullptr;

  // With pins the command line reads an assignment, and no class.
  labelled.request = request_of(
      document, picture.size(),
      document.horizon == "auto"
          ? vision::horizon_of_water(picture, matte, document.pins.empty() ? document.class_name : "")
          : std::nullopt);
  labelled.request.looked_at = whole_matte;
  const query::PreparedLabelling prepared =
      query::prepare(snapshot, base, picture, matte, labelled.request, job.progress, job.stop, known);
  query::CandidateSearch search = query::search_candidates(snapshot, base, picture, matte, prepared.options,
                                                           job.progress, job.stop, known);
  labelled.pinned = pin_pieces(*labelled.store, document, search);
  labelled.labelling =
      query::label(snapshot, std::move(search), prepared.options, job.progress, job.stop, known);

  labelled.kind = prepared.kind;
  if (!prepared.guess.empty()) labelled.notices.push_back(prepared.guess);
  const query::CandidateSearch& found = labelled.labelling.search;
  if (!found.filtered.too_short.empty())
    labelled.notices.push_back(fmt::format("left out, as they are too short and have no loop: {}",
                                           fmt::join(found.filtered.too_short, ", ")));
  const query::Assignment& assignment = labelled.labelling.assignment;
  if (const std::string warning = query::shares_warning(assignment, query::largest_shares(assignment));
      !warning.empty())
    labelled.notices.push_back(warning);
  labelled.filmed_speed = synth::takes::filmed_speed(snapshot, base.settings, assignment, matte);
  return labelled;
}

std::string pieces_json(const LabelledPicture& labelled) {
  const query::Assignment& assignment = labelled.labelling.assignment;
  const double scale = assignment.piece_scale;
  Json json{{"side", assignment.side * scale},  {"energy", assignment.energy},
            {"notices", labelled.notices},      {"paces", paces_json(labelled)},
            {"kind", kind_json(labelled.kind)}, {"clips", Json::array()},
            {"pieces", Json::array()}};
  if (std::isfinite(assignment.gap())) json["gap"] = assignment.gap();
  std::vector<std::size_t> used(assignment.clips.size());
  for (std::size_t i = 0; i < assignment.pieces.size(); ++i) {
    const query::AssignedPiece& piece = assignment.pieces[i];
    ++used[piece.clip];
    const float margin = labelled.labelling.margins[i];
    json["pieces"].push_back({piece.corner.x * scale, piece.corner.y * scale, piece.clip, piece.score,
                              static_cast<bool>(labelled.pinned[i]),
                              std::isfinite(margin) ? Json(margin) : Json()});
  }
  for (std::size_t i = 0; i < assignment.clips.size(); ++i)
    json["clips"].push_back({{"name", assignment.clips[i].name},
                             {"class", assignment.clips[i].class_name},
                             {"licence", assignment.clips[i].licence},
                             {"pieces", used[i]}});
  return text(json);
}

std::string candidates_json(const LabelledPicture& labelled, std::size_t piece) {
  const query::CandidateSearch& search = labelled.labelling.search;
  if (piece >= search.target.size())
    throw Error(ErrorKind::kNotFound, "piece", fmt::format("there is no piece {}", piece));
  const auto rows = search.candidates.rows_of(piece);
  const auto scores = search.candidates.scores_of(piece);
  const std::size_t chosen = labelled.labelling.labels[piece];
  const cv::Point corner = search.target.corners[piece];
  Json json{{"piece", piece},
            {"x", corner.x},
            {"y", corner.y},
            {"chosen", chosen},
            {"pinned", static_cast<bool>(labelled.pinned[piece])},
            {"candidates", Json::array()}};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i >= kShown && i != chosen) continue;
    json["candidates"].push_back(candidate_json(labelled, rows[i], scores[i]));
    json["candidates"].back()["place"] = i;
  }
  return text(json);
}

std::string candidate_strip(const LabelledPicture& labelled, std::size_t piece, std::size_t candidate) {
  const query::CandidateSearch& search = labelled.labelling.search;
  if (piece >= search.target.size() || candidate >= search.candidates.counts[piece])
    throw Error(ErrorKind::kNotFound, "candidate", "there is no such candidate");
  const stored::Row row = search.candidates.rows_of(piece)[candidate];
  const stored::PatchTable& table = labelled.store->base.table;
  const ClipSamples::Frames frames = labelled.store->samples->frames(table.clips[table.clip[row]]);
  return encoded(patch_strip(*frames, labelled.store->base.settings.variants()[table.variant[row]],
                             patch_of(labelled, row), kPatchSide));
}

std::string credits(const LabelledPicture& labelled) {
  const query::Assignment& assignment = labelled.labelling.assignment;
  std::vector<std::size_t> used(assignment.clips.size());
  for (const query::AssignedPiece& piece : assignment.pieces) ++used[piece.clip];
  std::string text = "Animated with Freshet, from these clips:\n\n";
  for (std::size_t i = 0; i < assignment.clips.size(); ++i) {
    const query::AssignedClip& clip = assignment.clips[i];
    text += fmt::format("{:5.1f} %  {}  ({})\n",
                        100.0 * static_cast<double>(used[i]) /
                            static_cast<double>(std::max<std::size_t>(1, assignment.pieces.size())),
                        clip.name, clip.licence.empty() ? "no licence recorded" : clip.licence);
  }
  return text;
}

}  // namespace freshet::studio
