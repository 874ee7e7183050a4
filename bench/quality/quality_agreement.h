// quality_agreement.h — does the critic, who does not know the truth, rank films as the truth's measures do?
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/quality/quality_report.h"

namespace freshet::bench {

/// Ranks from 1 for the least; equal values share the mean of theirs.
std::vector<double> ranks_of(std::span<const double> values);
/// Spearman's correlation of ranks, -1 to 1; NaN for fewer than three, or where all of one side are equal.
double spearman(std::span<const double> a, std::span<const double> b);

/// By clip. The truth's order of its films is the mean of their ranks by spectrum, texture, lifetime, flicker, pace,
/// SWD of the three finest levels, colour drift, and how far forms come back beyond the truth's. Fixed before the first
/// run of the critic; a measure that one of the films lacks counts for none.
struct Agreement {
  std::string clip, class_name;
  int films = 0;
  double correlation = kNotMeasured;
  /// Of the order by half of the truth's measures with that by the others, the mean of all halvings: where it is low no
  /// critic could follow.
  double halves = kNotMeasured;
  /// Of the films, by the truth's order from 0 (best) to 1 (worst): the critic's choice, and the first film, which is
  /// what one would have without a critic.
  double chosen = 0, first = 0;
};
/// Of all that was animated (Distance::faults is measured), without references.
std::vector<Agreement> agreements(const std::vector<Judged>& judged);
std::string agreement_table(const std::vector<Agreement>& agreements);

}  // namespace freshet::bench
