// Whole tours, through films on disk.

#include "synth/tour/tour.h"

#include <fstream>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/frame.h"
#include "media/video/picture_sink.h"
#include "media/video/video_reader.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::synth::tour {
namespace {

const cv::Size kSize(96, 64);

class TourThroughFilms : public testing::Test {
 protected:
  /// Frame i is of one grey, 20 * i + 10, but for a texture.
  cv::Mat frame(int i) const {
    cv::Mat out(kSize, CV_8UC3);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        out.at<cv::Vec3b>(y, x) =
            cv::Vec3b::all(static_cast<std::uint8_t>(20 * i + 10 + (x / 3 + y / 2) % 4));
    return out;
  }
  std::filesystem::path film(int frames) const {
    const std::filesystem::path path = folder_ / "film.mkv";
    media::PictureSink sink(path, kSize, frames + 1, 25);
    for (int i = 0; i < frames; ++i) sink.write(frame(i));
    sink.finish();
    return path;
  }
  static std::vector<int> greys(Tour& tour) {
    std::vector<int> result;
    cv::Mat out(tour.size(), CV_8UC3);
    for (int i = 0; i < tour.frames(); ++i) {
      tour.render(out);
      result.push_back(cvRound((cv::mean(out)[1] - 11.5) / 20));
    }
    return result;
  }
  static TourPlan still() {
    TourPlan plan;
    plan.horizon = 20;
    plan.keys = {{0, {}}};
    return plan;
  }
  void refused(const TourPlan& plan, const std::vector<std::string>& words) const {
    try {
      Tour tour(folder_ / "film.mkv", plan, {.frames = 5});
      ADD_FAILURE() << "taken, without " << words.front();
    } catch (const Error& error) {
      for (const std::string& word : words)
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
            << word << " is not in: " << error.what();
    }
  }
  ScratchFolder folder_;
};

TEST_F(TourThroughFilms, StandingStillItIsTheFilm) {
  Tour tour(film(5), still());
  ASSERT_EQ(tour.frames(), 5);
  EXPECT_EQ(tour.narrowed().share, 1);
  media::VideoReader reader(folder_ / "film.mkv");
  cv::Mat out(kSize, CV_8UC3);
  for (int i = 0; i < 5; ++i) {
    tour.render(out);
    EXPECT_LE(cv::norm(out, media::to_bgr(*reader.next()), cv::NORM_INF), 0) << i;
  }
}

TEST_F(TourThroughFilms, AFilmThatIsTooShortGoesOnAsAsked) {
  const std::filesystem::path path = film(5);
  const auto played = [&](FilmEnd end, int frames) {
    Tour tour(path, still(), {.frames = frames, .film_end = end});
    return greys(tour);
  };
  EXPECT_EQ(played(FilmEnd::kHold, 8), (std::vector<int>{0, 1, 2, 3, 4, 4, 4, 4}));
  EXPECT_EQ(played(FilmEnd::kPingPong, 12), (std::vector<int>{0, 1, 2, 3, 4, 3, 2, 1, 0, 1, 2, 3}));
  EXPECT_EQ(played(FilmEnd::kRepeat, 4), (std::vector<int>{0, 1, 2, 3}));
  // It does not come round: its end goes over into its beginning.
  const std::vector<int> faded = played(FilmEnd::kRepeat, 9);
  EXPECT_EQ(std::vector<int>(faded.begin(), faded.begin() + 4), (std::vector<int>{0, 1, 2, 3}));
  for (std::size_t i = 4; i < faded.size(); ++i) EXPECT_LE(faded[i], 4);
  EXPECT_LT(*std::ranges::min_element(faded.begin() + 4, faded.end()), 3);
}

TEST_F(TourThroughFilms, GoingBackwardsNeedsMemory) {
  film(5);
  try {
    Tour tour(folder_ / "film.mkv", still(),
              {.frames = 12, .film_end = FilmEnd::kPingPong, .memory_bytes = 50000});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("--memory"), std::string::npos) << error.what();
  }
}

