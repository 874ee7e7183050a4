#include "freshet/label.h"

#include <utility>

#include "freshet/error.h"
#include "library/opencv_threads.h"
#include "library/states.h"

namespace freshet {

Labelling label(const Search& search, const LabelOptions& options, const Job& job) {
  if (options.max_iterations < 1)
    throw Error(ErrorKind::kUsage, "passes of the solver",
                std::to_string(options.max_iterations) + ", and at least 1 is expected");
  const OneOpenCvThread one;
  query::LabelOptions chosen = search.impl().options;
  chosen.costs.lambda = options.lambda;
  chosen.max_iterations = options.max_iterations;
  query::check_weights(chosen.costs);
  query::Labelling found =
      query::label(search.impl().store.impl().snapshot, search.impl().found, chosen, job.progress, job.stop);
  return Labelling(std::make_shared<const Labelling::Impl>(Labelling::Impl{
      .search = search, .labels = std::move(found.labels), .assignment = std::move(found.assignment)}));
}

Search Labelling::search() const { return impl_->search; }

Candidate Labelling::chosen(std::size_t piece) const {
  const query::AssignedPiece& assigned = impl_->assignment.pieces.at(piece);
  return {.clip = impl_->assignment.clips[assigned.clip].name, .score = assigned.score};
}

cv::Mat Labelling::patches() const {
  const query::Candidates& candidates = impl_->search.impl().found.candidates;
  cv::Mat patches(static_cast<int>(impl_->labels.size()), 1, CV_32S);
  for (std::size_t piece = 0; piece < impl_->labels.size(); ++piece)
    patches.at<int>(static_cast<int>(piece), 0) =
        static_cast<int>(candidates.rows_of(piece)[static_cast<std::size_t>(impl_->labels[piece])]);
  return patches;
}

std::vector<UsedClip> Labelling::clips() const {
  std::vector<UsedClip> used;
  for (const query::AssignedClip& clip : impl_->assignment.clips)
    used.push_back({.name = clip.name, .class_name = clip.class_name, .licence = clip.licence, .pieces = 0});
  for (const query::AssignedPiece& piece : impl_->assignment.pieces) ++used[piece.clip].pieces;
  return used;
}

double Labelling::energy() const { return impl_->assignment.energy; }

double Labelling::gap() const { return impl_->assignment.gap(); }

void Labelling::write(const std::filesystem::path& path) const {
  query::write_assignment(path, impl_->assignment);
}

}  // namespace freshet
