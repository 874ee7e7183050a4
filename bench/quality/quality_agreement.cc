#include "bench/quality/quality_agreement.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace freshet::bench {
namespace {

/// Of which less is better.
std::vector<double> badness(const Judged& film) {
  const Distance& d = film.distance;
  const double fine = (d.patches[0] + d.patches[1] + d.patches[2]) / 3;
  return {d.spectrum_db,    d.texture,
          d.lifetime,       std::abs(d.flicker),
          std::abs(d.pace), fine,
          d.drift,          std::isnan(d.again_beyond) ? d.again_beyond : std::max(0.0, d.again_beyond)};
}

/// The films' ranks by each measure that all of them have.
std::vector<std::vector<double>> measured_ranks(std::span<const Judged* const> films) {
  std::vector<std::vector<double>> bad, all;
  for (const Judged* film : films) bad.push_back(badness(*film));
  for (std::size_t m = 0; !bad.empty() && m < bad.front().size(); ++m) {
    std::vector<double> values;
    for (const auto& film : bad) values.push_back(film[m]);
    if (std::ranges::none_of(values, [](double value) { return std::isnan(value); }))
      all.push_back(ranks_of(values));
  }
  return all;
}

/// The mean ranks of films by the measures that are in `chosen`, a bit each.
std::vector<double> order_by(const std::vector<std::vector<double>>& ranks, unsigned chosen,
                             std::size_t films) {
  std::vector<double> order(films);
  for (std::size_t m = 0; m < ranks.size(); ++m)
    if (chosen >> m & 1U)
      for (std::size_t i = 0; i < films; ++i) order[i] += ranks[m][i];
  return order;
}

/// How far half of the measures order the films as the other half do: the mean of all halvings.
double agreement_of_halves(const std::vector<std::vector<double>>& ranks, std::size_t films) {
  const auto n = static_cast<unsigned>(ranks.size());
  const unsigned all = (1U << n) - 1;
  double sum = 0;
  int halvings = 0;
  for (unsigned half = 1; half < all; ++half) {
    if (static_cast<unsigned>(std::popcount(half)) != n / 2) continue;
    const double found = spearman(order_by(ranks, half, films), order_by(ranks, all & ~half, films));
    if (!std::isnan(found)) sum += found, ++halvings;
  }
  return halvings > 0 ? sum / halvings : kNotMeasured;
}

/// 0 for the least of these values, 1 for the greatest.
double place_of(double value, std::span<const double> values) {
  const auto below = std::ranges::count_if(values, [&](double other) { return other < value; });
  return values.size() > 1 ? static_cast<double>(below) / static_cast<double>(values.size() - 1) : 0;
}

}  // namespace

std::vector<double> ranks_of(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  std::vector<double> ranks(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first;
    while (end < order.size() && values[order[end]] == values[order[first]]) ++end;
    for (std::size_t i = first; i < end; ++i) ranks[order[i]] = static_cast<double>(first + end + 1) / 2;
    first = end;
  }
  return ranks;
}

double spearman(std::span<const double> a, std::span<const double> b) {
  if (a.size() < 3 || a.size() != b.size()) return kNotMeasured;
  const std::vector<double> x = ranks_of(a), y = ranks_of(b);
  const double middle = static_cast<double>(a.size() + 1) / 2;
  double xy = 0, xx = 0, yy = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    xy += (x[i] - middle) * (y[i] - middle);
    xx += (x[i] - middle) * (x[i] - middle);
    yy += (y[i] - middle) * (y[i] - middle);
  }
  return xx > 0 && yy > 0 ? xy / std::sqrt(xx * yy) : kNotMeasured;
}

std::vector<Agreement> agreements(const std::vector<Judged>& judged) {
  std::vector<Agreement> all;
  std::vector<std::vector<const Judged*>> films;
  for (const Judged& one : judged) {
    if (std::isnan(one.distance.faults) || one.label_s + one.render_s == 0) continue;
    auto known = std::ranges::find(all, one.clip, &Agreement::clip);
    if (known == all.end()) {
      all.push_back({.clip = one.clip, .class_name = one.class_name});
      films.emplace_back();
      known = all.end() - 1;
    }
    films[static_cast<std::size_t>(known - all.begin())].push_back(&one);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::vector<std::vector<double>> ranks = measured_ranks(films[i]);
    const std::vector<double> order = order_by(ranks, ~0U, films[i].size());
    std::vector<double> faults;
    for (const Judged* film : films[i]) faults.push_back(film->distance.faults);
    all[i].films = static_cast<int>(faults.size());
    all[i].correlation = spearman(faults, order);
    all[i].halves = agreement_of_halves(ranks, films[i].size());
    const auto best = static_cast<std::size_t>(std::ranges::min_element(faults) - faults.begin());
    all[i].chosen = place_of(order[best], order);
    all[i].first = place_of(order.front(), order);
  }
  return all;
}

std::string agreement_table(const std::vector<Agreement>& agreements) {
  std::string text =
      "\nthe critic against the truth's order: Spearman's correlation, and that of halves of the truth's "
      "measures with each other; place of its choice and of the first film, 0 the best, 1 the worst\n\n"
      "| clip | films | Spearman | halves | chosen | first |\n| --- | --- | --- | --- | --- | --- |\n";
  double correlation = 0, halves = 0, chosen = 0, first = 0;
  int known = 0;
  for (const Agreement& one : agreements) {
    text += fmt::format("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", one.clip, one.films,
                        one.correlation, one.halves, one.chosen, one.first);
    if (std::isnan(one.correlation)) continue;
    correlation += one.correlation;
    halves += one.halves;
    chosen += one.chosen;
    first += one.first;
    ++known;
  }
  if (known > 0)
    text += fmt::format("| mean | | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", correlation / known,
                        halves / known, chosen / known, first / known);
  return text;
}

}  // namespace freshet::bench
