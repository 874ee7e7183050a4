#include "synth/scene/rendering/scene_animation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "synth/sampling/bilinear.h"
#include "synth/scene/motion/boat_ride.h"
#include "synth/scene/motion/cloud_drift.h"
#include "synth/scene/motion/floating_sheet.h"
#include "synth/scene/motion/stillness.h"
#include "synth/scene/motion/tree_sway.h"
#include "synth/scene/motion/water_surface.h"
#include "synth/scene/rendering/calm_water.h"
#include "synth/scene/scene_marks.h"

namespace freshet::synth::scene {
namespace {

Outline outline_of(const SceneLayer& layer) {
  if (const auto* water = layer.as<WaterMotion>(); water != nullptr && !water->edge_moves)
    return Outline::kHeld;
  if (layer.as<CloudMotion>() != nullptr) return Outline::kCyclic;
  return Outline::kMoves;
}

/// box   of the layer, px.
CloudCourse course_in(const Scene& scene, const CloudMotion& clouds, const cv::Rect& box, cv::Size picture) {
  return course_of(clouds, scene.wind, cycle_of(scene), scene.loop, box.width, picture.width);
}

/// kept   of the layer; null: none is.
Sprite sprite_of(const Scene& scene, const SceneLayer& layer, const LayerPixels& pixels,
                 KeptSprites::Of* kept) {
  constexpr int kMargins = 4;  // of a layer's width, which kept continuations of it are multiples of
  const cv::Mat& alpha = pixels.alpha;
  const auto* clouds = layer.as<CloudMotion>();
  const auto* water = layer.as<WaterMotion>();
  const double calm = water != nullptr ? water->calm : 0;
  const Line horizon = calm > 0 ? *water->horizon : Line{};
  const auto colour = [&] { return calm > 0 ? calmed(pixels.colour, alpha, horizon, calm) : pixels.colour; };
  const Outline outline = outline_of(layer);
  const int width = box_of(alpha).width;
  const CloudCourse course = clouds ? course_in(scene, *clouds, box_of(alpha), alpha.size()) : CloudCourse{};
  int period = course.period_px;
  if (kept == nullptr) return make_sprite(colour(), alpha, outline, period);
  const bool fits = course.dissolves ? kept->sprite.period() >= period : kept->sprite.period() == period;
  if (kept->sprite.texture.empty() || kept->outline != outline || kept->calm != calm ||
      kept->horizon != horizon || (clouds && !fits)) {
    const int step = std::max(1, width / kMargins);
    if (course.dissolves) period = width + 2 + 2 * step * ((period - width - 2 + 2 * step - 1) / (2 * step));
    *kept = {outline, calm, horizon, make_sprite(colour(), alpha, outline, period)};
  }
  Sprite sprite = kept->sprite;
  sprite.texture = sprite.texture.clone();  // a mirror is written into it
  return sprite;
}

/// The layer that a boat floats on; there is one (read_scene).
const SceneLayer& water_under(const Scene& scene, const BoatMotion& boat) {
  return *std::ranges::find_if(scene.layers, [&](const SceneLayer& other) {
    return other.as<WaterMotion>() != nullptr && (boat.water.empty() || other.name == boat.water);
  });
}

/// A reflection without a hull line has that of its boat.
Line hull_of(const Scene& scene, const BoatMotion& boat) {
  if (boat.hull) return *boat.hull;
  const auto above = std::ranges::find(scene.layers, boat.reflection_of, &SceneLayer::name);
  return *above->as<BoatMotion>()->hull;
}

/// Of the boat that moves or is mirrored: both move in one way.
bool moves_in_3d(const Scene& scene, const BoatMotion& boat) {
  const auto above = std::ranges::find(scene.layers, boat.reflection_of, &SceneLayer::name);
  return boat.reflection_of.empty() ? boat.in_3d : above->as<BoatMotion>()->in_3d;
}

/// Throws where a boat in three dimensions would float in the sky, or would be seen along its edge.
Waterplane checked_waterplane(const Scene& scene, const SceneLayer& layer, const Line& hull,
                              const WaterCamera& camera) {
  const cv::Point2d middle = (hull.from + hull.to) * 0.5;
  if (camera.rolled(middle.x - 0.5, middle.y - 0.5).y < camera.horizon() + 1)
    throw Error(
        ErrorKind::kInput, scene.file.string(),
        fmt::format("layer {}: the middle of its hull line, ({:.0f}, {:.0f}), lies above the water's horizon",
                    layer.name, middle.x, middle.y),
        "Draw the line along the waterline, the horizon above it, or leave in_3d out");
  const Waterplane plane = waterplane_of(hull, camera);
  if (!sees_side(plane))
    throw Error(
        ErrorKind::kInput, scene.file.string(),
        fmt::format("layer {}: its hull line, from ({:.0f}, {:.0f}) to ({:.0f}, {:.0f}), points at the "
                    "camera, which sees no side of it",
                    layer.name, hull.from.x, hull.from.y, hull.to.x, hull.to.y),
        "Draw the line more level, give the water a greater focal, or leave in_3d out");
  return plane;
}

/// px, where boats lie on this water. camera   that sees it.
cv::Rect boats_on(const Scene& scene, const SceneLayer& water, const WaterCamera& camera, cv::Size picture) {
  cv::Rect all;
  for (const SceneLayer& layer : scene.layers) {
    const auto* boat = layer.as<BoatMotion>();
    if (boat == nullptr || &water_under(scene, *boat) != &water) continue;
    const Line hull = hull_of(scene, *boat);
    const cv::Point from(cvFloor(std::min(hull.from.x, hull.to.x)),
                         cvFloor(std::min(hull.from.y, hull.to.y)));
    const cv::Point to(cvCeil(std::max(hull.from.x, hull.to.x)), cvCeil(std::max(hull.from.y, hull.to.y)));
    all |= cv::Rect(from, to + cv::Point(1, 1));
    // What of a boat lies further beside the picture has no waves.
    const cv::Rect near(-picture.width, -picture.height, 3 * picture.width, 3 * picture.height);
    if (moves_in_3d(scene, *boat))
      all |= waterplane_box(checked_waterplane(scene, layer, hull, camera), camera) & near;
  }
  return all;
}

/// On the horizon of the ground that clouds shade. box   of the clouds, px.
Line ground_of(const Scene& scene, const SceneLayer& layer, const cv::Rect& box, cv::Size picture) {
  const double width = picture.width, lowest = box.br().y;
  Line horizon{{0, lowest}, {width, lowest}};
  for (const SceneLayer& other : scene.layers)
    if (const auto* water = other.as<WaterMotion>()) {
      horizon = *water->horizon;
      break;
    }
  if (const auto& given = layer.as<CloudMotion>()->ground) horizon = *given;
  const cv::Point2d from = horizon.from, way = horizon.to - horizon.from;
  if (from.y + way.y * (width / 2 - from.x) / way.x > picture.height - 2)
    throw Error(
        ErrorKind::kInput, scene.file.string(),
        fmt::format("layer {}: no ground lies below the horizon, which clouds could shade", layer.name),
        "Give ground = [x, y, x, y] on the horizon of the land, or take shade out");
  return horizon;
}

/// Whether shadows and the light of fires fall on it; they do not on the sky, and on what adds its own light.
bool lies_in_light(const SceneLayer& layer) {
  return layer.as<CloudMotion>() == nullptr && layer.blend == Blend::kOver;
}

/// Where what stands upright meets the ground; nothing: it lies on it.
std::optional<cv::Point2d> foot_of(const Scene& scene, const SceneLayer& layer) {
  if (const auto* boat = layer.as<BoatMotion>()) {
    const Line hull = hull_of(scene, *boat);
    return (hull.from + hull.to) * 0.5;
  }
  const auto* tree = layer.as<TreeMotion>();
  if (tree == nullptr) return {};
  return std::ranges::max(tree->armatures, {}, [](const Line& line) { return line.from.y; }).from;
}

/// d' of a motion at each pixel, CV_32FC2.
cv::Mat displacement(const Motion& motion, cv::Size size) {
  cv::Mat field(size, CV_32FC2);
  oneapi::tbb::parallel_for(0, size.height, [&](int y) {
    std::vector<float> dx(static_cast<std::size_t>(size.width)), dy(dx.size());
    motion.row(0, 0, y, size.width, dx.data(), dy.data());
    auto* to = field.ptr<cv::Vec2f>(y);
    for (std::size_t x = 0; x < dx.size(); ++x) to[x] = {dx[x], dy[x]};
  });
  return field;
}

/// From the displacements of a frame to its motion until the next: what lies at p goes to the q at which the next frame
/// shows the same of the still, q + next(q) = p + now(p).
void to_motion(cv::Mat& now, const cv::Mat& next) {
  constexpr int kRounds = 5;  // neighbours move alike, so that each halves the error at least
  oneapi::tbb::parallel_for(0, now.rows, [&](int y) {
    auto* at = now.ptr<cv::Vec2f>(y);
    for (int x = 0; x < now.cols; ++x) {
      const cv::Vec2f p(static_cast<float>(x), static_cast<float>(y)), shown = p + at[x];
      cv::Vec2f q = p;
      for (int i = 0; i < kRounds; ++i) q = shown - sampling::bilinear<cv::Vec2f>(next, q[0], q[1]);
      at[x] = q - p;
    }
  });
}

/// Of a layer that brings its frames, where it lies in the picture; empty where it is not known.
cv::Mat own_motion(LayerFrames& frames, cv::Size picture) {
  const std::optional<cv::Mat> motion = frames.motion();
  if (!motion) return {};
  cv::Mat whole(picture, CV_32FC2, cv::Scalar::all(0));
  const cv::Rect box = cv::Rect(frames.at(), motion->size()) & cv::Rect({0, 0}, picture);
  if (!box.empty()) (*motion)(box - frames.at()).copyTo(whole(box));
  return whole;
}

}  // namespace

SceneAnimation::SceneAnimation(const Scene& scene, std::span<const LayerPixels> pixels, cv::Size picture,
                               const FramesOf& frames, std::vector<std::string>* notices, KeptSprites* kept)
    : cycle_(cycle_of(scene)), gusts_(scene.wind, cycle_, picture.width), picture_(picture) {
  for (std::size_t i = 0; i < scene.layers.size(); ++i)
    if (scene.layers[i].is_cut()) check_marks(scene, scene.layers[i], pixels[i].alpha, notices);
  placed_.resize(scene.layers.size());
  if (kept != nullptr) kept->layers.resize(placed_.size());
  oneapi::tbb::parallel_for(std::size_t{0}, placed_.size(), [&](std::size_t i) {
    const SceneLayer& layer = scene.layers[i];
    if (!layer.brings_frames())
      placed_[i].sprite = sprite_of(scene, layer, pixels[i], kept != nullptr ? &kept->layers[i] : nullptr);
  });
  // Boats ride on water: their motions come last.
  for (const bool rides : {false, true}) {
    for (std::size_t i = 0; i < placed_.size(); ++i) {
      Placed& placed = placed_[i];
      const SceneLayer& layer = scene.layers[i];
      if ((layer.as<BoatMotion>() != nullptr) != rides) continue;
      placed.rides = rides;
      place_motion(scene, i);
      if (layer.brings_frames()) placed.frames = frames(layer, pixels[i]);
    }
  }
  for (std::size_t i = 0; i < placed_.size(); ++i)
    moved_.push_back({&placed_[i].sprite, placed_[i].motion.get(), scene.layers[i].blend});
  place_shadows(scene, pixels);
  place_glows(scene);
  place_mirrors(scene, pixels);
}

void SceneAnimation::place_glows(const Scene& scene) {
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    const SceneLayer& layer = scene.layers[i];
    if (layer.glow == 0 || !layer.brings_frames()) continue;
    placed_[i].glow = std::make_unique<LayerGlow>(layer.glow, layer.glow_reach_px, picture_);
    falling_.push_back(&placed_[i].glow->light());
  }
  fires_ = falling_.size();
  const Stillness still;
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    const SceneLayer& layer = scene.layers[i];
    if (layer.glow == 0 || layer.as<WaterMotion>() == nullptr || placed_[i].sprite.box.empty()) continue;
    alone_.create(picture_, CV_32FC4);
    const MovedSprite as_cut{&placed_[i].sprite, &still};
    composite(std::span(&as_cut, 1), alone_);
    placed_[i].glitter = std::make_unique<GlitterGlow>(layer.glow, layer.glow_reach_px, alone_);
    falling_.push_back(&placed_[i].glitter->light());
  }
  const std::span<const FallingLight* const> all(falling_);
  for (std::size_t i = 0; i < placed_.size(); ++i)
    if (lies_in_light(scene.layers[i]) && placed_[i].glow == nullptr)
      moved_[i].falling = placed_[i].glitter == nullptr ? all : all.first(fires_);
}

