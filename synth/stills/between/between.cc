#include "synth/stills/between/between.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include <opencv2/imgproc.hpp>

#include "platform/vectors.h"

namespace freshet::synth::stills {
namespace {

using Source = Moment::Source;

constexpr int kFieldStep = 2;  // px of the flow, between places at which a moment is decided
constexpr int kTurns = 4;      // of the iteration that finds what will have come to a place
// How far forth and back miss each other beside the way that they go, at which half is trusted.
constexpr float kMissPart = .3f;
constexpr float kLeastWay = .5f;     // px: nothing is less sure for standing still
constexpr double kTrustPart = .053;  // of the longer side: half the window over which trust is judged

// Of a field's place, px of the flow.
float place_of(int at) { return kFieldStep * static_cast<float>(at) + .5f * (kFieldStep - 1); }
cv::Size field_size(cv::Size flow) {
  return {(flow.width + kFieldStep - 1) / kFieldStep, (flow.height + kFieldStep - 1) / kFieldStep};
}

// Catmull-Rom's weights of four samples, for a place a part of the way from the second to the third.
inline void cubic_weights(float part, float* out) {
  const float p2 = part * part, p3 = p2 * part;
  out[0] = .5f * (-p3 + 2 * p2 - part);
  out[1] = .5f * (3 * p3 - 5 * p2 + 2);
  out[2] = .5f * (-3 * p3 + 4 * p2 + part);
  out[3] = .5f * (p3 - p2);
}

// A sample of a picture of three channels, the border going on.
template <class T>
[[gnu::always_inline]] inline void add_sample(const cv::Mat& picture, float x, float y, float weight,
                                              float* sum) {
  constexpr int kFour = 12;  // values of four pixels
  x = std::clamp(x, 0.0f, static_cast<float>(picture.cols - 1));
  y = std::clamp(y, 0.0f, static_cast<float>(picture.rows - 1));
  const int x0 = static_cast<int>(x) - 1, y0 = static_cast<int>(y) - 1;
  float wx[4], wy[4], column[kFour] = {};
  cubic_weights(x - static_cast<float>(x0 + 1), wx);
  cubic_weights(y - static_cast<float>(y0 + 1), wy);
  const bool inside = x0 >= 0 && x0 + 3 < picture.cols;
  for (int k = 0; k < 4; ++k) {
    const T* row = picture.ptr<T>(std::clamp(y0 + k, 0, picture.rows - 1));
    if (inside) {
      for (int i = 0; i < kFour; ++i) column[i] += wy[k] * static_cast<float>(row[3 * x0 + i]);
    } else {
      for (int i = 0; i < kFour; ++i)
        column[i] += wy[k] * static_cast<float>(row[3 * std::clamp(x0 + i / 3, 0, picture.cols - 1) + i % 3]);
    }
  }
  for (int c = 0; c < 3; ++c)
    sum[c] +=
        weight * (wx[0] * column[c] + wx[1] * column[3 + c] + wx[2] * column[6 + c] + wx[3] * column[9 + c]);
}

[[gnu::always_inline]] inline Source mixed(const Source& one, const Source& two, float part) {
  return {(1 - part) * one.a + part * two.a, (1 - part) * one.b + part * two.b,
          (1 - part) * one.trust + part * two.trust};
}

// Nearer than that to its own pixel in either still, px, a sample is that pixel.
bool stands(const Source& at) {
  constexpr float kNoWay = .004f;
  return std::abs(at.a[0]) + std::abs(at.a[1]) + std::abs(at.b[0]) + std::abs(at.b[1]) < kNoWay;
}

// How a row of a moment's field lies at a row of the box.
struct RowScale {
  float to_field, full_x, full_y;
  RowScale(const Moment& moment, const cv::Rect& box)
      : to_field(static_cast<float>(moment.flow.width) / static_cast<float>(box.width) / kFieldStep),
        full_x(static_cast<float>(box.width) / static_cast<float>(moment.flow.width)),
        full_y(static_cast<float>(box.height) / static_cast<float>(moment.flow.height)) {}
};

// Between which two of the field's samples, `last` the outermost, a pixel of the row lies.
struct Along {
  int first, second;
  float part;
  Along(const RowScale& scale, int x, int last) {
    const float u =
        std::clamp((static_cast<float>(x) + .5f) * scale.to_field - .5f, 0.0f, static_cast<float>(last));
    first = static_cast<int>(u);
    second = std::min(first + 1, last);
    part = u - static_cast<float>(first);
  }
};

// The stills' samples along the row, `line` being the field at its height, `lean` likewise or empty.
template <class T>
[[gnu::always_inline]] inline void mix_row(const Moment& moment, std::span<const Source> line,
                                           std::span<const float> lean, const cv::Mat& a, const cv::Mat& b,
                                           const cv::Rect& box, int y, float* out) {
  constexpr float kNothing = .02f;  // of trust: not worth its samples
  const float t = moment.phase;
  const T* row_a = a.ptr<T>(y) + 3 * box.x;
  const T* row_b = b.ptr<T>(y) + 3 * box.x;
  for (int i = 0; i < 3 * box.width; ++i)
    out[i] = (1 - t) * static_cast<float>(row_a[i]) + t * static_cast<float>(row_b[i]);
  if (line.empty()) return;
  const RowScale scale(moment, box);
  const auto last = static_cast<int>(line.size()) - 1;
  for (int x = 0; x < box.width; ++x) {
    const auto [u0, u1, part] = Along(scale, x, last);
    const Source at = mixed(line[u0], line[u1], part);
    float* value = out + 3 * x;
    float phase = t;
    if (!lean.empty() && (lean[u0] != 0 || lean[u1] != 0)) {
      phase += (1 - part) * lean[u0] + part * lean[u1];
      for (int c = 0; c < 3; ++c)
        value[c] =
            (1 - phase) * static_cast<float>(row_a[3 * x + c]) + phase * static_cast<float>(row_b[3 * x + c]);
    }
    if (at.trust < kNothing || stands(at)) continue;
    for (int c = 0; c < 3; ++c) value[c] *= 1 - at.trust;
    const auto px = static_cast<float>(box.x + x), py = static_cast<float>(y);
    add_sample<T>(a, px + at.a[0] * scale.full_x, py + at.a[1] * scale.full_y, at.trust * (1 - phase), value);
    add_sample<T>(b, px + at.b[0] * scale.full_x, py + at.b[1] * scale.full_y, at.trust * phase, value);
  }
}

// What goes before the row that was mixed.
template <class T>
void cover_row(const Moment& moment, std::span<const Source> front, const cv::Mat& a, const cv::Mat& b,
               const cv::Rect& box, int y, float* out) {
  const float t = moment.phase;
  const RowScale scale(moment, box);
  const auto last = static_cast<int>(front.size()) - 1;
  for (int x = 0; x < box.width; ++x) {
    const auto [u0, u1, part] = Along(scale, x, last);
    const Source at = mixed(front[u0], front[u1], part);
    if (at.trust <= 0) continue;
    float* value = out + 3 * x;
    for (int c = 0; c < 3; ++c) value[c] *= 1 - at.trust;
    const auto px = static_cast<float>(box.x + x), py = static_cast<float>(y);
    add_sample<T>(a, px + at.a[0] * scale.full_x, py + at.a[1] * scale.full_y, at.trust * (1 - t), value);
    add_sample<T>(b, px + at.b[0] * scale.full_x, py + at.b[1] * scale.full_y, at.trust * t, value);
  }
}

FRESHET_WIDE void mix_row_of_8(const Moment& moment, std::span<const Source> line,
                               std::span<const float> lean, const cv::Mat& a, const cv::Mat& b,
                               const cv::Rect& box, int y, float* out) {
  mix_row<std::uint8_t>(moment, line, lean, a, b, box, y, out);
}

FRESHET_WIDE void mix_row_of_16(const Moment& moment, std::span<const Source> line,
                                std::span<const float> lean, const cv::Mat& a, const cv::Mat& b,
                                const cv::Rect& box, int y, float* out) {
  mix_row<std::uint16_t>(moment, line, lean, a, b, box, y, out);
}

float plane_at(const cv::Mat& plane, float x, float y) {
  const int px = std::clamp(cvRound(x), 0, plane.cols - 1), py = std::clamp(cvRound(y), 0, plane.rows - 1);
  return plane.at<float>(py, px);
}

// The window over which trust is judged, in places of the field.
int trust_window(cv::Size field) {
  return 2 * static_cast<int>(std::lround(kTrustPart * std::max(field.width, field.height))) + 1;
}

cv::Mat trust_of(const FlowPair& flow) {
  cv::Mat trust(field_size(flow.forth.size()), CV_32F), way(trust.size(), CV_32F);
  const auto add = [](const cv::Mat& one, const cv::Mat& other, float x, float y, float& gone, float& miss) {
    const cv::Vec2f move = flow_at(one, x, y), missed = flow_at(other, x + move[0], y + move[1]) + move;
    gone += .5f * std::hypot(move[0], move[1]);
    miss += .5f * std::hypot(missed[0], missed[1]);
  };
  for (int y = 0; y < way.rows; ++y)
    for (int x = 0; x < way.cols; ++x) {
      float &gone = way.at<float>(y, x) = 0, &miss = trust.at<float>(y, x) = 0;
      add(flow.forth, flow.back, place_of(x), place_of(y), gone, miss);
      add(flow.back, flow.forth, place_of(x), place_of(y), gone, miss);
    }
  const int side = trust_window(way.size());
  for (cv::Mat* each : {&way, &trust}) cv::blur(*each, *each, {side, side}, {-1, -1}, cv::BORDER_REFLECT_101);
  for (int y = 0; y < way.rows; ++y)
    for (int x = 0; x < way.cols; ++x) {
      float& miss = trust.at<float>(y, x);
      const float part = miss / (way.at<float>(y, x) + kLeastWay) / kMissPart;
      miss = 1 / (1 + part * part);
    }
  return trust;
}

}  // namespace

Between::Between(const FlowPair& flow) : flow_(flow), trust_(trust_of(flow)) {}

Between::Between(const FlowPair& unpinned, const PinnedFlow& pinned)
    : flow_(pinned.behind),
      trust_(trust_of(unpinned)),
      things_(pinned.things),
      hidden_a_(pinned.hidden_a),
      hidden_b_(pinned.hidden_b),
      changed_(pinned.changed) {
  // Beyond the window nothing is other than it was, but for the order in which sums were rounded.
  const int beyond = trust_window(trust_.size());
  const cv::Rect all({}, trust_.size());
  const cv::Rect near =
      cv::Rect(changed_.x / kFieldStep - beyond, changed_.y / kFieldStep - beyond,
               changed_.width / kFieldStep + 2 * beyond + 1, changed_.height / kFieldStep + 2 * beyond + 1) &
      all;
  trust_of(pinned.flow)(near).copyTo(trust_(near));
}

Moment Between::at(double phase) const {
  const cv::Size size = trust_.size();
  const auto t = static_cast<float>(phase);
  Moment moment{.size = size, .flow = flow_.forth.size(), .source = {}, .phase = t, .front = {}, .lean = {}};
  if (phase <= 0 || phase >= 1) return moment;
  // What of a still, going along its flow, has come to the place after a part of the way.
  const auto arrived = [](const cv::Mat& along, float x, float y, float part) {
    cv::Vec2f move = flow_at(along, x, y);
    for (int turn = 0; turn < kTurns; ++turn) move = flow_at(along, x - part * move[0], y - part * move[1]);
    return move;
  };
  moment.source.resize(static_cast<std::size_t>(size.area()));
  for (int y = 0; y < size.height; ++y) {
    Source* row = moment.source.data() + static_cast<std::size_t>(y) * size.width;
    for (int x = 0; x < size.width; ++x) {
      const cv::Vec2f forth = arrived(flow_.forth, place_of(x), place_of(y), t);
      const cv::Vec2f back = arrived(flow_.back, place_of(x), place_of(y), 1 - t);
      row[x] = {.a = .5f * t * (back - forth),
                .b = .5f * (1 - t) * (forth - back),
                .trust = trust_.at<float>(y, x)};
    }
  }
  if (!things_.empty()) add_things(moment);
  return moment;
}

void Between::add_things(Moment& moment) const {
  const float t = moment.phase;
  moment.front.resize(moment.source.size());
  moment.lean.resize(moment.source.size(), 0);
  const auto within = [&](float x, float y) {
    return static_cast<float>(changed_.x) <= x && x < static_cast<float>(changed_.br().x) &&
           static_cast<float>(changed_.y) <= y && y < static_cast<float>(changed_.br().y);
  };
  for (int row = 0; row < moment.size.height; ++row)
    for (int column = 0; column < moment.size.width; ++column) {
      const float x = place_of(column), y = place_of(row);
      if (!within(x, y)) continue;
      const std::size_t i = static_cast<std::size_t>(row) * moment.size.width + column;
      for (const CarriedThing& thing : things_) {
        const CarriedThing::Origin from = thing.origin({x, y}, t);
        // Where none of it is it goes on all the same, for the places between.
        if (from.opacity < moment.front[i].trust || (from.opacity == 0 && &thing != &things_[0])) continue;
        moment.front[i] = {.a = -t * cv::Vec2f(from.move.x, from.move.y),
                           .b = (1 - t) * cv::Vec2f(from.move.x, from.move.y),
                           .trust = from.opacity};
      }
      // Behind it: from the still that shows the place.
      Source& at = moment.source[i];
      const float in_a = plane_at(hidden_a_, x + at.a[0], y + at.a[1]),
                  in_b = plane_at(hidden_b_, x + at.b[0], y + at.b[1]);
      const float faded = std::max(plane_at(hidden_a_, x, y), plane_at(hidden_b_, x, y));
      at.trust = std::max(at.trust, std::min(1.0f, 2 * std::max({in_a, in_b, faded})));
      const float a = (1 - t) * (1 - in_a), b = t * (1 - in_b);
      constexpr float kNone = 1e-6f;
      if (in_a + in_b > 0 && a + b > kNone) moment.lean[i] = b / (a + b) - t;
    }
}

MomentReader::MomentReader(const Moment& moment, const cv::Mat& a, const cv::Mat& b, const cv::Rect& box)
    : moment_(moment), a_(a), b_(b), box_(box) {
  const auto width = static_cast<std::size_t>(moment.size.width);
  if (!moment.source.empty()) line_.resize(width);
  if (moment.front.empty()) return;
  front_.resize(width);
  lean_.resize(width);
}

void MomentReader::row(int y, float* out) {
  if (!line_.empty()) {
    const float to_field =
        static_cast<float>(moment_.flow.height) / static_cast<float>(box_.height) / kFieldStep;
    const float v = std::clamp((static_cast<float>(y) + .5f) * to_field - .5f, 0.0f,
                               static_cast<float>(moment_.size.height - 1));
    const int v0 = static_cast<int>(v), v1 = std::min(v0 + 1, moment_.size.height - 1);
    const float part = v - static_cast<float>(v0);
    const std::size_t top = static_cast<std::size_t>(v0) * line_.size(),
                      low = static_cast<std::size_t>(v1) * line_.size();
    for (std::size_t x = 0; x < line_.size(); ++x)
      line_[x] = mixed(moment_.source[top + x], moment_.source[low + x], part);
    for (std::size_t x = 0; x < front_.size(); ++x) {
      front_[x] = mixed(moment_.front[top + x], moment_.front[low + x], part);
      lean_[x] = (1 - part) * moment_.lean[top + x] + part * moment_.lean[low + x];
    }
  }
  const bool deep = a_.depth() == CV_16U;
  (deep ? mix_row_of_16 : mix_row_of_8)(moment_, line_, lean_, a_, b_, box_, box_.y + y, out);
  if (!front_.empty())
    (deep ? cover_row<std::uint16_t> : cover_row<std::uint8_t>)(moment_, front_, a_, b_, box_, box_.y + y,
                                                                out);
}

cv::Mat moment_picture(const Moment& moment, const cv::Mat& a, const cv::Mat& b, const cv::Rect& box) {
  cv::Mat out(box.size(), CV_32FC3);
  MomentReader reader(moment, a, b, box);
  for (int y = 0; y < box.height; ++y) reader.row(y, out.ptr<float>(y));
  return out;
}

}  // namespace freshet::synth::stills
