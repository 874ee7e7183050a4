// include/freshet/label.h — one patch chosen for each piece of a picture, so that neighbours go together.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "freshet/search.h"

namespace freshet {

struct LabelOptions {
  /// Weight of neighbours against likeness; 0: each piece takes what it is most like.
  double lambda = 0.01;
  /// Passes of the solver (TRW-S), at most; 1 or more.
  int max_iterations = 100;
};

/// A clip that a labelling takes patches from, to be credited.
struct UsedClip {
  std::string name, class_name, licence;
  std::size_t pieces = 0;
};

/// A labelling, with the search that it chose from. Copies share; there is no empty one.
class Labelling {
 public:
  Search search() const;
  /// The candidate chosen for a piece.
  Candidate chosen(std::size_t piece) const;
  /// Of all pieces: CV_32S, pieces x 1, numbered as in PatchTable.
  cv::Mat patches() const;
  /// In order of their first piece.
  std::vector<UsedClip> clips() const;
  double energy() const;
  /// How far the energy can be above the lowest at most, as a fraction of it: 0.01 is good. Infinite when that
  /// is not known.
  double gap() const;
  /// As JSON, for `freshet synth animate --assignment`. Throws Error{kIo}.
  void write(const std::filesystem::path& path) const;

  /// For the library's own use.
  struct Impl;
  explicit Labelling(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  Labelling(const Labelling&) = default;  // and no moves: they would leave an empty one
  Labelling& operator=(const Labelling&) = default;
  const Impl& impl() const& { return *impl_; }
  const Impl& impl() && = delete;

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Chooses among the candidates of a search; any number of labellings can follow one search. The same for any
/// number of threads. Throws Error{kUsage} for an option out of range, Error{kCancelled}.
Labelling label(const Search& search, const LabelOptions& options = {}, const Job& job = {});

}  // namespace freshet
