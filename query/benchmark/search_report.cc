#include "query/benchmark/search_report.h"

#include <fmt/format.h>

namespace freshet::query {
namespace {

nlohmann::json to_json(const SearchTimes& times) {
  return {{"median_ms", times.median_ms}, {"p99_ms", times.p99_ms}, {"all_threads_ms", times.all_threads_ms}};
}

nlohmann::json to_json(const IndexResult& index) {
  nlohmann::json json{{"name", index.name}, {"what", index.what}, {"exact", index.is_exact}};
  if (!index.skipped.empty()) {
    json["skipped"] = index.skipped;
    if (!index.package.empty()) json["package"] = index.package;
    return json;
  }
  json["rows"] = index.rows;
  json["build_seconds"] = index.build_seconds;
  if (index.projected_build_seconds > 0) json["projected_build_seconds"] = index.projected_build_seconds;
  json["from_store"] = index.from_store;
  json["bytes"] = index.bytes;
  json["settings"] = nlohmann::json::array();
  for (const SettingResult& setting : index.settings) {
    nlohmann::json one = to_json(setting.times);
    one["setting"] = setting.name;
    one["pieces"] = setting.pieces;
    one["recall_1"] = setting.recall.at_1;
    one["recall_10"] = setting.recall.at_10;
    one["recall_100"] = setting.recall.at_100;
    one["worst_recall_100"] = setting.recall.worst;
    if (setting.energy_loss) one["energy_loss"] = *setting.energy_loss;
    json["settings"].push_back(std::move(one));
  }
  json["filters"] = nlohmann::json::array();
  for (const FilterResult& filter : index.filters) {
    nlohmann::json one = to_json(filter.times);
    one["condition"] = filter.condition;
    one["setting"] = filter.setting;
    one["admitted"] = filter.admitted;
    one["recall_100"] = filter.recall;
    one["short_of"] = filter.short_of;
    json["filters"].push_back(std::move(one));
  }
  return json;
}

}  // namespace

nlohmann::json to_json(const SearchReport& report) {
  nlohmann::json pictures = nlohmann::json::array();
  for (std::size_t i = 0; i < report.pictures.size(); ++i)
    pictures.push_back({{"name", report.pictures[i]}, {"pieces", report.picture_pieces[i]}});
  nlohmann::json json{{"machine", to_json(report.machine)},
                      {"store", report.store},
                      {"clips", report.clips},
                      {"patches", report.patches},
                      {"rows", report.rows},
                      {"words", report.words},
                      {"pictures", pictures},
                      {"pieces", report.pieces},
                      {"checked", report.checked},
                      {"wrong", report.wrong},
                      {"build_limit_seconds", report.build_limit_s},
                      {"setting_limit_seconds", report.setting_limit_s},
                      {"indexes", nlohmann::json::array()}};
  if (!report.held_out.empty()) json["held_out_clip"] = report.held_out;
  if (!report.labelled.empty())
    json["labelled"] = {{"picture", report.labelled}, {"pieces", report.labelled_pieces}};
  for (const IndexResult& index : report.indexes) json["indexes"].push_back(to_json(index));
  return json;
}

std::string verdict(const SearchReport& report) {
  constexpr double kRecall = 0.9;
  const IndexResult* exact = nullptr;
  const IndexResult* nearest = nullptr;
  const SettingResult* setting = nullptr;
  for (const IndexResult& index : report.indexes) {
    if (index.name == "exact" && !index.settings.empty()) exact = &index;
    if (index.name == "exact" || index.rows != report.rows) continue;
    for (const SettingResult& one : index.settings) {
      if (one.recall.at_100 < kRecall) continue;
      if (setting == nullptr || one.times.median_ms < setting->times.median_ms) {
        nearest = &index;
        setting = &one;
      }
    }
  }
  if (exact == nullptr || nearest == nullptr) return {};
  return fmt::format(
      "From a recall@100 of .9 up, the fastest beside exact is {} ({}): recall {:.3f} in {:.3g} ms a "
      "piece, built in {:.3g} s. Exact: {:.3g} ms, built in {:.3g} s.",
      nearest->name, setting->name, setting->recall.at_100, setting->times.median_ms, nearest->build_seconds,
      exact->settings[0].times.median_ms, exact->build_seconds);
}

}  // namespace freshet::query
