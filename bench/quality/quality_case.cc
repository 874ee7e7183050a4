#include "bench/quality/quality_case.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "hints/motion_maps.h"
#include "ingest/clip_analysis.h"
#include "query/search/target.h"

namespace freshet::bench {
namespace {

constexpr int kMinFrames = 24;
constexpr double kMinMoving = 0.01;        // of the picture
constexpr double kMinPartFraction = 0.02;  // of the matte: smaller parts of it are left out
constexpr double kEdge = 2;                // px, sigma of the matte's soft edge

/// As a person outlines what moves: without the measure's holes and specks.
void tidy(cv::Mat& matte) {
  const int diameter = static_cast<int>(std::hypot(matte.cols, matte.rows) / 80) | 1;
  cv::morphologyEx(matte, matte, cv::MORPH_CLOSE,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {diameter, diameter}));
  cv::Mat labels, statistics, centres;
  const int count = cv::connectedComponentsWithStats(matte, labels, statistics, centres);
  const double min_area = kMinPartFraction * cv::countNonZero(matte);
  for (int i = 1; i < count; ++i)
    if (statistics.at<int>(i, cv::CC_STAT_AREA) < min_area) matte.setTo(0, labels == i);
}

cv::Mat moving_matte(const std::vector<PairMotion>& motions, const std::vector<cv::Mat>& luma, double fps,
                     const vision::Settings& settings) {
  cv::Mat speed = cv::Mat::zeros(motions[0].speed.size(), CV_32F);
  for (const PairMotion& motion : motions) speed += motion.speed;
  speed *= 1.0 / static_cast<double>(motions.size());
  ingest::LumaStatistics statistics(luma[0].size());
  for (const cv::Mat& frame : luma) statistics.add(frame);
  cv::Mat matte = ingest::moving_mask(speed, statistics.deviation(), fps, settings);
  tidy(matte);
  cv::GaussianBlur(matte, matte, {}, kEdge);
  return matte;
}

cv::Mat mean_motion(const std::vector<PairMotion>& motions, double fps) {
  cv::Mat flow = cv::Mat::zeros(motions[0].flow.size(), CV_32FC2);
  for (const PairMotion& motion : motions) flow += motion.flow;
  return flow * (fps / static_cast<double>(motions.size()));
}

}  // namespace

std::optional<Case> make_case(Footage footage, const vision::Settings& settings, std::string& why) {
  const int count = footage.truth_size, half = footage.half, middle = footage.middle;
  if (count < kMinFrames) {
    why = fmt::format("{} frames are too few", count);
    return std::nullopt;
  }
  Case made;
  made.name = std::move(footage.name);
  made.class_name = std::move(footage.class_name);
  made.same_scene = std::move(footage.same_scene);
  made.fps = footage.fps;

  const std::vector<cv::Mat>& frames = footage.frames;
  const std::vector<cv::Mat> luma = luma_of(frames);
  const std::vector<PairMotion> motions = pair_motions(luma);
  const auto part = [](const auto& all, int start, int length) {
    return std::vector(all.begin() + start, all.begin() + start + length);
  };
  made.truth = part(frames, footage.truth_begin, count);
  made.luma = part(luma, footage.truth_begin, count);
  made.motions = part(motions, footage.truth_begin, count - 1);
  made.still = frames[middle].clone();
  made.matte = moving_matte(made.motions, made.luma, made.fps, settings);
  const double fraction = cv::countNonZero(made.matte > 127) / static_cast<double>(made.matte.total());
  if (fraction < kMinMoving) {
    why = fmt::format("only {:.1f} % of it moves", 100 * fraction);
    return std::nullopt;
  }
  const cv::Mat motion = mean_motion(made.motions, made.fps);
  made.strokes = draw_strokes(motion, made.matte);
  cv::resize(motion, made.motion, made.still.size(), 0, 0, cv::INTER_LINEAR);

  const query::Target target = query::lay_out(made.matte, settings.grid);
  const int margin = (target.side - target.stride) / 2;
  made.region = {made.matte, target.origin + cv::Point(margin, margin), target.stride};
  made.film = measure(made.luma, made.motions, made.fps, made.region);
  const std::vector<cv::Mat> before = part(luma, middle - half, half), after = part(luma, middle, half);
  if (half >= kMinFrames) {
    const Film first = measure(before, part(motions, middle - half, half - 1), made.fps, made.region);
    Film second = measure(after, part(motions, middle, half - 1), made.fps, made.region);
    second.halves_apart = made.film.halves_apart = patch_distances(first.patches, second.patches);
    made.half = compare(first, second, made.region);
    made.half_lifetime = first.lifetime;
  } else {
    made.film.halves_apart =
        patch_distances(sample_patches(before, made.matte), sample_patches(after, made.matte));
  }
  const std::vector<cv::Mat> frozen(count, luma[middle]);
  const PairMotion& any = made.motions[0];
  const PairMotion none{cv::Mat::zeros(any.flow.size(), CV_32FC2), cv::Mat::zeros(any.speed.size(), CV_32F),
                        cv::Mat::zeros(any.fine.size(), CV_32FC2)};
  made.frozen = compare(measure(frozen, std::vector<PairMotion>(count - 1, none), made.fps, made.region),
                        made.film, made.region);
  made.frozen.start = 1;
  return made;
}

cv::Mat true_direction(const Case& clip) {
  cv::Mat direction, speed;
  hints::split_motion(clip.motion, clip.matte, direction, speed);
  return direction;
}

}  // namespace freshet::bench
