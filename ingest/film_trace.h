// film_trace.h — how the light of a film moves, small: by it a film is known again that was coded, cut, scaled or
// brightened anew.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::ingest {

/// Mean luma in the cells of a grid, frame by frame. Memory: 384 bytes a frame.
class FilmTrace {
 public:
  static constexpr int kColumns = 16, kRows = 12;

  explicit FilmTrace(double fps) : fps_(fps) {}
  void add(const cv::Mat& luma);  // CV_8U, of any size
  int frames() const { return static_cast<int>(levels_.size()) / kCells; }
  double fps() const { return fps_; }
  /// Frames first to last - 1.
  FilmTrace part(int first, int last) const;
  /// Every frame that is shown at `fps`, no more than its own: CV_32F, a row a frame, grey levels.
  cv::Mat rows(double fps) const;
  /// Of a picture, as a row of rows().
  static cv::Mat row_of(const cv::Mat& luma);

 private:
  static constexpr int kCells = kColumns * kRows;
  double fps_;
  std::vector<std::uint16_t> levels_;  // 256ths of a grey level
};

/// Where one film shows what another shows.
struct Overlap {
  double seconds = 0;      // of both
  double correlation = 0;  // of how their cells change, each around its own mean
};

/// The place where they are most alike: any second of the shorter (of sixteen, spread evenly) is sought in all of the
/// longer, and what then lies beside each other must be alike as a whole. Half-hour takes of one motif are not alike,
/// as long as what moves there moves in its own way each time; nor is what was cropped or mirrored.
/// null: they are not alike, or one is shorter than a second. Cost: 80,000 products a frame of the longer.
std::optional<Overlap> overlap(const FilmTrace& film, const FilmTrace& other);

}  // namespace freshet::ingest
