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
  double mean = 0, median = 0;
};
Average average(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  double sum = 0;
  for (double value : values) sum += value;
  const std::size_t n = values.size();
  return {sum / static_cast<double>(n), (values[(n - 1) / 2] + values[n / 2]) / 2};
}

std::string header(const std::vector<const char*>& first) {
  std::string heads = "|", rule = "|";
  for (const char* name : first) heads += fmt::format(" {} |", name), rule += " --- |";
  for (const Figure& figure : figures()) heads += fmt::format(" {} |", figure.head), rule += " --- |";
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
        for (const Judged& one : judged)
          if (one.method == method && (class_name == "all" || one.class_name == class_name))
            values.push_back(std::abs(one.distance.*figure.value));
        group.clips = values.size();
        group.averages.push_back(average(values));
      }
      if (group.clips > 0) groups.push_back(std::move(group));
    }
  }
  return groups;
}

}  // namespace

const std::vector<Figure>& figures() {
  static const std::vector<Figure> all{{"spectrum_db", "spectrum dB", &Distance::spectrum_db, 1},
                                       {"matte_db", "of matte dB", &Distance::matte_db, 1},
                                       {"angle_deg", "angle deg", &Distance::angle_deg, 1},
                                       {"speed", "speed log2", &Distance::speed, 2},
                                       {"block_speed", "speed by block", &Distance::block_speed, 2},
                                       {"texture", "texture log2", &Distance::texture, 2},
                                       {"contrast", "contrast log2", &Distance::contrast, 2},
                                       {"ssim", "SSIM", &Distance::ssim, 2, true},
                                       {"flicker", "flicker log2", &Distance::flicker, 2},
                                       {"seam", "seam", &Distance::seam, 2},
                                       {"dead", "dead", &Distance::dead, 2}};
  return all;
}

std::string summary_table(const std::vector<Judged>& judged) {
  std::string text;
  std::string class_name;
  for (const Group& group : groups_of(judged)) {
    if (group.class_name != class_name) {
      class_name = group.class_name;
      text += fmt::format("\n{}: mean / median of sizes\n\n{}", class_name, header({"method", "clips"}));
    }
    text += fmt::format("| {} | {} |", group.method, group.clips);
    for (std::size_t f = 0; f < figures().size(); ++f)
      text += fmt::format(" {0:.{2}f} / {1:.{2}f} |", group.averages[f].mean, group.averages[f].median,
                          figures()[f].digits);
    text += "\n";
  }
  return text;
}

std::string clip_table(const std::vector<Judged>& judged) {
  std::string text = header({"clip", "method"});
  for (const Judged& one : judged) {
    text += fmt::format("| {} | {} |", one.clip, one.method);
    for (const Figure& figure : figures())
      text += fmt::format(" {:.{}f} |", one.distance.*figure.value, figure.digits);
    text += "\n";
  }
  return text;
}

nlohmann::json to_json(const std::vector<Judged>& judged) {
  nlohmann::json rows = nlohmann::json::array(), summary = nlohmann::json::array();
  for (const Judged& one : judged) {
    nlohmann::json row{{"clip", one.clip},       {"class", one.class_name},
                       {"method", one.method},   {"moving", one.distance.moving},
                       {"label_s", one.label_s}, {"render_s", one.render_s}};
    for (const Figure& figure : figures()) row[figure.key] = one.distance.*figure.value;
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
