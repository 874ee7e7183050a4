#include "synth/transfer/exemplar.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::synth::transfer {
namespace {

void check_frame(const ExemplarFrame& frame, const TransferOptions& options) {
  const int type = frame.bgra.type();
  if (frame.bgra.empty() || (type != CV_8UC4 && type != CV_16UC4 && type != CV_32FC4)) {
    throw Error(ErrorKind::kInput, "exemplar", "a frame is empty or not of 4 channels of 8, 16 or 32 bits");
  }
  const int min_side = 2 * options.patch;
  if (frame.bgra.cols < min_side || frame.bgra.rows < min_side) {
    throw Error(ErrorKind::kInput, "exemplar",
                fmt::format("{} x {} px; at least {} x {} are needed for patches of {} px", frame.bgra.cols,
                            frame.bgra.rows, min_side, min_side, options.patch),
                "Give a larger picture");
  }
  if (!frame.back.empty() && (frame.back.type() != CV_32FC2 || frame.back.size() != frame.bgra.size() ||
                              !cv::checkRange(frame.back)))
    throw Error(ErrorKind::kInput, "exemplar", "its flow is of another size than its frame, or not finite");
}

// Its vectors turn with it.
VectorGrid quarter_turned_flow(const VectorGrid& flow, int turns) {
  VectorGrid out = quarter_turned(flow, turns);
  for (Vec2& by : out.values)
    for (int turn = 0; turn < turns; ++turn) by = {by.y, -by.x};
  return out;
}

// Each pixel as it was where it came from.
PixelGrid fetched(const PixelGrid& picture, const VectorGrid& back) {
  PixelGrid out(picture.width, picture.height);
  for_rows(out.height, [&](int y) {
    for (int x = 0; x < out.width; ++x) {
      const Vec2 by = back(x, y);
      const Tap tx = tap(static_cast<float>(x) + by.x, out.width),
                ty = tap(static_cast<float>(y) + by.y, out.height);
      const Pixel* a = picture.row(ty.index) + tx.index;
      const Pixel* b = picture.row(ty.index + ty.step) + tx.index;
      for (int c = 0; c < 4; ++c) {
        const float top = a[0].c[c] + (a[tx.step].c[c] - a[0].c[c]) * tx.weight;
        const float bottom = b[0].c[c] + (b[tx.step].c[c] - b[0].c[c]) * tx.weight;
        out(x, y).c[c] = top + (bottom - top) * ty.weight;
      }
    }
  });
  return out;
}

struct Turned {
  PixelGrid now, previous;
  Grid blurred_alpha;
  Guides guides;
};

template <typename T>
void paste(const GridOf<T>& from, int top, GridOf<T>& into) {
  for (int y = 0; y < from.height; ++y) std::copy_n(from.row(y), from.width, into.row(top + y));
}

ExemplarLevel make_level(const std::vector<Turned>& turned, const TransferOptions& options) {
  ExemplarLevel level;
  const int sides[] = {turned[0].now.width, turned[0].now.height};
  level.block = turned.size() > 1 ? std::max(sides[0], sides[1]) : 0;
  const int turns = static_cast<int>(turned.size());
  const int width = turns > 1 ? level.block : sides[0], height = turns > 1 ? level.block * turns : sides[1];
  level.now = PixelGrid(width, height);
  level.features = Features(width, height);
  level.segments.of = GridOf<Segment>(width, height, Segment::kNone);
  PixelGrid previous(width, height);
  Grid blurred_alpha(width, height);
  Guides guides;
  if (guided(options)) guides = {Grid(width, height), Grid(width, height)};
  for (int turn = 0; turn < turns; ++turn) {
    const Turned& one = turned[static_cast<std::size_t>(turn)];
    level.sizes.emplace_back(one.now.width, one.now.height);
    paste(one.now, turn * level.block, level.now);
    paste(one.previous, turn * level.block, previous);
    paste(one.blurred_alpha, turn * level.block, blurred_alpha);
    if (guided(options)) {
      paste(one.guides.curvature, turn * level.block, guides.curvature);
      paste(one.guides.divergence, turn * level.block, guides.divergence);
    }
    Segments own;
    segment(one.blurred_alpha, options.lower, options.upper, options.patch / 2, own);
    paste(own.of, turn * level.block, level.segments.of);
  }
  list_segments(level.segments);
  put_now(level.now, level.features);
  put_previous(previous, level.features);
  put_blurred_alpha(blurred_alpha, options.eta, level.features);
  if (guided(options)) put_guides(guides, options, level.features);
  return level;
}

}  // namespace

