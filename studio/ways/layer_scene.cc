#include "studio/ways/layer_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "studio/drawing/drawn_matte.h"
#include "studio/drawing/toml_text.h"

namespace freshet::studio {
namespace {

[[noreturn]] void lacks(const DrawnLayer& layer, const std::string& what, const std::string& remedy) {
  throw Error(ErrorKind::kUsage, "layer " + layer.name, what, remedy);
}

std::string png(const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", picture, bytes);
  return {bytes.begin(), bytes.end()};
}

constexpr int kSceneFps = 25;

/// White where the layer is.
cv::Mat painted(const DrawnLayer& layer, cv::Size size) {
  cv::Mat matte = cv::Mat::zeros(size, CV_8U);
  paint(layer.paint, matte);
  return matte;
}

/// White on the layer, black beside it, transparent where nothing was said.
cv::Mat scribbled(const DrawnLayer& layer, cv::Size size) {
  cv::Mat said = cv::Mat::zeros(size, CV_8U), white = cv::Mat::zeros(size, CV_8U);
  std::vector<Drawn> everywhere = layer.paint;
  for (Drawn& line : everywhere) line.adds = true;
  paint(everywhere, said);
  paint(layer.paint, white);
  // Half of an edge's pixel says nothing.
  const cv::Mat sure = said == 255;
  cv::Mat scribbles;
  cv::merge(std::vector<cv::Mat>{white, white, white, sure}, scribbles);
  return scribbles;
}

/// Empty: there is none.
std::string film_of(const DrawnLayer& layer, const SceneFiles& files) {
  if (layer.film == "design") return files.design;
  if (layer.film == "flowlines") return files.flowlines;
  if (layer.film == "stills") return files.stills;
  return layer.clip.empty() ? "" : files.clips + "/" + layer.clip;
}

bool is_painted(const DrawnLayer& layer) {
  return std::any_of(layer.paint.begin(), layer.paint.end(), [](const Drawn& line) { return line.adds; });
}

void expect_drawn(const DrawnLayer& layer, const SceneFiles& files) {
  if (layer.motion == "footage") {
    if (film_of(layer, files).empty())
      lacks(layer, "it has no film",
            "Drop one, give a motion its look under Design, make a clip endless under Flow lines, "
            "or a film under Stills");
    return;
  }
  if (layer.matte != LayerMatte::kRest && !is_painted(layer))
    lacks(layer, "it is nowhere", "Paint where it is");
  if (layer.motion == "patches" && files.store.empty())
    lacks(layer, "its patches have no store", "Choose one under Look");
  if (layer.motion == "tree" && !layer.sway_clip.empty()) {
    if (layer.sway_lines.empty())
      lacks(layer, "nothing says where in its clip the plant stands",
            "Draw a line on the clip's picture, from the plant's root to its tip");
    if (!layer.sway_dropped && files.store.empty())
      lacks(layer, "its clip is a store's, and none is chosen", "Choose one under Look");
  }
  const DrawnMotion& motion = drawn_motion(layer.motion);
  if (layer.lines.empty() && motion.missing != nullptr) lacks(layer, motion.missing, motion.remedy);
}

/// Where footage lies, px of the picture; as high as its shape makes it.
struct FilmPlace {
  cv::Point at;
  int width = 1;
};

/// Over all of the picture's width, unless a line says otherwise.
FilmPlace place_of(const DrawnLayer& layer, cv::Size size) {
  cv::Point2f from(0, 0), to(static_cast<float>(size.width), 0);
  if (!layer.lines.empty()) from = layer.lines.front().points.front(), to = layer.lines.front().points.back();
  return {.at = {cvRound(std::min(from.x, to.x)), cvRound(std::min(from.y, to.y))},
          .width = std::max(1, cvRound(std::abs(to.x - from.x)))};
}

/// What was painted over the picture, as it lies over the film. Empty: all of the film is seen.
cv::Mat film_matte(const DrawnLayer& layer, cv::Size picture, cv::Size film) {
  const FilmPlace place = place_of(layer, picture);
  const double scale = 1.0 * place.width / film.width;  // from the film's px to the picture's
  const cv::Matx23d picture_from_film(scale, 0, 0.5 * scale - 0.5 + place.at.x, 0, scale,
                                      0.5 * scale - 0.5 + place.at.y);
  cv::Mat matte;
  cv::warpAffine(painted(layer, picture), matte, picture_from_film, film,
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT);
  double least = 0, most = 0;
  cv::minMaxLoc(matte, &least, &most);
  if (most == 0)
    lacks(layer, "its paint lies beside the film", "Paint what of it is seen, or clear the paint");
  return least == 255 ? cv::Mat() : matte;
}

std::string footage_keys(const DrawnLayer& layer, cv::Size size, const SceneFiles& files) {
  const FilmPlace place = place_of(layer, size);
  return fmt::format("file = {}\nat = [{}, {}]\nwidth = {}\nstart = {}\nrepeat = {}\nground = \"{}\"\n",
                     toml_text(film_of(layer, files)), place.at.x, place.at.y, place.width, layer.start,
                     layer.repeats, layer.ground);
}

/// The plant of a clip that it sways as.
std::string sway_keys(const DrawnLayer& layer, const SceneFiles& files) {
  if (layer.sway_clip.empty()) return "";
  std::string lines;
  for (const DrawnStroke& line : layer.sway_lines)
    lines +=
        fmt::format("{}[{:.2f}, {:.2f}, {:.2f}, {:.2f}]", lines.empty() ? "" : ", ", line.points.front().x,
                    line.points.front().y, line.points.back().x, line.points.back().y);
  return (layer.sway_dropped
              ? "motion_from = " + toml_text(files.clips + "/" + layer.sway_clip)
              : "motion_from = " + toml_text(files.store) + "\nmotion_clip = " + toml_text(layer.sway_clip)) +
         "\nmotion_armature = [" + lines + "]\n";
}

/// What its motion has to say.
std::string motion_keys(const DrawnLayer& layer, const SceneFiles& files) {
  if (layer.motion == "tree")
    return fmt::format("plant = \"{}\"\nshimmer = {}\n", layer.plant, layer.shimmer) +
           sway_keys(layer, files);
  if (layer.motion == "water")
    return (layer.waves > 0 ? fmt::format("amplitude = {}\n", layer.waves) : "") +
           fmt::format("mirrors = {}\n", layer.mirrors);
  if (layer.motion == "boat")
    return fmt::format("heave = {0}\nroll = {0}\n", layer.roll) + (layer.in_3d ? "in_3d = true\n" : "");
  if (layer.motion == "clouds")
    return (layer.drift != 0 ? fmt::format("speed = {}\n", layer.drift) : "") +
           (layer.shade > 0 ? fmt::format("shade = {}\n", layer.shade) : "");
  if (layer.motion != "patches") return "";
  return "store = " + toml_text(files.store) + "\n" +
         (layer.class_name.empty() ? "" : "class = " + toml_text(layer.class_name) + "\n");
}

bool glows(const DrawnLayer& layer) {
  return layer.motion == "footage" || layer.motion == "patches" || layer.motion == "water";
}

bool has_lines(const DrawnLayer& layer) {
  return !layer.lines.empty() && drawn_motion(layer.motion).marks != DrawnMotion::Lines::kNone;
}

/// The lines that count.
std::string marks_svg(const DrawnScene& scene, cv::Size size) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n",
      size.width, size.height);
  for (const DrawnLayer& layer : scene.layers) {
    if (!has_lines(layer)) continue;
    svg += fmt::format("<g data-layer=\"{}\" fill=\"none\" stroke=\"#fff\">\n", layer.name);
    for (const DrawnStroke& line : layer.lines) {
      std::string points;
      for (const cv::Point2f& point : line.points)
        points += fmt::format("{}{:.2f},{:.2f}", points.empty() ? "" : " ", point.x, point.y);
      svg += fmt::format("  <polyline points=\"{}\"/>\n", points);
      if (drawn_motion(layer.motion).marks == DrawnMotion::Lines::kFirst) break;
    }
    svg += "</g>\n";
  }
  return svg + "</svg>\n";
}

