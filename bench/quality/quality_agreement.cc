#include "bench/quality/quality_agreement.h"

#include <algorithm>
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

std::vector<double> true_order(std::span<const Judged* const> films) {
  std::vector<std::vector<double>> bad;
  for (const Judged* film : films) bad.push_back(badness(*film));
  std::vector<double> order(films.size());
  for (std::size_t m = 0; !bad.empty() && m < bad.front().size(); ++m) {
    std::vector<double> values;
    for (const auto& film : bad) values.push_back(film[m]);
    if (std::ranges::any_of(values, [](double value) { return std::isnan(value); })) continue;
    const std::vector<double> ranks = ranks_of(values);
    for (std::size_t i = 0; i < ranks.size(); ++i) order[i] += ranks[i];
  }
  return order;
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
    const std::vector<double> order = true_order(films[i]);
    std::vector<double> faults;
    for (const Judged* film : films[i]) faults.push_back(film->distance.faults);
    all[i].films = static_cast<int>(faults.size());
    all[i].correlation = spearman(faults, order);
    const auto best = static_cast<std::size_t>(std::ranges::min_element(faults) - faults.begin());
    all[i].chosen = place_of(order[best], order);
    all[i].first = place_of(order.front(), order);
  }
  return all;
}

std::string agreement_table(const std::vector<Agreement>& agreements) {
  std::string text =
      "\nthe critic against the truth's order: Spearman's correlation; place of its choice and of the first "
      "film, 0 "
      "the best, 1 the worst\n\n| clip | films | Spearman | chosen | first |\n| --- | --- | --- | --- | --- "
      "|\n";
  double correlation = 0, chosen = 0, first = 0;
  int known = 0;
  for (const Agreement& one : agreements) {
    text += fmt::format("| {} | {} | {:.2f} | {:.2f} | {:.2f} |\n", one.clip, one.films, one.correlation,
                        one.chosen, one.first);
    if (std::isnan(one.correlation)) continue;
    correlation += one.correlation;
    chosen += one.chosen;
    first += one.first;
    ++known;
  }
  if (known > 0)
    text += fmt::format("| mean | | {:.2f} | {:.2f} | {:.2f} |\n", correlation / known, chosen / known,
                        first / known);
  return text;
}

}  // namespace freshet::bench