void SceneAnimation::place_shadows(const Scene& scene, std::span<const LayerPixels> pixels) {
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    const auto* clouds = scene.layers[i].as<CloudMotion>();
    if (clouds == nullptr || clouds->shade == 0 || placed_[i].sprite.box.empty()) continue;
    const Line horizon = ground_of(scene, scene.layers[i], placed_[i].sprite.box, picture_);
    shade_ = std::make_unique<CloudShade>(*clouds, horizon, gusts_.weather(), cycle_, scene.loop,
                                          scene.wind.seed * 64 + scene.layers[i].seed, picture_);
  }
  const cv::Mat* light = nullptr;
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    const SceneLayer& layer = scene.layers[i];
    Placed& placed = placed_[i];
    if (lies_in_light(layer)) {
      moved_[i].lights[0] = light;
      moved_[i].light_moves = layer.as<WaterMotion>() != nullptr;
      const std::optional<cv::Point2d> foot = foot_of(scene, layer);
      if (shade_ != nullptr && foot) placed.foot = *foot, moved_[i].lit = &placed.lit;
      if (shade_ != nullptr && !foot) moved_[i].lights[1] = &shaded_;
    }
    if (!layer.shadow || placed.sprite.box.empty()) continue;
    if (layer.shadow->from.y < placed.sprite.box.y + 1)
      throw Error(ErrorKind::kInput, scene.file.string(),
                  fmt::format("layer {}: its shadow begins at row {:.0f}, above all of it", layer.name,
                              layer.shadow->from.y),
                  "Draw it from where the layer stands to where the shadow of its top falls");
    placed.shadow = std::make_unique<LayerShadow>(layer, layer.shadow_in_still ? pixels[i].alpha : cv::Mat(),
                                                  placed.sprite.box, picture_);
    placed.light = cv::Mat(picture_, CV_32F, cv::Scalar(1));
    alone_.create(picture_, CV_32FC4);
    placed.nearer = std::exchange(light, &placed.light);
  }
}

