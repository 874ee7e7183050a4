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
  auto metadata = nlohmann::json::parse(clip.record.metadata);
  nlohmann::json& by_variant = metadata["patches"];
  for (std::size_t row = rows; row < clip.patches.size(); ++row) {
    nlohmann::json& count = by_variant[clip.patches.variant[row]];
    count = count.get<std::uint64_t>() - 1;
  }
  clip.record.metadata = metadata.dump();
  clip.patches.variant.resize(rows);
  clip.patches.x.resize(rows);
  clip.patches.y.resize(rows);
  clip.patches.motion.resize(rows);
  clip.patches.coverage.resize(rows);
  clip.words.resize(rows);
}

store::PlaneView view_of(const cv::Mat& plane) {
  return {reinterpret_cast<const std::byte*>(plane.data), static_cast<std::ptrdiff_t>(plane.step)};
}

void write_stream(store::ClipWriter& writer, store::Stream stream, std::span<const cv::Mat> planes,
                  std::size_t planes_per_frame) {
  std::vector<store::PlaneShape> shapes;
  for (const cv::Mat& plane : planes.first(planes_per_frame)) {
    shapes.push_back({static_cast<std::uint32_t>(plane.cols), static_cast<std::uint32_t>(plane.rows),
                      static_cast<std::uint8_t>(plane.elemSize1())});
  }
  std::vector<store::PlaneView> views;
  for (const cv::Mat& plane : planes) views.push_back(view_of(plane));
  writer.begin_stream(stream, shapes);
  writer.append(stream, views);
}

void write_clip(store::Store& store, JitteredClip clip) {
  store::ClipWriter writer = store.add_clip();
  write_stream(writer, store::Stream::kFrames, clip.frames, 1);
  std::vector<cv::Mat> flow;
  for (const auto& planes : clip.flow) flow.insert(flow.end(), planes.begin(), planes.end());
  if (!flow.empty()) write_stream(writer, store::Stream::kFlow, flow, 2);
  write_stream(writer, store::Stream::kAverage, {&clip.average, 1}, 1);

  const auto write_cells = [&](const std::string& name, const vision::CellMap& cells) {
    writer.column_bytes(name, std::as_bytes(std::span(cells.values)),
                        static_cast<std::uint32_t>(static_cast<std::size_t>(cells.channels) * sizeof(float)));
  };
  const double interval = static_cast<double>(clip.record.fps_den) / static_cast<double>(clip.record.fps_num);
  std::vector<double> times;
  for (std::size_t i = 0; i < clip.frames.size(); ++i) times.push_back(static_cast<double>(i) * interval);
  writer.column<double>("frame.time", times);
  write_cells("cells.motion", clip.motion);
  for (std::size_t i = 0; i < clip.texture.size(); ++i)
    write_cells(fmt::format("cells.texture.{}", i), clip.texture[i]);
  writer.column<std::uint8_t>("patch.variant", clip.patches.variant);
  writer.column<std::uint16_t>("patch.x", clip.patches.x);
  writer.column<std::uint16_t>("patch.y", clip.patches.y);
  writer.column<std::array<float, 2>>("patch.motion", clip.patches.motion);
  writer.column<float>("patch.coverage", clip.patches.coverage);
  writer.column<vision::WordMap>("patch.words", clip.words);
  writer.commit(std::move(clip.record));
}

}  // namespace

void generate(const store::Snapshot& source, const ScaleOptions& options,
              const std::function<void(JitteredClip&&, std::uint64_t)>& take) {
  const vision::Settings settings = vision::settings_from_json(source.settings());
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
      if (clip.patches.size() == 0 || given >= options.patches) continue;
      if (clip.patches.size() > options.patches - given) cut_rows(clip, options.patches - given);
      const std::uint64_t patches = clip.patches.size();
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
    report.patches = before + clip.patches.size();
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
