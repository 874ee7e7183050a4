#include "bench/quality/quality_method.h"

#include <functional>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "freshet/error.h"
#include "synth/animate/method_settings.h"
#include "synth/animate/printed.h"

namespace freshet::bench {
namespace {

struct Setting {
  std::string key, what;
  bool of_labels;  // else of rendering alone
  std::function<void(Method&, const std::string&)> set;
};

double number(const std::string& text) {
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
  }
  if (used == 0 || used != text.size()) throw Error(ErrorKind::kUsage, "\"" + text + "\"", "not a number");
  return value;
}

template <class T>
T one_of(const std::string& text, const std::vector<std::pair<const char*, T>>& names) {
  std::string known;
  for (const auto& [name, value] : names) {
    if (text == name) return value;
    known += std::string(known.empty() ? "" : ", ") + name;
  }
  throw Error(ErrorKind::kUsage, "\"" + text + "\"", "none of " + known);
}

template <class Field>
std::function<void(Method&, const std::string&)> to(Field&& field) {
  return [field](Method& method, const std::string& text) {
    auto& value = field(method);
    value = static_cast<std::remove_reference_t<decltype(value)>>(number(text));
  };
}

const std::vector<Setting>& all_settings() {
  static const std::vector<Setting> settings = [] {
    std::vector<Setting> all{
        {"renderer", "animate, eulerian, eulerian-varying, optimised, example or transfer (see --methods)",
         false,
         [](Method& m, const std::string& text) {
           m.renderer = one_of<Renderer>(text, {{"animate", Renderer::kAnimate},
                                                {"eulerian", Renderer::kCarried},
                                                {"eulerian-varying", Renderer::kCarriedVarying},
                                                {"optimised", Renderer::kOptimised},
                                                {"example", Renderer::kExample},
                                                {"transfer", Renderer::kTransfer}});
         }},
        {"costs", "log or power; resets the four weights that follow", true,
         [](Method& m, const std::string& text) {
           m.label.costs = query::default_costs(query::parse_cost_form(text));
         }},
        {"lambda", "weight of neighbours", true,
         to([](Method & m) -> auto& { return m.label.costs.lambda; })},
        {"sigma", "weight of temporal spectra", true,
         to([](Method & m) -> auto& { return m.label.costs.sigma; })},
        {"rho", "weight of textureness", true, to([](Method & m) -> auto& { return m.label.costs.rho; })},
        {"vote", "weight of the candidates' vote", true,
         to([](Method & m) -> auto& { return m.label.costs.vote; })},
        {"candidates", "of each piece", true, to([](Method & m) -> auto& { return m.label.candidates.k; })},
        {"coherent", "continued candidates of each neighbour", true,
         to([](Method & m) -> auto& { return m.label.candidates.coherent; })},
        {"min-scale", "of a variant", true,
         to([](Method & m) -> auto& { return m.label.candidates.min_scale; })},
        {"max-rotation", "of a variant, degrees", true,
         to([](Method & m) -> auto& { return m.label.candidates.max_rotation_deg; })},
        {"same-class", "1: candidates of the clip's class alone", true,
         to([](Method & m) -> auto& { return m.same_class; })},
        {"tolerance", "of the hint's direction, degrees", true,
         to([](Method & m) -> auto& { return m.label.guide.tolerance_deg; })},
        {"speed-ratio", "tolerance of the hint's speed", true,
         to([](Method & m) -> auto& { return m.label.guide.speed_ratio; })},
        {"hint-search", "wide or narrow; resets the costs of moving otherwise", true,
         [](Method& m, const std::string& text) {
           m.label.hint_search = query::parse_hint_search(text);
           m.label.guide_costs = query::default_guide_costs(m.label.hint_search);
         }},
        {"reuse", "cost of a place shown twice by neighbours", true,
         to([](Method & m) -> auto& { return m.label.reuse.overlap; })},
        {"crowd", "cost of each patch of a clip that has more than half of the pieces", true,
         to([](Method & m) -> auto& { return m.label.reuse.crowd; })},
        {"solver", "trw-s, alpha-expansion or icm", true,
         [](Method& m, const std::string& text) { m.label.minimizer = query::parse_minimizer(text); }},
        {"hint-weight", "times the costs of moving otherwise than asked", true,
         [](Method& m, const std::string& text) {
           m.label.guide_costs = query::weighted(m.label.guide_costs, number(text));
         }},
        {"piece-scale", "divisor of the picture's sides before it is cut into pieces", true,
         to([](Method & m) -> auto& { return m.label.piece_scale; })},
        {"speed",
         "times the speeds that are asked, else that the clips play at; auto: as freshet synth animate has "
         "it",
         false,
         [](Method& m, const std::string& text) {
           m.speed = text == "auto" ? std::nullopt : std::optional(number(text));
         }},
        {"horizon", "auto, as freshet synth animate has it, or none", false,
         [](Method& m, const std::string& text) { m.horizon = text != "none"; }},
        {"own", "1: the clip itself is a candidate too", true, to([](Method & m) -> auto& { return m.own; })},
    };
    for (const synth::animate::MethodSetting& setting : synth::animate::method_settings())
      all.push_back({setting.name, setting.text, false, [&setting](Method& m, const std::string& text) {
                       setting.set(m.animate.method, text);
                       if (setting.name == "method") m.animate.for_fires.reset();
                     }});
    return all;
  }();
  return settings;
}

/// But for the hint: the bench says it.
std::string as_printed() {
  std::string settings;
  for (const synth::animate::PrintedOption& option : synth::animate::printed_options())
    if (std::string_view(option.name) != "hint") settings += fmt::format("{}={} ", option.name, option.value);
  return settings;
}

}  // namespace

