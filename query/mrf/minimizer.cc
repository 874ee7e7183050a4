#include "query/mrf/minimizer.h"

#include "freshet/error.h"
#include "query/mrf/alpha_expansion.h"
#include "query/mrf/forest_descent.h"
#include "query/mrf/icm.h"
#include "query/mrf/trw_s.h"

namespace freshet::query {

Minimizer parse_minimizer(const std::string& name) {
  for (const Minimizer known : {Minimizer::kTrwS, Minimizer::kAlphaExpansion, Minimizer::kIcm}) {
    if (name == name_of(known)) return known;
  }
  throw Error(ErrorKind::kUsage, "minimizer \"" + name + "\"", "no such minimizer",
              "Use trw-s, alpha-expansion or icm");
}

const char* name_of(Minimizer minimizer) {
  switch (minimizer) {
    case Minimizer::kTrwS:
      return "trw-s";
    case Minimizer::kAlphaExpansion:
      return "alpha-expansion";
    case Minimizer::kIcm:
      return "icm";
  }
  return "";
}

Solution minimize(const Mrf& mrf, Minimizer minimizer, int max_iterations) {
  switch (minimizer) {
    case Minimizer::kAlphaExpansion:
      return alpha_expansion(mrf, {.max_cycles = max_iterations});
    case Minimizer::kIcm:
      return icm(mrf, {.max_sweeps = max_iterations});
    case Minimizer::kTrwS:
      break;
  }
  Solution solution = trw_s(mrf, {.max_iterations = max_iterations});
  forest_descent(mrf, solution);
  return solution;
}

}  // namespace freshet::query
