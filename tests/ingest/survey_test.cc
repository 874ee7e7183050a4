#include "ingest/survey.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numbers>

#include <tbb/global_control.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "ingest/ingest.h"
#include "media/video/video_writer.h"
#include "stored/clip_metadata.h"
#include "stored/clip_schema.h"
#include "tests/harness/scratch_folder.h"
#include "tests/ingest/synthetic_clip.h"

namespace freshet::ingest {
namespace {

namespace fs = std::filesystem;

constexpr int kFps = 25;
const SyntheticClip kTake{
    .size = {384, 216}, .frames = 60, .moving = {120, 60, 150, 100}, .changing = true, .coarse = true};

SyntheticClip take(int frames, std::uint64_t seed, cv::Vec2d pan = {0, 0}, double jitter = 0) {
  SyntheticClip clip = kTake;
  clip.frames = frames;
  clip.seed = seed;
  clip.pan = pan;
  clip.jitter = jitter;
  return clip;
}

std::vector<cv::Mat> film_of(std::initializer_list<SyntheticClip> takes) {
  std::vector<cv::Mat> film;
  for (const SyntheticClip& clip : takes)
    for (cv::Mat& frame : render(clip)) film.push_back(std::move(frame));
  return film;
}

/// A camera that stands, pans, and stands again.
std::vector<cv::Mat> pan_between(int still, int panned, double px) {
  const SyntheticClip clip = take(1, 5);
  std::vector<cv::Mat> film;
  double at = 0;
  for (int t = 0; t < 2 * still + panned; ++t) {
    if (t > still && t <= still + panned) at += px;
    SyntheticClip moment = clip;
    moment.pan = {};
    moment.velocity = {};
    moment.frames = 1;
    moment.start = t;
    moment.shift = {at, 0};
    film.push_back(render(moment).front());
  }
  return film;
}

Survey look(const std::vector<cv::Mat>& film, double fps = kFps, const ScreeningLimits& limits = {},
            bool steady = false) {
  Surveyor surveyor(film.front().size(), fps, limits, steady);
  for (std::size_t t = 0; t < film.size(); ++t) surveyor.add(film[t], static_cast<double>(t) / fps);
  return surveyor.finish();
}

std::vector<std::pair<int, int>> fit(const Survey& survey) {
  std::vector<std::pair<int, int>> taken;
  for (const Piece& piece : survey.pieces)
    if (piece.fit()) taken.emplace_back(piece.span.first, piece.span.last);
  return taken;
}

void expect_partition(const Survey& survey, int frames) {
  int at = 0;
  for (const Piece& piece : survey.pieces) {
    EXPECT_EQ(piece.span.first, at);
    at = piece.span.last;
  }
  EXPECT_EQ(at, frames);
}

using Spans = std::vector<std::pair<int, int>>;

TEST(Survey, LeavesAFitClipWhole) {
  const Survey survey = look(film_of({take(60, 1)}));
  EXPECT_FALSE(survey.in_parts());
  EXPECT_EQ(fit(survey), (Spans{{0, 60}}));
  EXPECT_DOUBLE_EQ(survey.whole.to_s, 60.0 / kFps);
}

TEST(Survey, CutsAFilmIntoItsTakes) {
  const Survey survey = look(film_of({take(50, 1), take(31, 2), take(77, 3)}));
  EXPECT_EQ(survey.takes, 3);
  EXPECT_EQ(fit(survey), (Spans{{0, 50}, {50, 81}, {81, 158}}));
  expect_partition(survey, 158);
  EXPECT_DOUBLE_EQ(survey.pieces[1].span.from_s, 2);
  EXPECT_DOUBLE_EQ(survey.pieces[1].span.to_s, 3.24);
}

TEST(Survey, LeavesOutTheTakesThatAreUnfitAndSaysWhy) {
  const Survey survey =
      look(film_of({take(50, 1), take(50, 2, {2, 0}), take(12, 3), take(50, 4, {}, 3), take(50, 5)}));
  EXPECT_EQ(fit(survey), (Spans{{0, 50}, {162, 212}}));
  ASSERT_EQ(survey.pieces.size(), 5u);
  EXPECT_NE(survey.pieces[1].refusals.front().find("the camera moves"), std::string::npos);
  EXPECT_NE(survey.pieces[2].refusals.front().find("12 frames"), std::string::npos);
  EXPECT_NE(survey.pieces[3].refusals.front().find("the camera shakes"), std::string::npos);
}

TEST(Survey, AFilmOfWhichNothingIsFitIsOnePieceWithTheReasonsOfAll) {
  const Survey survey = look(film_of({take(15, 1), take(16, 2)}));
  ASSERT_EQ(survey.pieces.size(), 1u);
  EXPECT_EQ(survey.pieces[0].span.frames(), 31);
  ASSERT_EQ(survey.pieces[0].refusals.size(), 3u);
  EXPECT_EQ(survey.pieces[0].refusals[0], "2 takes, none of which is fit");
  EXPECT_NE(survey.pieces[0].refusals[2].find("0.60 to 1.24 s: "), std::string::npos);
}

TEST(Survey, FindsTheStretchesInWhichACameraStands) {
  // 4 s, a pan by a fifth of the frame in 1 s, 4 s.
  const Survey survey = look(pan_between(100, 25, 4));
  const Spans taken = fit(survey);
  ASSERT_EQ(taken.size(), 2u);
  EXPECT_EQ(taken[0], (std::pair{0, 100}));
  EXPECT_EQ(taken[1], (std::pair{125, 225}));
  expect_partition(survey, 225);
  EXPECT_NE(survey.pieces[1].refusals.front().find("the camera moves"), std::string::npos);
}

TEST(Survey, CutsNoSlowPanIntoStretches) {
  // .5 % of the diagonal a second: five seconds would pass for a whole take, but the camera never stands.
  const Survey survey = look(film_of({take(250, 6, {0.088, 0})}));
  EXPECT_EQ(fit(survey), Spans{});
}

TEST(Survey, CutsWhereFramesAreMissing) {
  const std::vector<cv::Mat> film = film_of({take(80, 1)});
  Surveyor surveyor(film.front().size(), kFps, {}, false);
  for (int t = 0; t < 80; ++t) surveyor.add(film[t], t / 25.0 + (t < 40 ? 0 : 0.6));
  const Survey survey = surveyor.finish();
  EXPECT_EQ(fit(survey), (Spans{{0, 40}, {40, 80}}));
  EXPECT_DOUBLE_EQ(survey.pieces[0].span.to_s, 1.6) << "its last frame is not shown through the gap";
  EXPECT_DOUBLE_EQ(survey.pieces[1].span.from_s, 2.2);
}

TEST(Survey, AnEmptyFilmHasNoPieces) {
  Surveyor surveyor({64, 48}, kFps, {}, false);
  EXPECT_TRUE(surveyor.finish().pieces.empty());
}

TEST(Survey, MakesSteadyWhatACameraInTheHandFilmed) {
  // A slow pan and a shake, each refused as it is.
  for (const SyntheticClip& clip : {take(100, 6, {0.3, -0.1}), take(100, 7, {}, 2.5)}) {
    const std::vector<cv::Mat> film = film_of({clip});
    EXPECT_EQ(fit(look(film)), Spans{});
    const Survey survey = look(film, kFps, {}, true);
    expect_partition(survey, 100);
    int frames = 0;
    for (const Piece& piece : survey.pieces) {
      if (!piece.steady) continue;
      const SteadyPath& path = *piece.steady;
      EXPECT_EQ(path.source_from_steady.size(), static_cast<std::size_t>(piece.span.frames()));
      EXPECT_GT(path.kept, 0.7);
      EXPECT_LT(path.kept, 1);
      Screener steady(path.size, kFps);
      for (int t = 0; t < piece.span.frames(); ++t, ++frames) {
        cv::Mat frame;
        cv::warpAffine(film[piece.span.first + t], frame, path.source_from_steady[t], path.size,
                       cv::INTER_LANCZOS4 | cv::WARP_INVERSE_MAP);
        steady.add(frame);
      }
      const Screening screening = steady.finish();
      EXPECT_LT(screening.camera.drift, 0.002);
      EXPECT_LT(screening.camera.shake, 0.0005);
      EXPECT_TRUE(judge(screening).refusals.empty());
    }
    EXPECT_GE(frames, 75);
  }
}

TEST(Survey, DoesNotMakeSteadyWhatMovesTooFast) {
  const Survey survey = look(film_of({take(100, 6, {6, 0})}), kFps, {}, true);
  EXPECT_EQ(fit(survey), Spans{});
  const Survey all_water = look(pan_between(60, 30, 12), kFps, {}, true);
  for (const Piece& piece : all_water.pieces) EXPECT_FALSE(piece.steady);
}

void write_film(const fs::path& path, const std::vector<cv::Mat>& film) {
  media::VideoWriter writer(path, film.front().size(), {.fps_num = kFps});
  cv::Mat bgr;
  for (const cv::Mat& frame : film) {
    cv::cvtColor(frame, bgr, cv::COLOR_GRAY2BGR);
    writer.write(bgr);
  }
  writer.finish();
}

const vision::Settings kSettings;

store::Store new_store(const fs::path& path) {
  return store::Store::create(path, vision::to_json(kSettings));
}

IngestReport run(store::Store& store, const fs::path& path, std::stop_token stop = {},
                 const std::function<void(const IngestProgress&)>& progress = {}) {
  const fs::path paths[] = {path};
  return ingest(store, kSettings, paths, {}, progress, stop);
}

struct Film {
  ScratchFolder folder;
  fs::path path = folder / "water/film.mkv";
  Film() {
    fs::create_directories(folder / "water");
    write_film(path, film_of({take(40, 1), take(30, 2, {2, 0}), take(45, 3)}));
  }
};

TEST(IngestParts, AFilmBecomesAClipForEachFitTakeAndARowForTheRest) {
  const Film film;
  store::Store store = new_store(film.folder / "s");
  const IngestReport report = run(store, film.path);
  ASSERT_EQ(report.clips.size(), 3u);
  EXPECT_EQ(report.clips[0].name, "film.mkv@0.000-1.600");
  EXPECT_EQ(report.clips[0].outcome, Outcome::kAdded);
  EXPECT_EQ(report.clips[1].name, "film.mkv@1.600-2.800");
  EXPECT_EQ(report.clips[1].outcome, Outcome::kRefused);
  EXPECT_EQ(report.clips[1].frames, 30u);
  EXPECT_EQ(report.clips[2].name, "film.mkv@2.800-4.600");
  const store::Snapshot snapshot = store.snapshot();
  ASSERT_EQ(snapshot.clips().size(), 2u);
  const store::ClipId second = *snapshot.find("film.mkv@2.800-4.600");
  EXPECT_EQ(snapshot.clip(second).class_name, "water");
  EXPECT_EQ(snapshot.clip(second).source_hash, part_hash(source_hash(film.path), 70, 115));
  EXPECT_EQ(stored::kFrameTime.read(snapshot, second).front(), 0);
  const nlohmann::json part = stored::metadata_of(snapshot, second).more.at("part");
  EXPECT_EQ(part.at("source"), source_hash(film.path));
  EXPECT_EQ(part.at("first_frame"), 70);
  EXPECT_DOUBLE_EQ(part.at("from_s"), 2.8);
  EXPECT_EQ(part.at("number"), 2);
  EXPECT_EQ(part.at("of"), 2);
}

TEST(IngestParts, ARunAgainAddsNothingAndAStoppedOneGoesOn) {
  const Film film;
  store::Store whole = new_store(film.folder / "whole"), store = new_store(film.folder / "s");
  run(whole, film.path);
  std::stop_source stop;
  const IngestReport stopped = run(store, film.path, stop.get_token(), [&](const IngestProgress& at) {
    if (!at.surveying && at.frames > 75) stop.request_stop();
  });
  ASSERT_TRUE(stopped.stopped.has_value());
  EXPECT_EQ(store.snapshot().clips().size(), 1u);
  const IngestReport rest = run(store, film.path);
  EXPECT_EQ(rest.clips[0].outcome, Outcome::kAlreadyThere);
  EXPECT_EQ(rest.clips[2].outcome, Outcome::kAdded);
  EXPECT_EQ(store.snapshot().digest(), whole.snapshot().digest());

  fs::rename(film.path, film.folder / "water/renamed.mkv");
  const IngestReport again = run(store, film.folder / "water");
  ASSERT_EQ(again.clips.size(), 1u);
  EXPECT_EQ(again.clips[0].outcome, Outcome::kAlreadyThere);
  EXPECT_EQ(again.clips[0].reasons.front(),
            "its 2 parts are in the store, the first as \"film.mkv@0.000-1.600\"");
  EXPECT_EQ(again.clips[0].seconds.survey, 0);
}

TEST(IngestParts, AStopAtTheFirstLookIsHeeded) {
  const Film film;
  store::Store store = new_store(film.folder / "s");
  std::stop_source stop;
  const IngestReport report = run(store, film.path, stop.get_token(), [&](const IngestProgress& at) {
    if (at.surveying) stop.request_stop();
  });
  ASSERT_TRUE(report.stopped.has_value());
  EXPECT_EQ(report.stopped->kind(), ErrorKind::kCancelled);
  EXPECT_TRUE(store.snapshot().clips().empty());
}

TEST(IngestParts, AreTheSameForAnyNumberOfThreads) {
  const Film film;
  const auto digest = [&](int threads, const char* name) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    store::Store store = new_store(film.folder / name);
    run(store, film.path);
    return store.snapshot().digest();
  };
  const std::string two = digest(2, "two");
  EXPECT_EQ(digest(1, "one"), two);
  EXPECT_EQ(digest(5, "five"), two);
}

/// What a command prints; empty when it fails.
std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  for (int c; pipe && (c = std::fgetc(pipe.get())) != EOF;) text += static_cast<char>(c);
  return text;
}

