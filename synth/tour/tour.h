// synth/tour/tour.h — a camera that goes through a film: planes, things, path and view, brought together.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/tour/film.h"
#include "synth/tour/path.h"
#include "synth/tour/renderer.h"
#include "synth/tour/tour_file.h"

namespace freshet::synth::tour {

struct TourOptions {
  int frames = 0;   // 0: as long as the plan says, or the film, or 4 s
  double fps = 0;   // 0: the film's, or 25
  cv::Size size{};  // of the frames; 0: the film's. One side 0: in proportion
  FilmEnd film_end = FilmEnd::kRepeat;
  std::size_t memory_bytes = std::size_t{1} << 30;  // for frames of a film that goes backwards
};

/// Frame after frame. Memory beside that: some 60 bytes a pixel of the film.
/// Source   Horry, Anjyo, Arai 1997, Tour into the picture. Theirs has one rectangle and five walls; ours leaves out
///          those that the picture does not show, and the back wall where the floor goes on to the horizon. Where they
///          paint what lies behind a thing, ours copies it from beside it, and lets it move.
class Tour {
 public:
  /// Throws Error{kInput} naming file, key and remedy: as Film, mesh_of and Room; a path that leaves the box or looks
  /// where there is nothing; a matte of another shape; Error{kUsage}: a size out of range.
  Tour(const std::filesystem::path& film, const TourPlan& plan, const TourOptions& options = {},
       std::stop_token stop = {});
  Tour(const Tour&) = delete;
  Tour& operator=(const Tour&) = delete;

  int frames() const { return frames_; }
  double fps() const { return fps_; }
  cv::Size size() const { return size_; }
  bool deep() const { return film_.deep(); }
  const Room& room() const { return room_; }
  const Path& path() const { return path_; }
  /// So that nothing beyond the picture is seen; anchored below where the lower edge cuts a thing, which it would lose.
  const Narrowing& narrowed() const { return narrowed_; }
  /// Of all pixels of all frames, how many show what the picture does not; and of the frame that has most of them.
  double beyond_share() const { return beyond_share_; }
  const std::vector<std::string>& notices() const { return notices_; }

  /// The next frame as Renderer::render has it; what is passed over costs no rendering.
  void render(cv::Mat& out, cv::Mat* depth = nullptr);
  void skip();
  /// The picture with its planes' edges and the things' feet, for a person. CV_8UC3.
  cv::Mat drawn() const;

 private:
  void narrow(Beyond beyond);

  std::vector<std::string> notices_;  // first: those below add to it
  Film film_;
  Room room_;
  int frames_ = 0;
  double fps_ = 25;
  cv::Size size_;
  Scenery scenery_;
  Path path_;
  Renderer renderer_;
  Narrowing narrowed_;
  double beyond_share_ = 0;
  int at_ = 0;
};

}  // namespace freshet::synth::tour
