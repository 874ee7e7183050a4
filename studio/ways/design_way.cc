#include <algorithm>
#include <cstdint>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "studio/ways/design_scene.h"
#include "studio/ways/way.h"

namespace freshet::studio {
namespace {

constexpr int kDraftSide = 400, kFullSide = 1280;  // px of the film's longer side, at most

/// Even, as H.264 wants it.
cv::Size film_size(const Design& design, cv::Size picture) {
  const int longest = design.full ? kFullSide : kDraftSide;
  const double factor = std::max(1.0, std::max(picture.width, picture.height) / static_cast<double>(longest));
  const auto even = [&](int side) { return std::max(16, 2 * cvRound(side / factor / 2)); };
  return {even(picture.width), even(picture.height)};
}

/// A motion that was designed, and then given the look of a clip over the picture.
WayPlan plan_design(const Document& document) {
  const Design& design = document.design;
  const auto is_source = [](const Drawn& line) { return line.adds; };
  if (std::none_of(design.sources.begin(), design.sources.end(), is_source))
    throw Error(ErrorKind::kUsage, "design", "nothing comes from anywhere", "Draw a source");
  if (!design.look.empty() && document.store.empty())
    throw Error(ErrorKind::kUsage, "design", "the clip that it shall look like has no store",
                "Choose one under Look");
  WayPlan plan{.folder = "design",
               .commands = {{"synth", "simulate", "ways/design/scene.toml", "-o", "ways/design/motion",
                             "--overwrite"}},
               .film = "ways/design/motion/preview.mp4"};
  if (design.look.empty()) return plan;
  plan.film = "ways/design/film.mp4";
  plan.fluid = "ways/design/fluid.mkv";
  plan.store = document.store;
  plan.commands.push_back({"synth", "transfer", "--design", "ways/design/motion", "--store", document.store,
                           "--exemplar", design.look, "--ground", design.ground, "-o", plan.fluid, "--over",
                           "ways/design/behind.png", "--composite", plan.film, "--restart", "--overwrite"});
  return plan;
}

std::vector<WayFile> design_files(const WayInput& input) {
  const Design& design = input.document.design;
  const cv::Mat& picture = input.picture;
  const cv::Size size = film_size(design, picture.size());
  std::vector<WayFile> files{{"scene.toml", design_scene(design, picture.size(), size)}};
  if (design.look.empty()) return files;
  cv::Mat behind;
  cv::resize(picture, behind, size, 0, 0, cv::INTER_AREA);
  std::vector<std::uint8_t> png;
  cv::imencode(".png", behind, png);
  files.push_back({"behind.png", {png.begin(), png.end()}});
  return files;
}

}  // namespace

extern const Way kDesignWay{.name = "design", .plan = plan_design, .files = design_files};

}  // namespace freshet::studio
