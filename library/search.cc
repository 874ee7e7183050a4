#include "freshet/search.h"

#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "freshet/error.h"
#include "hints/stroke_field.h"
#include "hints/strokes.h"
#include "library/opencv_threads.h"
#include "library/states.h"
#include "synth/matte/held.h"
#include "vision/look/horizon.h"

namespace freshet {

MotionGuide read_strokes(const std::filesystem::path& path, cv::Size picture,
                         std::vector<std::string>* notices, const std::optional<Horizon>& horizon) {
  const hints::StrokeField field = hints::interpolate(hints::read_strokes(path, picture, notices), picture,
                                                      path.string(), {.horizon = horizon});
  if (notices && !field.clash.empty()) notices->push_back(field.clash);
  return {.direction = field.direction, .speed = field.speed, .horizon = horizon};
}

std::optional<Horizon> find_horizon(const cv::Mat& picture, const cv::Mat& matte,
                                    const std::string& class_name) {
  check_picture(picture, matte);
  return matte.empty() ? std::nullopt : vision::horizon_of_water(picture, matte, class_name);
}

void check_picture(const cv::Mat& picture, const cv::Mat& matte) {
  if (picture.empty() || picture.type() != CV_8UC3 ||
      (!matte.empty() && (matte.type() != CV_8U || matte.size() != picture.size())))
    throw Error(ErrorKind::kUsage, "picture and matte",
                "8-bit BGR and 8-bit grey of the same size are expected");
}

void check_count(int k) {
  if (k < 1 || k > 10000)
    throw Error(ErrorKind::kUsage, "number of candidates", fmt::format("{}; 1 to 10000 expected", k));
}

std::string horizon_words(const Horizon& horizon) {
  return fmt::format(
      "the matte's upper border is straight, row {:.0f} to {:.0f}: towards it the water goes slower",
      horizon.from.y, horizon.to.y);
}

Search search(const Store& store, const cv::Mat& picture, const cv::Mat& matte, const SearchOptions& options,
              const Job& job) {
  check_picture(picture, matte);
  if (options.frames < 1 || !(options.fps >= 1 && options.fps <= 240))
    throw Error(ErrorKind::kUsage, "length of the animation",
                fmt::format("{} frames at {:g} per second, and at least 1 at 1 to 240 are expected",
                            options.frames, options.fps));
  const OneOpenCvThread one;
  Search::Impl state{.store = store,
                     .base = nullptr,
                     .picture = picture.clone(),
                     .matte = matte.empty() ? cv::Mat(picture.size(), CV_8U, cv::Scalar(255)) : matte.clone(),
                     .held = options.held.clone(),
                     .frames = options.frames,
                     .fps = options.fps,
                     .kind = {},
                     .request = {.options = {},
                                 .piece_scale = options.piece_scale,
                                 .duration_s = options.frames / options.fps,
                                 .guesses = options.guess},
                     .options = {},
                     .found = {},
                     .notices = {}};
  if (!state.held.empty()) {
    if (state.held.size() != state.matte.size() || state.held.type() != CV_8U)
      throw Error(ErrorKind::kUsage, "what is held", "CV_8U of the picture's size is expected");
    state.request.looked_at = state.matte;
    state.matte = synth::matte::less_held(state.matte, state.held, "what is held");
  }
  query::CandidateOptions& candidates = state.request.options.candidates;
  candidates.k = options.candidates;
  candidates.class_name = options.class_name;
  candidates.direction_deg = options.direction_deg;
  candidates.direction_tolerance_deg = options.direction_tolerance_deg;
  candidates.excluded_clips = options.excluded_clips;
  state.request.options.guide = options.guide;
  std::optional<Horizon>& horizon = state.request.options.guide.horizon;
  if (options.horizon && !horizon) {
    horizon = find_horizon(state.picture, state.matte, options.class_name);
    if (horizon) state.notices.push_back(horizon_words(*horizon));
  }
  state.request.options.hint_search = options.narrow ? query::HintSearch::kNarrow : query::HintSearch::kWide;
  state.request.options.guide_costs = query::default_guide_costs(state.request.options.hint_search);

  const store::Snapshot& snapshot = store.impl().snapshot;
  if (job.progress) job.progress({"reading the index", 0, 0});
  state.base = store.impl().search_base();
  query::PreparedLabelling prepared = query::prepare(snapshot, *state.base, state.picture, state.matte,
                                                     state.request, job.progress, job.stop);
  state.options = prepared.options;
  state.found = query::search_candidates(snapshot, *state.base, state.picture, state.matte, state.options,
                                         job.progress, job.stop);
  if (!prepared.kind.words.empty()) state.notices.push_back(prepared.kind.words);
  state.kind = std::move(prepared.kind);
  if (!prepared.guess.empty()) state.notices.push_back(std::move(prepared.guess));
  if (const auto& short_ones = state.found.filtered.too_short; !short_ones.empty())
    state.notices.push_back(fmt::format("left out, as they do not last {:.2f} s and have no loop rule: {}",
                                        state.request.duration_s, fmt::join(short_ones, ", ")));
  const std::vector<std::string>& notes = state.found.candidates.notes;
  state.notices.insert(state.notices.end(), notes.begin(), notes.end());
  return Search(std::make_shared<const Search::Impl>(std::move(state)));
}

std::size_t Search::pieces() const { return impl_->found.target.size(); }

cv::Rect2d Search::area(std::size_t piece) const {
  const query::Target& target = impl_->found.target;
  const cv::Point corner = target.corners.at(piece);
  const double scale = impl_->found.piece_scale;
  return {corner.x * scale, corner.y * scale, target.side * scale, target.side * scale};
}

std::vector<Candidate> Search::candidates(std::size_t piece) const {
  const query::CandidateSearch& found = impl_->found;
  const store::Snapshot& snapshot = impl_->store.impl().snapshot;
  const auto rows = found.candidates.rows_of(piece);
  const auto scores = found.candidates.scores_of(piece);
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < rows.size(); ++i)
    candidates.push_back(
        {.clip = snapshot.clip(found.table().clips[found.table().clip[rows[i]]]).name, .score = scores[i]});
  return candidates;
}

PatchTable Search::candidates() const {
  const query::Candidates& found = impl_->found.candidates;
  const auto pieces = static_cast<int>(found.pieces()), k = static_cast<int>(found.k);
  PatchTable table{cv::Mat(pieces, k, CV_32S, cv::Scalar(-1)), cv::Mat::zeros(pieces, k, CV_32F)};
  for (int piece = 0; piece < pieces; ++piece) {
    const auto rows = found.rows_of(static_cast<std::size_t>(piece));
    const auto scores = found.scores_of(static_cast<std::size_t>(piece));
    for (int i = 0; i < static_cast<int>(rows.size()); ++i) {
      table.patches.at<int>(piece, i) = static_cast<int>(rows[static_cast<std::size_t>(i)]);
      table.scores.at<float>(piece, i) = scores[static_cast<std::size_t>(i)];
    }
  }
  return table;
}

std::vector<std::string> Search::notices() const { return impl_->notices; }

}  // namespace freshet
