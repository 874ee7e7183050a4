#include "query/labelling/label_request.h"

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

PreparedLabelling prepare(const store::Snapshot& snapshot, const SearchBase& base, const cv::Mat& picture,
                          const cv::Mat& matte, const LabelRequest& request, const ProgressFunction& progress,
                          std::stop_token stop, LabellingMemo* memo) {
  PreparedLabelling prepared{.options = request.options, .guess = {}};
  LabelOptions& options = prepared.options;
  options.piece_scale = request.piece_scale.value_or(auto_piece_scale(picture.size()));
  options.candidates.min_duration_s = request.duration_s;
  if (guide_overrules_direction(request)) options.candidates.direction_deg.reset();
  if (!may_guess(request)) return prepared;

  if (progress) progress({"guessing the motion", 0, 0});
  LabelOptions unasked = options;
  unasked.guide = {};
  const MotionGuess guess = guess_motion(
      snapshot, search_candidates(snapshot, base, picture, matte, unasked, {}, stop, memo), picture, matte);
  prepared.guess = guess.report;
  if (guess.guide.empty()) return prepared;
  options.guide.direction = guess.guide.direction;
  options.guide.tolerance_deg = guess.guide.tolerance_deg;
  return prepared;
}

}  // namespace freshet::query
