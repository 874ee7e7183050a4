#include "synth/stills/between.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include <opencv2/imgproc.hpp>

#include "platform/vectors.h"
#include "vision/flow.h"

namespace freshet::synth::stills {
namespace {

using Source = Moment::Source;

constexpr int kCoarse = 4;     // the first flow is found at 1 / kCoarse of the size
constexpr int kFieldStep = 2;  // px of the flow, between places at which a moment is decided
constexpr int kTurns = 4;      // of the iteration that finds what will have come to a place
// How far forth and back miss each other beside the way that they go, at which half is trusted.
constexpr float kMissPart = .3f;
constexpr float kLeastWay = .5f;     // px: nothing is less sure for standing still
constexpr double kTrustPart = .053;  // of the longer side: half the window over which trust is judged

cv::Mat grey(const cv::Mat& bgr) {
  cv::Mat out;
  cv::cvtColor(bgr, out, cv::COLOR_BGR2GRAY);
  return out;
}

cv::Mat flow_one_way(const cv::Mat& from, const cv::Mat& to) {
  const cv::Size coarse(std::max(64, from.cols / kCoarse), std::max(64, from.rows / kCoarse));
  if (coarse.width >= from.cols || coarse.height >= from.rows) return vision::optical_flow(from, to);
  cv::Mat small_from, small_to, flow;
  cv::resize(from, small_from, coarse, 0, 0, cv::INTER_AREA);
  cv::resize(to, small_to, coarse, 0, 0, cv::INTER_AREA);
  cv::resize(vision::optical_flow(small_from, small_to), flow, from.size(), 0, 0, cv::INTER_LINEAR);
  cv::multiply(flow,
               cv::Scalar(static_cast<double>(from.cols) / coarse.width,
                          static_cast<double>(from.rows) / coarse.height),
               flow);
  return vision::refined_flow(from, to, flow);
}

cv::Mat as_integers(const cv::Mat& flow) {
  cv::Mat out;
  flow.convertTo(out, CV_16S, 1 / FlowPair::kUnit);
  return out;
}

cv::Vec2f read(const cv::Mat& flow, float x, float y) {
  x = std::clamp(x, 0.0f, static_cast<float>(flow.cols - 1));
  y = std::clamp(y, 0.0f, static_cast<float>(flow.rows - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, flow.cols - 1), y1 = std::min(y0 + 1, flow.rows - 1);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const auto* top = flow.ptr<cv::Vec2s>(y0);
  const auto* low = flow.ptr<cv::Vec2s>(y1);
  cv::Vec2f out;
  for (int c = 0; c < 2; ++c)
    out[c] = FlowPair::kUnit *
             ((1 - fy) * ((1 - fx) * static_cast<float>(top[x0][c]) + fx * static_cast<float>(top[x1][c])) +
              fy * ((1 - fx) * static_cast<float>(low[x0][c]) + fx * static_cast<float>(low[x1][c])));
  return out;
}

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

// The stills' samples along the row, `line` being the field at its height.
template <class T>
[[gnu::always_inline]] inline void mix_row(const Moment& moment, std::span<const Source> line,
                                           const cv::Mat& a, const cv::Mat& b, const cv::Rect& box, int y,
                                           float* out) {
  constexpr float kNothing = .02f;  // of trust: not worth its samples
  const float t = moment.phase;
  const T* row_a = a.ptr<T>(y) + 3 * box.x;
  const T* row_b = b.ptr<T>(y) + 3 * box.x;
  for (int i = 0; i < 3 * box.width; ++i)
    out[i] = (1 - t) * static_cast<float>(row_a[i]) + t * static_cast<float>(row_b[i]);
  if (line.empty()) return;
  const float to_field = static_cast<float>(moment.flow.width) / static_cast<float>(box.width) / kFieldStep;
  const float full_x = static_cast<float>(box.width) / static_cast<float>(moment.flow.width);
  const float full_y = static_cast<float>(box.height) / static_cast<float>(moment.flow.height);
  const auto last = static_cast<int>(line.size()) - 1;
  for (int x = 0; x < box.width; ++x) {
    const float u =
        std::clamp((static_cast<float>(x) + .5f) * to_field - .5f, 0.0f, static_cast<float>(last));
    const int u0 = static_cast<int>(u);
    const Source at = mixed(line[u0], line[std::min(u0 + 1, last)], u - static_cast<float>(u0));
    if (at.trust < kNothing || stands(at)) continue;
    float* value = out + 3 * x;
    for (int c = 0; c < 3; ++c) value[c] *= 1 - at.trust;
    const auto px = static_cast<float>(box.x + x), py = static_cast<float>(y);
    add_sample<T>(a, px + at.a[0] * full_x, py + at.a[1] * full_y, at.trust * (1 - t), value);
    add_sample<T>(b, px + at.b[0] * full_x, py + at.b[1] * full_y, at.trust * t, value);
  }
}

FRESHET_WIDE void mix_row_of_8(const Moment& moment, std::span<const Source> line, const cv::Mat& a,
                               const cv::Mat& b, const cv::Rect& box, int y, float* out) {
  mix_row<std::uint8_t>(moment, line, a, b, box, y, out);
}

FRESHET_WIDE void mix_row_of_16(const Moment& moment, std::span<const Source> line, const cv::Mat& a,
                                const cv::Mat& b, const cv::Rect& box, int y, float* out) {
  mix_row<std::uint16_t>(moment, line, a, b, box, y, out);
}

}  // namespace

FlowPair flow_between(const cv::Mat& from, const cv::Mat& to) {
  const cv::Mat one = grey(from), two = grey(to);
  return {as_integers(flow_one_way(one, two)), as_integers(flow_one_way(two, one))};
}

Between::Between(const FlowPair& flow) : flow_(flow), trust_(field_size(flow.forth.size()), CV_32F) {
  cv::Mat way(trust_.size(), CV_32F);
  const auto add = [](const cv::Mat& one, const cv::Mat& other, float x, float y, float& gone, float& miss) {
    const cv::Vec2f move = read(one, x, y), missed = read(other, x + move[0], y + move[1]) + move;
    gone += .5f * std::hypot(move[0], move[1]);
    miss += .5f * std::hypot(missed[0], missed[1]);
  };
  for (int y = 0; y < way.rows; ++y)
    for (int x = 0; x < way.cols; ++x) {
      float &gone = way.at<float>(y, x) = 0, &miss = trust_.at<float>(y, x) = 0;
      add(flow.forth, flow.back, place_of(x), place_of(y), gone, miss);
      add(flow.back, flow.forth, place_of(x), place_of(y), gone, miss);
    }
  const int side = 2 * static_cast<int>(std::lround(kTrustPart * std::max(way.cols, way.rows))) + 1;
  for (cv::Mat* each : {&way, &trust_})
    cv::blur(*each, *each, {side, side}, {-1, -1}, cv::BORDER_REFLECT_101);
  for (int y = 0; y < way.rows; ++y)
    for (int x = 0; x < way.cols; ++x) {
      float& miss = trust_.at<float>(y, x);
      const float part = miss / (way.at<float>(y, x) + kLeastWay) / kMissPart;
      miss = 1 / (1 + part * part);
    }
}

Moment Between::at(double phase) const {
  const cv::Size size = trust_.size();
  const auto t = static_cast<float>(phase);
  Moment moment{.size = size, .flow = flow_.forth.size(), .source = {}, .phase = t};
  if (phase <= 0 || phase >= 1) return moment;
  // What of a still, going along its flow, has come to the place after a part of the way.
  const auto arrived = [](const cv::Mat& along, float x, float y, float part) {
    cv::Vec2f move = read(along, x, y);
    for (int turn = 0; turn < kTurns; ++turn) move = read(along, x - part * move[0], y - part * move[1]);
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
  return moment;
}

MomentReader::MomentReader(const Moment& moment, const cv::Mat& a, const cv::Mat& b, const cv::Rect& box)
    : moment_(moment), a_(a), b_(b), box_(box) {
  if (!moment.source.empty()) line_.resize(static_cast<std::size_t>(moment.size.width));
}

void MomentReader::row(int y, float* out) {
  if (!line_.empty()) {
    const float to_field =
        static_cast<float>(moment_.flow.height) / static_cast<float>(box_.height) / kFieldStep;
    const float v = std::clamp((static_cast<float>(y) + .5f) * to_field - .5f, 0.0f,
                               static_cast<float>(moment_.size.height - 1));
    const int v0 = static_cast<int>(v), v1 = std::min(v0 + 1, moment_.size.height - 1);
    const Source* top = moment_.source.data() + static_cast<std::size_t>(v0) * line_.size();
    const Source* low = moment_.source.data() + static_cast<std::size_t>(v1) * line_.size();
    for (std::size_t x = 0; x < line_.size(); ++x)
      line_[x] = mixed(top[x], low[x], v - static_cast<float>(v0));
  }
  if (a_.depth() == CV_16U)
    mix_row_of_16(moment_, line_, a_, b_, box_, box_.y + y, out);
  else
    mix_row_of_8(moment_, line_, a_, b_, box_, box_.y + y, out);
}

cv::Mat moment_picture(const Moment& moment, const cv::Mat& a, const cv::Mat& b, const cv::Rect& box) {
  cv::Mat out(box.size(), CV_32FC3);
  MomentReader reader(moment, a, b, box);
  for (int y = 0; y < box.height; ++y) reader.row(y, out.ptr<float>(y));
  return out;
}

}  // namespace freshet::synth::stills