void SceneAnimation::cast_shadows(int frame) {
  if (shade_ != nullptr) {
    shade_->go_to(frame);
    shade_->light(shaded_);
    for (Placed& placed : placed_) placed.lit = shade_->light_at(placed.foot);
  }
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    if (placed_[i].shadow == nullptr) continue;
    // Where nearer layers cast none, all but this shadow's region stays 1.
    cv::Mat shaded = placed_[i].light(placed_[i].shadow->region());
    if (placed_[i].nearer != nullptr)
      placed_[i].nearer->copyTo(placed_[i].light);
    else
      shaded.setTo(1);
    const MovedSprite alone{moved_[i].sprite, moved_[i].motion};
    composite(std::span(&alone, 1), alone_);
    placed_[i].shadow->cast(alone_, placed_[i].light);
  }
}

void SceneAnimation::place_mirrors(const Scene& scene, std::span<const LayerPixels> pixels) {
  const auto mirrors = [&](std::size_t i) {
    const auto* water = scene.layers[i].as<WaterMotion>();
    return water != nullptr && water->mirrors && !placed_[i].sprite.box.empty();
  };
  const Stillness still;
  std::vector<Sprite> as_cut;
  as_cut.reserve(placed_.size());
  std::vector<MovedSprite> unmoved;
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    const SceneLayer& layer = scene.layers[i];
    if (layer.as<WaterMotion>() != nullptr || layer.as<BoatMotion>() != nullptr) continue;
    mirrored_.push_back(moved_[i]);
    // Water's own light is known only once it mirrors.
    auto& falling = mirrored_.back().falling;
    falling = falling.first(std::min(falling.size(), fires_));
    if (!layer.is_cut()) continue;
    const bool brings = layer.brings_frames();
    if (brings) as_cut.push_back(make_sprite(pixels[i].colour, pixels[i].alpha, Outline::kMoves));
    unmoved.push_back({brings ? &as_cut.back() : &placed_[i].sprite, &still, layer.blend});
  }
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    if (!mirrors(i)) continue;
    if (beyond_.empty()) composite(unmoved, beyond_ = cv::Mat(picture_, CV_32FC4));
    placed_[i].mirror = std::make_unique<WaterMirror>(placed_[i].sprite,
                                                      *scene.layers[i].as<WaterMotion>()->horizon, beyond_);
  }
}

