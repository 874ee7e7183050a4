#include "synth/scene/frames/footage_reader.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/bgra.h"
#include "media/picture/picture.h"
#include "synth/transfer/files/exemplar_motion.h"
#include "synth/transfer/files/ground.h"
#include "vision/flow.h"

namespace freshet::synth::scene {
namespace {

constexpr int kTallest = 65536;  // px

/// White's value, of BGRA of 8 or 16 bits.
double white_of(const cv::Mat& bgra) { return bgra.depth() == CV_16U ? 65535 : 255; }

/// Straight alpha of any depth to colours times alpha.
void premultiply(const cv::Mat& bgra, double white, cv::Mat& out) {
  bgra.convertTo(out, CV_32F, 1 / white);
  for (int y = 0; y < out.rows; ++y) {
    auto* row = out.ptr<cv::Vec4f>(y);
    for (int x = 0; x < out.cols; ++x)
      for (int c = 0; c < 3; ++c) row[x][c] *= row[x][3];
  }
}

/// Colours times alpha, by a matte that lies over them.
void limit(const cv::Mat& matte, cv::Mat& premultiplied) {
  for (int y = 0; y < premultiplied.rows; ++y) {
    const auto* by = matte.ptr<std::uint8_t>(y);
    auto* row = premultiplied.ptr<cv::Vec4f>(y);
    for (int x = 0; x < premultiplied.cols; ++x) row[x] *= static_cast<float>(by[x]) / 255;
  }
}

/// Its alpha, or its grey, as read_matte has it: nearly black is black.
void matte_of(const cv::Mat& bgra, bool is_alpha, cv::Size size, cv::Mat& matte) {
  cv::Mat alpha;
  if (is_alpha)
    cv::extractChannel(bgra, alpha, 3);
  else
    cv::cvtColor(bgra, alpha, cv::COLOR_BGRA2GRAY);
  alpha.convertTo(matte, CV_8U, 255 / white_of(bgra));
  media::scale_matte(matte, size);
  media::settle_dark(matte);
}

/// Makes the ground quite black or white. bgra   CV_16UC4.
void level_ground(cv::Mat& bgra, media::Ground ground, const cv::Vec3f& depth) {
  constexpr float kMax = 65535;
  const bool black = ground == media::Ground::kBlack;
  for (int y = 0; y < bgra.rows; ++y) {
    auto* row = bgra.ptr<cv::Vec4w>(y);
    for (int x = 0; x < bgra.cols; ++x)
      for (int c = 0; c < 3; ++c) {
        const float away = black ? row[x][c] : kMax - row[x][c];
        const float over = std::max(0.0f, (away - kMax * depth[c]) / (1 - depth[c]));
        row[x][c] = cv::saturate_cast<std::uint16_t>(black ? over : kMax - over);
      }
  }
}

}  // namespace

cv::Vec3f ground_depth(const cv::Mat& frame, media::Ground ground) {
  constexpr int kNear = 26;         // of 255 levels
  constexpr double kFewest = 0.02;  // of all pixels: a ground is seen
  constexpr int kNoise = 2;         // levels
  std::array<std::array<int, kNear>, 3> counts{};
  for (int y = 0; y < frame.rows; ++y) {
    const auto* row = frame.ptr<cv::Vec4f>(y);
    for (int x = 0; x < frame.cols; ++x)
      for (int c = 0; c < 3; ++c) {
        const int level = cvRound(255 * row[x][c]),
                  away = ground == media::Ground::kBlack ? level : 255 - level;
        if (away >= 0 && away < kNear) ++counts[static_cast<std::size_t>(c)][static_cast<std::size_t>(away)];
      }
  }
  cv::Vec3f depth;
  for (int c = 0; c < 3; ++c) {
    const auto& of = counts[static_cast<std::size_t>(c)];
    const auto most = std::max_element(of.begin(), of.end());
    if (most != of.begin() && *most >= kFewest * static_cast<double>(frame.total()))
      depth[c] = static_cast<float>(most - of.begin() + kNoise) / 255;
  }
  return depth;
}

bool has_transparency(const std::filesystem::path& film, int most, const std::stop_token& stop) {
  FilmSource source(film);
  if (!source.may_have_alpha()) return false;
  for (int i = 0; i < most && (i == 0 || !source.at_end()); ++i) {
    if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, film.string(), "stopped");
    if (media::is_transparent(source.next())) return true;
  }
  return false;
}

