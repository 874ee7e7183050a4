// What does a warm edit save, and a sweep?
//
//   bench_reuse STORE PICTURE[:MATTE] [CLASS]
//
// A made field of strokes asks for motion; then the strokes in one corner turn by 40 degrees. The picture is
// labelled without a cache, with an empty one, with the first field's results after the edit, and once more
// unchanged; the bench ends with 1 when any labels differ from those made without a cache. Then six weights
// are labelled by label_variations and one by one, again to the same labels. CPU seconds of all threads,
// opening the store included; wall seconds beside them. Rendering is in neither.

#include <CLI/CLI.hpp>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "bench/harness/machine.h"
#include "bench/harness/picture_argument.h"
#include "query/hints/stroke_field.h"
#include "query/labelling/label_sweep.h"
#include "query/labelling/labelling.h"
#include "query/labelling/labelling_memo.h"

namespace {

using namespace freshet;

query::MotionGuide guide_of(cv::Size size, double turned_deg) {
  const auto w = static_cast<float>(size.width), h = static_cast<float>(size.height);
  const auto stroke = [&](float x, float y, double degrees) {
    const double angle = degrees * CV_PI / 180;
    return query::Stroke{{{x * w, y * h},
                          {x * w + 0.12f * w * static_cast<float>(std::cos(angle)),
                           y * h + 0.12f * h * static_cast<float>(std::sin(angle))}}};
  };
  query::MotionGuide guide;
  guide.direction =
      query::interpolate({stroke(0.2f, 0.2f, 30), stroke(0.7f, 0.2f, 60), stroke(0.5f, 0.5f, 45),
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
  std::optional<query::LabelCache> cache;
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

bool sweep(const store::Snapshot& snapshot, const bench::PictureArgument& read, query::LabelOptions options) {
  std::vector<query::LabelVariation> variations;
  for (const double sigma : {0.05, 0.125, 1.0})
    for (const double rho : {0.25, 2.0}) variations.push_back({.costs = {.sigma = sigma, .rho = rho}});
  fmt::print("\nsweep of six labellings          CPU s  wall s\n");
  const Seconds start;
  const query::SearchBase base = query::open_search(snapshot);
  const query::CandidateSearch search =
      query::search_candidates(snapshot, base, read.picture, read.matte, options);
  const auto swept = query::label_variations(snapshot, search, variations);
  fmt::print("  {:<26}{}\n", "at once", start.text());
  const Seconds alone;
  bool right = true;
  for (std::size_t i = 0; i < variations.size(); ++i) {
    options.costs = variations[i].costs;
    const query::SearchBase own = query::open_search(snapshot);
    right = query::label(snapshot, own, read.picture, read.matte, options).labels == swept[i].labels && right;
  }
  fmt::print("  {:<26}{}\n", "six single runs", alone.text());
  return right;
}

}  // namespace

int main(int argc, char** argv) try {
  std::string store, picture;
  query::LabelOptions options;
  CLI::App app("What does a warm edit save, and a sweep?");
  app.add_option("STORE", store)->required();
  app.add_option("PICTURE", picture, "PICTURE[:MATTE]")->required();
  app.add_option("CLASS", options.candidates.class_name, "Only clips of this class [all]");
  CLI11_PARSE(app, argc, argv);
  const store::Snapshot snapshot = store::Store::open_read(store).snapshot();
  const auto read = bench::read_picture_argument(picture);
  fmt::print("{}\n{}: {} x {} px\n", bench::to_string(bench::this_machine()), read.name, read.picture.cols,
             read.picture.rows);
  const bool edits = warm_edit(snapshot, read, options), sweeps = sweep(snapshot, read, options);
  if (!edits || !sweeps)
    fmt::print(stderr, "wrong: labels differ from those of a single run without a cache\n");
  return edits && sweeps ? 0 : 1;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