void SceneAnimation::place_motion(const Scene& scene, std::size_t i) {
  const SceneLayer& layer = scene.layers[i];
  Placed& placed = placed_[i];
  const cv::Rect& box = placed.sprite.box;
  placed.motion = std::make_unique<Stillness>();
  if (box.empty()) return;
  if (const auto* tree = layer.as<TreeMotion>()) {
    placed.motion = std::make_unique<TreeSway>(*tree, gusts_, cycle_, layer.seed, around(box, picture_));
  } else if (const auto* asked = layer.as<WaterMotion>()) {
    WaterMotion water = *asked;
    water.focal_px = water.focal_or_usual(picture_);
    if (!water.mapping) water.mapping = mapping_seen(water, box, picture_);
    // Reflections ask about the water beside the layer too, for it lies behind them.
    const cv::Rect region(0, box.y, picture_.width, picture_.height - box.y);
    const WaterCamera camera(*water.horizon, *water.focal_px, water.camera_height_m, picture_);
    auto surface = std::make_unique<WaterSurface>(water, gusts_, cycle_, scene.wind.seed * 64 + layer.seed,
                                                  region, picture_, boats_on(scene, layer, camera, picture_));
    placed.surface = surface.get();
    placed.motion = std::move(surface);
  } else if (const auto* floating = layer.as<BoatMotion>()) {
    const SceneLayer& water = water_under(scene, *floating);
    const WaterSurface* surface = placed_[static_cast<std::size_t>(&water - scene.layers.data())].surface;
    if (surface == nullptr)
      throw Error(
          ErrorKind::kInput, scene.file.string(),
          fmt::format("nothing of the water {} on which {} floats is to be seen", water.name, layer.name),
          "Give that layer a matte that shows some of it");
    BoatMotion boat = *floating;
    boat.hull = hull_of(scene, *floating);
    const bool reflection = !boat.reflection_of.empty();
    const cv::Rect region = around(box, picture_);
    if (moves_in_3d(scene, boat))
      placed.motion = std::make_unique<FloatingSheet>(boat, *surface, reflection, region);
    else
      placed.motion = std::make_unique<BoatRide>(boat, *surface, reflection, region);
  } else if (const auto* clouds = layer.as<CloudMotion>()) {
    CloudCourse course = course_in(scene, *clouds, box, picture_);
    course.period_px = placed.sprite.period();
    placed.motion =
        std::make_unique<CloudDrift>(course, *clouds, cycle_, box, scene.wind.seed * 64 + layer.seed);
  }
}

