// query/index/index_builder.h — builds what a store is searched by: codebook, visual words, FLANN indexes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "freshet/job.h"
#include "query/index/flann_index.h"
#include "store/rewrite/contents.h"
#include "store/store.h"
#include "vision/codebook.h"
#include "vision/spatial_pyramid.h"

namespace freshet::query {

struct IndexOptions {
  /// FLANN indexes that the store is to hold: those that it lacks are built. Empty: it is to hold none.
  std::vector<FlannKind> flann{FlannKind::kHierarchical};
  FlannOptions flann_options{};  // trees, branching, ...; `kind` is taken from the list
  /// Of the dense histograms that FLANN builds from, 21 * words bytes a patch. A store that needs more gets no
  /// FLANN index, and the report says so: 2 GiB are half a million patches at 200 words.
  std::size_t flann_max_bytes = std::size_t{2} << 30;
  bool rebuild = false;           // even when nothing has changed
  std::size_t samples = 200'000;  // descriptors that the codebook is trained on, spread evenly over the clips
  /// For descriptors, kept from the first pass over the clips for the second. Of clips that do not fit, only
  /// the samples are made twice.
  std::size_t cache_bytes = std::size_t{256} << 20;
};

struct IndexReport {
  bool words_built = false;  // false: the index was up to date
  int words = 0;             // of the codebook; fewer than asked for where descriptors are few
  std::size_t clips = 0, patches = 0, samples = 0;
  struct Flann {
    FlannKind kind;
    FlannTuning tuning;
    std::size_t bytes = 0;  // in the store
  };
  std::vector<Flann> flann_built;
  bool flann_too_large = false;  // left out: flann_max_bytes
  double sample_s = 0, train_s = 0, assign_s = 0, flann_s = 0, write_s = 0;
};

/// Builds the index of all clips: blob "codebook", column "patch.words" of every clip, and blobs "flann-..."
/// as asked for, in one transaction: a build that is stopped leaves the store as it was.
///
/// The representative image of each unflipped variant is described on one grid that all of its patches
/// share; flipped patches take the mirrored descriptors. Samples are taken clip by clip in order of
/// source hash, as many from each, half of them mirrored, so that neither the order of ingest nor the
/// number of threads has a part.
///
/// When clips are new, everything is trained again: the words of a store depend on its clips, not on its
/// history. FLANN indexes are erased when words change. Those in the list are built where the store has none
/// that can be read, and tuned (tune_flann); those of other kinds stay while the words do.
///
/// progress    "sampling descriptors", "training the codebook", "assigning words", "building FLANN indexes",
///             "writing"; counts clips, or indexes. Called from the calling thread; may be empty.
/// Throws      Error{kNotFound} when there is no patch, Error{kCancelled} when stopped, Error{kDamaged}.
/// Memory      samples * 128 bytes and what training takes of it, cache_bytes, 81 bytes per patch; then, for a FLANN
///             index, the dense histograms.
IndexReport build_index(store::Store& store, const IndexOptions& options = {},
                        const ProgressFunction& progress = {}, std::stop_token stop = {});

/// The codebook and the words of all patches, a row each as in stored::PatchTable, that build_index would make of a
/// store whose settings had these options. Nothing is written: for trying codebooks.
struct TriedCodebook {
  vision::Codebook codebook;
  vision::OwnWordMaps words;
};
TriedCodebook try_codebook(store::Store& store, const vision::CodebookOptions& options);

/// What of a store build_index makes, by name: a store whose clips change is better without it.
store::Rebuildable rebuildable();

}  // namespace freshet::query
