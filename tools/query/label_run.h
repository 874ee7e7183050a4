// tools/query/label_run.h — labelling with its progress and its findings shown on stderr.
#pragma once

#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "query/labelling/label_request.h"
#include "query/labelling/labelling.h"
#include "tools/console/run_context.h"
#include "tools/options/duration.h"
#include "tools/options/motion_options.h"
#include "tools/options/search_options.h"
#include "tools/options/solver_options.h"
#include "tools/options/target_files.h"

namespace freshet::tools {

/// A labelling and the base that it borrows.
struct LabelRun {
  std::shared_ptr<const query::SearchBase> base;
  query::Labelling labelling;
  query::KindChoice kind;
};

/// The base of all searches in a store, opened with its progress shown.
/// built_late   see query::IndexChoice.
std::shared_ptr<const query::SearchBase> open_with_progress(const store::Snapshot& snapshot,
                                                            const SearchOptions& search,
                                                            bool built_late = false);

/// What the options ask of a picture; says which of them have no effect. labelling   may be null: nothing is
/// labelled.
query::LabelRequest request_of(const SearchOptions& search, const AskedMotion& asked,
                               const Duration& duration, const SolverOptions* labelling = nullptr);

/// query::prepare with its progress shown. What was taken and guessed is said, and how to overrule it.
query::PreparedLabelling prepare_with_progress(const store::Snapshot& snapshot, const query::SearchBase& base,
                                               const TargetFiles::Loaded& loaded,
                                               const query::LabelRequest& request, const RunContext& context,
                                               query::LabellingMemo* memo = nullptr);

/// base    of this snapshot, opened with built_late where there is a cache; shared by labellings of one index.
/// cache   may be null; what was reused of it is said.
LabelRun label_with_progress(const store::Snapshot& snapshot, std::shared_ptr<const query::SearchBase> base,
                             const TargetFiles::Loaded& loaded, const query::LabelRequest& request,
                             const Duration& duration, const RunContext& context,
                             cache::ResultCache* cache = nullptr);

/// How far the energy can be above the minimum, and whether that is within query::kGapAimed.
std::string gap_text(const query::Assignment& assignment);

/// What the picture looks like, and the class taken for it ("only", null where all were).
nlohmann::json to_json(const query::KindChoice& kind);
/// Seconds by stage; patches and clips that were left by each condition.
nlohmann::json to_json(const query::SearchBase& base, const query::LabelSeconds& seconds);
nlohmann::json to_json(const query::Filtered& filtered);

/// Largest shares of a clip and a patch, for programs; to `say` what is wrong with them.
nlohmann::json shares_json(const query::Assignment& assignment);
void say_shares(const query::Assignment& assignment);

/// Pieces, edges, solver, energy, bound, gap, largest shares, conditions, seconds.
nlohmann::json label_json(const LabelRun& run);

/// One line: pieces, energy, bound, gap, largest shares, seconds by stage.
std::string label_summary(const LabelRun& run);

}  // namespace freshet::tools