void SceneAnimation::move(const std::function<void(Motion& motion)>& how) {
  for (const bool rides : {false, true})
    oneapi::tbb::parallel_for(std::size_t{0}, placed_.size(), [&](std::size_t i) {
      if (placed_[i].rides == rides) how(*placed_[i].motion);
    });
}

std::vector<cv::Mat> SceneAnimation::motions() {
  const auto displacements = [&] {
    std::vector<cv::Mat> all(placed_.size());
    for (std::size_t i = 0; i < placed_.size(); ++i)
      if (placed_[i].frames == nullptr) all[i] = displacement(*placed_[i].motion, picture_);
    return all;
  };
  std::vector<cv::Mat> all = displacements();
  move([&](Motion& motion) { motion.go_on_from(frame_); });
  const std::vector<cv::Mat> next = displacements();
  move([&](Motion& motion) { motion.go_to(frame_); });
  for (std::size_t i = 0; i < all.size(); ++i)
    if (placed_[i].frames == nullptr) to_motion(all[i], next[i]);
  oneapi::tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    if (placed_[i].frames != nullptr) all[i] = own_motion(*placed_[i].frames, picture_);
  });
  return all;
}

void SceneAnimation::render(int frame, cv::Mat& out) {
  if (out.empty()) out.create(picture_, CV_8UC3);
  Stopwatch watch;
  for (Placed& placed : placed_)
    if (placed.frames != nullptr) {
      const cv::Mat& own = placed.frames->next();
      set_frame(placed.sprite, own, placed.frames->at(), picture_);
      if (placed.glow != nullptr) placed.glow->see(own, placed.frames->at());
    }
  seconds_.frames += watch.seconds();
  watch = {};
  frame_ = frame;
  move([&](Motion& motion) { motion.go_to(frame); });
  seconds_.motion += watch.seconds();
  watch = {};
  cast_shadows(frame);
  if (!beyond_.empty()) composite(mirrored_, beyond_);
  for (Placed& placed : placed_)
    if (placed.mirror != nullptr) placed.mirror->reflect(beyond_, placed.sprite);
  for (Placed& placed : placed_) {
    if (placed.glitter == nullptr) continue;
    const MovedSprite alone{&placed.sprite, placed.motion.get()};
    composite(std::span(&alone, 1), alone_);
    placed.glitter->see(alone_);
  }
  composite(moved_, out);
  seconds_.composite += watch.seconds();
}

void SceneAnimation::whole(cv::Mat& out) const {
  out.create(picture_, CV_32FC4);
  composite(moved_, out);
}

void SceneAnimation::layer(std::size_t i, cv::Mat& out) const {
  out.create(picture_, CV_32FC4);
  MovedSprite alone = moved_[i];
  alone.blend = Blend::kOver;
  composite(std::span(&alone, 1), out);
}

std::size_t SceneAnimation::bytes() const {
  std::size_t sum = 0;
  for (const Placed& placed : placed_)
    sum += placed.sprite.texture.total() * placed.sprite.texture.elemSize() +
           placed.sprite.held.total() * sizeof(float);
  return sum;
}

}  // namespace freshet::synth::scene
