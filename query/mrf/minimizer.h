// query/mrf/minimizer.h — the ways to minimise an energy, by name.
#pragma once

#include <string>

#include "query/mrf/mrf.h"

namespace freshet::query {

enum class Minimizer {
  kTrwS,            // TRW-S, then forest_descent: the default
  kAlphaExpansion,  // as Okabe et al. 2011
  kIcm,             // for comparison
};

Minimizer parse_minimizer(const std::string& name);  // "trw-s", "alpha-expansion", "icm"; Error{kUsage}
const char* name_of(Minimizer minimizer);

/// max_iterations   TRW-S's passes, alpha-expansion's cycles or ICM's sweeps.
Solution minimize(const Mrf& mrf, Minimizer minimizer, int max_iterations = 100);

}  // namespace freshet::query