TEST_F(TourThroughFilms, AtAnotherRateItShowsTheFrameOfTheMoment) {
  film(5);
  Tour tour(folder_ / "film.mkv", still(), {.frames = 8, .fps = 50});
  EXPECT_EQ(greys(tour), (std::vector<int>{0, 0, 1, 1, 2, 2, 3, 3}));
}

TEST_F(TourThroughFilms, SkippedFramesCountAsShownOnes) {
  film(5);
  TourPlan plan = still();
  plan.keys = {{0, {}}, {0.16, {.position = {0, 0, 1}}}};
  Tour whole(folder_ / "film.mkv", plan), part(folder_ / "film.mkv", plan);
  cv::Mat a(kSize, CV_8UC3), b(kSize, CV_8UC3);
  for (int i = 0; i < 4; ++i) whole.render(a);
  for (int i = 0; i < 3; ++i) part.skip();
  part.render(b);
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0);
}

TEST_F(TourThroughFilms, ViewsAreNarrowedOrMirrored) {
  film(5);
  TourPlan plan;
  plan.horizon = 20;
  plan.move = Move::kTruck;
  Tour narrowed(folder_ / "film.mkv", plan);
  EXPECT_LT(narrowed.narrowed().share, 0.95);
  EXPECT_GT(narrowed.narrowed().share, 0.5);
  EXPECT_EQ(narrowed.beyond_share(), 0);
  // As wide as can be: each frame's rim is in the picture, one of them just so.
  double widest = -1e9;
  for (int i = 0; i < narrowed.frames(); ++i)
    for (const double y : {0.0, 63.0})
      for (const double x : {-0.5, 95.5}) {
        const Room::Hit hit = narrowed.room().hit(
            narrowed.room().camera(narrowed.path().at(i / 25.0), kSize, narrowed.narrowed()), {x, y});
        widest = std::max({widest, -0.5 - hit.sample.x, hit.sample.x - 95.5});
      }
  EXPECT_LT(widest, 1e-3);
  EXPECT_GT(widest, -1);
  plan.beyond = Beyond::kMirror;
  Tour mirrored(folder_ / "film.mkv", plan);
  EXPECT_EQ(mirrored.narrowed().share, 1);
  EXPECT_GT(mirrored.beyond_share(), 0.02);
  EXPECT_NE(mirrored.notices().back().find("mirrored"), std::string::npos);
  plan.move = Move::kIn;
  EXPECT_EQ(Tour(folder_ / "film.mkv", plan).narrowed().share,
            1);  // ahead everything shown was in the picture
}

TEST_F(TourThroughFilms, AThingThatTheLowerEdgeCutsIsKept) {
  film(5);
  cv::Mat matte(kSize, CV_8U, cv::Scalar(0));
  matte(cv::Rect(40, 44, 16, 20)).setTo(255);
  cv::imwrite(folder_ / "rock.png", matte);
  TourPlan plan;
  plan.horizon = 20;
  plan.move = Move::kTruck;
  plan.amount = 0.4;
  plan.things = {{.name = "rock", .matte = folder_ / "rock.png"}};
  Tour tour(folder_ / "film.mkv", plan);
  ASSERT_LT(tour.narrowed().share, 0.97);
  EXPECT_EQ(tour.narrowed().anchor, 1);
  const Room::Hit below = tour.room().hit(tour.room().camera({}, kSize, tour.narrowed()), {47.5, 63.5});
  EXPECT_NEAR(below.sample.y, 63.5, 1e-6);
  EXPECT_NEAR(below.sample.x, 47.5, 1e-6);
}