/// What the wind is and, where it changes, what it becomes: by the film's end, or by a loop's middle and back.
std::string wind_tables(const DrawnScene& scene) {
  std::string toml = fmt::format("[wind]\nspeed = {}\ndirection = {}\ngustiness = {}\n", scene.wind,
                                 scene.direction, scene.gustiness);
  if (!scene.changes) return toml;
  const auto becomes = [&](double frames, double speed) {
    toml += fmt::format("[[wind.at]]\ntime = {}\nspeed = {}\n", frames / kSceneFps, speed);
  };
  becomes(scene.loop ? scene.frames / 2.0 : scene.frames, scene.becomes);
  if (scene.loop) becomes(scene.frames, scene.wind);
  return toml;
}

}  // namespace

std::vector<WayFile> layer_scene(const DrawnScene& scene, cv::Size size, const SceneFiles& files) {
  if (scene.layers.empty()) throw Error(ErrorKind::kUsage, "layers", "there is none", "Add one");
  std::vector<WayFile> made;
  std::string toml = fmt::format("picture = {}\nframes = {}\nfps = {}\nloop = {}\n", toml_text(files.picture),
                                 scene.frames, kSceneFps, scene.loop);
  if (std::any_of(scene.layers.begin(), scene.layers.end(), has_lines)) {
    toml += "marks = \"marks.svg\"\n";
    made.push_back({"marks.svg", marks_svg(scene, size)});
  }
  toml += wind_tables(scene);
  int place = 0;
  for (const DrawnLayer& layer : scene.layers) {
    expect_drawn(layer, files);
    const std::string file = fmt::format("layer-{}.png", ++place);
    toml += fmt::format("[[layer]]\nname = {}\nmotion = \"{}\"\nblend = \"{}\"\n", toml_text(layer.name),
                        layer.motion, layer.blend);
    if (layer.glow > 0 && glows(layer))
      toml += fmt::format("glow = {}\n", layer.glow) +
              (layer.glow_reach > 0 ? fmt::format("glow_reach = {}\n", std::max(1.0, layer.glow_reach)) : "");
    if (layer.motion == "footage") {
      toml += footage_keys(layer, size, files);
      if (!layer.matte_clip.empty())
        toml += fmt::format("matte = {}\n", toml_text(files.clips + "/" + layer.matte_clip));
      const cv::Mat matte = layer.matte_clip.empty() && is_painted(layer)
                                ? film_matte(layer, size, files.film_size(film_of(layer, files)))
                                : cv::Mat();
      if (!matte.empty()) {
        toml += fmt::format("matte = \"{}\"\n", file);
        made.push_back({file, png(matte)});
      }
    } else if (layer.matte == LayerMatte::kRest) {
      toml += "matte = \"rest\"\n";
    } else if (layer.matte == LayerMatte::kPainted) {
      toml += fmt::format("matte = \"{}\"\n", file);
      made.push_back({file, png(painted(layer, size))});
    } else {
      toml += fmt::format("scribbles = \"{}\"\n", file);
      made.push_back({file, png(scribbled(layer, size))});
    }
    toml += motion_keys(layer, files);
  }
  made.push_back({"scene.toml", toml});
  return made;
}

}  // namespace freshet::studio
