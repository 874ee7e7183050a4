// query/labelling/label_request.h — what a person asks of a picture, and the options of a labelling that follow.
#pragma once

#include <optional>
#include <stop_token>
#include <string>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "query/index/search_base.h"
#include "query/labelling/kind_choice.h"
#include "query/labelling/labelling.h"
#include "query/labelling/labelling_memo.h"
#include "store/store.h"

namespace freshet::query {

/// Every program that labels for an animation asks in this form, so that all of them keep the same rules.
struct LabelRequest {
  /// piece_scale and candidates.min_duration_s are not read: they follow from what stands below. candidates.class_name:
  /// empty: as choose_kind takes it.
  LabelOptions options{};
  /// What the picture's sides are divided by before it is cut; nothing: what suits its size (auto_piece_scale).
  std::optional<double> piece_scale{};
  /// Of the animation, s: clips that do not last as long and have no loop rule are no candidates.
  double duration_s = 0;
  /// Whether a direction may be guessed where nobody says one.
  bool guesses = true;
  /// The fluid by whose look choose_kind tells the class: the matte before anything in it was held back, for a sky
  /// without its stars looks like water. Empty: the matte.
  cv::Mat looked_at{};
};

/// Whether both a direction for the whole picture and a guide with directions are asked: the guide holds.
bool guide_overrules_direction(const LabelRequest& request);
/// Whether nobody says a direction, neither one nor a guide, and one may be guessed.
bool may_guess(const LabelRequest& request);

/// What the animation's motion is turned to: the guide; and in a wide search, which lets in what goes elsewhere,
/// one direction for the whole picture too. picture   px.
MotionGuide guide_of_animation(const LabelRequest& request, cv::Size picture);

/// Makes a guess the hint of a labelling; a speed that is asked stays. A guess turns nothing, so that a wide search
/// becomes a narrow one, of directions alone.
void adopt_guess(const MotionGuide& guess, LabelOptions& options);

/// Of fire that is asked to go, by direction and speed, looks alone choose in a wide search (guide_costs 0): flames
/// leap and flicker on the spot, and those that go as slowly in the mean hardly burn. Where the fastest tenth of what
/// is asked in the matte is slower than kFlamesGo, the calm are meant.
/// matte    CV_8U. Throws as check_guide.
void let_looks_choose_flames(const cv::Mat& matte, LabelOptions& options);
/// Of the picture's longer side, a second. Asked of a burner, .014; of campfires, a wall and grass, .1 to .8.
inline constexpr double kFlamesGo = 0.04;

struct PreparedLabelling {
  LabelOptions options;  // complete; guide holds what is guessed where it said no direction
  KindChoice kind;       // whose class the candidates are of
  std::string guess;     // what was guessed and why, for a person; empty: nothing was to be guessed
};

/// The options with which a picture is searched and labelled, of the class that choose_kind takes. Where may_guess, a
/// search without a hint comes first (stage "guessing the motion"), and options.guide is given the guessed directions
/// and their tolerance; a speed that was asked stays. What is asked of the animation's motion is guide_of_animation all
/// the same: a guess chooses patches and turns nothing, so that the search is narrow where it says a direction.
/// let_looks_choose_flames holds.
/// picture, matte   as search_candidates takes them. memo   may be null.
/// Throws           as search_candidates.
PreparedLabelling prepare(const store::Snapshot& snapshot, const SearchBase& base, const cv::Mat& picture,
                          const cv::Mat& matte, const LabelRequest& request,
                          const ProgressFunction& progress = {}, std::stop_token stop = {},
                          LabellingMemo* memo = nullptr);

}  // namespace freshet::query
