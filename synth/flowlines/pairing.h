// synth/flowlines/pairing.h — which input line each edited line takes its texture from.
#pragma once

#include <functional>
#include <vector>

namespace freshet::synth::flowlines {

/// For every edited line x, in their order across the flow, the input line y of least total overlap error.
///
/// lines     edited lines; inputs   input lines; both at least 1.
/// error     E(x - 1, y', x, y) for x from 1 on: the patch overlap error of neighbours, >= 0. Called once for each.
/// given     by edited line: the input line that a person has chosen, or -1. Empty: none.
/// Returns   the globally best choice; of equal ones that of the lower numbers.
/// Cost      lines x inputs^2 calls.
/// Source    Bhat et al. 2004, Eq. 1: C(x, y) = min over y' of C(x - 1, y') + E(x - 1, y', x, y).
std::vector<int> pair_lines(int lines, int inputs,
                            const std::function<double(int x, int before, int y)>& error,
                            const std::vector<int>& given = {});

}  // namespace freshet::synth::flowlines
