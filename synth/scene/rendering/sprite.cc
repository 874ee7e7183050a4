#include "synth/scene/rendering/sprite.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "synth/sampling/pull_push.h"
#include "synth/scene/rendering/cyclic_texture.h"

namespace freshet::synth::scene {
namespace {

constexpr float kStands = 0.02f;  // alpha below which a colour is noise

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

}  // namespace

cv::Rect box_of(const cv::Mat& alpha) {
  const cv::Mat some = alpha > 0;
  return cv::boundingRect(some);
}

cv::Rect around(const cv::Rect& box, cv::Size picture) {
  const int more = std::max(8, std::max(box.width, box.height) / 4);
  return cv::Rect(box.x - more, box.y - more, box.width + 2 * more, box.height + 2 * more) &
         cv::Rect({0, 0}, picture);
}

Sprite make_sprite(const cv::Mat& colour, const cv::Mat& alpha, Outline outline, int period) {
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
    const cv::Mat whole = outline == Outline::kCyclic
                              ? cyclic_texture(colour(inside), alpha(inside) > kStands, period)
                              : sampling::pull_push(colour(inside), alpha(inside));
    const cv::Mat opaque(whole.size(), CV_32F, cv::Scalar(1));
    cv::copyMakeBorder(premultiplied(whole, opaque), sprite.texture, kBorder, kBorder, kBorder, kBorder,
                       cv::BORDER_REPLICATE);
    if (outline == Outline::kCyclic) {
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
