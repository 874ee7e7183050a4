// survey.h — a first look at a film: its takes, and which stretches of them are fit.
//
// A film is cut where a take ends (find_cuts) and where frames are missing. Each take is screened for itself. Where
// the camera moves in one, the longest stretches are sought in which it stands; what is left is left out, with the
// reason. A slow pan stands for any second: a stretch must therefore stand better than a whole take has to, and half
// of it must show something solid, since elsewhere in its take the camera is known to move.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "ingest/film_look.h"
#include "ingest/film_trace.h"
#include "ingest/screening.h"
#include "ingest/steady.h"
#include "media/video/video_reader.h"

namespace freshet::ingest {

/// Frames of a source, first included, last not, and when they are shown.
struct Span {
  int first = 0, last = 0;
  double from_s = 0, to_s = 0;  // from the source's first frame on; to_s is when the last frame ends
  int frames() const { return last - first; }
  bool operator==(const Span&) const = default;
};

/// A part of a film that is taken or left out as a whole.
struct Piece {
  Span span;
  std::vector<std::string> refusals;  // sentences; empty: it is fit
  std::vector<std::string> notes, help;
  PartLook look;                     // where pictures were asked for
  std::optional<SteadyPath> steady;  // fit when its frames are made steady
  bool fit() const { return refusals.empty(); }
};

struct Survey {
  Span whole;
  int takes = 0;
  std::vector<Piece> pieces;       // all of the film, in order; a single one where it is fit as a whole
  std::string complaint;           // of the reader
  std::optional<FilmTrace> trace;  // of the whole
  /// Whether it becomes parts: it is no clip as it is.
  bool in_parts() const { return pieces.size() > 1 || (pieces.size() == 1 && pieces.front().steady); }
  int fit() const;
};

/// Takes a film's frames in order. Memory: six small frames, the camera tracker's, 20 bytes a frame and 200 a second.
class Surveyor {
 public:
  /// steady   what no camera that stands has filmed is made so, as far as it can be.
  Surveyor(cv::Size source, double fps, const ScreeningLimits& limits, bool steady);
  ~Surveyor();
  void add(const cv::Mat& luma, double time_s);  // CV_8U, source size, or that of screening_size
  Survey finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// All frames that a reader has, and their trace; one thread decodes while another measures. Memory: a Surveyor's, and
/// 384 bytes a frame.
/// steady    see Surveyor. pictures   each piece gets its look.
/// on_slab   called with the number of frames done. Throws Error{kCancelled}.
Survey survey(media::VideoReader& reader, double fps, const ScreeningLimits& limits, bool steady,
              bool pictures, const std::string& where, const std::function<void(std::uint32_t)>& on_slab,
              const std::stop_token& stop);

/// "NAME@4.200-11.680": of a part of a clip, in seconds of its source.
std::string part_name(const std::string& name, const Span& span);

}  // namespace freshet::ingest
