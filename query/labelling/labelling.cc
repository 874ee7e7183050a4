#include "query/labelling/labelling.h"

#include <algorithm>
#include <map>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "query/costs/steadiness.h"
#include "query/costs/stored_features.h"
#include "query/mrf/spread.h"
#include "query/search/coherent_candidates.h"
#include "query/search/picture_scale.h"

namespace freshet::query {
namespace {

// Says where the work stands, times it, and stops it.
class Stages {
 public:
  Stages(const ProgressFunction& progress, std::stop_token stop)
      : progress_(progress), stop_(std::move(stop)) {}
  template <class Work>
  auto run(const char* stage, double& seconds, Work&& work) {
    if (stop_.stop_requested()) throw Error(ErrorKind::kCancelled, "labelling", "stopped");
    if (progress_) progress_({stage, 0, 0});
    const TimedScope timer(seconds);
    return work();
  }

 private:
  const ProgressFunction& progress_;
  std::stop_token stop_;
};

}  // namespace

CandidateSearch search_candidates(const store::Snapshot& snapshot, const SearchBase& base,
                                  const cv::Mat& picture, const cv::Mat& matte, const LabelOptions& options,
                                  const ProgressFunction& progress, std::stop_token stop,
                                  LabellingMemo* memo) {
  if (picture.type() != CV_8UC3 || matte.type() != CV_8U || picture.size() != matte.size()) {
    throw Error(ErrorKind::kUsage, "picture and matte", "8-bit BGR and 8-bit grey of the same size expected");
  }
  if (options.candidates.k < 1)
    throw Error(ErrorKind::kUsage, "number of candidates",
                std::to_string(options.candidates.k) + " is out of range");
  Stages stages(progress, stop);
  CandidateSearch search;
  search.base = &base;
  search.picture = picture.size();
  search.piece_scale = options.piece_scale;
  const cv::Mat searched = reduce(picture, options.piece_scale), fluid = reduce(matte, options.piece_scale);
  const bool wide = options.hint_search == HintSearch::kWide;
  const MotionGuide guide = reduce(wide ? widened(options.guide) : options.guide, options.piece_scale);
  search.filtered = filter_rows(snapshot, base.table, base.settings.variants(), options.candidates);
  search.target = stages.run("describing the picture", search.seconds.cut, [&] {
    return make_target(searched, fluid, base.settings.grid, base.codebook, options.target);
  });
  search.candidates = stages.run("searching candidates", search.seconds.search, [&] {
    const auto k = static_cast<std::size_t>(options.candidates.k);
    const std::size_t considered =
        wide && !guide.empty() ? k * static_cast<std::size_t>(std::max(1, options.candidates.considered)) : k;
    const RowFilter& rows = search.filtered.rows;
    Candidates found = memo != nullptr ? memo->find_candidates(search.target, fluid, considered, rows, guide)
                                       : find_candidates(*base.index, base.table, search.target, fluid,
                                                         considered, rows, guide);
    const auto measure = [&] {
      if (!guide.direction.empty())
        found.steadiness = steadiness(snapshot, base.settings, base.table, found.rows);
    };
    measure();
    if (wide) keep_best_paid(base.table, options.guide_costs, k, found);
    add_coherent(base.table, base.codebook.words, search.target, search.filtered.rows, guide,
                 static_cast<std::size_t>(std::max(0, options.candidates.coherent)), found);
    measure();
    if (wide) keep_best_paid(base.table, options.guide_costs, found.k, found);
    return found;
  });
  return search;
}

Labelling label(const store::Snapshot& snapshot, CandidateSearch search, const LabelOptions& options,
                const ProgressFunction& progress, std::stop_token stop, LabellingMemo* memo) {
  const SearchBase& base = *search.base;
  Labelling labelling;
  labelling.search = std::move(search);
  labelling.seconds = labelling.search.seconds;
  const Target& target = labelling.search.target;
  const Candidates& candidates = labelling.search.candidates;
  Stages stages(progress, stop);
  cache::Key key;
  std::optional<Solution> known;
  if (memo != nullptr) {
    key = memo->solution_key(target, candidates, options.costs, options.guide_costs, options.reuse,
                             options.minimizer, options.max_iterations);
    known = memo->find_solution(key, target, candidates);
  }
  if (!known) {
    Mrf mrf = stages.run("comparing neighbours", labelling.seconds.costs, [&] {
      StoredFeatures features(snapshot, base.settings, base.table);
      const FeatureShape shape = feature_shape(base.settings);
      Mrf costs = memo != nullptr
                      ? memo->build_mrf(target, candidates, shape, options.costs, features.source(), stop)
                      : build_mrf(target, candidates, shape, options.costs, features.source(), stop);
      add_guide_costs(base.table, candidates, options.guide_costs, costs);
      add_reuse_costs(snapshot, base.settings, base.table, target, candidates, options.reuse, costs);
      return costs;
    });
    known = stages.run("choosing patches", labelling.seconds.minimize, [&] {
      std::vector<std::uint32_t> clips;  // of each label
      for (std::size_t piece = 0; piece < candidates.pieces(); ++piece)
        for (const stored::Row row : candidates.rows_of(piece)) clips.push_back(base.table.clip[row]);
      Solution solution =
          minimize_spread(clips, options.reuse.crowd, options.minimizer, options.max_iterations, mrf);
      solution.margins = margins(mrf, solution.labels);
      return solution;
    });
    if (memo != nullptr) memo->keep_solution(key, *known);
  }
  labelling.assignment =
      make_assignment(snapshot, labelling.search, *known, options.minimizer, options.costs.form);
  labelling.labels = std::move(known->labels);
  labelling.margins = std::move(known->margins);
  labelling.iterations = known->iterations;
  return labelling;
}

Labelling label(const store::Snapshot& snapshot, const SearchBase& base, const cv::Mat& picture,
                const cv::Mat& matte, const LabelOptions& options, const ProgressFunction& progress,
                std::stop_token stop, LabellingMemo* memo) {
  return label(snapshot, search_candidates(snapshot, base, picture, matte, options, progress, stop, memo),
               options, progress, stop, memo);
}

Assignment make_assignment(const store::Snapshot& snapshot, const CandidateSearch& search,
                           const Labels& labels) {
  const std::vector<vision::Variant> variants = search.base->settings.variants();
  const stored::PatchTable& table = search.table();
  Assignment assignment;
  assignment.picture = search.picture;
  assignment.piece_scale = search.piece_scale;
  assignment.side = search.target.side;
  assignment.stride = search.target.stride;
  std::map<std::uint32_t, std::uint32_t> number_of;  // clip of the table, clip of the assignment
  for (std::size_t piece = 0; piece < search.target.size(); ++piece) {
    const stored::Row row = search.candidates.rows_of(piece)[labels[piece]];
    const std::uint32_t clip = table.clip[row];
    const auto [entry, is_new] = number_of.emplace(clip, static_cast<std::uint32_t>(assignment.clips.size()));
    if (is_new) {
      const store::ClipRecord& record = snapshot.clip(table.clips[clip]);
      assignment.clips.push_back({record.name, record.class_name, record.licence, record.source_hash});
    }
    assignment.pieces.push_back({search.target.corners[piece], entry->second, variants[table.variant[row]],
                                 cv::Point(table.x[row], table.y[row]),
                                 search.candidates.scores_of(piece)[labels[piece]]});
  }
  return assignment;
}

Assignment make_assignment(const store::Snapshot& snapshot, const CandidateSearch& search,
                           const Solution& solution, Minimizer minimizer, CostForm form) {
  Assignment assignment = make_assignment(snapshot, search, solution.labels);
  assignment.minimizer = name_of(minimizer);
  assignment.cost_form = name_of(form);
  assignment.energy = solution.energy;
  assignment.lower_bound = solution.lower_bound;
  return assignment;
}

}  // namespace freshet::query
