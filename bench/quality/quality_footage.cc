#include "bench/quality/quality_footage.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "bench/quality/quality_measures.h"
#include "media/frame/frame.h"
#include "media/video/video_reader.h"
#include "stored/average_image.h"
#include "stored/clip_frames.h"

namespace freshet::bench {
namespace {

constexpr double kSameScene = 0.97;  // correlation of two clips' average images

cv::Mat reduced(const media::Frame& frame, int longest) {
  cv::Mat picture = media::to_bgr(frame);
  const double scale = std::min(1.0, 1.0 * longest / std::max(picture.cols, picture.rows));
  const cv::Size size(static_cast<int>(std::lround(picture.cols * scale)),
                      static_cast<int>(std::lround(picture.rows * scale)));
  if (picture.size() != size) cv::resize(picture, picture, size, 0, 0, cv::INTER_AREA);
  return picture(cv::Rect(0, 0, size.width / kSpectrumBlock * kSpectrumBlock,
                          size.height / kSpectrumBlock * kSpectrumBlock))
      .clone();
}

/// Frames [first, first + count) of a stored clip.
std::vector<cv::Mat> read_stored(const store::Snapshot& snapshot, store::ClipId clip, std::uint32_t first,
                                 std::uint32_t count, int longest) {
  const stored::ClipFrames frames(snapshot, clip);
  std::vector<cv::Mat> read(count);
  constexpr std::uint32_t kSlab = 16;
  for (std::uint32_t at = first; at < first + count;) {
    // By the slabs in which they are stored: each is decoded once.
    const std::uint32_t end = std::min((at / kSlab + 1) * kSlab, first + count);
    const std::vector<media::Frame> slab = frames.read(at, end - at);
    oneapi::tbb::parallel_for(std::size_t{0}, slab.size(),
                              [&](std::size_t i) { read[at - first + i] = reduced(slab[i], longest); });
    at = end;
  }
  return read;
}

cv::Mat thumbnail(const cv::Mat& average) {
  cv::Mat small, values;
  cv::resize(average, small, {48, 32}, 0, 0, cv::INTER_AREA);
  small.convertTo(values, CV_32F);
  return values - cv::mean(values)[0];
}

/// Clips of the same class and shape whose average images agree: two takes of one place.
/// own   luma's average, of any range.
std::vector<std::string> clips_of_scene(const store::Snapshot& snapshot, const std::string& name,
                                        const std::string& class_name, const cv::Mat& own, double aspect) {
  std::vector<std::string> names;
  const cv::Mat ours = thumbnail(own);
  for (const store::ClipId clip : snapshot.clips()) {
    const store::ClipRecord& record = snapshot.clip(clip);
    if (record.name != name) {
      const double theirs = static_cast<double>(record.width) / record.height;
      if (record.class_name != class_name || std::abs(theirs / aspect - 1) > 0.002) continue;
      const cv::Mat other = thumbnail(stored::average_image(snapshot, clip));
      if (ours.dot(other) <= kSameScene * cv::norm(ours) * cv::norm(other)) continue;
    }
    names.push_back(record.name);
  }
  return names;
}

/// Which frames of `total` are needed; as indices of the whole clip, `first` of them the first.
struct Range {
  int first = 0, count = 0;
};
Range around_middle(int total, int wanted, Footage& footage) {
  const int count = std::min(wanted, total);
  footage.half = std::min(wanted, total / 2);
  const int middle = total / 2, begin = std::min(middle - count / 2, total - count);
  const int first = std::min(middle - footage.half, begin),
            end = std::max(middle + footage.half, begin + count);
  footage.middle = middle - first;
  footage.truth_begin = begin - first;
  footage.truth_size = count;
  return {first, end - first};
}

}  // namespace

Footage stored_footage(const store::Snapshot& snapshot, store::ClipId clip, const CaseOptions& options) {
  const store::ClipRecord& record = snapshot.clip(clip);
  Footage footage;
  footage.name = record.name;
  footage.class_name = record.class_name;
  footage.fps = static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den);
  footage.same_scene =
      clips_of_scene(snapshot, record.name, record.class_name, stored::average_image(snapshot, clip),
                     static_cast<double>(record.width) / record.height);
  const Range range = around_middle(static_cast<int>(record.frame_count), options.frames, footage);
  footage.frames = read_stored(snapshot, clip, range.first, range.count, options.width);
  return footage;
}

Footage held_out_footage(const store::Snapshot& snapshot, const ingest::Source& source,
                         const CaseOptions& options) {
  Footage footage;
  footage.name = source.name;
  footage.class_name = source.class_name;
  footage.frames = read_video(source.path, options.width, &footage.fps);
  cv::Mat sum = cv::Mat::zeros(footage.frames[0].size(), CV_32F);
  for (const cv::Mat& luma : luma_of(footage.frames)) cv::accumulate(luma, sum);
  footage.same_scene =
      clips_of_scene(snapshot, source.name, source.class_name, sum, static_cast<double>(sum.cols) / sum.rows);
  const Range range = around_middle(static_cast<int>(footage.frames.size()), options.frames, footage);
  footage.frames =
      std::vector(footage.frames.begin() + range.first, footage.frames.begin() + range.first + range.count);
  return footage;
}

std::vector<cv::Mat> read_video(const std::filesystem::path& path, int longest, double* fps) {
  media::VideoReader reader(path, 0, {.upright = true});
  if (fps) *fps = static_cast<double>(reader.info().fps_num) / static_cast<double>(reader.info().fps_den);
  std::vector<cv::Mat> frames;
  while (const auto frame = reader.next()) frames.push_back(reduced(*frame, longest));
  return frames;
}

std::vector<cv::Mat> luma_of(const std::vector<cv::Mat>& frames) {
  std::vector<cv::Mat> luma(frames.size());
  oneapi::tbb::parallel_for(std::size_t{0}, frames.size(),
                            [&](std::size_t i) { cv::cvtColor(frames[i], luma[i], cv::COLOR_BGR2GRAY); });
  return luma;
}

}  // namespace freshet::bench
