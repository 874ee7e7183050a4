#include "synth/transfer/exemplar.h"

#include <algorithm>
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
}

struct Turned {
  PixelGrid now, previous;
  Grid blurred_alpha;
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
  for (int turn = 0; turn < turns; ++turn) {
    const Turned& one = turned[static_cast<std::size_t>(turn)];
    level.sizes.emplace_back(one.now.width, one.now.height);
    paste(one.now, turn * level.block, level.now);
    paste(one.previous, turn * level.block, previous);
    paste(one.blurred_alpha, turn * level.block, blurred_alpha);
    Segments own;
    segment(one.blurred_alpha, options.lower, options.upper, options.patch / 2, own);
    paste(own.of, turn * level.block, level.segments.of);
  }
  list_segments(level.segments);
  put_now(level.now, level.features);
  put_previous(previous, level.features);
  put_blurred_alpha(blurred_alpha, options.eta, level.features);
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
  const PixelGrid before = previous.bgra.data == frame.bgra.data ? now : premultiplied(previous.bgra);
  const Grid alpha = alpha_of(now);
  prepared.opaque = *std::min_element(alpha.values.begin(), alpha.values.end()) >= 254.5f / 255;
  const Grid blurred_alpha = blurred(alpha, options.radius);
  std::vector<Turned> turned;
  for (int turn = 0; turn < options.quarter_turns; ++turn)
    turned.push_back(
        {quarter_turned(now, turn), quarter_turned(before, turn), quarter_turned(blurred_alpha, turn)});
  for (int k = 0; k < levels; ++k) {
    if (k > 0)
      for (Turned& one : turned) one = {halved(one.now), halved(one.previous), halved(one.blurred_alpha)};
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

}  // namespace freshet::synth::transfer
