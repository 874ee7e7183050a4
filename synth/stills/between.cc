#include "synth/stills/between.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "vision/flow.h"

namespace freshet::synth::stills {
namespace {

using Source = Moment::Source;

constexpr int kCoarse = 4;          // the first flow is found at 1 / kCoarse of the size
constexpr int kFieldStep = 2;       // px of the flow, between places at which a moment is decided
constexpr int kTurns = 4;           // of the iteration that finds what will have come to a place
constexpr double kBlurPart = .012;  // of the longer side: over what likeness is judged
constexpr float kNoise = 8;         // variance, of 255^2: below it nothing is told from noise
// Forth and back may miss each other by kMiss px and by kMissPart of the way before they are doubted.
constexpr float kMiss = 1, kMissPart = .3f;
constexpr float kFadeWeight = .8f;  // of the cross-fade beside a guess of the same likeness

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

cv::Vec2f read(const cv::Mat& field, float x, float y) {
  x = std::clamp(x, 0.0f, static_cast<float>(field.cols - 1));
  y = std::clamp(y, 0.0f, static_cast<float>(field.rows - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, field.cols - 1), y1 = std::min(y0 + 1, field.rows - 1);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const auto* top = field.ptr<cv::Vec2f>(y0);
  const auto* low = field.ptr<cv::Vec2f>(y1);
  return (1 - fy) * ((1 - fx) * top[x0] + fx * top[x1]) + fy * ((1 - fx) * low[x0] + fx * low[x1]);
}

// Samples of a picture of three channels at a place, bilinear, the border going on.
template <class T>
void read_colour(const cv::Mat& picture, float x, float y, float weight, float* sum) {
  x = std::clamp(x, 0.0f, static_cast<float>(picture.cols - 1));
  y = std::clamp(y, 0.0f, static_cast<float>(picture.rows - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = x0 + 1 < picture.cols ? 3 : 0;
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const T* top = picture.ptr<T>(y0) + 3 * x0;
  const T* low = picture.ptr<T>(y0 + 1 < picture.rows ? y0 + 1 : y0) + 3 * x0;
  const float w00 = (1 - fy) * (1 - fx) * weight, w01 = (1 - fy) * fx * weight;
  const float w10 = fy * (1 - fx) * weight, w11 = fy * fx * weight;
  for (int c = 0; c < 3; ++c)
    sum[c] += w00 * static_cast<float>(top[c]) + w01 * static_cast<float>(top[x1 + c]) +
              w10 * static_cast<float>(low[c]) + w11 * static_cast<float>(low[x1 + c]);
}

float squared_difference(const float* a, const float* b) {
  float sum = 0;
  for (int c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum / 3;
}

// Of a field's place, px of the flow.
float place_of(int at) { return kFieldStep * static_cast<float>(at) + .5f * (kFieldStep - 1); }
cv::Size field_size(cv::Size flow) {
  return {(flow.width + kFieldStep - 1) / kFieldStep, (flow.height + kFieldStep - 1) / kFieldStep};
}

void blur(cv::Mat& plane) {
  const int side = 2 * static_cast<int>(std::lround(kBlurPart * std::max(plane.cols, plane.rows))) + 3;
  cv::blur(plane, plane, {side, side}, {-1, -1}, cv::BORDER_REFLECT_101);
}

// One guess, over the whole picture.
struct Guess {
  cv::Mat here,
      there;  // CV_32FC2: from a place to its sources in the still whose flow is followed, and in the other
  cv::Mat unlikeness;  // CV_32F: of the two sources
  cv::Mat trust;       // CV_32F, 0..1: forth and back agree
};

// What of `picture`, going along `flow`, has come to each place of a field after `part` of the way.
Guess follow(const cv::Mat& picture, const cv::Mat& other, const cv::Mat& flow, const cv::Mat& back,
             float part, cv::Size size) {
  Guess guess{cv::Mat(size, CV_32FC2), cv::Mat(size, CV_32FC2), cv::Mat(size, CV_32F), cv::Mat(size, CV_32F)};
  for (int y = 0; y < size.height; ++y) {
    auto* here = guess.here.ptr<cv::Vec2f>(y);
    auto* there = guess.there.ptr<cv::Vec2f>(y);
    float* unlikeness = guess.unlikeness.ptr<float>(y);
    float* trust = guess.trust.ptr<float>(y);
    for (int x = 0; x < size.width; ++x) {
      const float fx = place_of(x), fy = place_of(y);
      cv::Vec2f move = read(flow, fx, fy);
      for (int turn = 0; turn < kTurns; ++turn) move = read(flow, fx - part * move[0], fy - part * move[1]);
      here[x] = -part * move;
      there[x] = here[x] + move;
      const cv::Vec2f miss = read(back, fx + there[x][0], fy + there[x][1]) + move;
      const float allowed = kMiss + kMissPart * std::hypot(move[0], move[1]);
      trust[x] = std::exp(-miss.dot(miss) / (allowed * allowed));
      float one[3] = {0, 0, 0}, two[3] = {0, 0, 0};
      read_colour<std::uint8_t>(picture, fx + here[x][0], fy + here[x][1], 1, one);
      read_colour<std::uint8_t>(other, fx + there[x][0], fy + there[x][1], 1, two);
      unlikeness[x] = squared_difference(one, two);
    }
  }
  blur(guess.unlikeness);
  blur(guess.trust);
  return guess;
}

template <class T>
void mix_row(const Moment& moment, const cv::Mat& a, const cv::Mat& b, const cv::Rect& box, int y,
             float* out) {
  constexpr float kNothing = .02f;  // of a weight: not worth its samples
  const float scale_x = static_cast<float>(moment.flow.width) / static_cast<float>(box.width) / kFieldStep;
  const float scale_y = static_cast<float>(moment.flow.height) / static_cast<float>(box.height) / kFieldStep;
  const float t = moment.phase;
  const T* row_a = a.ptr<T>(box.y + y) + 3 * box.x;
  const T* row_b = b.ptr<T>(box.y + y) + 3 * box.x;
  if (moment.source.empty()) {
    for (int i = 0; i < 3 * box.width; ++i)
      out[i] = (1 - t) * static_cast<float>(row_a[i]) + t * static_cast<float>(row_b[i]);
    return;
  }
  const float v = std::clamp((static_cast<float>(y) + .5f) * scale_y - .5f, 0.0f,
                             static_cast<float>(moment.size.height - 1));
  const int v0 = static_cast<int>(v), v1 = std::min(v0 + 1, moment.size.height - 1);
  const float fv = v - static_cast<float>(v0);
  const Source* top = moment.source.data() + static_cast<std::size_t>(v0) * moment.size.width;
  const Source* low = moment.source.data() + static_cast<std::size_t>(v1) * moment.size.width;
  const cv::Vec2f to_full(1 / (scale_x * kFieldStep), 1 / (scale_y * kFieldStep));
  const auto py = static_cast<float>(box.y + y);
  for (int x = 0; x < box.width; ++x) {
    const float u = std::clamp((static_cast<float>(x) + .5f) * scale_x - .5f, 0.0f,
                               static_cast<float>(moment.size.width - 1));
    const int u0 = static_cast<int>(u), u1 = std::min(u0 + 1, moment.size.width - 1);
    const float fu = u - static_cast<float>(u0);
    const float c00 = (1 - fv) * (1 - fu), c01 = (1 - fv) * fu, c10 = fv * (1 - fu), c11 = fv * fu;
    const auto mixed = [&](auto Source::*what) {
      return c00 * top[u0].*what + c01 * top[u1].*what + c10 * low[u0].*what + c11 * low[u1].*what;
    };
    float w1 = mixed(&Source::w1), w2 = mixed(&Source::w2);
    const auto px = static_cast<float>(box.x + x);
    float* sum = out + 3 * x;
    if (w1 < kNothing) w1 = 0;
    if (w2 < kNothing) w2 = 0;
    const float fade = 1 - w1 - w2;
    for (int c = 0; c < 3; ++c)
      sum[c] =
          fade * ((1 - t) * static_cast<float>(row_a[3 * x + c]) + t * static_cast<float>(row_b[3 * x + c]));
    const auto add = [&](const cv::Mat& picture, const cv::Vec2f& by, float weight) {
      read_colour<T>(picture, px + by[0] * to_full[0], py + by[1] * to_full[1], weight, sum);
    };
    if (w1 > 0) {
      add(a, mixed(&Source::a1), w1 * (1 - t));
      add(b, mixed(&Source::b1), w1 * t);
    }
    if (w2 > 0) {
      add(a, mixed(&Source::a2), w2 * (1 - t));
      add(b, mixed(&Source::b2), w2 * t);
    }
  }
}

}  // namespace

FlowPair flow_between(const cv::Mat& from, const cv::Mat& to) {
  const cv::Mat one = grey(from), two = grey(to);
  return {as_integers(flow_one_way(one, two)), as_integers(flow_one_way(two, one))};
}

Between::Between(const cv::Mat& from, const cv::Mat& to, const FlowPair& flow)
    : from_(from), to_(to), unlikeness_(field_size(from.size()), CV_32F) {
  flow.forth.convertTo(forth_, CV_32F, FlowPair::kUnit);
  flow.back.convertTo(back_, CV_32F, FlowPair::kUnit);
  for (int y = 0; y < unlikeness_.rows; ++y)
    for (int x = 0; x < unlikeness_.cols; ++x) {
      float one[3] = {0, 0, 0}, two[3] = {0, 0, 0};
      read_colour<std::uint8_t>(from, place_of(x), place_of(y), 1, one);
      read_colour<std::uint8_t>(to, place_of(x), place_of(y), 1, two);
      unlikeness_.at<float>(y, x) = squared_difference(one, two);
    }
  blur(unlikeness_);
}

Moment Between::at(double phase) const {
  const cv::Size size = unlikeness_.size();
  Moment moment{.size = size, .flow = from_.size(), .source = {}, .phase = static_cast<float>(phase)};
  if (phase <= 0 || phase >= 1) return moment;
  const Guess forth = follow(from_, to_, forth_, back_, moment.phase, size);
  const Guess back = follow(to_, from_, back_, forth_, 1 - moment.phase, size);
  moment.source.resize(static_cast<std::size_t>(size.area()));
  for (int y = 0; y < size.height; ++y) {
    Source* row = moment.source.data() + static_cast<std::size_t>(y) * size.width;
    for (int x = 0; x < size.width; ++x) {
      const auto worth = [](float unlikeness) { return 1 / ((unlikeness + kNoise) * (unlikeness + kNoise)); };
      const float w1 = forth.trust.at<float>(y, x) * worth(forth.unlikeness.at<float>(y, x));
      const float w2 = back.trust.at<float>(y, x) * worth(back.unlikeness.at<float>(y, x));
      const float all = w1 + w2 + kFadeWeight * worth(unlikeness_.at<float>(y, x));
      row[x] = {.a1 = forth.here.at<cv::Vec2f>(y, x),
                .b1 = forth.there.at<cv::Vec2f>(y, x),
                .a2 = back.there.at<cv::Vec2f>(y, x),
                .b2 = back.here.at<cv::Vec2f>(y, x),
                .w1 = w1 / all,
                .w2 = w2 / all};
    }
  }
  return moment;
}

void moment_row(const Moment& moment, const cv::Mat& a, const cv::Mat& b, const cv::Rect& box, int y,
                float* out) {
  if (a.depth() == CV_16U)
    mix_row<std::uint16_t>(moment, a, b, box, y, out);
  else
    mix_row<std::uint8_t>(moment, a, b, box, y, out);
}

cv::Mat moment_picture(const Moment& moment, const cv::Mat& a, const cv::Mat& b, const cv::Rect& box) {
  cv::Mat out(box.size(), CV_32FC3);
  for (int y = 0; y < box.height; ++y) moment_row(moment, a, b, box, y, out.ptr<float>(y));
  return out;
}

}  // namespace freshet::synth::stills
