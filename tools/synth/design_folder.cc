#include "tools/synth/design_folder.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/picture/motion_file.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"
#include "platform/whole_file.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
namespace sim = synth::simulate;

constexpr const char* kDescription = "design.json";
constexpr std::array kParts{"alpha", "flow", "emitters"};
constexpr const char *kAlpha = "alpha/%05d.png", *kFlo = "flow/%05d.flo", *kExr = "flow/%05d.exr",
                     *kEmitters = "emitters/%05d.png";

void clear(const fs::path& folder) {
  std::error_code fault;
  fs::remove(folder / kDescription, fault);
  for (const char* part : kParts) fs::remove_all(folder / part, fault);
}

}  // namespace

DesignFolder::DesignFolder(const fs::path& folder, const sim::SceneOptions& options,
                           const std::string& scene_text)
    : folder_(folder) {
  std::error_code fault;
  if (fs::exists(folder, fault)) {
    const bool ours = fs::exists(folder / kDescription, fault) || fs::exists(folder / "scene.toml", fault);
    if (!fs::is_directory(folder, fault) || (!ours && !fs::is_empty(folder, fault)))
      throw Error(ErrorKind::kUsage, folder.string(), "it holds something else than a design",
                  "Name a new folder");
    clear(folder);
  }
  fs::create_directory(folder, fault);
  for (const char* part : kParts)
    if (!fault) fs::create_directory(folder / part, fault);
  if (fault)
    throw Error(ErrorKind::kIo, folder.string(), "the folder cannot be made: " + fault.message(),
                "Make the folder above it first");
  write_whole_file(folder / "scene.toml", scene_text);

  const cv::Size cells = sim::cells_of(options.design, options.size);
  const bool designed = options.kind == sim::SceneKind::kDesign;
  description_["size"] = {options.size.width, options.size.height};
  if (designed) {
    description_["grid"] = {cells.width, cells.height};
    description_["steps"] = options.design.steps;
  }
  description_["frames"] = options.frames;
  description_["fps"] = options.fps;
  description_["seed"] = options.seed;
  description_["first_number"] = 0;
  description_["alpha"] = {{"files", kAlpha},
                           {"bits", options.alpha_bits},
                           {"meaning", "the share of a pixel that fluid covers, straight, linear"}};
  description_["flow"] = {{"files", {kFlo, kExr}},
                          {"meaning",
                           "file t belongs to frame t: what lies at p in frame t lies at p + flow in frame t "
                           "+ 1. Pixels a frame; "
                           ".flo: x right, y down; .exr: channels forward.u and forward.v, half, y up"}};
  description_["emitters"] = {{"files", kEmitters},
                              {"meaning", "white where an emitter held the fluid of this frame"},
                              {"frames_with", nlohmann::ordered_json::array()}};
  for (const sim::Emitter& emitter : options.design.emitters)
    description_["emitters"]["names"].push_back(emitter.name);
}

void DesignFolder::write(int number, const sim::SimulatedFrame& frame) {
  write_grey(folder_ / kAlpha, number, frame.alpha);
  write_grey(folder_ / kEmitters, number, frame.emitters);
  for (const char* pattern : {kFlo, kExr})
    media::write_motion(media::numbered(folder_ / pattern, number), frame.motion);
  for (int y = 0; y < frame.emitters.rows; ++y) {
    const std::uint8_t* p = frame.emitters.ptr<std::uint8_t>(y);
    if (std::any_of(p, p + frame.emitters.cols, [](std::uint8_t value) { return value > 0; })) {
      description_["emitters"]["frames_with"].push_back(number);
      break;
    }
  }
}

void DesignFolder::finish() {
  write_whole_file(folder_ / kDescription,
                   description_.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

void write_grey(const fs::path& pattern, int number, const cv::Mat& grey) {
  media::write_picture(media::numbered(pattern, number), grey);
}

}  // namespace freshet::tools
