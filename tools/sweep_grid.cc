#include "tools/sweep_grid.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "freshet/error.h"

namespace freshet::tools {
namespace {

// Either words, or numbers of a range.
struct Sweepable {
  const char* name;
  std::vector<std::string> words;
  double minimum = 0, maximum = 0;
};

const std::vector<Sweepable>& sweepables() {
  static const std::vector<Sweepable> all{
      {"lambda", {}, 0, 1e9},
      {"sigma", {}, 0, 1e9},
      {"rho", {}, 0, 1e9},
      {"vote", {}, 0, 1e9},
      {"costs", {"log", "power"}},
      {"solver", {"trw-s", "alpha-expansion", "icm"}},
      {"shutter", {}, 0, 10},
      {"softness", {}, 0, 10},
      {"blend", {"variance", "paper"}},
      {"low-band", {"shared", "keep", "remove"}},
      {"matching", {"sequence", "frame", "none"}},
      {"max-gain", {}, 1, 20},
  };
  return all;
}

[[noreturn]] void refuse(const std::string& text, const std::string& fault, const std::string& remedy) {
  throw Error(ErrorKind::kUsage, "--sweep " + text, fault, remedy);
}

double number_of(const std::string& text) {
  double value = std::nan("");
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  return fault == std::errc() && end == text.data() + text.size() ? value : std::nan("");
}

// Of several writings of one value, one.
std::string plain(const Sweepable& sweepable, const std::string& value) {
  return sweepable.words.empty() ? fmt::format("{}", number_of(value)) : value;
}

template <class Choice>
Choice choice_of(const std::string& value, std::initializer_list<std::pair<const char*, Choice>> choices) {
  for (const auto& [name, choice] : choices)
    if (value == name) return choice;
  return choices.begin()->second;
}

void apply(const std::string& name, const std::string& value, SweepPoint& point) {
  query::PairwiseOptions& costs = point.labelling.costs;
  synth::animate::AnimateOptions& rendering = point.rendering;
  if (name == "lambda") costs.lambda = number_of(value);
  if (name == "sigma") costs.sigma = number_of(value);
  if (name == "rho") costs.rho = number_of(value);
  if (name == "vote") costs.vote = number_of(value);
  if (name == "solver") point.labelling.minimizer = query::parse_minimizer(value);
  if (name == "shutter") rendering.base.shutter_s = number_of(value);
  if (name == "softness") rendering.base.gaussian_s = number_of(value);
  if (name == "max-gain") rendering.appearance.max_gain = number_of(value);
  if (name == "blend")
    rendering.blend.weights =
        choice_of<synth::animate::BlendWeights>(value, {{"variance", synth::animate::BlendWeights::kVariance},
                                                        {"paper", synth::animate::BlendWeights::kPaper}});
  if (name == "low-band")
    rendering.blend.low_band =
        choice_of<synth::animate::LowBand>(value, {{"shared", synth::animate::LowBand::kShared},
                                                   {"keep", synth::animate::LowBand::kKeep},
                                                   {"remove", synth::animate::LowBand::kRemove}});
  if (name == "matching")
    rendering.matching = choice_of<synth::animate::AppearanceMatching>(
        value, {{"sequence", synth::animate::AppearanceMatching::kSequence},
                {"frame", synth::animate::AppearanceMatching::kFrame},
                {"none", synth::animate::AppearanceMatching::kNone}});
}

}  // namespace

std::string sweepable_names() {
  std::vector<std::string> names;
  for (const Sweepable& sweepable : sweepables())
    names.push_back(sweepable.words.empty()
                        ? std::string(sweepable.name)
                        : fmt::format("{} ({})", sweepable.name, fmt::join(sweepable.words, ", ")));
  return fmt::format("{}", fmt::join(names, ", "));
}

SweepAxis parse_axis(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos)
    refuse(text, "no \"=\"", "Write a name and its values, for example --sweep sigma=100,1000");
  SweepAxis axis{text.substr(0, equals), {}};
  const auto known = std::find_if(sweepables().begin(), sweepables().end(),
                                  [&](const Sweepable& sweepable) { return axis.name == sweepable.name; });
  if (known == sweepables().end())
    refuse(text, fmt::format("\"{}\" cannot be swept", axis.name),
           "A sweep shares its candidates; it has " + sweepable_names());
  std::vector<std::string> seen;
  for (std::size_t from = equals + 1; from <= text.size();) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    const std::string value = text.substr(from, to - from);
    from = to + 1;
    if (value.empty()) refuse(text, "a value is missing", "Write values with a comma between two");
    if (!known->words.empty() &&
        std::find(known->words.begin(), known->words.end(), value) == known->words.end())
      refuse(text, fmt::format("\"{}\" is no value of {}", value, known->name),
             fmt::format("It takes {}", fmt::join(known->words, ", ")));
    if (known->words.empty()) {
      const double number = number_of(value);
      if (!(number >= known->minimum && number <= known->maximum))
        refuse(text,
               fmt::format("\"{}\" is no number from {:g} to {:g}", value, known->minimum, known->maximum),
               "Write numbers such as 0.5 or 1000, with a comma between two");
    }
    if (std::find(seen.begin(), seen.end(), plain(*known, value)) != seen.end())
      refuse(text, fmt::format("{} is given twice", value), "Give each value once");
    seen.push_back(plain(*known, value));
    axis.values.push_back(value);
  }
  return axis;
}

std::string SweepPoint::title() const {
  std::string text;
  for (const auto& [name, value] : settings) text += (text.empty() ? "" : " ") + name + "=" + value;
  return text;
}

std::vector<SweepPoint> make_grid(const std::vector<SweepAxis>& axes, const SolverOptions& labelling,
                                  const synth::animate::AnimateOptions& rendering) {
  std::size_t count = 1;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      if (axes[j].name == axes[i].name)
        refuse(axes[i].name, "given twice", "Give all of its values at once, with a comma between two");
    count *= axes[i].values.size();
    if (count > kMaxPoints)
      refuse(axes[i].name,
             fmt::format("that makes {} animations or more; {} at most are made at once", count, kMaxPoints),
             "Sweep fewer values");
  }
  std::vector<SweepPoint> points;
  for (std::size_t number = 0; number < count; ++number) {
    SweepPoint point;
    std::size_t rest = number;
    for (std::size_t i = axes.size(); i-- > 0; rest /= axes[i].values.size())
      point.settings.insert(point.settings.begin(),
                            {axes[i].name, axes[i].values[rest % axes[i].values.size()]});
    point.rendering = rendering;
    // The form of costs first: what other weights are by default depends on it.
    std::optional<query::CostForm> form;
    for (const auto& [name, value] : point.settings)
      if (name == "costs") form = query::parse_cost_form(value);
    point.labelling = {form ? labelling.costs(*form) : labelling.costs(), labelling.solver(),
                       labelling.iterations()};
    for (const auto& [name, value] : point.settings) apply(name, value, point);
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace freshet::tools
