// freshet store page: what a store holds and lacks.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "platform/whole_file.h"
#include "query/index/search_base.h"
#include "query/labelling/kind_choice.h"
#include "query/labelling/labelling.h"
#include "query/search/coverage.h"
#include "query/search/picture_scale.h"
#include "store/store.h"
#include "stored/average_image.h"
#include "stored/clip_metadata.h"
#include "studio/clip_strip.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/options/target_files.h"
#include "tools/store/store_page.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

struct PageCommand {
  std::string store, out;
  std::vector<fs::path> pictures, mattes;
  bool json = false;
};

/// The clip's first two seconds.
PlayedStrip strip_of(studio::ClipSamples& samples, store::ClipId id, double clip_seconds) {
  constexpr int kWidth = 192;  // px of a frame
  const studio::ClipSamples::Frames frames = samples.frames(id);
  const int count = static_cast<int>(frames->size());
  const cv::Mat all = studio::clip_strip(*frames, kWidth);
  const std::string jpeg = studio::encoded(all);
  return {.jpeg = {jpeg.begin(), jpeg.end()},
          .frames = count,
          .frame = {all.cols / count, all.rows},
          .seconds = std::min(2.0, clip_seconds)};
}

/// px/s: median of the clip's patches as it was filmed.
double median_speed(const query::SearchBase& base, std::size_t clip, std::uint8_t upright) {
  const stored::PatchTable& table = base.table;
  std::vector<double> speeds;
  for (stored::Row row = table.first_row[clip]; row < table.first_row[clip + 1]; ++row)
    if (table.variant[row] == upright) speeds.push_back(std::hypot(table.mean_u[row], table.mean_v[row]));
  if (speeds.empty()) return 0;
  const auto middle = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2);
  std::nth_element(speeds.begin(), middle, speeds.end());
  return *middle;
}

ShownClip shown_clip(const store::Snapshot& snapshot, const query::SearchBase& base,
                     studio::ClipSamples& samples, std::size_t clip) {
  const store::ClipId id = base.table.clips[clip];
  const store::ClipRecord& record = snapshot.clip(id);
  const std::vector<vision::Variant> variants = base.settings.variants();
  const auto upright = std::ranges::find(variants, vision::Variant{}) - variants.begin();
  const stored::ClipMetadata metadata = stored::metadata_of(snapshot, id);
  ShownClip shown{.name = record.name,
                  .class_name = record.class_name,
                  .licence = record.licence,
                  .author = metadata.author,
                  .source = metadata.source,
                  .size = {static_cast<int>(record.width), static_cast<int>(record.height)},
                  .fps = static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den),
                  .patches = record.rows,
                  .strip = {}};
  shown.seconds = record.frame_count / shown.fps;
  shown.speed = median_speed(base, clip, static_cast<std::uint8_t>(upright)) /
                std::max(shown.size.width, shown.size.height);
  shown.light = cv::mean(stored::average_image(snapshot, id))[0] / 255;
  if (metadata.half_life_s) shown.half_life_s = metadata.half_life_s->front();
  shown.strip = strip_of(samples, id, shown.seconds);
  return shown;
}

/// Red over the pieces that look like nothing in the store.
cv::Mat marked(const cv::Mat& picture, const query::CandidateSearch& search, double unlike) {
  constexpr double kLongest = 640;  // px
  cv::Mat red = picture.clone();
  const query::Target& target = search.target;
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    if (search.candidates.scores_of(piece).front() >= unlike) continue;
    const double scale = search.piece_scale;
    // Each piece is marked where no neighbour overlaps it.
    const cv::Point corner = target.corners[piece] + cv::Point(target.side / 4, target.side / 4);
    const cv::Rect box(cvRound(corner.x * scale), cvRound(corner.y * scale), cvRound(target.side / 2 * scale),
                       cvRound(target.side / 2 * scale));
    const cv::Rect seen = box & cv::Rect({0, 0}, picture.size());
    if (!seen.empty()) cv::add(red(seen), cv::Scalar(-50, -50, 90), red(seen));
  }
  const double factor = std::min(1.0, kLongest / std::max(red.cols, red.rows));
  cv::resize(red, red, {}, factor, factor, cv::INTER_AREA);
  return red;
}

