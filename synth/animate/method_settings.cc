#include "synth/animate/method_settings.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "freshet/error.h"

namespace freshet::synth::animate {
namespace {

/// Each method with its defaults, by name.
const std::vector<std::pair<std::string, Method>>& methods() {
  static const std::vector<std::pair<std::string, Method>> all{
      {"carried", CarriedOptions{}}, {"forms", FormsOptions{}}, {"paper", PaperOptions{}}};
  return all;
}

/// Where a method's options have a field, as the first of `of` that takes them finds it; null without one.
template <class Value, class... Of>
Value* find(Method& method, const Of&... of) {
  return std::visit(
      [&](auto& options) {
        Value* found = nullptr;
        const auto look = [&](const auto& field) {
          if constexpr (std::is_invocable_v<decltype(field), decltype(options)>) found = field(options);
        };
        (look(of), ...);
        return found;
      },
      method);
}

struct Range {
  double min, max;
};

/// of   take a method's options by reference, and give a pointer to the double; null where it is not there.
template <class... Of>
MethodSetting number(std::string name, std::string text, Range range, Of... of) {
  MethodSetting setting{.name = std::move(name),
                        .text = std::move(text),
                        .min = range.min,
                        .max = range.max,
                        .words = {},
                        .value = {}};
  setting.value = [=](const Method& method) -> std::optional<std::string> {
    Method copy = method;
    const double* const field = find<double>(copy, of...);
    return field != nullptr ? std::optional(fmt::format("{:g}", *field)) : std::nullopt;
  };
  setting.put = [=](Method& method, const std::string& value) {
    double* const field = find<double>(method, of...);
    if (field != nullptr) std::from_chars(value.data(), value.data() + value.size(), *field);
    return field != nullptr;
  };
  return setting;
}

/// The same of an enumeration.
template <class Enum, class... Of>
MethodSetting word(std::string name, std::string text, const std::vector<std::pair<std::string, Enum>>& words,
                   Of... of) {
  MethodSetting setting{.name = std::move(name), .text = std::move(text), .words = {}, .value = {}};
  for (const auto& [known, unused] : words) setting.words.push_back(known);
  setting.value = [=](const Method& method) -> std::optional<std::string> {
    Method copy = method;
    const Enum* const field = find<Enum>(copy, of...);
    if (field == nullptr) return std::nullopt;
    return std::ranges::find(words, *field, &std::pair<std::string, Enum>::second)->first;
  };
  setting.put = [=](Method& method, const std::string& value) {
    Enum* const field = find<Enum>(method, of...);
    if (field != nullptr)
      *field = std::ranges::find(words, value, &std::pair<std::string, Enum>::first)->second;
    return field != nullptr;
  };
  return setting;
}

MethodSetting of_benches(MethodSetting setting) {
  setting.for_commands = false;
  return setting;
}

MethodSetting method_itself() {
  MethodSetting setting{
      .name = "method",
      .text =
          "carried: the picture, carried along the patches' motion (of a fire its flames alone, unless it is "
          "named); forms: flames over the picture's ground, for fires; paper: the patches' differences on a "
          "long "
          "exposure of the picture (Okabe et al. 2011)",
      .words = {},
      .value = [](const Method& method) { return std::optional(methods()[method.index()].first); }};
  for (const auto& [name, unused] : methods()) setting.words.push_back(name);
  setting.put = [](Method& method, const std::string& value) {
    method = std::ranges::find(methods(), value, &std::pair<std::string, Method>::first)->second;
    return true;
  };
  return setting;
}

InnovationOptions* innovations(CarriedOptions& o) { return o.innovations ? &*o.innovations : nullptr; }

std::vector<MethodSetting> rows() {
  return {
      method_itself(),
      word<Resampling>(
          "resampling", "Moments between a clip's frames: flow (made along the motion) or nearest (frame)",
          {{"flow", Resampling::kFlow}, {"nearest", Resampling::kNearest}},
          [](CarriedOptions& o) { return &o.resampling; }, [](PaperOptions& o) { return &o.resampling; }),
      number(
          "shutter", "Exposure of what stands still below, s: blurs it along the motion", {0, 10},
          [](CarriedOptions& o) { return &o.base.shutter_s; },
          [](PaperOptions& o) { return &o.base.shutter_s; }),
      number(
          "softness", "Further blur in all directions: sigma in px for each px/s of speed", {0, 10},
          [](CarriedOptions& o) { return &o.base.gaussian_s; },
          [](PaperOptions& o) { return &o.base.gaussian_s; }),
      number("variation",
             "Share of the patches' flow fluctuations that carries the picture, beside the mean flow; 0: a "
             "steady field",
             {0, 4}, [](CarriedOptions& o) { return &o.carrying.variation; }),
      number("renewal", "Share of the patches' frame-to-frame residual to add, 0 to 1", {0, 1},
             [](CarriedOptions& o) { return innovations(o) ? &innovations(o)->renewal.share : nullptr; }),
      number("standing", "Share of the static light and dark (rock, glow) that stays fixed, 0 to 1", {0, 1},
             [](CarriedOptions& o) { return &o.standing; }),
      number(
          "glitter",
          "Share of sparkles on water (a low sun, a moon) that are lit and go out in place, 0 to 1; 0: they "
          "go along with it",
          {0, 1}, [](CarriedOptions& o) { return &o.glitter; }),
      number("detail-life",
             "Half-life of moving detail, s: short for rapids and flames (.2), long for clouds (4); 0: the "
             "clips' own, of water .4 of that",
             {0, 60}, [](CarriedOptions& o) { return &o.half_life_s; }),
      word<Layout>(
          "layout",
          "What moves: goes (the picture with its forms: seas, clouds), stands (its texture alone: "
          "falls and rapids, whose ledges and brinks do not move) or measured (place by place, as in "
          "the clips)",
          {{"measured", Layout::kMeasured}, {"goes", Layout::kGoes}, {"stands", Layout::kStands}},
          [](CarriedOptions& o) { return &o.layout; }),
      word<Flames>(
          "flames", "Whose flames burn: clips (of the store) or own (the picture's, carried as light)",
          {{"clips", Flames::kClips}, {"own", Flames::kOwn}}, [](FormsOptions& o) { return &o.flames; }),
      of_benches(number("life-pace", "Power of the pace that half-lives are divided by", {0, 4},
                        [](CarriedOptions& o) { return &o.life_pace; })),
      of_benches(number("contrast-gain", "Limit of the gain that restores lost contrast", {1, 4},
                        [](CarriedOptions& o) { return &o.contrast.max_gain; })),
      word<BlendWeights>(
          "blend", "Weights of overlapping pieces: variance (keeps their contrast) or paper (averages)",
          {{"variance", BlendWeights::kVariance}, {"paper", BlendWeights::kPaper}},
          [](CarriedOptions& o) { return innovations(o) ? &innovations(o)->weights : nullptr; },
          [](PaperOptions& o) { return &o.blend.weights; }),
      word<LowBand>("low-band", "Level of each piece over time: shared with its neighbours, keep, or remove",
                    {{"shared", LowBand::kShared}, {"keep", LowBand::kKeep}, {"remove", LowBand::kRemove}},
                    [](PaperOptions& o) { return &o.blend.low_band; }),
      of_benches(number(
          "low-band-reach", "Sigma of the neighbourhood that shares its level, pieces", {0, 100},
          [](CarriedOptions& o) { return innovations(o) ? &innovations(o)->low_band_reach : nullptr; },
          [](PaperOptions& o) { return &o.blend.low_band_reach; })),
      word<AppearanceMatching>("matching",
                               "Contrast and levels matched to the picture: over the whole sequence, by "
                               "frame (the paper's; pumps), or none",
                               {{"sequence", AppearanceMatching::kSequence},
                                {"frame", AppearanceMatching::kFrame},
                                {"none", AppearanceMatching::kNone}},
                               [](PaperOptions& o) { return &o.matching; }),
      number("max-gain", "Limit of the gain of a band in matching", {1, 20},
             [](PaperOptions& o) { return &o.appearance.max_gain; }),
      of_benches(number("max-level-gain", "The same of the picture's own levels", {1, 20},
                        [](PaperOptions& o) { return &o.appearance.max_level_gain; })),
  };
}

bool is_in_range(const MethodSetting& setting, const std::string& text) {
  double number = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  return fault == std::errc() && end == text.data() + text.size() && number >= setting.min &&
         number <= setting.max;
}

}  // namespace

void MethodSetting::set(Method& method, const std::string& given) const {
  const bool right =
      words.empty() ? is_in_range(*this, given) : std::ranges::find(words, given) != words.end();
  if (!right)
    throw Error(ErrorKind::kUsage, name,
                words.empty() ? fmt::format("\"{}\" is no number between {:g} and {:g}", given, min, max)
                              : fmt::format("\"{}\" is none of {}", given, fmt::join(words, ", ")));
  if (!put(method, given))
    throw Error(ErrorKind::kUsage, name, fmt::format("method {} does without it", method_name(method)),
                fmt::format("It belongs to method {}", fmt::join(methods_with(*this), ", ")));
}

const std::vector<MethodSetting>& method_settings() {
  static const std::vector<MethodSetting> all = rows();
  return all;
}

const MethodSetting& method_setting(const std::string& name) {
  const auto found = std::ranges::find(method_settings(), name, &MethodSetting::name);
  if (found == method_settings().end()) throw Error(ErrorKind::kUsage, name, "it is no setting of a method");
  return *found;
}

std::string method_name(const Method& method) { return methods()[method.index()].first; }

std::string default_value(const MethodSetting& setting) {
  for (const auto& [unused, method] : methods())
    if (const auto value = setting.value(method)) return *value;
  return "";
}

std::vector<std::string> methods_with(const MethodSetting& setting) {
  std::vector<std::string> names;
  for (const auto& [name, method] : methods())
    if (setting.value(method)) names.push_back(name);
  return names;
}

}  // namespace freshet::synth::animate
