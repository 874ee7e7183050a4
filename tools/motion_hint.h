// tools/motion_hint.h — a guess of the motion where a person has asked for none, said on stderr.
#pragma once

#include <stop_token>

#include "query/index/search_base.h"
#include "query/labelling/labelling.h"
#include "query/labelling/labelling_memo.h"
#include "store/store.h"
#include "tools/options/motion_options.h"
#include "tools/options/search_options.h"

namespace freshet::tools {

/// Whether nobody says a direction: neither strokes nor an orientation map nor --direction, and not --hint
/// none.
bool may_guess(const AskedMotion& asked, const query::CandidateOptions& options);

/// Gives options.guide a direction, and its tolerance, where one may be guessed and the guess dares. What was
/// guessed is said, and how to overrule it. A speed that was asked stays. Costs a search without hint.
/// memo   may be null.
void guess_where_unasked(const store::Snapshot& snapshot, const query::SearchBase& base,
                         const TargetFiles::Loaded& loaded, const AskedMotion& asked,
                         query::LabelOptions& options, std::stop_token stop,
                         query::LabellingMemo* memo = nullptr);

}  // namespace freshet::tools