void expect_shape(const std::filesystem::path& matte, cv::Size size, const std::filesystem::path& film,
                  cv::Size film_size) {
  if (!media::has_shape_of(size, film_size))
    throw Error(ErrorKind::kInput, matte.string(),
                fmt::format("the matte has {} x {} px, the film {} {} x {}: another shape", size.width,
                            size.height, film.string(), film_size.width, film_size.height),
                "Paint it over a frame of the film");
}

FootageReader::FootageReader(const std::filesystem::path& file, FootageForm form)
    : form_(std::move(form)), film_(file) {
  if (!form_.mattes.empty()) mattes_.emplace(form_.mattes);
}

void FootageReader::take_matte() {
  const cv::Mat frame = mattes_->next();
  expect_shape(mattes_->file(), frame.size(), film_.file(), read_.size());
  matte_of(frame, form_.mattes_are_alpha, read_.size(), form_.matte);
  ++place_;
  if (const bool ends = mattes_->at_end(); ends != film_.at_end()) {
    const std::string film = film_.file().string();
    throw Error(ErrorKind::kInput, mattes_->file().string(),
                ends ? fmt::format("it ends after {} frames, and the film {} goes on", place_, film)
                     : fmt::format("it goes on after the {} frames of the film {}", place_, film),
                "Give one matte for each frame of the film");
  }
  if (film_.at_end()) place_ = 0;
}

cv::Mat FootageReader::motion(bool comes_round) {
  if (read_.empty() || (at_end() && !comes_round)) return {};
  const cv::Mat after = at_end() ? FilmSource(film_.file()).following() : film_.following();
  if (after.size() != read_.size()) return {};  // next() says so
  const std::array<cv::Mat, 2> seen = transfer::seen_by_flow(read_, after);
  cv::Mat flow = vision::optical_flow(seen[0], seen[1]);
  flow = flow(cv::Rect({0, 0}, read_.size()));
  const cv::Size size = sized_.empty() ? read_.size() : sized_.size();
  if (size == read_.size()) return flow;
  cv::Mat sized;
  cv::resize(flow, sized, size, 0, 0, size.width < read_.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
  cv::multiply(sized, cv::Scalar(1.0 * size.width / read_.cols, 1.0 * size.height / read_.rows), sized);
  return sized;
}

const cv::Mat& FootageReader::next() {
  read_ = film_.next();
  if (mattes_) take_matte();
  cv::Mat bgra = read_;
  if (form_.ground != media::Ground::kNone) {
    bgra = cv::Mat();
    read_.convertTo(bgra, CV_16U, 65535 / white_of(read_));
    if (form_.ground_depth != cv::Vec3f()) level_ground(bgra, form_.ground, form_.ground_depth);
    transfer::take_off_ground(bgra, form_.ground);
  }
  premultiply(bgra, white_of(bgra), frame_);
  if (!form_.matte.empty()) limit(form_.matte, frame_);
  const int width = form_.width;
  if (width == 0 || width == frame_.cols) return frame_;
  const cv::Size size(width, std::max(1, cvRound(1.0 * frame_.rows * width / frame_.cols)));
  if (size.height > kTallest)
    throw Error(ErrorKind::kInput, film_.file().string(),
                fmt::format("{} px wide it would be {} px high", width, size.height),
                "Ask for a smaller width");
  // Of colours times alpha: what is transparent gives no colour to an edge.
  cv::resize(frame_, sized_, size, 0, 0, width < frame_.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
  return sized_;
}

}  // namespace freshet::synth::scene
