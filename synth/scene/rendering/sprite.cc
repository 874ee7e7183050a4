#include "synth/scene/rendering/sprite.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "synth/animate/sampling/pull_push.h"

namespace freshet::synth::scene {
namespace {

/// The smallest box of what is above 0; empty when nothing is.
cv::Rect box_of(const cv::Mat& alpha) {
  const cv::Mat some = alpha > 0;
  return cv::boundingRect(some);
}

std::vector<cv::Range> spans_of(const cv::Mat& alpha) {
  std::vector<cv::Range> spans;
  for (int y = 0; y < alpha.rows; ++y) {
    const auto* row = alpha.ptr<float>(y);
    int first = 0, last = alpha.cols;
    while (first < last && !(row[first] > 0)) ++first;
    while (last > first && !(row[last - 1] > 0)) --last;
    spans.emplace_back(first, last);
  }
  return spans;
}

cv::Mat premultiplied(const cv::Mat& colour, const cv::Mat& alpha) {
  cv::Mat out(colour.size(), CV_32FC4);
  for (int y = 0; y < out.rows; ++y) {
    const auto* c = colour.ptr<cv::Vec3f>(y);
    const auto* a = alpha.ptr<float>(y);
    auto* to = out.ptr<cv::Vec4f>(y);
    for (int x = 0; x < out.cols; ++x) to[x] = {c[x][0] * a[x], c[x][1] * a[x], c[x][2] * a[x], a[x]};
  }
  return out;
}

/// Wider by half, so that it comes round: the new part goes from the right end, mirrored, over to the left
/// end, mirrored.
cv::Mat come_round(const cv::Mat& colour) {
  const int width = colour.cols, more = std::max(1, width / 2);
  cv::Mat wide(colour.rows, width + more, colour.type());
  colour.copyTo(wide.colRange(0, width));
  for (int y = 0; y < colour.rows; ++y) {
    const auto* from = colour.ptr<cv::Vec3f>(y);
    auto* to = wide.ptr<cv::Vec3f>(y);
    for (int i = 0; i < more; ++i) {
      const float part = (static_cast<float>(i) + 0.5f) / static_cast<float>(more);
      const float late = part * part * (3 - 2 * part);
      to[width + i] = from[width - 1 - i] * (1 - late) + from[more - 1 - i] * late;
    }
  }
  return wide;
}

}  // namespace

Sprite make_sprite(const cv::Mat& colour, const cv::Mat& alpha, Outline outline) {
  Sprite sprite;
  sprite.outline = outline;
  const cv::Rect inside = box_of(alpha), picture({0, 0}, alpha.size());
  if (inside.empty()) return sprite;
  constexpr int kBorder = Sprite::kBorder;
  if (outline == Outline::kMoves) {
    constexpr int kMore = Sprite::kTransparent;
    sprite.box =
        cv::Rect(inside.x - kMore, inside.y - kMore, inside.width + 2 * kMore, inside.height + 2 * kMore) &
        picture;
    cv::copyMakeBorder(premultiplied(colour(sprite.box), alpha(sprite.box)), sprite.texture, kBorder, kBorder,
                       kBorder, kBorder, cv::BORDER_REPLICATE);
  } else {
    sprite.box = inside;
    alpha(inside).copyTo(sprite.held);
    cv::Mat whole = animate::pull_push(colour(inside), alpha(inside));
    if (outline == Outline::kCyclic) whole = come_round(whole);
    const cv::Mat opaque(whole.size(), CV_32F, cv::Scalar(1));
    cv::copyMakeBorder(premultiplied(whole, opaque), sprite.texture, kBorder, kBorder, kBorder, kBorder,
                       cv::BORDER_REPLICATE);
    if (outline == Outline::kCyclic) {
      const int period = sprite.period();
      sprite.texture.colRange(period, period + kBorder).copyTo(sprite.texture.colRange(0, kBorder));
      sprite.texture.colRange(kBorder, 2 * kBorder)
          .copyTo(sprite.texture.colRange(period + kBorder, period + 2 * kBorder));
    }
  }
  sprite.spans = spans_of(alpha(sprite.box));
  return sprite;
}

void set_frame(Sprite& sprite, const cv::Mat& frame, cv::Point at, cv::Size picture) {
  constexpr int kBorder = Sprite::kBorder;
  sprite.outline = Outline::kMoves;
  sprite.box = cv::Rect(at, frame.size()) & cv::Rect({0, 0}, picture);
  if (sprite.box.empty()) return;
  sprite.texture.create(sprite.box.height + 2 * kBorder, sprite.box.width + 2 * kBorder, CV_32FC4);
  frame(sprite.box - at).copyTo(sprite.texture(cv::Rect({kBorder, kBorder}, sprite.box.size())));
  sprite.spans.assign(static_cast<std::size_t>(sprite.box.height), cv::Range(0, sprite.box.width));
}

}  // namespace freshet::synth::scene
