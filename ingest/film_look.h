// film_look.h — how the parts of a film look: a picture of each, and which class of fluid it seems to show.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "media/frame/frame.h"
#include "vision/look/fluid_kind.h"

namespace freshet::ingest {

struct PartLook {
  std::vector<std::uint8_t>
      jpeg;  // of its middle, at most FilmLook::kSide px; empty: it is too short for one
  std::optional<vision::FluidKind> kind;  // by what moves in it
};

/// Keeps a picture and what changes of each half second. Memory: some 30 KB a second.
class FilmLook {
 public:
  explicit FilmLook(double fps);
  /// luma   CV_8U, of the frame, of any size that is always the same. One frame after another.
  void add(const media::Frame& frame, const cv::Mat& luma);
  /// Of frames first to last - 1.
  PartLook look(int first, int last) const;

  static constexpr int kSide = 256;  // px, the size that vision::fluid_look judges

 private:
  struct Slot {
    std::vector<std::uint8_t> jpeg;
    cv::Mat change;  // CV_32F, grey levels from frame to frame, summed
  };
  int slot_frames_;
  int frames_ = 0;
  std::vector<Slot> slots_;
  cv::Mat tiny_, previous_, difference_;
};

}  // namespace freshet::ingest
