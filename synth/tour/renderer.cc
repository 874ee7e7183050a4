#include "synth/tour/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

namespace freshet::synth::tour {
namespace {

constexpr double kFadeFrom = 0.2,
                 kFadeTo = 0.06;  // of its own depth: nearer to the camera a thing thins out, and is gone

constexpr std::size_t kMostViews = 9;  // two of each of four sides, and the back

/// Columns of a row in which all limits hold: from first to last, which is less where there are none.
struct Span {
  int first, last;
};
Span span_of(std::span<const cv::Vec3d> limits, int y, int width) {
  double low = 0, high = width - 1;
  for (const cv::Vec3d& limit : limits) {
    const double slope = limit[0], rest = limit[1] * y + limit[2];
    if (slope > 0)
      low = std::max(low, -rest / slope);
    else if (slope < 0)
      high = std::min(high, -rest / slope);
    else if (rest < 0)
      return {0, -1};
  }
  if (!(low <= high)) return {0, -1};
  return {static_cast<int>(std::ceil(low)), static_cast<int>(std::floor(high))};
}

struct SeenBoard {
  const Scenery::Board* board;
  Room::View view;
  float opacity;
};

/// Where the box of a thing is seen, and a sample around it, for its edge is soft.
std::vector<cv::Vec3d> limits_of(const cv::Rect& box, const cv::Matx33d& h) {
  const cv::Vec3d x(h(0, 0), h(0, 1), h(0, 2)), y(h(1, 0), h(1, 1), h(1, 2)), w(h(2, 0), h(2, 1), h(2, 2));
  return {x - (box.x - 1.0) * w, static_cast<double>(box.br().x) * w - x, y - (box.y - 1.0) * w,
          static_cast<double>(box.br().y) * w - y};
}

cv::Matx33d shifted(const cv::Matx33d& h, cv::Point by) {
  return cv::Matx33d(1, 0, -by.x, 0, 1, -by.y, 0, 0, 1) * h;
}

/// Where sides meet rounding can leave a pixel to none of them: its neighbour's goes on.
void close_gaps(std::span<Span> spans, int width, cv::Vec4f* row, float* depths) {
  std::ranges::sort(spans, {}, &Span::first);
  int next = 0;
  const auto close = [&](int until, int from) {
    for (; next < until; ++next) {
      row[next] = row[from];
      if (depths != nullptr) depths[next] = depths[from];
    }
  };
  for (const Span& span : spans) {
    if (span.first > next) close(span.first, next > 0 ? next - 1 : span.first);
    next = std::max(next, span.last + 1);
  }
  if (next > 0) close(width, next - 1);
}

void put(const cv::Vec4f* row, int width, cv::Mat& out, int y) {
  if (out.depth() == CV_8U) {
    auto* to = out.ptr<cv::Vec3b>(y);
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        to[x][c] = static_cast<std::uint8_t>(std::clamp(row[x][c], 0.0f, 1.0f) * 255 + 0.5f);
    return;
  }
  auto* to = out.ptr<cv::Vec4f>(y);
  for (int x = 0; x < width; ++x)
    to[x] = {std::max(0.0f, row[x][0]), std::max(0.0f, row[x][1]), std::max(0.0f, row[x][2]), 1};
}

}  // namespace

Renderer::Renderer(const Room& room, const Scenery& scenery, cv::Size frame)
    : room_(room), scenery_(scenery), frame_(frame) {}

void Renderer::render(const Pinhole& camera, cv::Mat& out, cv::Mat* depth) const {
  out.create(frame_, out.type());
  if (depth != nullptr) depth->create(frame_, CV_32F);
  const std::vector<Room::View> views = room_.seen_by(camera);
  std::vector<SeenBoard> boards;
  for (const Scenery::Board& board : scenery_.furthest_first()) {
    const double ahead = (board.depth - camera.centre[2]) / board.depth;
    if (ahead <= kFadeTo) continue;
    SeenBoard seen{&board, room_.board_seen_by(camera, board.depth),
                   static_cast<float>(std::min(1.0, (ahead - kFadeTo) / (kFadeFrom - kFadeTo)))};
    seen.view.limits = limits_of(board.box, seen.view.picture_from_frame);
    seen.view.picture_from_frame = shifted(seen.view.picture_from_frame, board.box.tl());
    boards.push_back(std::move(seen));
  }
  oneapi::tbb::enumerable_thread_specific<std::vector<cv::Vec4f>> scratch(
      [&] { return std::vector<cv::Vec4f>(2 * static_cast<std::size_t>(frame_.width)); });
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<int>(0, frame_.height, 8), [&](const auto& rows) {
    cv::Vec4f* const row = scratch.local().data();
    cv::Vec4f* const over = row + frame_.width;
    for (int y = rows.begin(); y < rows.end(); ++y) {
      auto* depths = depth == nullptr ? nullptr : depth->ptr<float>(y);
      std::array<Span, kMostViews> spans;
      std::size_t count = 0;
      for (const Room::View& view : views) {
        const auto [first, last] = span_of(view.limits, y, frame_.width);
        if (last < first) continue;
        spans[count++] = {first, last};
        scenery_.ground().read(view.picture_from_frame, first, y, last - first + 1, row + first);
        if (depths == nullptr) continue;
        const cv::Vec3d& q = view.inverse_depth;
        for (int x = first; x <= last; ++x) {
          const double inverse = q[0] * x + q[1] * y + q[2];
          depths[x] = static_cast<float>(inverse > 1 / kFar ? 1 / inverse : kFar);
        }
      }
      close_gaps({spans.data(), count}, frame_.width, row, depths);
      for (const SeenBoard& seen : boards) {
        const auto [first, last] = span_of(seen.view.limits, y, frame_.width);
        if (last < first) continue;
        seen.board->texture.read(seen.view.picture_from_frame, first, y, last - first + 1, over);
        for (int x = first; x <= last; ++x) {
          const cv::Vec4f& front = over[x - first];
          const float alpha = std::clamp(front[3], 0.0f, 1.0f) * seen.opacity;
          for (int c = 0; c < 3; ++c)
            row[x][c] = std::max(0.0f, front[c]) * seen.opacity + (1 - alpha) * row[x][c];
          if (depths != nullptr && alpha >= 0.5f) {
            const cv::Vec3d& q = seen.view.inverse_depth;
            depths[x] = static_cast<float>(1 / (q[0] * x + q[1] * y + q[2]));
          }
        }
      }
      put(row, frame_.width, out, y);
    }
  });
}

}  // namespace freshet::synth::tour
