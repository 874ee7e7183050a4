#include "bench/quality/quality_case.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "ingest/clip_analysis.h"
#include "media/frame/frame.h"
#include "query/search/target.h"
#include "query/stored/average_image.h"
#include "query/stored/clip_frames.h"

namespace freshet::bench {
namespace {

constexpr std::uint32_t kMinFrames = 24;
constexpr double kMinMoving = 0.01;        // of the picture
constexpr double kMinPartFraction = 0.02;  // of the matte: smaller parts of it are left out
constexpr double kEdge = 2;                // px, sigma of the matte's soft edge
constexpr double kSameScene = 0.97;        // correlation of two clips' average images

/// Frames of a clip, reduced and cropped.
std::vector<cv::Mat> read_reduced(const store::Snapshot& snapshot, store::ClipId clip, std::uint32_t first,
                                  std::uint32_t count, int longest) {
  const query::ClipFrames frames(snapshot, clip);
  const double scale = std::min(1.0, 1.0 * longest / std::max(frames.layout().width, frames.layout().height));
  const cv::Size size(static_cast<int>(std::lround(frames.layout().width * scale)),
                      static_cast<int>(std::lround(frames.layout().height * scale)));
  const cv::Rect whole(0, 0, size.width / kSpectrumBlock * kSpectrumBlock,
                       size.height / kSpectrumBlock * kSpectrumBlock);
  std::vector<cv::Mat> reduced(count);
  constexpr std::uint32_t kSlab = 16;
  for (std::uint32_t at = first; at < first + count;) {
    // By the slabs in which they are stored: each is decoded once.
    const std::uint32_t end = std::min((at / kSlab + 1) * kSlab, first + count);
    const std::vector<media::Frame> slab = frames.read(at, end - at);
    oneapi::tbb::parallel_for(std::size_t{0}, slab.size(), [&](std::size_t i) {
      cv::Mat picture = media::to_bgr(slab[i]);
      if (picture.size() != size) cv::resize(picture, picture, size, 0, 0, cv::INTER_AREA);
      reduced[at - first + i] = picture(whole).clone();
    });
    at = end;
  }
  return reduced;
}

cv::Mat thumbnail(const store::Snapshot& snapshot, store::ClipId clip) {
  cv::Mat small, values;
  cv::resize(query::average_image(snapshot, clip), small, {48, 32}, 0, 0, cv::INTER_AREA);
  small.convertTo(values, CV_32F);
  return values - cv::mean(values)[0];
}

/// Clips of the same class and shape whose average images agree: two takes of one place.
std::vector<std::string> clips_of_scene(const store::Snapshot& snapshot, store::ClipId clip) {
  const store::ClipRecord& record = snapshot.clip(clip);
  const cv::Mat own = thumbnail(snapshot, clip);
  std::vector<std::string> names{record.name};
  for (const store::ClipId other : snapshot.clips()) {
    const store::ClipRecord& others = snapshot.clip(other);
    if (other == clip || others.class_name != record.class_name ||
        others.width * record.height != record.width * others.height)
      continue;
    const cv::Mat theirs = thumbnail(snapshot, other);
    if (own.dot(theirs) > kSameScene * cv::norm(own) * cv::norm(theirs)) names.push_back(others.name);
  }
  return names;
}

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

std::vector<cv::Mat> luma_of(const std::vector<cv::Mat>& frames) {
  std::vector<cv::Mat> luma(frames.size());
  oneapi::tbb::parallel_for(std::size_t{0}, frames.size(),
                            [&](std::size_t i) { cv::cvtColor(frames[i], luma[i], cv::COLOR_BGR2GRAY); });
  return luma;
}

std::optional<Case> make_case(const store::Snapshot& snapshot, const vision::Settings& settings,
                              store::ClipId clip, const CaseOptions& options, std::string& why) {
  const store::ClipRecord& record = snapshot.clip(clip);
  if (record.frame_count < kMinFrames) {
    why = fmt::format("{} frames are too few", record.frame_count);
    return std::nullopt;
  }
  Case made;
  made.name = record.name;
  made.class_name = record.class_name;
  made.same_scene = clips_of_scene(snapshot, clip);
  made.fps = static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den);

  // Around the middle: the frames to be matched, and as many before and after it as there are.
  const auto wanted = static_cast<std::uint32_t>(options.frames);
  const std::uint32_t count = std::min(wanted, record.frame_count),
                      half = std::min(wanted, record.frame_count / 2);
  const std::uint32_t middle = record.frame_count / 2, first = middle - half;
  const std::uint32_t begin = std::min(middle - count / 2, record.frame_count - count);
  const std::uint32_t from = std::min(first, begin), to = std::max(first + 2 * half, begin + count);
  std::vector<cv::Mat> frames = read_reduced(snapshot, clip, from, to - from, options.width);
  const std::vector<cv::Mat> luma = luma_of(frames);
  const std::vector<PairMotion> motions = pair_motions(luma);
  const auto part = [&](const auto& all, std::uint32_t start, std::uint32_t length) {
    return std::vector(all.begin() + (start - from), all.begin() + (start - from) + length);
  };

  made.truth = part(frames, begin, count);
  made.luma = part(luma, begin, count);
  made.still = frames[middle - from].clone();
  const std::vector<PairMotion> own = part(motions, begin, count - 1);
  made.matte = moving_matte(own, made.luma, made.fps, settings);
  const double fraction = cv::countNonZero(made.matte > 127) / static_cast<double>(made.matte.total());
  if (fraction < kMinMoving) {
    why = fmt::format("only {:.1f} % of it moves", 100 * fraction);
    return std::nullopt;
  }
  made.strokes = draw_strokes(mean_motion(own, made.fps), made.matte);

  const query::Target target = query::lay_out(made.matte, settings.grid);
  const int margin = (target.side - target.stride) / 2;
  made.region = {made.matte, target.origin + cv::Point(margin, margin), target.stride};
  made.film = measure(made.luma, own, made.fps, made.region);
  if (half >= kMinFrames) {
    const auto film_of = [&](std::uint32_t start) {
      return measure(part(luma, start, half), part(motions, start, half - 1), made.fps, made.region);
    };
    made.half = compare(film_of(first), film_of(middle), made.region);
  }
  const std::vector<cv::Mat> frozen(count, luma[middle - from]);
  const PairMotion none{cv::Mat::zeros(own[0].flow.size(), CV_32FC2),
                        cv::Mat::zeros(own[0].speed.size(), CV_32F)};
  made.frozen = compare(measure(frozen, std::vector<PairMotion>(count - 1, none), made.fps, made.region),
                        made.film, made.region);
  return made;
}

}  // namespace freshet::bench
