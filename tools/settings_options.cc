#include "tools/settings_options.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet_error.h"

namespace freshet::tools {

void SettingsOptions::add_to(CLI::App& command) {
  const std::string group = "Settings of a new store";
  const auto add = [&](CLI::Option* option) {
    options_.push_back(option->group(group));
    return option;
  };
  add(command.add_option("--scales", settings_.scales, "Scales at which each clip is cut into patches"))
      ->delimiter(',')
      ->check(CLI::Range(0.1, 1.0))
      ->capture_default_str();
  add(command.add_option("--rotations", settings_.rotations_deg, "Rotations, degrees counter-clockwise"))
      ->delimiter(',')
      ->check(CLI::Range(-180.0, 180.0))
      ->capture_default_str();
  add(command.add_flag("--no-flips", no_flips_, "Do not mirror clips"));
  add(command.add_option("--patch", settings_.grid.patch, "Side of a patch, px"))
      ->check(CLI::IsMember({48}))
      ->capture_default_str();
  add(command.add_option(
          "--stride", settings_.grid.stride,
          "Distance between patches, px; at 48 they do not overlap, and squares show: for measuring"))
      ->check(CLI::IsMember({12, 24, 48}))
      ->capture_default_str();
  add(command.add_option("--min-coverage", settings_.min_coverage, "Share of a patch that must move, 0..1"))
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  add(command.add_option("--min-motion", settings_.min_motion_px,
                         "Mean motion that counts, px a frame at 25 frames/s"))
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  add(command.add_option("--flow", flow_, "Optical flow: dis, or the paper's tv-l1 (65 times slower)"))
      ->check(CLI::IsMember({"dis", "tv-l1"}))
      ->capture_default_str();
  add(command.add_option("--flow-step", settings_.flow_step, "Flow is kept at 1/STEP of the resolution"))
      ->check(CLI::IsMember({1, 2, 4}))
      ->capture_default_str();
  add(command.add_option("--cell", settings_.spectrum.cell,
                         "Side of a cell of spectra and textureness, px; 1 is exact"))
      ->check(CLI::IsMember({1, 2, 4, 8}))
      ->capture_default_str();
  add(command.add_option("--bands", settings_.spectrum.bands,
                         "Bands of the spectra; 0 keeps every frequency"))
      ->check(CLI::Range(0, 16))
      ->capture_default_str();
  add(command.add_option("--words", settings_.codebook.words, "Visual words in the codebook"))
      ->check(CLI::Range(2, 256))
      ->capture_default_str();
}

vision::Settings SettingsOptions::described() const {
  vision::Settings settings = settings_;
  settings.flips = !no_flips_;
  settings.flow.method = vision::parse_flow_method(flow_);
  settings.texture_cell = settings.spectrum.cell;
  return settings;
}

vision::Settings SettingsOptions::for_new_store() const {
  const vision::Settings settings = described();
  const int cell = settings.spectrum.cell, step = settings.flow_step, stride = settings.grid.stride;
  if (cell % step != 0)
    throw Error(ErrorKind::kUsage, fmt::format("--cell {} --flow-step {}", cell, step),
                "a cell must hold whole samples of the flow",
                fmt::format("Add --flow-step {}, or choose larger cells", cell));
  if (stride % cell != 0)
    throw Error(ErrorKind::kUsage, fmt::format("--cell {} --stride {}", cell, stride),
                "overlapping patches must share whole cells",
                "Choose smaller cells, or a stride that is a multiple of the cell");
  return settings;
}

void SettingsOptions::check_against(const vision::Settings& settings, const std::string& store) const {
  bool given = false;
  std::string name;
  for (const CLI::Option* option : options_)
    if (option->count() > 0) given = true, name = option->get_name();
  if (!given) return;
  // Options not given keep the defaults, which an older store need not have: only a contradiction in what was
  // given matters, and the settings' own form is the shortest way to compare them.
  const nlohmann::json asked = nlohmann::json::parse(vision::to_json(described()));
  const nlohmann::json defaults = nlohmann::json::parse(vision::to_json(vision::Settings{}));
  const nlohmann::json held = nlohmann::json::parse(vision::to_json(settings));
  for (const nlohmann::json& step : nlohmann::json::diff(defaults, asked)) {
    const nlohmann::json::json_pointer at(step.at("path").get<std::string>());
    if (!held.contains(at) || !asked.contains(at) || held.at(at) != asked.at(at))
      throw Error(
          ErrorKind::kUsage, store,
          "the store was made with other settings than " + name + " asks for (" + at.to_string() + ")",
          "Leave the option out, or make another store");
  }
}

}  // namespace freshet::tools
