#include "synth/scene/frames/footage_reader.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/bgra.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"
#include "synth/transfer/files/ground.h"
#include "vision/flow.h"

namespace freshet::synth::scene {
namespace {

constexpr int kTallest = 65536;  // px

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

/// Makes the ground quite black or white. bgra   CV_16UC4.
void level_ground(cv::Mat& bgra, FilmedGround ground, const cv::Vec3f& depth) {
  constexpr float kMax = 65535;
  const bool black = ground == FilmedGround::kBlack;
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

/// White's value, of BGRA of 8 or 16 bits.
double white_of(const cv::Mat& bgra) { return bgra.depth() == CV_16U ? 65535 : 255; }

/// Whether what is seen is dark, and has an alpha: over white its outline shows.
bool is_dark_paint(const cv::Mat& bgra) {
  cv::Mat alpha, grey;
  cv::extractChannel(bgra, alpha, 3);
  const cv::Scalar seen = cv::mean(alpha);
  if (seen[0] == 0 || seen[0] == white_of(bgra)) return false;
  cv::cvtColor(bgra, grey, cv::COLOR_BGRA2GRAY);
  cv::multiply(grey, alpha, grey, 1 / white_of(bgra));
  constexpr double kDark = 0.25;
  return cv::mean(grey)[0] < kDark * seen[0];
}

/// What is seen over black or white, CV_8U, at least kLeast px a side: as optical flow takes it.
cv::Mat luma_of(const cv::Mat& bgra, bool over_white) {
  constexpr int kLeast = 16;
  const double white = white_of(bgra);
  const float unit = static_cast<float>(255 / white), to_alpha = static_cast<float>(1 / white);
  cv::Mat wide, luma(bgra.size(), CV_8U);
  bgra.convertTo(wide, CV_32F);
  for (int y = 0; y < luma.rows; ++y) {
    const auto* from = wide.ptr<cv::Vec4f>(y);
    auto* to = luma.ptr<std::uint8_t>(y);
    for (int x = 0; x < luma.cols; ++x) {
      const float grey = unit * (0.114f * from[x][0] + 0.587f * from[x][1] + 0.299f * from[x][2]);
      const float alpha = to_alpha * from[x][3];
      to[x] = cv::saturate_cast<std::uint8_t>(grey * alpha + (over_white ? 255 * (1 - alpha) : 0.0f));
    }
  }
  cv::copyMakeBorder(luma, luma, 0, std::max(0, kLeast - luma.rows), 0, std::max(0, kLeast - luma.cols),
                     cv::BORDER_REPLICATE);
  return luma;
}

}  // namespace

cv::Vec3f ground_depth(const cv::Mat& frame, FilmedGround ground) {
  constexpr int kNear = 26;         // of 255 levels
  constexpr double kFewest = 0.02;  // of all pixels: a ground is seen
  constexpr int kNoise = 2;         // levels
  std::array<std::array<int, kNear>, 3> counts{};
  for (int y = 0; y < frame.rows; ++y) {
    const auto* row = frame.ptr<cv::Vec4f>(y);
    for (int x = 0; x < frame.cols; ++x)
      for (int c = 0; c < 3; ++c) {
        const int level = cvRound(255 * row[x][c]),
                  away = ground == FilmedGround::kBlack ? level : 255 - level;
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

FootageReader::FootageReader(const std::filesystem::path& file, FootageForm form)
    : file_(file), form_(std::move(form)) {
  if (media::is_pattern(file))
    pictures_ = media::list_pattern(file).files;
  else if (std::filesystem::is_directory(file))
    pictures_ = media::list_folder(file).files;
  else
    reader_.emplace(file), ahead_ = reader_->next();
}

bool FootageReader::at_end() { return reader_ ? !ahead_ : picture_ == pictures_.size(); }

const cv::Mat& FootageReader::next() {
  const cv::Size before = frame_.size();
  if (reader_) {
    if (!ahead_) {
      reader_.emplace(file_);
      ahead_ = reader_->next();
    }
    if (!ahead_)
      throw Error(ErrorKind::kInput, file_.string(), "no frame of it can be decoded", "Check the file");
    read_ = media::to_bgra(*ahead_);
    ahead_ = reader_->next();
    return taken();
  }
  if (picture_ == pictures_.size()) picture_ = 0;
  read_ = media::read_deep_picture(pictures_[picture_]).values;
  const cv::Mat& frame = taken();
  if (!before.empty() && before != frame_.size())
    throw Error(ErrorKind::kInput, pictures_[picture_].string(),
                fmt::format("it has {} x {} px, the frames before it {} x {}", frame_.cols, frame_.rows,
                            before.width, before.height),
                "Give frames of one size");
  ++picture_;
  return frame;
}

cv::Mat FootageReader::following() const {
  return reader_ ? media::to_bgra(*ahead_) : media::read_deep_picture(pictures_[picture_]).values;
}

cv::Mat FootageReader::motion(bool comes_round) {
  if (read_.empty() || (at_end() && !comes_round)) return {};
  const cv::Mat after = at_end() ? FootageReader(file_).following() : following();
  if (after.size() != read_.size()) return {};  // next() says so
  const bool over_white = is_dark_paint(read_);
  cv::Mat flow = vision::optical_flow(luma_of(read_, over_white), luma_of(after, over_white));
  flow = flow(cv::Rect({0, 0}, read_.size()));
  const cv::Size size = sized_.empty() ? read_.size() : sized_.size();
  if (size == read_.size()) return flow;
  cv::Mat sized;
  cv::resize(flow, sized, size, 0, 0, size.width < read_.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
  cv::multiply(sized, cv::Scalar(1.0 * size.width / read_.cols, 1.0 * size.height / read_.rows), sized);
  return sized;
}

const cv::Mat& FootageReader::taken() {
  cv::Mat bgra = read_;
  if (form_.ground != FilmedGround::kNone) {
    bgra = cv::Mat();
    read_.convertTo(bgra, CV_16U, 65535 / white_of(read_));
    if (form_.ground_depth != cv::Vec3f()) level_ground(bgra, form_.ground, form_.ground_depth);
    transfer::take_off_ground(bgra, static_cast<transfer::Ground>(form_.ground));
  }
  premultiply(bgra, white_of(bgra), frame_);
  if (!form_.matte.empty()) limit(form_.matte, frame_);
  const int width = form_.width;
  if (width == 0 || width == frame_.cols) return frame_;
  const cv::Size size(width, std::max(1, cvRound(1.0 * frame_.rows * width / frame_.cols)));
  if (size.height > kTallest)
    throw Error(ErrorKind::kInput, file_.string(),
                fmt::format("{} px wide it would be {} px high", width, size.height),
                "Ask for a smaller width");
  // Of colours times alpha: what is transparent gives no colour to an edge.
  cv::resize(frame_, sized_, size, 0, 0, width < frame_.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
  return sized_;
}

}  // namespace freshet::synth::scene