const std::vector<NamedSettings>& methods() {
  static const std::vector<NamedSettings> all{
      {"ours", "", "the defaults"},
      {"paper", as_printed(),
       "Okabe et al. 2011 as printed, labels too: what freshet synth animate --as-printed does"},
      {"paper-rendering", "method=paper blend=paper low-band=keep matching=frame speed=1 horizon=none",
       "its rendering alone, of our labels: averaged differences on the long exposure, matched by frame"},
      {"eulerian", "renderer=eulerian",
       "two copies of the still carried along the clip's true mean motion; no hint, no labels"},
      {"eulerian-varying", "renderer=eulerian-varying",
       "two copies of the still carried along the clip's own flow, frame by frame"},
      {"kwatra2005", "renderer=optimised",
       "texture optimisation: the still's own patches, carried along what is asked; else along our labels"},
      {"okabe2009", "renderer=example",
       "one clip, the best for most pieces of those of the still's class: its residuals, carried likewise"},
      {"transfer-own", "renderer=transfer",
       "of fires alone: the still's own flames by appearance transfer, on alpha and flow of a clip's flames; "
       "no hint"},
  };
  return all;
}

const std::vector<NamedSettings>& ablations() {
  static const std::vector<NamedSettings> all{
      {"looks", "lambda=0 vote=0", "each piece takes the candidate that looks most like it: no MRF"},
      {"no-spectra", "sigma=0", "neighbours' temporal spectra do not count"},
      {"no-texture", "rho=0", "neighbours' textureness does not count"},
      {"no-vote", "vote=0", "candidates do not vote on strength of motion"},
      {"power-costs", "costs=power", "distances of raw power, as in the paper"},
      {"no-coherent", "coherent=0", "no continuations of neighbours' candidates"},
      {"one-scale", "min-scale=1", "clips at whole size only"},
      {"no-rotation", "max-rotation=0", "upright clips only"},
      {"paper-blend", "blend=paper", "innovations are averaged where pieces overlap"},
      {"steady", "variation=0", "the picture is carried along a field that does not change"},
      {"no-renewal", "renewal=0", "nothing comes anew from the patches but their level"},
      {"no-contrast", "contrast-gain=1", "contrast that mixing loses is not brought back place by place"},
      {"all-goes", "standing=0", "nothing of the picture keeps its place"},
      {"short-life", "detail-life=.2", "half of carried detail is new after a fifth of a second"},
      {"long-life", "detail-life=2", "half of it is new after two seconds"},
  };
  return all;
}

std::string setting_keys() {
  std::string text;
  for (const Setting& setting : all_settings())
    text += fmt::format("  {:16} {}\n", setting.key, setting.what);
  return text;
}

void apply_settings(const std::string& settings, Method& method) {
  std::string spaced = settings;
  for (char& c : spaced)
    if (c == ',') c = ' ';
  std::istringstream words(spaced);
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    const Setting* found = nullptr;
    for (const Setting& setting : all_settings())
      if (word.substr(0, equals) == setting.key) found = &setting;
    if (!found || equals == std::string::npos)
      throw Error(ErrorKind::kUsage, "setting \"" + word + "\"",
                  "key=value expected, with a key of\n" + setting_keys());
    found->set(method, word.substr(equals + 1));
    if (found->of_labels) method.labels_settings += word + " ";
  }
}

}  // namespace freshet::bench
