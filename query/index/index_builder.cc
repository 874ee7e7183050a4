#include "query/index/index_builder.h"

#include <algorithm>
#include <optional>
#include <string>

#include "freshet/error.h"
#include "platform/random.h"
#include "platform/stopwatch.h"
#include "query/index/dense_histogram.h"
#include "query/index/flann_tuning.h"
#include "query/index/patch_descriptors.h"
#include "stored/average_image.h"
#include "stored/clip_schema.h"
#include "stored/store_settings.h"
#include "stored/stored_codebook.h"
#include "vision/settings.h"

namespace freshet::query {
namespace {

// What a person reads of where the build stands.
namespace stage {
constexpr const char *kSample = "sampling descriptors", *kTrain = "training the codebook",
                     *kAssign = "assigning words", *kFlann = "building FLANN indexes", *kWrite = "writing";
}
constexpr FlannKind kFlannKinds[] = {FlannKind::kKdTree, FlannKind::kKMeans, FlannKind::kHierarchical};

using Descriptors = std::vector<vision::Descriptor>;

std::uint64_t seed_of(const store::ClipRecord& clip) {
  std::uint64_t seed = 0;
  for (const char c : clip.source_hash) seed = scramble(seed ^ static_cast<unsigned char>(c));
  return seed;
}

class Build {
 public:
  Build(store::Store& store, const IndexOptions& options, const ProgressFunction& progress,
        std::stop_token stop)
      : store_(store),
        options_(options),
        progress_(progress),
        stop_(std::move(stop)),
        snapshot_(store.snapshot()),
        settings_(stored::settings_of(snapshot_)),
        variants_(settings_.variants()) {
    clips_.assign(snapshot_.clips().begin(), snapshot_.clips().end());
    std::sort(clips_.begin(), clips_.end(), [&](store::ClipId a, store::ClipId b) {
      return snapshot_.clip(a).source_hash < snapshot_.clip(b).source_hash;
    });
    descriptors_.resize(clips_.size());
    for (const store::ClipId clip : clips_) report_.patches += snapshot_.clip(clip).rows;
    report_.clips = clips_.size();
  }

  TriedCodebook tried(const vision::CodebookOptions& codebook) {
    settings_.codebook = codebook;
    TriedCodebook made{train(sample()), {}};
    assign(made.codebook);
    made.words = rows().words;
    return made;
  }

  IndexReport run() {
    if (report_.patches == 0) {
      throw Error(ErrorKind::kNotFound, store_.path().string(), "the store holds no patches",
                  "Ingest clips of moving fluid first");
    }
    std::optional<stored::StoredCodebook> known;
    if (!options_.rebuild) known = stored::find_codebook(snapshot_);
    if (known && up_to_date(*known)) {
      report_.words = known->codebook.words;
      const std::vector<FlannKind> missing = missing_flann();
      if (options_.flann.empty()) erase_flann();
      if (!missing.empty()) read_words();
      add_flann(missing);
      if (!blobs_.empty() || !erased_.empty()) write();
      return report_;
    }
    report_.words_built = true;
    stored::StoredCodebook trained{train(sample()), stored::hash_of_clips(snapshot_)};
    report_.words = trained.codebook.words;
    assign(trained.codebook);
    blobs_.push_back({stored::kCodebookBlob, stored::to_bytes(trained), true});
    erase_flann();
    add_flann(options_.flann);
    write();
    return report_;
  }

 private:
  void say(const char* stage, std::size_t done, std::size_t total) {
    if (stop_.stop_requested()) {
      throw Error(ErrorKind::kCancelled, store_.path().string(), "stopped; its index is as it was before");
    }
    if (progress_) progress_({stage, done, total});
  }

  int word_bytes() const { return vision::word_bytes(settings_.codebook.words); }

  bool up_to_date(const stored::StoredCodebook& known) const {
    if (known.clips_hash != stored::hash_of_clips(snapshot_)) return false;
    return std::all_of(clips_.begin(), clips_.end(), [&](store::ClipId clip) {
      return snapshot_.clip(clip).rows == 0 || stored::kPatchWords.is_in(snapshot_, clip);
    });
  }

  PatchPoints points_of(store::ClipId clip) const {
    return PatchPoints(snapshot_.clip(clip), settings_, variants_,
                       stored::read_clip_patches(snapshot_, settings_, variants_, clip));
  }

