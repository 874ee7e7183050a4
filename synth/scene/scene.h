// synth/scene/scene.h — a picture as layers that one wind moves: what a scene file says.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::scene {

/// A line drawn over the picture, px: (0, 0) is the outer corner of its upper left pixel, whose middle is
/// (0.5, 0.5).
struct Line {
  cv::Point2d from, to;
};

/// One for all layers.
struct Wind {
  double speed_m_per_s = 5;  // mean, 0..60
  double direction_deg = 0;  // where it blows to, seen from above: 0 right, 90 away from the viewer, 180 left
  double turbulence = 0.25;  // standard deviation of its speed, fractions of the mean, 0..1
  double kappa_m = 100;      // Eq. 8: at speed / kappa hertz its spectrum begins to fall
  double gustiness =
      0;  // 0: every layer has turbulence of its own (the paper); 1: all of it crosses the picture
  double width_m = 30;  // of the picture, for gusts that cross it
  std::uint64_t seed = 1;
};

/// Where a layer's matte comes from.
struct MatteFrom {
  enum class Kind {
    kRest,       // what the other layers leave; the furthest layer
    kFile,       // a grey picture, or one with alpha: white where the layer is
    kScribbles,  // strokes on the layer (white, green) and beside it (black, red)
    kTrimap,     // white the layer, black not, grey unknown
    kPaint,      // the layer of this name in the scene's .ora: paint is the layer
  };
  Kind kind = Kind::kRest;
  bool painted = false;          // of kPaint: its colours are the paint's, and not the picture's below it
  std::filesystem::path file{};  // of kFile, kScribbles, kTrimap
};

enum class MotionKind { kStill, kTree, kWater, kBoat, kClouds, kPatches, kTransfer, kFootage };
/// "still", "tree", ...
const char* to_string(MotionKind kind);

/// Branches and plants (Sec. 3.2).
struct TreeMotion {
  std::vector<Line> armatures{};  // each from the root to the tip; not empty once marks are read
  double frequency_hz = 0.5;      // natural; 0.05..10
  double damping_per_s = 0.6;     // gamma = c / m
  double mass = 6;  // kg for each N that 1 m/s of wind makes; displacements in lengths of the armature
  double foreshortening = 0;    // Sec. 4: of the length, lost and won for a displacement of one length; 0..1
  double shimmer_px = 0;        // Sec. 5: standard deviation of the leaves' own motion at the mean wind
  double shimmer_size_px = 12;  // of what shimmers together
  bool stand = false;  // its armatures have one turbulence, as what stands close together; else each its own
};

/// What of the water's surface moves the picture.
enum class WaterMapping {
  kDisplacement,  // as printed (Eq. 10): a point of the plane is lifted by the wave's height
  kNormals,       // what is mirrored moves as the surface tilts
};

/// A plane of waves (Sec. 3.3).
struct WaterMotion {
  std::optional<Line> horizon{};     // set once marks are read
  std::optional<double> focal_px{};  // nothing: 1.2 times the picture's longer side
  double camera_height_m = 0.5;      // above the water
  int tile = 256;                    // samples along a tile's side, N; a power of 2, 32..1024
  std::optional<double> tile_m{};    // its side at roughness 1; nothing: 25 L, L = speed^2 / 9.81 m/s^2
  double roughness = 25;             // beta: waves are so many times shorter than the sea's
  /// a; 1: as high as those of a fully developed sea of this roughness. Nothing: .3 for displacement, .04 for normals,
  /// with which stills of lakes move as their clips (docs/scene.md).
  std::optional<double> amplitude{};
  double against = 0.3;                   // amplitude of waves against the wind, fractions; 1 as printed
  std::optional<WaterMapping> mapping{};  // nothing: by the angle at which the water is seen (mapping_seen)
  bool mirrors = false;                   // what moves above the horizon, but boats, moves mirrored in it too
  bool edge_moves = false;  // true: the matte moves with the water (the paper); else only what lies in it
  double focal_or_usual(cv::Size picture) const {
    return focal_px.value_or(1.2 * std::max(picture.width, picture.height));
  }
  double amplitude_or_usual() const {
    return amplitude.value_or(mapping == WaterMapping::kNormals ? 0.04 : 0.3);
  }
  double gust_darkening = 0.15;  // of the light, under a gust of one standard deviation; with gustiness alone
};

/// What floats, or is mirrored by the water below it (Sec. 3.4).
struct BoatMotion {
  std::optional<Line> hull{};   // set once marks are read
  std::string water{};          // name of the layer that it floats on; empty: the first of water
  double heave = 1, roll = 1;   // gains
  std::string reflection_of{};  // name of the boat whose reflection this is; empty: it is a boat itself
};

/// Translation (Sec. 3.5).
struct CloudMotion {
  std::optional<double>
      speed_px_per_s{};  // nothing: wind.speed * 0.6 % of the picture's width, along the wind
  double far_speed = 1;  // at the layer's lowest row, fractions of the speed at its highest
};

/// Patches of a store (Okabe et al. 2011), as `freshet synth animate` makes them.
struct PatchesMotion {
  std::filesystem::path store{};
  std::string class_name{};            // empty: all
  std::filesystem::path strokes{};     // empty: those of the scene's drawing that name this layer
  std::vector<std::string> options{};  // of freshet synth animate, word by word
};

/// What lies behind an exemplar that has no alpha of its own (transfer::Ground).
enum class ExemplarGround { kNone, kBlack, kWhite };

/// A designed motion with the look of an exemplar (Jamriska et al. 2015).
struct TransferMotion {
  std::filesystem::path design_alpha{}, design_flow{}, exemplar{}, exemplar_alpha{};
  ExemplarGround ground = ExemplarGround::kNone;
  cv::Point at{0, 0};  // px, of its upper left corner in the picture
};

/// A sequence or video with alpha.
struct FootageMotion {
  std::filesystem::path file{};
  cv::Point at{0, 0};
  int width = 0;  // px that it is shown wide, in its own shape; 0: as it is
};

/// One layer. The fields of the motion that `kind` names hold.
struct SceneLayer {
  std::string name;  // unique; letters, digits, '-', '_' and spaces
  int order = 0;     // 1 is nearest; unique
  MatteFrom matte;
  MotionKind kind = MotionKind::kStill;
  std::uint64_t seed = 0;  // of its own; differs between layers
  TreeMotion tree{};
  WaterMotion water{};
  BoatMotion boat{};
  CloudMotion clouds{};
  PatchesMotion patches{};
  TransferMotion transfer{};
  FootageMotion footage{};

  /// Whether it is cut from the picture; transferred fluids and footage bring their own pixels.
  bool is_cut() const { return kind != MotionKind::kTransfer && kind != MotionKind::kFootage; }
};

struct Scene {
  std::filesystem::path file;     // itself, for messages
  std::filesystem::path picture;  // the still
  std::filesystem::path marks{};  // SVG over it; empty: lines stand in the scene file
  std::filesystem::path paint{};  // .ora with a layer of paint for layers whose matte is kPaint
  /// .ora of cut layers, as `freshet synth layers` wrote it and a person may have painted over it; empty: they
  /// are cut from the picture.
  std::filesystem::path cut{};
  Wind wind;
  int frames = 96;
  double fps = 25;
  bool loop = false;
  std::vector<SceneLayer> layers;  // nearest first
};

}  // namespace freshet::synth::scene
