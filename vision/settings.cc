#include "vision/settings.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "freshet/error.h"

namespace freshet::vision {
namespace {

using nlohmann::json;

[[noreturn]] void damaged(const std::string& fault) {
  throw Error(ErrorKind::kDamaged, "settings of the store", fault);
}

const char* name_of(FlowMethod method) { return method == FlowMethod::kDis ? "dis" : "tv-l1"; }

// A JSON object whose every key must be taken exactly once.
class Fields {
 public:
  Fields(const json& object, std::string where) : object_(object), where_(std::move(where)) {
    if (!object.is_object()) damaged(where_ + " is not an object");
  }

  const json& take(const char* key) {
    const auto found = object_.find(key);
    if (found == object_.end()) damaged(path(key) + " is missing");
    ++taken_;
    return *found;
  }
  double number(const char* key, double minimum, double maximum) {
    return checked(take(key), path(key), minimum, maximum);
  }
  int integer(const char* key, int minimum, int maximum) {
    const json& value = take(key);
    if (!value.is_number_integer()) damaged(path(key) + " is not a whole number");
    return static_cast<int>(checked(value, path(key), minimum, maximum));
  }
  bool boolean(const char* key) {
    const json& value = take(key);
    if (!value.is_boolean()) damaged(path(key) + " is neither true nor false");
    return value.get<bool>();
  }
  std::vector<float> numbers(const char* key, double minimum, double maximum, std::size_t max_values) {
    const json& list = take(key);
    if (!list.is_array() || list.empty() || list.size() > max_values) {
      damaged(path(key) + " is not a list of 1 to " + std::to_string(max_values) + " numbers");
    }
    std::vector<float> values;
    for (const json& value : list)
      values.push_back(static_cast<float>(checked(value, path(key), minimum, maximum)));
    return values;
  }
  // What we do not know may change what a patch means, so it is not passed over.
  void finish() const {
    if (taken_ != object_.size()) damaged(where_ + " holds a setting that this version does not know");
  }

 private:
  std::string path(const char* key) const { return where_ + "." + key; }
  static double checked(const json& value, const std::string& name, double minimum, double maximum) {
    if (!value.is_number()) damaged(name + " is not a number");
    const double number = value.get<double>();
    if (!(number >= minimum && number <= maximum)) {
      damaged(name + " is " + value.dump() + ", outside " + json(minimum).dump() + ".." +
              json(maximum).dump());
    }
    return number;
  }

  const json& object_;
  std::string where_;
  std::size_t taken_ = 0;
};

json to_list(const std::vector<float>& values) {
  json list = json::array();
  for (const float value : values) list.push_back(static_cast<double>(value));
  return list;
}

}  // namespace

std::string to_json(const Settings& s) {
  const json value = {
      {"scales", to_list(s.scales)},
      {"rotations_deg", to_list(s.rotations_deg)},
      {"flips", s.flips},
      {"patch", s.grid.patch},
      {"stride", s.grid.stride},
      {"min_coverage", s.min_coverage},
      {"min_motion_px", s.min_motion_px},
      {"min_change", s.min_change},
      {"flow",
       {{"method", name_of(s.flow.method)},
        {"tvl1_lambda", s.flow.tvl1_lambda},
        {"tvl1_theta", s.flow.tvl1_theta},
        {"tvl1_iterations", s.flow.tvl1_iterations},
        {"tvl1_warps", s.flow.tvl1_warps},
        {"step", s.flow_step}}},
      {"spectrum",
       {{"cell", s.spectrum.cell},
        {"bands", s.spectrum.bands},
        {"window_s", s.spectrum.window_s},
        {"max_hz", s.spectrum.max_hz}}},
      {"texture_cell", s.texture_cell},
      {"codebook",
       {{"words", s.codebook.words}, {"iterations", s.codebook.iterations}, {"seed", s.codebook.seed}}},
  };
  return value.dump();
}

Settings settings_from_json(const std::string& text) {
  if (text.size() > 65536) damaged(std::to_string(text.size()) + " bytes, more than settings can need");
  const json value = json::parse(text, nullptr, false);
  if (value.is_discarded()) damaged("not JSON");

  Settings s;
  Fields all(value, "settings");
  s.scales = all.numbers("scales", 1.0 / 16, 4, 16);
  s.rotations_deg = all.numbers("rotations_deg", -180, 180, 64);
  s.flips = all.boolean("flips");
  s.grid.patch = all.integer("patch", 8, 1024);
  s.grid.stride = all.integer("stride", 1, 1024);
  s.min_coverage = all.number("min_coverage", 0, 1);
  s.min_motion_px = all.number("min_motion_px", 0, 1000);
  s.min_change = all.number("min_change", 0, 1);
  s.texture_cell = all.integer("texture_cell", 1, 64);

  Fields flow(all.take("flow"), "settings.flow");
  const json& method = flow.take("method");
  if (method == "dis") {
    s.flow.method = FlowMethod::kDis;
  } else if (method == "tv-l1") {
    s.flow.method = FlowMethod::kTvL1;
  } else {
    damaged("settings.flow.method is neither dis nor tv-l1");
  }
  s.flow.tvl1_lambda = flow.number("tvl1_lambda", 1e-6, 1000);
  s.flow.tvl1_theta = flow.number("tvl1_theta", 1e-6, 1000);
  s.flow.tvl1_iterations = flow.integer("tvl1_iterations", 1, 10000);
  s.flow.tvl1_warps = flow.integer("tvl1_warps", 1, 100);
  s.flow_step = flow.integer("step", 1, 64);
  flow.finish();

  Fields spectrum(all.take("spectrum"), "settings.spectrum");
  s.spectrum.cell = spectrum.integer("cell", 1, 64);
  s.spectrum.bands = spectrum.integer("bands", 0, kMaxBands);
  s.spectrum.window_s = spectrum.number("window_s", 0.1, 60);
  s.spectrum.max_hz = spectrum.number("max_hz", 0.1, 1000);
  spectrum.finish();

  Fields codebook(all.take("codebook"), "settings.codebook");
  s.codebook.words = codebook.integer("words", 1, kMaxWords);
  s.codebook.iterations = codebook.integer("iterations", 0, 1000);
  const json& seed = codebook.take("seed");
  if (!seed.is_number_unsigned()) damaged("settings.codebook.seed is not a whole number from 0");
  s.codebook.seed = seed.get<std::uint64_t>();
  codebook.finish();
  all.finish();

  // What no single range can say.
  if (s.scales.size() * s.rotations_deg.size() * 2 > 256) damaged("more variants than a byte can number");
  if (s.grid.patch % (kGridSide - 1) != 0) damaged("settings.patch is not a multiple of 8 px");
  if (s.spectrum.cell % s.flow_step != 0)
    damaged("settings.spectrum.cell is not a multiple of settings.flow.step");
  if (s.grid.patch % s.spectrum.cell != 0)
    damaged("settings.patch is not a multiple of settings.spectrum.cell");
  if (s.spectrum.window_s * s.spectrum.max_hz < 1 || motion_bands(s.spectrum) > kMaxBands) {
    damaged("settings.spectrum.window_s times max_hz is outside 1.." + std::to_string(kMaxBands));
  }
  return s;
}

}  // namespace freshet::vision