ExemplarLevel::Place ExemplarLevel::split(int place) const {
  const int y = place / now.width, x = place - y * now.width;
  const int turn = block > 0 ? y / block : 0;
  return {x, y - turn * block, turn};
}

PreparedExemplar prepare(const ExemplarFrame& frame, const ExemplarFrame& previous, int levels,
                         const TransferOptions& options) {
  check_frame(frame, options);
  check_frame(previous, options);
  if (frame.bgra.size() != previous.bgra.size()) {
    throw Error(ErrorKind::kInput, "exemplar", "its frames differ in size");
  }
  PreparedExemplar prepared;
  prepared.size = frame.bgra.size();
  const PixelGrid now = premultiplied(frame.bgra);
  PixelGrid before = previous.bgra.data == frame.bgra.data ? now : premultiplied(previous.bgra);
  if (options.stabilised && !frame.back.empty()) {
    const VectorGrid back = vectors_of(frame.back);
    before = fetched(before, back);
    for (int turn = 0; turn < options.quarter_turns; ++turn)
      prepared.back.push_back(quarter_turned_flow(back, turn));
  }
  const Grid alpha = alpha_of(now);
  prepared.opaque = *std::min_element(alpha.values.begin(), alpha.values.end()) >= 254.5f / 255;
  const Grid blurred_alpha = blurred(alpha, options.radius);
  Guides guides;
  if (guided(options)) {
    VectorGrid flow = frame.back.empty() ? VectorGrid(now.width, now.height) : vectors_of(frame.back);
    for (Vec2& by : flow.values) by = {-by.x, -by.y};
    guides = guides_of(alpha, flow, options);
  }
  std::vector<Turned> turned;
  for (int turn = 0; turn < options.quarter_turns; ++turn)
    turned.push_back({quarter_turned(now, turn),
                      quarter_turned(before, turn),
                      quarter_turned(blurred_alpha, turn),
                      {quarter_turned(guides.curvature, turn), quarter_turned(guides.divergence, turn)}});
  for (int k = 0; k < levels; ++k) {
    if (k > 0)
      for (Turned& one : turned)
        one = {halved(one.now),
               halved(one.previous),
               halved(one.blurred_alpha),
               {halved(one.guides.curvature), halved(one.guides.divergence)}};
    if (std::min(turned[0].now.width, turned[0].now.height) < options.patch) break;
    ExemplarLevel level = make_level(turned, options);
    if (level.segments[Segment::kBoundary].empty() && level.segments[Segment::kInterior].empty()) break;
    prepared.levels.push_back(std::move(level));
  }
  if (prepared.levels.empty()) {
    throw Error(ErrorKind::kInput, "exemplar", "its alpha shows no fluid",
                "Give a picture whose alpha is above the lower threshold somewhere");
  }
  return prepared;
}

void follow(const PreparedExemplar& exemplar, GridOf<std::int32_t>& places) {
  if (exemplar.back.empty()) return;
  const ExemplarLevel& finest = exemplar.levels.front();
  for (std::int32_t& place : places.values) {
    if (place < 0 || place >= static_cast<std::int32_t>(finest.now.values.size())) continue;
    const ExemplarLevel::Place at = finest.split(place);
    const VectorGrid& back = exemplar.back[static_cast<std::size_t>(at.turn)];
    const Vec2 by = back(std::min(at.x, back.width - 1), std::min(at.y, back.height - 1));
    const float x = static_cast<float>(at.x) - by.x + 0.5f, y = static_cast<float>(at.y) - by.y + 0.5f;
    const bool inside =
        x >= 0 && y >= 0 && x < static_cast<float>(back.width) && y < static_cast<float>(back.height);
    place = inside ? finest.join({static_cast<int>(x), static_cast<int>(y), at.turn}) : -1;
  }
}

}  // namespace freshet::synth::transfer
