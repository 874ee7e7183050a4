// What does a warm edit save?
//
//   bench_reuse STORE PICTURE[:MATTE] [CLASS]
//
// A made field of strokes asks for motion; then the strokes in one corner turn by 40 degrees. The picture is
// labelled without a cache, with an empty one, with the first field's results after the edit, and once more
// unchanged; the bench ends with 1 when any labels differ from those made without a cache. CPU seconds of all
// threads, opening the store included; wall seconds beside them. Rendering is in neither.

#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "bench/harness/arguments.h"
#include "bench/harness/machine.h"
#include "bench/harness/picture_argument.h"
#include "hints/stroke_field.h"
#include "query/labelling/labelling.h"
#include "query/labelling/labelling_memo.h"

namespace {

using namespace freshet;

query::MotionGuide guide_of(cv::Size size, double turned_deg) {
  const auto w = static_cast<float>(size.width), h = static_cast<float>(size.height);
  const auto stroke = [&](float x, float y, double degrees) {
    const double angle = degrees * CV_PI / 180;
    return hints::Stroke{{{x * w, y * h},
                          {x * w + 0.12f * w * static_cast<float>(std::cos(angle)),
                           y * h + 0.12f * h * static_cast<float>(std::sin(angle))}}};
  };
  query::MotionGuide guide;
  guide.direction =
      hints::interpolate({stroke(0.2f, 0.2f, 30), stroke(0.7f, 0.2f, 60), stroke(0.5f, 0.5f, 45),
                          stroke(0.2f, 0.75f, 20), stroke(0.75f, 0.75f, 30 + turned_deg)},
                         size)
          .direction;
  return guide;
}

struct Seconds {
  double wall = bench::wall_seconds(), cpu = bench::process_seconds();
  std::string text() const {
    return fmt::format("{:>8.2f}{:>8.2f}", bench::process_seconds() - cpu, bench::wall_seconds() - wall);
  }
};

query::Labelling run(const store::Snapshot& snapshot, const bench::PictureArgument& read,
                     const query::LabelOptions& options, const std::filesystem::path& folder,
                     const char* what) {
  const Seconds start;
  const query::SearchBase base = query::open_search(snapshot, {.built_late = !folder.empty()});
  std::optional<cache::ResultCache> cache;
  std::optional<query::LabellingMemo> memo;
  if (!folder.empty()) memo.emplace(cache.emplace(folder), snapshot, base);
  query::Labelling labelling =
      query::label(snapshot, base, read.picture, read.matte, options, {}, {}, memo ? &*memo : nullptr);
  if (cache) cache->finish();
  fmt::print("  {:<26}{}  {}\n", what, start.text(), memo ? query::to_string(memo->reuse()) : "");
  std::fflush(stdout);
  return labelling;
}

bool warm_edit(const store::Snapshot& snapshot, const bench::PictureArgument& read,
               query::LabelOptions options) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("freshet-bench-reuse-{}", getpid());
  fmt::print("\nwarm edit                        CPU s  wall s\n");
  options.guide = guide_of(read.picture.size(), 0);
  const auto first = run(snapshot, read, options, {}, "no cache");
  bool right = run(snapshot, read, options, folder, "empty cache").labels == first.labels;
  options.guide = guide_of(read.picture.size(), 40);
  right = run(snapshot, read, options, folder, "one stroke turned, warm").labels ==
              run(snapshot, read, options, {}, "one stroke turned, cold").labels &&
          right;
  run(snapshot, read, options, folder, "unchanged");
  std::filesystem::remove_all(folder);
  return right;
}

}  // namespace

int main(int argc, char** argv) try {
  std::string store, picture;
  query::LabelOptions options;
  bench::Arguments app("What does a warm edit save?");
  app.option("STORE", store).required();
  app.option("PICTURE", picture, "PICTURE[:MATTE]").required();
  app.option("CLASS", options.candidates.class_name, "Only clips of this class [all]");
  app.parse(argc, argv);
  const store::Snapshot snapshot = store::Store::open_read(store).snapshot();
  const auto read = bench::read_picture_argument(picture);
  fmt::print("{}\n{}: {} x {} px\n", bench::to_string(bench::this_machine()), read.name, read.picture.cols,
             read.picture.rows);
  if (warm_edit(snapshot, read, options)) return 0;
  fmt::print(stderr, "wrong: labels differ from those of a single run without a cache\n");
  return 1;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
