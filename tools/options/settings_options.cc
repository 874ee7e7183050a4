#include "tools/options/settings_options.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"

namespace freshet::tools {

void SettingsOptions::add_to(CLI::App& command) {
  const std::string group = "Settings of a new store";
  const auto add = [&](const char* at, CLI::Option* option) {
    options_.push_back({option->group(group), at});
    return option;
  };
  add("/scales",
      command.add_option("--scales", settings_.scales, "Scales at which each clip is cut into patches"))
      ->delimiter(',')
      ->check(CLI::Range(0.1, 1.0))
      ->capture_default_str();
  add("/rotations_deg",
      command.add_option("--rotations", settings_.rotations_deg, "Rotations, degrees counter-clockwise"))
      ->delimiter(',')
      ->check(CLI::Range(-180.0, 180.0))
      ->capture_default_str();
  add("/flips", command.add_flag("--no-flips", no_flips_, "Do not mirror clips"));
  add("/patch", command.add_option("--patch", settings_.grid.patch,
                                   "Side of a patch, px. Small patches follow thin streams; large ones keep "
                                   "whole waves and flames, and fewer of them fit into a clip"))
      ->check(CLI::IsMember({24, 32, 40, 48, 64, 72, 80, 96}))
      ->capture_default_str();
  stride_ = add("/stride", command.add_option("--stride", settings_.grid.stride,
                                              "Distance between patches, px: from a quarter of a patch to a "
                                              "whole one. At a whole patch squares show: for measuring"))
                ->check(CLI::Range(4, 96))
                ->default_str("half of the patch");
  add("/min_coverage",
      command.add_option("--min-coverage", settings_.min_coverage, "Share of a patch that must move, 0 to 1"))
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  add("/min_motion_px", command.add_option("--min-motion", settings_.min_motion_px,
                                           "Smallest mean motion that counts, px a frame at 25 frames/s"))
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  add("/flow/method",
      command.add_option("--flow", flow_, "Optical flow: dis, or the paper's tv-l1 (5 times slower)"))
      ->check(CLI::IsMember({"dis", "tv-l1"}))
      ->capture_default_str();
  add("/flow/step", command.add_option("--flow-step", settings_.flow_step,
                                       "Divisor of the resolution at which flow is stored"))
      ->check(CLI::IsMember({1, 2, 4}))
      ->capture_default_str();
  add("/spectrum/cell", command.add_option("--cell", settings_.spectrum.cell,
                                           "Side of a cell of spectra and textureness, px; 1: every pixel"))
      ->check(CLI::IsMember({1, 2, 4, 8}))
      ->capture_default_str();
  add("/spectrum/bands", command.add_option("--bands", settings_.spectrum.bands,
                                            "Number of bands of the spectra; 0: every frequency"))
      ->check(CLI::Range(0, 16))
      ->capture_default_str();
  add("/codebook/words",
      command.add_option("--words", settings_.codebook.words, "Number of visual words in the codebook"))
      ->check(CLI::Range(2, vision::kMaxWords))
      ->capture_default_str();
}

vision::Settings SettingsOptions::described() const {
  vision::Settings settings = settings_;
  settings.flips = !no_flips_;
  settings.flow.method = vision::parse_flow_method(flow_);
  settings.texture_cell = settings.spectrum.cell;
  if (stride_->count() == 0) settings.grid.stride = settings.grid.patch / 2;
  return settings;
}

vision::Settings SettingsOptions::for_new_store() const {
  const vision::Settings settings = described();
  const int cell = settings.spectrum.cell, step = settings.flow_step, stride = settings.grid.stride;
  const int patch = settings.grid.patch;
  if (stride % 4 != 0 || stride > patch || patch > 4 * stride)
    throw Error(ErrorKind::kUsage, fmt::format("--patch {} --stride {}", patch, stride),
                "pieces cannot be blended at this distance",
                fmt::format("Choose a stride that is a multiple of 4 px, from {} to {}, or leave it out",
                            (patch / 4 + 3) / 4 * 4, patch));
  if (patch % cell != 0)
    throw Error(ErrorKind::kUsage, fmt::format("--cell {} --patch {}", cell, patch),
                "a patch must hold whole cells", "Choose smaller cells, or another patch");
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
  // Options not given keep the defaults, which an older store need not have: only what was given counts. The
  // settings' own form is the shortest way to compare them.
  using Json = nlohmann::json;
  const Json asked = Json::parse(vision::to_json(described()));
  const Json held = Json::parse(vision::to_json(settings));
  for (const Described& given : options_) {
    if (given.option->count() == 0) continue;
    const Json::json_pointer at(given.at);
    if (held.at(at) != asked.at(at))
      throw Error(ErrorKind::kUsage, store,
                  fmt::format("the store was made with another {}: {}, and {} was asked for",
                              given.option->get_name(), held.at(at).dump(), asked.at(at).dump()),
                  "Leave the option out, or make another store");
  }
}

}  // namespace freshet::tools