// The matte misses a dark thing's rim by 5 px, which would stand on the floor where the thing moves away.
TEST_F(TourThroughFilms, AGrownMatteLeavesNoRimBehind) {
  cv::Mat picture(kSize, CV_8UC3, cv::Scalar::all(180)), matte(kSize, CV_8U, cv::Scalar(0));
  cv::rectangle(picture, cv::Rect(40, 24, 20, 26), cv::Scalar::all(20), cv::FILLED);
  cv::rectangle(matte, cv::Rect(45, 29, 10, 16), 255, cv::FILLED);
  cv::imwrite(folder_ / "still.png", picture);
  cv::imwrite(folder_ / "thing.png", matte);
  TourPlan plan = still();
  plan.keys = {{0, {.position = {0.8, 0, 0}}}};
  plan.beyond = Beyond::kMirror;
  // Dark px where the thing stood, on the floor behind it.
  const auto dark = [&](int grow) {
    plan.things = {{.name = "thing", .matte = folder_ / "thing.png", .foot = 50, .grow_px = grow}};
    Tour tour(folder_ / "still.png", plan, {.frames = 1});
    cv::Mat out(kSize, CV_8UC3), green;
    tour.render(out);
    cv::extractChannel(out, green, 1);
    return cv::countNonZero(green.colRange(38, kSize.width) < 100);
  };
  EXPECT_GT(dark(0), 100);
  EXPECT_LT(dark(8), 10);
}

TEST_F(TourThroughFilms, SizesKeepTheView) {
  film(5);
  Tour half(folder_ / "film.mkv", still(), {.size = {48, 0}});
  EXPECT_EQ(half.size(), cv::Size(48, 32));
  cv::Mat out(half.size(), CV_8UC3), expected;
  half.render(out);
  cv::resize(frame(0), expected, half.size(), 0, 0, cv::INTER_AREA);
  EXPECT_LE(cv::norm(out, expected, cv::NORM_INF), 3);
  EXPECT_THROW(Tour(folder_ / "film.mkv", still(), {.size = {100000, 2}}), Error);
}

TEST_F(TourThroughFilms, AStillIsAFilmOfOneFrame) {
  cv::imwrite(folder_ / "still.png", frame(3));
  TourPlan plan;
  plan.seconds = 0.4;
  Tour tour(folder_ / "still.png", plan);
  EXPECT_EQ(tour.frames(), 10);
  EXPECT_NE(tour.notices().front().find("no horizon"), std::string::npos);
  EXPECT_EQ(greys(tour), std::vector<int>(10, 3));
  EXPECT_EQ(tour.drawn().size(), kSize);
}

TEST_F(TourThroughFilms, CamerasOutsideAndViewsOfNothingAreRefused) {
  film(5);
  TourPlan plan = still();
  plan.keys = {{0, {}}, {0.1, {.position = {0, -1.2, 0}}}};
  refused(plan, {"below the floor", "s: ", "Move the keys"});
  plan.back = 24;
  plan.keys = {{0, {.position = {0, 0, 40}}}};
  refused(plan, {"behind the back wall"});
  plan.keys = {{0, {.yaw_deg = 80, .view_deg = 60}}};
  refused(plan, {"looks [80, 0] degrees", "Turn it less"});
  plan.keys.clear();
  plan.move = Move::kRise;
  plan.amount = -4;
  refused(plan, {"below the floor", "smaller amount"});
  plan.back = 19;
  refused(plan, {"not below the horizon"});
}

TEST_F(TourThroughFilms, MattesThatDoNotFitAreRefused) {
  film(5);
  TourPlan plan = still();
  cv::Mat matte(kSize, CV_8U, cv::Scalar(0));
  plan.things = {{.name = "boat", .matte = folder_ / "boat.png"}};
  refused(plan, {"boat.png"});  // it is not there
  cv::imwrite(folder_ / "boat.png", matte);
  refused(plan, {"boat.png", "black"});
  matte(cv::Rect(30, 5, 20, 10)).setTo(255);
  cv::imwrite(folder_ / "boat.png", matte);
  refused(plan, {"boat", "row 15", "horizon"});
  cv::imwrite(folder_ / "boat.png", cv::Mat(matte.colRange(0, 50)));
  refused(plan, {"boat.png", "50 x 64", "96 x 64"});
}

}  // namespace
}  // namespace freshet::synth::tour
