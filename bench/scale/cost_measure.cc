#include "bench/scale/cost_measure.h"

#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <span>

#include "bench/harness/machine.h"
#include "bench/harness/subprocess.h"
#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "query/index/index_builder.h"
#include "query/index/search_base.h"
#include "query/labelling/labelling.h"
#include "query/search/target.h"
#include "store/store.h"
#include "vision/settings.h"

namespace freshet::bench {
namespace {

using nlohmann::json;

constexpr std::size_t kCandidates = 100;
constexpr int kRounds = 5;  // of the batch; the median counts

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

PictureArgument small_picture(const std::string& argument) {
  return brought_to(read_picture_argument(argument), {640, 480});
}

json measure_open(const std::filesystem::path& path, const std::vector<std::string>& pictures) {
  const PictureArgument picture = small_picture(pictures.at(0));
  json result;
  json& seconds = result["seconds"];
  Stopwatch watch;
  const store::Snapshot snapshot = store::Store::open_read(path).snapshot();
  seconds["store"] = watch.lap();
  const query::SearchBase base = query::open_search(snapshot);
  seconds["base"] = watch.lap();
  const query::Target target =
      query::make_target(picture.picture, picture.matte, base.settings.grid, base.codebook);
  seconds["picture"] = watch.lap();
  const auto answers = base.index->search(target.queries, kCandidates);
  seconds["search"] = watch.lap();
  double total = 0;
  for (const auto& [phase, time] : seconds.items()) total += time.get<double>();
  seconds["total"] = total;
  result["pieces"] = answers.size();
  result["memory"] = memory_now();
  return result;
}

json measure_search(const std::filesystem::path& path, const std::vector<std::string>& pictures) {
  const store::Snapshot snapshot = store::Store::open_read(path).snapshot();
  const query::SearchBase base = query::open_search(snapshot);
  std::vector<query::PieceQuery> all, queries;
  for (const std::string& argument : pictures) {
    const PictureArgument read = read_picture_argument(argument);
    const auto pieces =
        query::make_target(read.picture, read.matte, base.settings.grid, base.codebook).queries;
    all.insert(all.end(), pieces.begin(), pieces.end());
  }
  // Of small pictures, some pieces are asked twice.
  for (std::size_t i = 0; i < kPiecesPerBatch; ++i) queries.push_back(all[i * all.size() / kPiecesPerBatch]);

  const std::span<const query::PieceQuery> batch(queries);
  base.index->search(batch.first(1), kCandidates);  // whatever is built or mapped late
  std::vector<double> ms, batches;
  {
    const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const double start = thread_seconds();
      base.index->search(batch.subspan(i, 1), kCandidates);
      ms.push_back(1e3 * (thread_seconds() - start));
    }
  }
  for (int round = 0; round < kRounds; ++round) {
    const double start = wall_seconds();
    base.index->search(batch, kCandidates);
    batches.push_back(wall_seconds() - start);
  }
  return {{"median_ms", quantile(ms, 0.5)},
          {"p99_ms", quantile(ms, 0.99)},
          {"batch_s", quantile(batches, 0.5)},
          {"distinct_pieces", std::min(all.size(), kPiecesPerBatch)},
          {"memory", memory_now()}};
}

json measure_label(const std::filesystem::path& path, const std::vector<std::string>& pictures) {
  const PictureArgument picture = small_picture(pictures.at(0));
  const store::Snapshot snapshot = store::Store::open_read(path).snapshot();
  const query::SearchBase base = query::open_search(snapshot);
  const query::Labelling labelling = query::label(snapshot, base, picture.picture, picture.matte);
  const query::LabelSeconds& s = labelling.seconds;
  return {{"seconds",
           {{"cut", s.cut},
            {"search", s.search},
            {"costs", s.costs},
            {"minimize", s.minimize},
            {"total", s.cut + s.search + s.costs + s.minimize}}},
          {"pieces", labelling.assignment.pieces.size()},
          {"gap", labelling.assignment.gap()},
          {"memory", memory_now()}};
}

json measure_keep(const std::filesystem::path& path) {
  const store::Snapshot snapshot = store::Store::open_read(path).snapshot();
  json result{{"clips", snapshot.clips().size()}};
  std::uint64_t patches = 0;
  for (const store::ClipId clip : snapshot.clips()) patches += snapshot.clip(clip).rows;
  result["patches"] = patches;
  Stopwatch watch;
  for (const auto& part : snapshot.usage()) result["bytes"][part.what] = part.stored_bytes;
  result["usage_s"] = watch.lap();
  const auto faults = snapshot.verify();
  result["verify_s"] = watch.lap();
  if (!faults.empty()) throw Error(ErrorKind::kDamaged, path.string(), faults.front());
  return result;
}

json measure_index(const std::filesystem::path& path) {
  store::Store store = store::Store::open_write(path);
  const query::IndexReport report = query::build_index(store, {.rebuild = true});
  return {{"sample", report.sample_s},
          {"train", report.train_s},
          {"assign", report.assign_s},
          {"write", report.write_s},
          {"total", report.sample_s + report.train_s + report.assign_s + report.write_s},
          {"memory", memory_now()}};
}

}  // namespace

Measurement parse_measurement(const std::string& name) {
  for (const auto& [known, what] :
       {std::pair{"open", Measurement::kOpen}, std::pair{"search", Measurement::kSearch},
        std::pair{"label", Measurement::kLabel}, std::pair{"keep", Measurement::kKeep},
        std::pair{"index", Measurement::kIndex}}) {
    if (name == known) return what;
  }
  throw Error(ErrorKind::kUsage, name, "is not a measurement");
}

json measure(const std::filesystem::path& store, Measurement what, const std::vector<std::string>& pictures) {
  switch (what) {
    case Measurement::kOpen:
      return measure_open(store, pictures);
    case Measurement::kSearch:
      return measure_search(store, pictures);
    case Measurement::kLabel:
      return measure_label(store, pictures);
    case Measurement::kKeep:
      return measure_keep(store);
    case Measurement::kIndex:
      return measure_index(store);
  }
  return {};
}

}  // namespace freshet::bench
