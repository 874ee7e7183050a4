#include "bench/quality/quality_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace freshet::bench {
namespace {

std::vector<std::string> in_order(const std::vector<Judged>& judged, std::string Judged::*field) {
  std::vector<std::string> names;
  for (const Judged& one : judged)
    if (std::find(names.begin(), names.end(), one.*field) == names.end()) names.push_back(one.*field);
  return names;
}

struct Average {
  double mean = kNotMeasured, median = kNotMeasured;
};
Average average(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  double sum = 0;
  for (double value : values) sum += value;
  const std::size_t n = values.size();
  return {sum / static_cast<double>(n), (values[(n - 1) / 2] + values[n / 2]) / 2};
}

constexpr FigureGroup kParts[] = {FigureGroup::kMotion, FigureGroup::kLook, FigureGroup::kAsked};

std::string header(const std::vector<const char*>& first, FigureGroup part) {
  std::string heads = "|", rule = "|";
  for (const char* name : first) heads += fmt::format(" {} |", name), rule += " --- |";
  for (const Figure& figure : figures())
    if (figure.group == part) heads += fmt::format(" {} |", figure.head), rule += " --- |";
  return heads + "\n" + rule + "\n";
}

struct Group {
  std::string class_name, method;
  std::size_t clips = 0;
  std::vector<Average> averages;  // by figure
};

std::vector<Group> groups_of(const std::vector<Judged>& judged) {
  std::vector<std::string> classes = in_order(judged, &Judged::class_name);
  std::sort(classes.begin(), classes.end());
  classes.insert(classes.begin(), "all");
  std::vector<Group> groups;
  for (const std::string& class_name : classes) {
    for (const std::string& method : in_order(judged, &Judged::method)) {
      Group group{class_name, method, 0, {}};
      for (const Figure& figure : figures()) {
        std::vector<double> values;
        group.clips = 0;
        for (const Judged& one : judged) {
          if (one.method != method || (class_name != "all" && one.class_name != class_name)) continue;
          ++group.clips;
          const double value = figure.value(one.distance);
          if (!std::isnan(value)) values.push_back(figure.is_signed ? value : std::abs(value));
        }
        group.averages.push_back(average(values));
      }
      if (group.clips > 0) groups.push_back(std::move(group));
    }
  }
  return groups;
}

}  // namespace

const char* to_string(FigureGroup group) {
  switch (group) {
    case FigureGroup::kMotion:
      return "motion and level";
    case FigureGroup::kLook:
      return "look";
    case FigureGroup::kAsked:
      return "what was asked";
  }
  return "";
}

const std::vector<Figure>& figures() {
  using enum FigureGroup;
  using D = const Distance&;
  static const std::vector<Figure> all{
      {"spectrum_db", "spectrum dB", [](D d) { return d.spectrum_db; }, 1},
      {"matte_db", "of matte dB", [](D d) { return d.matte_db; }, 1},
      {"angle_deg", "angle deg", [](D d) { return d.angle_deg; }, 1},
      {"speed", "speed log2", [](D d) { return std::abs(d.speed); }, 2},
      {"speed_signed", "speed +-", [](D d) { return d.speed; }, 2, kMotion, false, true},
      {"block_speed", "speed by block", [](D d) { return d.block_speed; }, 2},
      {"pace", "pace log2", [](D d) { return std::abs(d.pace); }, 2},
      {"pace_signed", "pace +-", [](D d) { return d.pace; }, 2, kMotion, false, true},
      {"flicker", "flicker log2", [](D d) { return d.flicker; }, 2},
      {"dead", "dead", [](D d) { return d.dead; }, 2},
      {"texture", "texture log2", [](D d) { return d.texture; }, 2, kLook},
      {"contrast", "contrast log2", [](D d) { return d.contrast; }, 2, kLook},
      {"ssim", "SSIM", [](D d) { return d.ssim; }, 2, kLook, true},
      {"seam", "seam", [](D d) { return d.seam; }, 2, kLook},
      {"lifetime", "lifetime", [](D d) { return d.lifetime; }, 3, kLook},
      {"half_life_s", "half-life s", [](D d) { return d.half_life_s; }, 2, kLook},
      {"swd0", "SWD 0", [](D d) { return d.patches[0]; }, 2, kLook},
      {"swd1", "SWD 1", [](D d) { return d.patches[1]; }, 2, kLook},
      {"swd2", "SWD 2", [](D d) { return d.patches[2]; }, 2, kLook},
      {"swd3", "SWD 3", [](D d) { return d.patches[3]; }, 2, kLook},
      {"swd4", "SWD 4", [](D d) { return d.patches[4]; }, 2, kLook},
      {"ribbon", "ribbon log2", [](D d) { return std::abs(d.ribbon); }, 2, kLook},
      {"ribbon_signed", "ribbon +-", [](D d) { return d.ribbon; }, 2, kLook, false, true},
      {"comes_again", "comes again", [](D d) { return d.again; }, 2, kLook},
      {"comes_again_beyond", "again +-", [](D d) { return d.again_beyond; }, 2, kLook, false, true},
      {"colour_drift", "colour drift", [](D d) { return d.drift; }, 1, kLook},
      {"faults", "critic", [](D d) { return d.faults; }, 1, kLook},
      {"start", "start", [](D d) { return d.start; }, 2, kAsked, true},
      {"back_seconds", "seconds back", [](D d) { return d.back_seconds; }, 2, kAsked},
      {"back_blocks", "blocks back", [](D d) { return d.back_blocks; }, 2, kAsked},
      {"clip_share", "one clip", [](D d) { return d.clip_share; }, 2, kAsked},
      {"patch_share", "one patch", [](D d) { return d.patch_share; }, 3, kAsked},
      {"malf", "MALF", [](D d) { return d.loop; }, 2, kAsked, true}};
  return all;
}

