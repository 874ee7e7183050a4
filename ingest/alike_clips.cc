#include "ingest/alike_clips.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "stored/average_image.h"
#include "stored/clip_frames.h"
#include "vision/dot.h"

namespace freshet::ingest {
namespace {

// Correlation of mean pictures: a cut of fast clouds keeps .83 of the whole's, and one pair of 46 scenes is above.
constexpr double kSameScene = 0.8;
constexpr std::uint32_t kSlab = 16;

double correlation(const cv::Mat& a, const cv::Mat& b) {
  const cv::Mat x = a - cv::mean(a), y = b - cv::mean(b);
  const double energy = std::sqrt(vision::dot(x, x) * vision::dot(y, y));
  return energy > 0 ? vision::dot(x, y) / energy : 1;
}

cv::Mat mean_of(const FilmTrace& film) {
  cv::Mat mean;
  cv::reduce(film.rows(film.fps()), mean, 0, cv::REDUCE_AVG);
  return mean;
}

FilmTrace trace_of(const store::Snapshot& snapshot, store::ClipId id) {
  const store::ClipRecord& record = snapshot.clip(id);
  const stored::ClipFrames frames(snapshot, id);
  FilmTrace trace(static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den));
  for (std::uint32_t first = 0; first < frames.size(); first += kSlab)
    for (const cv::Mat& luma : frames.read_luma(first, std::min(kSlab, frames.size() - first)))
      trace.add(luma);
  return trace;
}

}  // namespace

void AlikeClips::read_store() {
  if (read_ || !store_) return;
  read_ = true;
  const store::Snapshot snapshot = store_->snapshot();
  for (const store::ClipId id : snapshot.clips()) {
    const std::string& name = snapshot.clip(id).name;
    try {
      known_.push_back({name, FilmTrace::row_of(stored::average_image(snapshot, id)), {}});
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kDamaged) throw;
    }
  }
}

std::optional<AlikeClip> AlikeClips::find(const std::string& name, const FilmTrace& film) {
  read_store();
  const cv::Mat mean = mean_of(film);
  std::optional<AlikeClip> found;
  for (const Known& known : known_) {
    if (known.name == name || correlation(mean, known.mean) < kSameScene) continue;
    std::optional<Overlap> shared;
    if (known.trace) {
      shared = overlap(film, *known.trace);
    } else {
      const store::Snapshot snapshot = store_->snapshot();
      const std::optional<store::ClipId> id = snapshot.find(known.name);
      if (!id) continue;
      try {
        shared = overlap(film, trace_of(snapshot, *id));
      } catch (const Error& error) {
        if (error.kind() != ErrorKind::kDamaged) throw;
      }
    }
    if (shared && (!found || shared->seconds > found->seconds)) found = {known.name, shared->seconds};
  }
  return found;
}

void AlikeClips::add(const std::string& name, const FilmTrace& film, bool in_store) {
  if (std::ranges::find(known_, name, &Known::name) != known_.end()) return;
  known_.push_back({name, mean_of(film), in_store ? std::nullopt : std::optional(film)});
}

}  // namespace freshet::ingest
