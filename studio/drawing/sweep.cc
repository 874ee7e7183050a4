#include "studio/drawing/sweep.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "studio/drawing/fields.h"

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

bool is_speed(const std::string& value) {
  double speed = 0;
  const auto [end, fault] = std::from_chars(value.data(), value.data() + value.size(), speed);
  return fault == std::errc() && end == value.data() + value.size() && speed >= 0.05 && speed <= 20;
}

bool is_value(const std::string& setting, const std::string& value) {
  if (setting == "speed") return is_speed(value);
  if (setting == "outline") return value == "still" || value == "moving";
  if (setting == "lines") return value == "with" || value == "without";
  return true;
}

SweepAxis read_axis(const Fields& fields) {
  fields.only({"setting", "values"});
  SweepAxis axis{.setting = fields.word("setting", {"speed", "class", "outline", "lines"}), .values = {}};
  for (const Json& item : fields.list("values", kMostValues)) {
    const Json holder{{"values", item}};
    const Fields value = fields.below(holder, "values", axis.values.size());
    axis.values.push_back(value.text("values"));
    if (!is_value(axis.setting, axis.values.back()))
      value.fail(fmt::format("\"values\" has what \"{}\" cannot be", axis.setting));
    if (std::find(axis.values.begin(), axis.values.end() - 1, axis.values.back()) != axis.values.end() - 1)
      value.fail("\"values\" has one twice");
  }
  return axis;
}

}  // namespace

std::size_t swept(const Sweep& sweep) {
  std::size_t animations = sweep.axes.empty() ? 0 : 1;
  for (const SweepAxis& axis : sweep.axes) animations *= axis.values.size();
  return animations;
}

Sweep read_sweep(const Fields& fields) {
  fields.only({"axes", "full"});
  Sweep sweep{.axes = {}, .full = fields.flag("full")};
  for (const Json& item : fields.list("axes", kMostAxes)) {
    const Fields axis = fields.below(item, "axes", sweep.axes.size());
    sweep.axes.push_back(read_axis(axis));
    if (sweep.axes.size() == 2 && sweep.axes[0].setting == sweep.axes[1].setting)
      axis.fail("\"setting\" is that of another axis");
  }
  return sweep;
}

Json sweep_json(const Sweep& sweep) {
  Json json{{"axes", Json::array()}, {"full", sweep.full}};
  for (const SweepAxis& axis : sweep.axes)
    json["axes"].push_back({{"setting", axis.setting}, {"values", axis.values}});
  return json;
}

}  // namespace freshet::studio
