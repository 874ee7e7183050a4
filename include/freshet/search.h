// include/freshet/search.h — the patches of a store that look like the pieces of a picture.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "freshet/motion.h"
#include "freshet/store.h"

namespace freshet {

struct SearchOptions {
  /// Only clips of this class; "any": of all; empty: of the class that the picture looks most like, or, where the
  /// store has none of it, of all.
  std::string class_name{};
  /// Where the fluid goes, degrees as seen on the screen: 0 right, 90 up, 180 left, 270 down: patches that go
  /// elsewhere pay for it, and are turned. Without effect beside a guide that has directions. Nothing: any.
  std::optional<double> direction_deg{};
  /// Only patches that move about as asked, by direction_deg or the guide, are candidates, within the tolerances.
  bool narrow = false;
  /// Degrees to either side of direction_deg in a narrow search.
  double direction_tolerance_deg = 30;
  /// Where and how fast the fluid is to go (read_strokes); empty: any motion.
  MotionGuide guide{};
  /// Whether find_horizon is asked where the guide has no horizon.
  bool horizon = true;
  /// Whether a direction is guessed, from the candidates' classes and the picture's texture, where neither
  /// direction_deg nor the guide says one.
  bool guess = true;
  /// Candidates per piece, 1 to 10000; continuations of its neighbours' best ones join them.
  int candidates = 100;
  /// What the picture's sides are divided by before it is cut into pieces, 1 to 16; patches are shown enlarged
  /// by it. Nothing: what brings the longer side near 1280 px.
  std::optional<double> piece_scale{};
  /// Length of the animation, in frames, at least 1, and frames per second, 1 to 240. Clips that do not last as long
  /// and have no loop rule are no candidates.
  int frames = 96;
  double fps = 25;
  /// Names of clips that are left out.
  std::vector<std::string> excluded_clips{};
  /// CV_8U of the picture's size, 255 where something stands before the fluid or beside it: it is taken out of the
  /// matte, stays the picture to the bit, and a moving outline goes on behind it. Empty: nothing.
  cv::Mat held{};
};

struct Candidate {
  std::string clip;  // its name
  double score = 0;  // likeness, 0 to 1; above 0.2 is good
};

/// Patches for each of several questions, best first. Patches are numbered through the store: those of its first clip,
/// then those of the next, ... (Store::first_patches).
struct PatchTable {
  cv::Mat patches;  // CV_32S, a row for each question, as wide as the most found; -1 where there are fewer
  cv::Mat scores;   // CV_32F, the same shape: likeness, 0 to 1; 0 where there are fewer
};

/// What a search found: pieces and their candidates, with the picture, the store and the options. Copies
/// share; there is no empty one. Safe from many threads.
class Search {
 public:
  std::size_t pieces() const;
  /// Where a piece lies, px of the picture; may stand over its border.
  cv::Rect2d area(std::size_t piece) const;
  /// Best first, at least one.
  std::vector<Candidate> candidates(std::size_t piece) const;
  /// Of all pieces at once.
  PatchTable candidates() const;
  /// For a person: what was guessed, which clips are too short, where candidates were few.
  std::vector<std::string> notices() const;

  /// For the library's own use.
  struct Impl;
  explicit Search(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  Search(const Search&) = default;  // and no moves: they would leave an empty one
  Search& operator=(const Search&) = default;
  const Impl& impl() const& { return *impl_; }
  const Impl& impl() && = delete;

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Cuts a picture into pieces and finds each piece's candidates.
/// picture  CV_8UC3 BGR; copied.
/// matte    CV_8U of its size, 255 where the fluid is; empty: everywhere.
/// Throws   Error{kNotFound} when no patch is left that the options allow, or the store has no index;
///          Error{kUsage} for an option out of range, Error{kInput} when hardly anything of the matte is not held,
///          Error{kCancelled}.
/// Cost     the first search opens the store's index (1.6 us and 620 bytes per patch), which others share.
///          The same answer for any number of threads.
Search search(const Store& store, const cv::Mat& picture, const cv::Mat& matte = {},
              const SearchOptions& options = {}, const Job& job = {});

/// The patches that are most like descriptions of one's own, by weighted histogram intersection.
/// words      CV_8U or CV_16U, Q x 81: visual words of a grid of 9 x 9 (Footage::column, "patch.words"); points of
///            words beyond the store's do not count.
/// k          1 to 10000.
/// Throws     Error{kNotFound} when the store has no index, Error{kUsage} for another shape.
/// Cost       as search().
PatchTable nearest_by_words(const Store& store, const cv::Mat& words, int k = 100);
/// histograms   CV_8U, Q x bins, as histograms_of gives them.
/// Cost         all patches are scanned: some 1 us a patch and question.
PatchTable nearest_by_histograms(const Store& store, const cv::Mat& histograms, int k = 100);
/// Spatial pyramids of words, CV_8U, Q x 21 cells * the store's words: weights 1, 1, 2 by level.
cv::Mat histograms_of(const Store& store, const cv::Mat& words);

}  // namespace freshet
