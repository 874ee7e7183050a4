#include "synth/animate/printed.h"

namespace freshet::synth::animate {

const std::vector<PrintedOption>& printed_options() {
  static const std::vector<PrintedOption> options{{"method", "paper", "Sec. 6"},
                                                  {"piece-scale", "1", "Sec. 5"},
                                                  {"candidates", "100", "Sec. 5"},
                                                  {"coherent", "0", "Sec. 5"},
                                                  {"hint", "none", "Sec. 5"},
                                                  {"hint-search", "narrow", "Sec. 5"},
                                                  {"costs", "power", "Eq. 2, 3, 6"},
                                                  {"vote", "0", "Eq. 5"},
                                                  {"hint-weight", "0", "Eq. 5"},
                                                  {"reuse", "0", "Eq. 6"},
                                                  {"crowd", "0", "Eq. 6"},
                                                  {"solver", "alpha-expansion", "Sec. 5"},
                                                  {"horizon", "none", "Sec. 6"},
                                                  {"speed", "1", "Sec. 6"},
                                                  {"resampling", "nearest", "Sec. 6"},
                                                  {"blend", "paper", "Sec. 6"},
                                                  {"low-band", "keep", "Sec. 6"},
                                                  {"matching", "frame", "Sec. 6"},
                                                  {"max-gain", "20", "Sec. 6"}};
  return options;
}

}  // namespace freshet::synth::animate