  std::vector<Descriptors> describe(store::ClipId clip, const PatchPoints& points) const {
    std::vector<Descriptors> all;
    if (points.sheets().empty()) return all;
    const cv::Mat average = stored::average_image(snapshot_, clip);
    for (const PatchPoints::Sheet& sheet : points.sheets()) all.push_back(points.describe(sheet, average));
    return all;
  }

  /// Descriptors of the chosen points of a clip, which are numbered through its sheets; ascending.
  Descriptors describe_some(store::ClipId clip, const PatchPoints& points,
                            std::span<const std::size_t> chosen) const {
    Descriptors some;
    if (chosen.empty()) return some;
    const cv::Mat average = stored::average_image(snapshot_, clip);
    std::vector<std::uint32_t> of_sheet;
    std::size_t before = 0, next = 0;
    for (const PatchPoints::Sheet& sheet : points.sheets()) {
      of_sheet.clear();
      for (; next < chosen.size() && chosen[next] - before < sheet.points.size(); ++next)
        of_sheet.push_back(sheet.points[chosen[next] - before]);
      const Descriptors described = points.describe(sheet, average, of_sheet);
      some.insert(some.end(), described.begin(), described.end());
      before += sheet.points.size();
    }
    return some;
  }

  Descriptors sample() {
    Stopwatch watch;
    const auto with_patches = static_cast<std::size_t>(std::count_if(
        clips_.begin(), clips_.end(), [&](store::ClipId clip) { return snapshot_.clip(clip).rows > 0; }));
    const std::size_t samples_per_clip = std::max<std::size_t>(1, options_.samples / with_patches);
    Descriptors samples;
    samples.reserve(samples_per_clip * with_patches);
    std::size_t cached = 0;
    for (std::size_t c = 0; c < clips_.size(); ++c) {
      say(stage::kSample, c, clips_.size());
      const PatchPoints points = points_of(clips_[c]);
      // Evenly spaced with a random start in each space, so that neighbours are not all alike.
      const std::size_t total = points.points(), taken = std::min(samples_per_clip, total);
      const std::uint64_t seed = seed_of(snapshot_.clip(clips_[c]));
      std::vector<std::size_t> chosen;
      for (std::size_t i = 0; i < taken; ++i) {
        const std::size_t from = i * total / taken, to = (i + 1) * total / taken;
        chosen.push_back(from + (scramble(seed + i) >> 1) % (to - from));
      }
      Descriptors described;
      cached += total * sizeof(vision::Descriptor);
      if (cached <= options_.cache_bytes) {
        descriptors_[c] = describe(clips_[c], points);
        std::size_t sheet = 0, before = 0;
        for (const std::size_t at : chosen) {
          while (at - before >= (*descriptors_[c])[sheet].size())
            before += (*descriptors_[c])[sheet++].size();
          described.push_back((*descriptors_[c])[sheet][at - before]);
        }
      } else {
        described = describe_some(clips_[c], points, chosen);
      }
      for (std::size_t i = 0; i < taken; ++i) {
        const bool turned = settings_.flips && (scramble(seed + i) & 1) != 0;
        samples.push_back(turned ? vision::mirrored(described[i]) : described[i]);
      }
    }
    report_.samples = samples.size();
    report_.sample_s = watch.lap();
    return samples;
  }

  vision::Codebook train(const Descriptors& samples) {
    say(stage::kTrain, 0, 1);
    Stopwatch watch;
    vision::Codebook codebook = vision::train_codebook(samples, settings_.codebook);
    report_.train_s = watch.lap();
    return codebook;
  }

  void assign(const vision::Codebook& codebook) {
    Stopwatch watch;
    words_.resize(clips_.size());
    for (std::size_t c = 0; c < clips_.size(); ++c) {
      say(stage::kAssign, c, clips_.size());
      const PatchPoints points = points_of(clips_[c]);
      if (!descriptors_[c]) descriptors_[c] = describe(clips_[c], points);
      words_[c] = points.words(codebook, *descriptors_[c]);
      descriptors_[c].reset();
    }
    report_.assign_s = watch.lap();
  }

  void read_words() {
    words_.resize(clips_.size());
    for (std::size_t c = 0; c < clips_.size(); ++c) {
      if (snapshot_.clip(clips_[c]).rows > 0) {
        words_[c] = stored::kPatchWords.read(snapshot_, clips_[c], word_bytes());
      }
    }
  }

