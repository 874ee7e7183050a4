#include "query/labelling/label_request.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "freshet/error.h"
#include "query/labelling/motion_guess.h"
#include "query/search/picture_scale.h"

namespace freshet::query {

bool guide_overrules_direction(const LabelRequest& request) {
  return request.options.candidates.direction_deg && !request.options.guide.direction.empty();
}

bool may_guess(const LabelRequest& request) {
  return request.guesses && request.options.guide.direction.empty() &&
         !request.options.candidates.direction_deg;
}

MotionGuide guide_of_animation(const LabelRequest& request, cv::Size picture) {
  MotionGuide guide = request.options.guide;
  const std::optional<double>& degrees = request.options.candidates.direction_deg;
  if (request.options.hint_search == HintSearch::kWide && degrees && guide.direction.empty()) {
    const double angle = *degrees * std::numbers::pi / 180;
    guide.direction = cv::Mat(picture, CV_32FC2, cv::Scalar(std::cos(angle), -std::sin(angle)));
  }
  return guide;
}

void adopt_guess(const MotionGuide& guess, LabelOptions& options) {
  if (options.hint_search == HintSearch::kWide) {
    // What they were weighed by stays, and the price of what is unsteady: a guess is of steady motion.
    const GuideCosts wide = default_guide_costs(HintSearch::kWide),
                     narrow = default_guide_costs(HintSearch::kNarrow);
    options.hint_search = HintSearch::kNarrow;
    const auto [direction, speed, unsteady] = options.guide_costs;
    options.guide_costs = {.direction = narrow.direction * (direction / wide.direction),
                           .speed = narrow.speed * (speed / wide.speed),
                           .unsteady = unsteady};
    options.guide = widened(options.guide);
  }
  options.guide.direction = guess.direction;
  options.guide.tolerance_deg = guess.tolerance_deg;
}

void let_looks_choose_flames(const cv::Mat& matte, LabelOptions& options) {
  const MotionGuide& guide = options.guide;
  if (options.hint_search != HintSearch::kWide || options.candidates.class_name != vision::kFire ||
      guide.direction.empty() || guide.speed.empty())
    return;
  check_guide(guide, matte.size());
  std::vector<float> speeds;
  for (int y = 0; y < matte.rows; ++y)
    for (int x = 0; x < matte.cols; ++x)
      if (matte.at<std::uint8_t>(y, x) > 127 && guide.speed.at<float>(y, x) >= 0)
        speeds.push_back(guide.speed.at<float>(y, x));
  if (speeds.empty()) return;
  const auto fast = speeds.begin() + static_cast<std::ptrdiff_t>(9 * speeds.size() / 10);
  std::ranges::nth_element(speeds, fast);
  if (*fast >= kFlamesGo * std::max(matte.cols, matte.rows))
    options.guide_costs = weighted(options.guide_costs, 0);
}

PreparedLabelling prepare(const store::Snapshot& snapshot, const SearchBase& base, const cv::Mat& picture,
                          const cv::Mat& matte, const LabelRequest& request, const ProgressFunction& progress,
                          std::stop_token stop, LabellingMemo* memo) {
  PreparedLabelling prepared{.options = request.options, .kind = {}, .guess = {}};
  LabelOptions& options = prepared.options;
  options.piece_scale = request.piece_scale.value_or(auto_piece_scale(picture.size()));
  if (options.piece_scale > kMaxPieceScale)
    throw Error(ErrorKind::kUsage, "piece scale " + std::to_string(options.piece_scale), "1 to 16 expected");
  options.candidates.min_duration_s = request.duration_s;
  options.guide = guide_of_animation(request, picture.size());
  if (!options.guide.direction.empty()) options.candidates.direction_deg.reset();
  prepared.kind = choose_kind(snapshot, base, picture, request.looked_at.empty() ? matte : request.looked_at,
                              options.guide, options.candidates);
  let_looks_choose_flames(matte, options);
  if (!may_guess(request)) return prepared;

  if (progress) progress({"guessing the motion", 0, 0});
  LabelOptions unasked = options;
  unasked.guide = {};
  const MotionGuess guess = guess_motion(
      snapshot, search_candidates(snapshot, base, picture, matte, unasked, {}, stop, memo), picture, matte);
  prepared.guess = guess.report;
  if (guess.guide.empty()) return prepared;
  adopt_guess(guess.guide, options);
  return prepared;
}

}  // namespace freshet::query