std::string to_string(const Figure& figure, double value) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, figure.digits);
}

std::string summary_table(const std::vector<Judged>& judged) {
  std::string text;
  const std::vector<Group> groups = groups_of(judged);
  for (std::size_t first = 0; first < groups.size();) {
    std::size_t end = first;
    while (end < groups.size() && groups[end].class_name == groups[first].class_name) ++end;
    for (const FigureGroup part : kParts) {
      text += fmt::format("\n{}, {}: mean / median of sizes (+-: signed)\n\n{}", groups[first].class_name,
                          to_string(part), header({"method", "clips"}, part));
      for (std::size_t g = first; g < end; ++g) {
        text += fmt::format("| {} | {} |", groups[g].method, groups[g].clips);
        for (std::size_t f = 0; f < figures().size(); ++f)
          if (figures()[f].group == part)
            text += fmt::format(" {} / {} |", to_string(figures()[f], groups[g].averages[f].mean),
                                to_string(figures()[f], groups[g].averages[f].median));
        text += "\n";
      }
    }
    first = end;
  }
  return text;
}

std::string clip_table(const std::vector<Judged>& judged) {
  std::string text;
  for (const FigureGroup part : kParts) {
    text += fmt::format("\nby clip, {}\n\n{}", to_string(part), header({"clip", "method"}, part));
    for (const Judged& one : judged) {
      text += fmt::format("| {} | {} |", one.clip, one.method);
      for (const Figure& figure : figures())
        if (figure.group == part) text += fmt::format(" {} |", to_string(figure, figure.value(one.distance)));
      text += "\n";
    }
  }
  return text;
}

nlohmann::json to_json(const std::vector<Judged>& judged) {
  // NaN is written as null.
  nlohmann::json rows = nlohmann::json::array(), summary = nlohmann::json::array();
  for (const Judged& one : judged) {
    nlohmann::json row{{"clip", one.clip},       {"class", one.class_name},
                       {"method", one.method},   {"moving", one.distance.moving},
                       {"label_s", one.label_s}, {"render_s", one.render_s}};
    for (const Figure& figure : figures()) row[figure.key] = figure.value(one.distance);
    row["lifetime_curve"] = one.lifetime;
    for (const synth::judging::Finding& finding : one.verdict.findings)
      row["critic"][synth::judging::words_of(finding.measure).name] = {{"value", finding.reading.value},
                                                                       {"fault", finding.fault}};
    rows.push_back(std::move(row));
  }
  for (const Group& group : groups_of(judged)) {
    nlohmann::json row{{"class", group.class_name}, {"method", group.method}, {"clips", group.clips}};
    for (std::size_t f = 0; f < figures().size(); ++f)
      row[figures()[f].key] = {{"mean", group.averages[f].mean}, {"median", group.averages[f].median}};
    summary.push_back(std::move(row));
  }
  return {{"rows", rows}, {"summary", summary}};
}

}  // namespace freshet::bench
