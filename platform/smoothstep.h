// platform/smoothstep.h — a step without a corner.
#pragma once

#include <algorithm>

namespace freshet {

/// 0 up to low, 1 from high on (or the other way round where high is less), level at both.
template <class Real>
Real smoothstep(Real low, Real high, Real x) {
  const Real t = std::clamp((x - low) / (high - low), Real(0), Real(1));
  return t * t * (3 - 2 * t);
}

}  // namespace freshet
