// synth/scene/rendering/scene_animation.h — a scene, ready to be rendered frame by frame.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/cycle.h"
#include "synth/scene/motion/motion.h"
#include "synth/scene/rendering/cloud_shade.h"
#include "synth/scene/rendering/composite.h"
#include "synth/scene/rendering/glitter_glow.h"
#include "synth/scene/rendering/layer_frames.h"
#include "synth/scene/rendering/layer_glow.h"
#include "synth/scene/rendering/layer_shadow.h"
#include "synth/scene/rendering/sprite.h"
#include "synth/scene/rendering/water_mirror.h"
#include "synth/scene/scene.h"
#include "synth/scene/wind/gusts.h"

namespace freshet::synth::scene {

class WaterSurface;

/// A layer's pixels: what cutting gave. Both empty for layers that bring their own.
struct LayerPixels {
  cv::Mat colour;  // CV_32FC3, sRGB code, straight
  cv::Mat alpha;   // CV_32F, 0..1
};

/// Sprites of layers as they were cut, one a layer, for scenes of these layers that differ in their motions alone.
struct KeptSprites {
  struct Of {
    Outline outline = Outline::kMoves;
    double calm = 0;  // of water
    Line horizon{};   // of water that is calmed
    Sprite sprite;
  };
  std::vector<Of> layers;  // empty: none is kept yet
};

/// Where the time went, s.
struct SceneSeconds {
  double motion = 0, composite = 0, frames = 0;
};

/// Holds all motions and sprites. Frames may be rendered in any order where no layer brings frames of its own; with
/// those, from 0 on.
class SceneAnimation {
 public:
  /// Makes the frames of a layer of patches, transfer or footage.
  using FramesOf =
      std::function<std::unique_ptr<LayerFrames>(const SceneLayer& layer, const LayerPixels& pixels)>;

  /// scene    with its marks (read_marks). pixels   one a layer, of the picture's size.
  /// frames   may be empty where no layer needs it.
  /// notices  for a person, when not null.
  /// kept     null, or of an earlier animation of the same pixels: what fits is copied, what does not is made and left
  ///          there. Frames are the same, but where clouds dissolve: theirs is a wider sky, that does for more winds.
  /// Throws   Error{kInput} naming scene, layer and remedy: an armature outside its layer, a horizon below its water, a
  ///          hull outside its boat.
  SceneAnimation(const Scene& scene, std::span<const LayerPixels> pixels, cv::Size picture,
                 const FramesOf& frames = {}, std::vector<std::string>* notices = nullptr,
                 KeptSprites* kept = nullptr);
  SceneAnimation(const SceneAnimation&) = delete;
  SceneAnimation& operator=(const SceneAnimation&) = delete;

  /// out   CV_8UC3 or CV_32FC4 of the picture's size (composite.h); created as the former when empty.
  void render(int frame, cv::Mat& out);
  /// The frame that was rendered last, CV_32FC4, as render.
  void whole(cv::Mat& out) const;
  /// One layer of the frame that was rendered last, alone: CV_32FC4, colours times alpha.
  void layer(std::size_t i, cv::Mat& out) const;

  /// How far what each layer shows in the frame that was rendered last goes until the next: CV_32FC2 of the picture's
  /// size, px, x right, y down, wherever the layer lies; empty where it is not known. Once a frame. Layers that bring
  /// frames of their own were asked for it (LayerFrames::motion). Cost: the motion of two frames more, and of footage
  /// its optical flow.
  std::vector<cv::Mat> motions();

  const Cycle& cycle() const { return cycle_; }
  const SceneSeconds& seconds() const { return seconds_; }
  /// Bytes that sprites hold.
  std::size_t bytes() const;
  const Motion& motion(std::size_t i) const { return *placed_[i].motion; }

 private:
  struct Placed {
    Sprite sprite;
    std::unique_ptr<Motion> motion;
    std::unique_ptr<LayerFrames> frames;
    std::unique_ptr<WaterMirror> mirror;
    const WaterSurface* surface = nullptr;  // the motion, where it is water that is to be seen
    bool rides = false;                     // on another layer's motion, which goes first
    std::unique_ptr<LayerGlow> glow;
    std::unique_ptr<GlitterGlow> glitter;
    std::unique_ptr<LayerShadow> shadow;
    cv::Mat light;                    // CV_32F, that this shadow and those of nearer layers leave
    const cv::Mat* nearer = nullptr;  // of the next nearer shadow
    cv::Point2d foot;                 // px, of what stands on ground that clouds shade
    float lit = 1;                    // there
  };
  void place_motion(const Scene& scene, std::size_t i);
  /// Shadows, and which layers lie in them.
  void place_shadows(const Scene& scene, std::span<const LayerPixels> pixels);
  /// Fires and glittering waters, and which layers they light.
  void place_glows(const Scene& scene);
  /// The light of the frame that all motions have gone to.
  void cast_shadows(int frame);
  void place_mirrors(const Scene& scene, std::span<const LayerPixels> pixels);
  /// Every motion, those that ride on others last.
  void move(const std::function<void(Motion& motion)>& how);

  Cycle cycle_;
  Gusts gusts_;
  cv::Size picture_;
  int frame_ = 0;               // that was rendered last
  std::vector<Placed> placed_;  // nearest first
  std::vector<MovedSprite> moved_;
  std::vector<MovedSprite> mirrored_;         // all but waters and what floats
  cv::Mat beyond_;                            // CV_32FC4, of mirrored_; empty where no water mirrors
  std::vector<const FallingLight*> falling_;  // of all fires, and then of all glittering waters
  std::size_t fires_ = 0;                     // of these
  std::unique_ptr<CloudShade> shade_;
  cv::Mat shaded_;  // CV_32F, the light that shade_ leaves
  cv::Mat alone_;   // CV_32FC4, a layer that casts a shadow, or glitters
  SceneSeconds seconds_;
};

}  // namespace freshet::synth::scene
