// synth/tour/tour_file.h — a tour as a TOML file that a person edits: planes, things, and the camera's path.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "synth/tour/path.h"
#include "synth/tour/room.h"

namespace freshet::synth::tour {

struct TourThing {
  std::string name;
  std::filesystem::path matte;
  std::optional<double> foot{};  // row in which it stands on the floor, px; nothing: the matte's lowest
  int grow_px = 0;  // over which the matte ends outwards: nothing of a thing's rim is left behind
  std::optional<double> depth{};  // heights of the camera; instead of foot
};

/// What becomes of views that leave the picture.
enum class Beyond { kNarrow, kMirror };

struct TourPlan {
  std::filesystem::path file;  // for messages
  bool relative = false;       // lengths are shares of the picture's width and height, not px
  std::optional<double> horizon, back;
  std::optional<std::array<double, 2>> vanishing;
  std::optional<std::array<double, 4>> rectangle;
  double view_deg = kUsualView_deg;
  std::optional<Move> move;
  double amount = 1;
  std::optional<double> seconds;
  bool ease = true;
  Beyond beyond = Beyond::kNarrow;
  std::vector<PathKey> keys;
  std::vector<TourThing> things;
};

/// Throws Error{kInput} naming file, line, key and remedy: no TOML, an unknown key (and those there are), a value out
/// of range or no number, times that do not grow, keys beside a move.
TourPlan read_tour(const std::filesystem::path& path);
/// The same from text. name   stands for the file.
TourPlan parse_tour(std::string_view text, const std::filesystem::path& name);
/// What is said above the file. move   a name of move_names(); empty, and nothing: the file's.
/// Throws Error{kUsage}: an unknown move, a move or an amount beside keys, a horizon in px where the file's is
/// relative.
void change(TourPlan& plan, const std::string& move, std::optional<double> amount,
            std::optional<double> horizon);
/// Every key with unit, range and default, for a person.
std::string tour_keys();

/// The planes of a picture. Without horizon, vanishing point and wall its middle row is the horizon.
/// Throws Error{kInput} as Room, and where horizon and vanishing point are not one row.
Mesh mesh_of(const TourPlan& plan, cv::Size picture);
/// px row of the foot that a thing has, or that its matte shows. Throws Error{kInput}: the matte is black, the foot is
/// at the horizon or above.
double depth_of(const TourThing& thing, const TourPlan& plan, const cv::Mat& matte, const Room& room);

}  // namespace freshet::synth::tour