  void erase_flann() {
    const std::vector<std::string> names = snapshot_.blob_names();
    for (const FlannKind kind : kFlannKinds)
      if (std::find(names.begin(), names.end(), blob_name(kind)) != names.end())
        erased_.push_back(blob_name(kind));
  }

  std::vector<FlannKind> missing_flann() const {
    std::vector<FlannKind> missing;
    for (const FlannKind kind : options_.flann) {
      std::optional<std::vector<std::byte>> bytes;
      try {
        bytes = snapshot_.blob(blob_name(kind));
      } catch (const Error& fault) {
        if (fault.kind() != ErrorKind::kDamaged) throw;
      }
      if (!bytes) missing.push_back(kind);
    }
    return missing;
  }

  void add_flann(const std::vector<FlannKind>& kinds) {
    if (kinds.empty()) return;
    if (report_.patches > options_.flann_max_bytes / histogram_bins(report_.words)) {
      report_.flann_too_large = true;
      return;
    }
    Stopwatch watch;
    Rows all;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      say(stage::kFlann, i, kinds.size());
      if (all.words.empty()) all = rows();
      FlannOptions options = options_.flann_options;
      options.kind = kinds[i];
      FlannIndex index(all.words, report_.words, options);
      tune_flann(index, all.words, report_.words, all.first_row);
      blobs_.push_back({blob_name(options.kind), index.serialize(), false});
      report_.flann_built.push_back({options.kind, index.tuning(), blobs_.back().bytes.size()});
    }
    report_.flann_s = watch.lap();
  }

  struct Rows {
    vision::OwnWordMaps words;
    std::vector<stored::Row> first_row{0};  // of each clip, and the number of rows at the end
  };
  /// Rows are numbered by clip id, words_ stands in order of source hash.
  Rows rows() const {
    std::vector<std::size_t> by_id(clips_.size());
    for (std::size_t c = 0; c < clips_.size(); ++c) by_id[c] = c;
    std::sort(by_id.begin(), by_id.end(),
              [&](std::size_t a, std::size_t b) { return clips_[a] < clips_[b]; });
    Rows rows{vision::OwnWordMaps(word_bytes(), report_.patches)};
    for (const std::size_t c : by_id) {
      rows.words.set(rows.first_row.back(), words_[c]);
      rows.first_row.push_back(rows.first_row.back() + static_cast<stored::Row>(words_[c].size()));
    }
    return rows;
  }

  void write() {
    say(stage::kWrite, 0, 1);
    Stopwatch watch;
    std::vector<store::Store::Blob> blobs;
    for (const Blob& blob : blobs_) {
      blobs.push_back({blob.name, blob.bytes, blob.in_digest});
      std::erase(erased_, blob.name);
    }
    std::vector<store::Store::Column> columns;
    for (std::size_t c = 0; report_.words_built && c < clips_.size(); ++c) {
      if (words_[c].empty()) continue;
      columns.push_back(stored::kPatchWords.column(clips_[c], words_[c]));
    }
    store_.write(blobs, columns, erased_);
    report_.write_s = watch.lap();
  }

  struct Blob {
    std::string name;
    std::vector<std::byte> bytes;
    bool in_digest;
  };
  store::Store& store_;
  const IndexOptions& options_;
  const ProgressFunction& progress_;
  std::stop_token stop_;
  store::Snapshot snapshot_;
  vision::Settings settings_;
  std::vector<vision::Variant> variants_;
  std::vector<store::ClipId> clips_;                                  // in order of source hash
  std::vector<std::optional<std::vector<Descriptors>>> descriptors_;  // by clip, then sheet; what is cached
  std::vector<vision::OwnWordMaps> words_;                            // by clip
  std::vector<Blob> blobs_;
  std::vector<std::string> erased_;
  IndexReport report_;
};

}  // namespace

IndexReport build_index(store::Store& store, const IndexOptions& options, const ProgressFunction& progress,
                        std::stop_token stop) {
  return Build(store, options, progress, std::move(stop)).run();
}

TriedCodebook try_codebook(store::Store& store, const vision::CodebookOptions& options) {
  const IndexOptions plain;
  const ProgressFunction silent;
  return Build(store, plain, silent, {}).tried(options);
}

store::Rebuildable rebuildable() {
  store::Rebuildable index{.columns = {stored::kPatchWords.name}, .blobs = {stored::kCodebookBlob}};
  for (const FlannKind kind : kFlannKinds) index.blobs.insert(blob_name(kind));
  return index;
}

}  // namespace freshet::query