TEST(IngestParts, AreWhatTheFfmpegToolCutsOut) {
  const Film film;
  fs::create_directories(film.folder / "cut/water");
  const fs::path cut = film.folder / "cut/water/cut.mkv";
  if (std::system(("ffmpeg -v error -i '" + film.path.string() +
                   "' -vf trim=start_frame=70:end_frame=115,setpts=PTS-STARTPTS -c:v ffv1 '" + cut.string() +
                   "'")
                      .c_str()) != 0)
    GTEST_SKIP() << "needs the ffmpeg tool: apt-get install ffmpeg";
  store::Store parts = new_store(film.folder / "parts"), twin = new_store(film.folder / "twin");
  run(parts, film.path);
  ASSERT_EQ(run(twin, cut).clips.at(0).outcome, Outcome::kAdded);
  const store::Snapshot a = parts.snapshot(), b = twin.snapshot();
  const store::ClipId part = *a.find("film.mkv@2.800-4.600"), alone = b.clips().front();
  EXPECT_EQ(stored::kFrameTime.read(a, part).size(), 45u);
  for (const store::Stream stream : {store::Stream::kFrames, store::Stream::kFlow}) {
    const store::StreamShape& shape =
        stream == store::Stream::kFrames ? a.clip(part).frames : a.clip(part).flow;
    for (std::uint32_t plane = 0; plane < shape.planes.size(); ++plane) {
      const store::PlaneShape& size = shape.planes[plane];
      std::vector<std::byte> of_part(std::size_t{size.width} * size.height * size.bytes_per_sample *
                                     shape.frames),
          of_twin(of_part.size());
      a.read(part, stream, plane, {0, 0, size.width, size.height}, 0, shape.frames, of_part);
      b.read(alone, stream, plane, {0, 0, size.width, size.height}, 0, shape.frames, of_twin);
      EXPECT_EQ(of_part, of_twin) << "plane " << plane;
    }
  }
  const stored::ClipMetadata here = stored::metadata_of(a, part), there = stored::metadata_of(b, alone);
  EXPECT_EQ(here.more.at("screening"), there.more.at("screening"));
  EXPECT_EQ(here.patches, there.patches);
  // Its time in the source, by ffprobe.
  const std::string stamp =
      output_of("ffprobe -v error -select_streams v -show_entries frame=pts_time -of csv=p=0 '" +
                film.path.string() + "' | sed -n 71p");
  EXPECT_NEAR(here.more.at("part").at("from_s").get<double>(), std::atof(stamp.c_str()), 1e-3);
}

}  // namespace
}  // namespace freshet::ingest