AskedPicture asked_picture(const store::Snapshot& snapshot, const query::SearchBase& base,
                           const fs::path& file, const fs::path& matte, double unlike,
                           const RunContext& context) {
  TargetFiles target;
  target.picture = file;
  target.matte = matte;
  const TargetFiles::Loaded loaded = target.load();
  AskedPicture asked{.name = file.filename().string(), .kind = {}, .jpeg = {}};
  query::CandidateOptions any{.class_name = std::string(query::kAnyClass)};
  const query::KindChoice kind = query::choose_kind(snapshot, base, loaded.picture, loaded.matte, {}, any);
  asked.kind = kind.look.name();
  asked.kind_sure = kind.look.sure();
  query::LabelOptions options;
  options.candidates.k = 1;
  options.candidates.coherent = 0;
  options.piece_scale = query::auto_piece_scale(loaded.picture.size());
  const auto search = [&] {
    return query::search_candidates(snapshot, base, loaded.picture, loaded.matte, options, {}, context.stop);
  };
  const query::CandidateSearch whole = search();
  asked.unlike = asked.unlike_reduced = query::unlike_share(whole.candidates, unlike);
  cv::imencode(".jpg", marked(loaded.picture, whole, unlike), asked.jpeg, {cv::IMWRITE_JPEG_QUALITY, 82});
  options.piece_scale *= 2;
  if (std::min(loaded.picture.cols, loaded.picture.rows) / options.piece_scale >=
      2 * base.settings.grid.patch)
    asked.unlike_reduced = query::unlike_share(search().candidates, unlike);
  return asked;
}

void write_page(const PageCommand& command, const RunContext& context) {
  check_output_folder(command.out);
  if (!command.mattes.empty() && command.mattes.size() != command.pictures.size())
    throw Error(ErrorKind::kUsage, "--matte", "there are not as many mattes as pictures",
                "Give one for each picture, in the same order, or none");
  const store::Snapshot snapshot = store::Store::open_read(command.store).snapshot();
  Progress progress;
  progress.show("reading the index", 0, 0);
  const query::SearchBase base = query::open_search(snapshot);
  const query::Likeness likeness = query::likeness_between_clips(base);
  StoreContents contents{
      .store = fs::path(command.store).filename().string(), .bytes = 0, .clips = {}, .pictures = {}};
  studio::ClipSamples samples(snapshot);
  for (const fs::path& file : snapshot.files()) contents.bytes += fs::file_size(file);
  for (std::size_t clip = 0; clip < base.table.clips.size(); ++clip) {
    if (context.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "page", "stopped");
    progress.show("looking at clips", clip, base.table.clips.size(), "clips");
    contents.clips.push_back(shown_clip(snapshot, base, samples, clip));
    contents.clips.back().alike = likeness.clips[clip];
  }
  for (std::size_t i = 0; i < command.pictures.size(); ++i) {
    progress.show("looking at pictures", i, command.pictures.size(), "pictures");
    contents.pictures.push_back(asked_picture(snapshot, base, command.pictures[i],
                                              command.mattes.empty() ? fs::path() : command.mattes[i],
                                              likeness.unlike, context));
  }
  progress.finish();
  write_whole_file(command.out, store_page(contents));
  if (command.json) {
    fmt::print("{}\n", to_json(contents).dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    return;
  }
  for (const std::string& lack : lacks_of(contents)) say(lack);
  fmt::print("{}\n", command.out);
}

}  // namespace

void add_store_page(CLI::App& store, RunContext& context) {
  auto command = std::make_shared<PageCommand>();
  CLI::App* sub = store.add_subcommand(
      "page",
      "A page of all clips, which play, and of what the store lacks: kinds, speeds, and what pictures ask");
  sub->add_option("STORE", command->store, "The store file")->required();
  sub->add_option("-o,--output", command->out, "The page (.html)")->required();
  sub->add_option("--picture", command->pictures,
                  "Pictures that are to be animated: how much of each looks like nothing in the store");
  sub->add_option(
      "--matte", command->mattes,
      "A matte for each picture, in the same order, white where the fluid is [its alpha, else all of it]");
  sub->add_flag("--json", command->json, "Print what the page says as JSON");
  add_overwrite(*sub);
  add_threads(*sub);
  sub->callback([command, &context] { write_page(*command, context); });
}

}  // namespace freshet::tools
