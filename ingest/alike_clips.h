// alike_clips.h — near-duplicates: which clip of a store, or of this run, shows what another shows.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "ingest/film_trace.h"
#include "store/store.h"

namespace freshet::ingest {

struct AlikeClip {
  std::string name;
  double seconds = 0;  // that both show
};

/// Clips whose mean pictures are alike are compared frame by frame (overlap); of the others only the mean is looked at.
/// Memory: .8 kB a clip, and its trace where no store has it. Time: reading all averages of the store once (2 ms a
/// clip at 480 px), then the frames of those whose average is alike.
class AlikeClips {
 public:
  /// store   read when first needed; null: none. Clips of it that cannot be read are passed over.
  explicit AlikeClips(const store::Store* store) : store_(store) {}
  /// The clip of another name with the longest overlap.
  std::optional<AlikeClip> find(const std::string& name, const FilmTrace& film);
  /// in_store   its frames can be read from the store by its name.
  void add(const std::string& name, const FilmTrace& film, bool in_store);

 private:
  struct Known {
    std::string name;
    cv::Mat mean;                    // a row of FilmTrace::rows
    std::optional<FilmTrace> trace;  // null: of the store
  };
  void read_store();

  const store::Store* store_;
  bool read_ = false;
  std::vector<Known> known_;
};

}  // namespace freshet::ingest
