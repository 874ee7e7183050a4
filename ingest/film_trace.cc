#include "ingest/film_trace.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "vision/dot.h"

namespace freshet::ingest {
namespace {

constexpr double kWindowS = 1;
constexpr int kWindows = 16;
// Of 46 clips, second halves reach .77 beside their first (clouds_gap_slow); copies at other sizes and rates stay above
// .87, but for two fast fires that lost half of their frames (.73).
constexpr double kAlike = 0.82;
constexpr double kStill = 0.01;  // mean square of a cell's changes, grey levels: below, nothing moves

/// Of rows first to last - 1 in each of two matrices.
double correlation(const cv::Mat& a, const cv::Mat& b) {
  const auto centred = [](const cv::Mat& rows) {
    cv::Mat mean;
    cv::reduce(rows, mean, 0, cv::REDUCE_AVG);
    return cv::Mat(rows - cv::repeat(mean, rows.rows, 1));
  };
  const cv::Mat x = centred(a), y = centred(b);
  const double xx = vision::dot(x, x), yy = vision::dot(y, y),
               still = kStill * static_cast<double>(x.total());
  return xx > still && yy > still ? vision::dot(x, y) / std::sqrt(xx * yy) : 0;
}

}  // namespace

cv::Mat FilmTrace::row_of(const cv::Mat& luma) {
  cv::Mat levels, cells;
  luma.convertTo(levels, CV_32F);
  cv::resize(levels, cells, {kColumns, kRows}, 0, 0, cv::INTER_AREA);
  return cells.reshape(1, 1);
}

void FilmTrace::add(const cv::Mat& luma) {
  const cv::Mat row = row_of(luma);
  for (int i = 0; i < kCells; ++i)
    levels_.push_back(cv::saturate_cast<std::uint16_t>(256 * row.at<float>(0, i)));
}

FilmTrace FilmTrace::part(int first, int last) const {
  FilmTrace part(fps_);
  part.levels_.assign(levels_.begin() + std::ptrdiff_t{first} * kCells,
                      levels_.begin() + std::ptrdiff_t{last} * kCells);
  return part;
}

cv::Mat FilmTrace::rows(double fps) const {
  const int shown = static_cast<int>(std::floor((frames() - 1) / fps_ * fps + 1e-6)) + 1;
  cv::Mat rows(shown, kCells, CV_32F);
  for (int t = 0; t < shown; ++t) {
    const int frame = std::min(frames() - 1, static_cast<int>(std::lround(t / fps * fps_)));
    for (int i = 0; i < kCells; ++i)
      rows.at<float>(t, i) = static_cast<float>(levels_[std::size_t(frame) * kCells + i]) / 256;
  }
  return rows;
}

std::optional<Overlap> overlap(const FilmTrace& film, const FilmTrace& other) {
  if (film.frames() < 2 || other.frames() < 2) return {};
  const double fps = std::min(film.fps(), other.fps());
  cv::Mat shorter = film.rows(fps), longer = other.rows(fps);
  if (shorter.rows > longer.rows) std::swap(shorter, longer);
  const int window = std::max(2, static_cast<int>(std::lround(kWindowS * fps)));
  if (shorter.rows < window) return {};
  Overlap best;
  int shift = 0;  // of the shorter's first frame in the longer
  const int last = shorter.rows - window, windows = std::min(kWindows, 1 + 2 * last / window);
  for (int w = 0; w < windows; ++w) {
    const int at = windows > 1 ? last * w / (windows - 1) : 0;
    for (int place = 0; place + window <= longer.rows; ++place) {
      const double alike =
          correlation(shorter.rowRange(at, at + window), longer.rowRange(place, place + window));
      if (alike <= best.correlation) continue;
      best.correlation = alike;
      shift = place - at;
    }
  }
  const int from = std::max(0, shift), to = std::min(longer.rows, shift + shorter.rows);
  best.seconds = (to - from) / fps;
  best.correlation = correlation(longer.rowRange(from, to), shorter.rowRange(from - shift, to - shift));
  if (best.correlation < kAlike) return {};
  return best;
}

}  // namespace freshet::ingest
