#include "bench/scale/scaled_store.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "bench/harness/machine.h"
#include "bench/harness/seeded_random.h"
#include "freshet/error.h"
#include "query/index/index_builder.h"
#include "stored/clip_columns.h"
#include "stored/store_settings.h"
#include "stored/stored_codebook.h"

namespace freshet::bench {
namespace {

constexpr std::size_t kBatch = 8;    // copies made at a time; part of no result
constexpr int kFruitlessRounds = 3;  // without one patch: there will be none

/// Source clips, each as often as a window fits into its frame, in the order of a round.
class Rounds {
 public:
  Rounds(const store::Snapshot& source, const ScaleOptions& options) : seed_(options.seed) {
    std::vector<store::ClipId> chosen;
    for (const std::string& name : options.clips) {
      const auto found = source.find(name);
      if (!found) {
        throw Error(ErrorKind::kNotFound, source.path().string(), "has no clip \"" + name + "\"",
                    "freshet store info lists them");
      }
      chosen.push_back(*found);
    }
    if (chosen.empty()) chosen.assign(source.clips().begin(), source.clips().end());
    const double window = static_cast<double>(options.window.area());
    for (const store::ClipId clip : chosen) {
      const store::ClipRecord& record = source.clip(clip);
      if (record.rows == 0) continue;
      const double fit = static_cast<double>(record.width) * record.height / window;
      places_.insert(places_.end(), std::max<std::size_t>(1, static_cast<std::size_t>(fit + 0.5)), clip);
    }
    if (places_.empty()) {
      throw Error(ErrorKind::kNotFound, source.path().string(), "it holds no patches to repeat",
                  "Ingest clips of moving fluid first");
    }
  }
  std::size_t length() const { return places_.size(); }
  store::ClipId clip(std::uint64_t number) {
    const std::uint64_t round = number / places_.size();
    if (round != round_) {
      round_ = round;
      order_ = places_;
      SeededRandom random(seed_ ^ 0x726f756e64ull, round);
      for (std::size_t i = order_.size(); i > 1; --i) std::swap(order_[i - 1], order_[random.below(i)]);
    }
    return order_[number % places_.size()];
  }

 private:
  std::uint64_t seed_;
  std::uint64_t round_ = ~std::uint64_t{0};
  std::vector<store::ClipId> places_, order_;
};

/// Leaves the first rows.
void cut_rows(JitteredClip& clip, std::size_t rows) {
  stored::PatchColumns& patches = clip.columns.patches;
  for (std::size_t row = rows; row < patches.size(); ++row) --clip.metadata.patches[patches.variant[row]];
  patches.keep_first(rows);
}

void write_clip(store::Store& store, JitteredClip clip) {
  store::ClipWriter writer = store.add_clip();
  stored::begin_stream(writer, store::Stream::kFrames, {clip.frames.at(0)});
  for (const cv::Mat& frame : clip.frames) stored::append(writer, store::Stream::kFrames, {frame});
  if (!clip.flow.empty())
    stored::begin_stream(writer, store::Stream::kFlow, {clip.flow[0][0], clip.flow[0][1]});
  for (const auto& [u, v] : clip.flow) stored::append(writer, store::Stream::kFlow, {u, v});
  const double interval = static_cast<double>(clip.record.fps_den) / static_cast<double>(clip.record.fps_num);
  for (std::size_t i = 0; i < clip.frames.size(); ++i)
    clip.columns.times_s.push_back(static_cast<double>(i) * interval);
  stored::write_columns(writer, clip.columns);
  clip.record.metadata = to_json(clip.metadata);
  writer.commit(std::move(clip.record));
}

}  // namespace

void generate(const store::Snapshot& source, const ScaleOptions& options,
              const std::function<void(JitteredClip&&, std::uint64_t)>& take) {
  const vision::Settings settings = stored::settings_of(source);
  const vision::Codebook codebook = stored::read_codebook(source);
  Rounds rounds(source, options);
  std::map<store::ClipId, SourceClip> sources;
  std::uint64_t given = 0;
  for (std::uint64_t first = 0; given < options.patches; first += kBatch) {
    if (given == 0 && first / rounds.length() >= kFruitlessRounds) {
      throw Error(ErrorKind::kNotFound, source.path().string(),
                  fmt::format("no patch is left in windows of {} x {} px of its clips", options.window.width,
                              options.window.height),
                  "Choose a larger window");
    }
    std::array<const SourceClip*, kBatch> batch{};
    for (std::size_t i = 0; i < kBatch; ++i) {
      const store::ClipId id = rounds.clip(first + i);
      auto found = sources.find(id);
      if (found == sources.end())
        found = sources.emplace(id, read_source_clip(source, settings, id, options.frames)).first;
      batch[i] = &found->second;
    }
    std::array<JitteredClip, kBatch> made;
    oneapi::tbb::parallel_for(std::size_t{0}, kBatch, [&](std::size_t i) {
      made[i] = jittered_clip(*batch[i], settings, codebook, options.jitter, options.window, options.seed,
                              first + i);
    });
    for (JitteredClip& clip : made) {
      if (clip.columns.patches.size() == 0 || given >= options.patches) continue;
      if (clip.columns.patches.size() > options.patches - given) cut_rows(clip, options.patches - given);
      const std::uint64_t patches = clip.columns.patches.size();
      take(std::move(clip), given);
      given += patches;
    }
  }
}

ScaleReport write_scaled_store(const store::Snapshot& source, const std::filesystem::path& path,
                               const ScaleOptions& options,
                               const std::function<void(std::uint64_t)>& progress) {
  const double start = wall_seconds();
  ScaleReport report;
  const vision::Codebook codebook = stored::read_codebook(source);
  store::Store store = store::Store::create(path, source.settings());
  generate(source, options, [&](JitteredClip&& clip, std::uint64_t before) {
    report.patches = before + clip.columns.patches.size();
    ++report.clips;
    write_clip(store, std::move(clip));
    if (progress) progress(report.patches);
  });
  const auto bytes = stored::to_bytes({codebook, stored::hash_of_clips(store.snapshot())});
  const store::Store::Blob blob{stored::kCodebookBlob, bytes, true};
  store.write({&blob, 1});
  query::build_index(store);  // whatever else a search is opened with; words are up to date
  report.bytes = std::filesystem::file_size(path);
  report.seconds = wall_seconds() - start;
  return report;
}

}  // namespace freshet::bench
