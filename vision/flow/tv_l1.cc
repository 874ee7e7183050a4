#include "vision/flow/tv_l1.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "platform/vectors.h"

namespace freshet::vision {
namespace {

constexpr float kTau = 0.25f;  // of the dual's ascent, the maximum that is known to converge
constexpr int kMinSide = 16;
// Iterations of one sweep: their rows, 10 planes two rows apart, stay in the second cache (250 KB at 640 px).
constexpr int kSweep = 5;
constexpr float kFlat = 1e-7f;  // squared gradient below which the data say nothing

/// Rows of the planes that an iteration reads and writes.
struct Planes {
  int width = 0, height = 0;
  // The data term is |rho + gx u + gy v|; `inverse` is 1 / (gx^2 + gy^2).
  const float *gx = nullptr, *gy = nullptr, *rho = nullptr, *inverse = nullptr;
  float *u = nullptr, *v = nullptr;
  float *ux = nullptr, *uy = nullptr, *vx = nullptr, *vy = nullptr;  // the dual variables
};

// One row of u or v: a step towards the data, then the divergence of the dual. Planes begin one column to the
// right of a zero.
FRESHET_WIDE void flow_row(const Planes& planes, std::ptrdiff_t at, std::ptrdiff_t pitch, float maximum,
                           float theta) {
  const float *gx = planes.gx + at, *gy = planes.gy + at, *rho = planes.rho + at,
              *inverse = planes.inverse + at;
  const float *ux = planes.ux + at, *uy = planes.uy + at, *vx = planes.vx + at, *vy = planes.vy + at;
  float *u = planes.u + at, *v = planes.v + at;
#pragma GCC ivdep
  for (int x = 0; x < planes.width; ++x) {
    const float off = rho[x] + gx[x] * u[x] + gy[x] * v[x];
    const float step = std::min(maximum, std::max(-maximum, -off * inverse[x]));
    const float div_u = ux[x] - ux[x - 1] + uy[x] - (uy - pitch)[x];
    const float div_v = vx[x] - vx[x - 1] + vy[x] - (vy - pitch)[x];
    u[x] += step * gx[x] + theta * div_u;
    v[x] += step * gy[x] + theta * div_v;
  }
}

// One row of the dual, from the flow's forward differences; `below` is 0 in the last row, else the pitch.
FRESHET_WIDE void dual_row(const Planes& planes, std::ptrdiff_t at, std::ptrdiff_t below, float rate) {
  const float *u = planes.u + at, *v = planes.v + at;
  float *ux = planes.ux + at, *uy = planes.uy + at, *vx = planes.vx + at, *vy = planes.vy + at;
  const auto one = [&](int x, float du_x, float dv_x) {
    const float du_y = (u + below)[x] - u[x], dv_y = (v + below)[x] - v[x];
    const float less_u = 1 / (1 + rate * std::sqrt(du_x * du_x + du_y * du_y));
    const float less_v = 1 / (1 + rate * std::sqrt(dv_x * dv_x + dv_y * dv_y));
    ux[x] = (ux[x] + rate * du_x) * less_u;
    uy[x] = (uy[x] + rate * du_y) * less_u;
    vx[x] = (vx[x] + rate * dv_x) * less_v;
    vy[x] = (vy[x] + rate * dv_y) * less_v;
  };
#pragma GCC ivdep
  for (int x = 0; x < planes.width - 1; ++x) one(x, u[x + 1] - u[x], v[x + 1] - v[x]);
  one(planes.width - 1, 0, 0);
}

// `count` iterations in one sweep, each two rows behind the one before it: no row is touched before the
// iteration ahead is done with it and its neighbours.
void sweep(const Planes& planes, std::ptrdiff_t pitch, int count, float maximum, float theta) {
  for (int front = 0; front < planes.height + 1 + 2 * (count - 1); ++front) {
    for (int i = 0; i < count; ++i) {
      const int y = front - 2 * i;
      if (y >= 0 && y < planes.height) flow_row(planes, y * pitch, pitch, maximum, theta);
      if (y >= 1 && y <= planes.height)
        dual_row(planes, (y - 1) * pitch, y < planes.height ? pitch : 0, kTau / theta);
    }
  }
}

// Planes with a border of zeros above and to the left.
struct Bordered {
  cv::Mat whole, inside;
  void zero(cv::Size size) {
    whole = cv::Mat::zeros(size.height + 1, size.width + 1, CV_32F);
    inside = whole(cv::Rect(1, 1, size.width, size.height));
  }
  float* first() { return inside.ptr<float>(); }
};

/// Memory of one thread, kept from pair to pair.
struct Scratch {
  Bordered u, v, ux, uy, vx, vy, gx, gy, rho, inverse;
  cv::Mat places, bundle, warped;
  std::vector<cv::Mat> from, to;
};

// Half the difference of the two neighbours; at the border of the one neighbour and the pixel itself.
void bundle_gradients(const cv::Mat& picture, cv::Mat& bundle) {
  bundle.create(picture.size(), CV_32FC3);
  for (int y = 0; y < picture.rows; ++y) {
    const float* row = picture.ptr<float>(y);
    const float* above = picture.ptr<float>(std::max(y - 1, 0));
    const float* below = picture.ptr<float>(std::min(y + 1, picture.rows - 1));
    auto* to = bundle.ptr<cv::Vec3f>(y);
    for (int x = 0; x < picture.cols; ++x) {
      const float left = row[std::max(x - 1, 0)], right = row[std::min(x + 1, picture.cols - 1)];
      to[x] = {row[x], 0.5f * (right - left), 0.5f * (below[x] - above[x])};
    }
  }
}

// The data term around the flow in hand.
void linearise(const cv::Mat& from, Scratch& s) {
  s.places.create(from.size(), CV_32FC2);
  for (int y = 0; y < from.rows; ++y) {
    const float *u = s.u.inside.ptr<float>(y), *v = s.v.inside.ptr<float>(y);
    auto* place = s.places.ptr<cv::Vec2f>(y);
    for (int x = 0; x < from.cols; ++x) {
      place[x] = {static_cast<float>(x) + u[x], static_cast<float>(y) + v[x]};
    }
  }
  cv::remap(s.bundle, s.warped, s.places, cv::noArray(), cv::INTER_CUBIC);
  for (int y = 0; y < from.rows; ++y) {
    const auto* warped = s.warped.ptr<cv::Vec3f>(y);
    const float *u = s.u.inside.ptr<float>(y), *v = s.v.inside.ptr<float>(y), *was = from.ptr<float>(y);
    float *gx = s.gx.inside.ptr<float>(y), *gy = s.gy.inside.ptr<float>(y), *rho = s.rho.inside.ptr<float>(y),
          *inverse = s.inverse.inside.ptr<float>(y);
    for (int x = 0; x < from.cols; ++x) {
      gx[x] = warped[x][1];
      gy[x] = warped[x][2];
      const float squared = gx[x] * gx[x] + gy[x] * gy[x];
      inverse[x] = squared > kFlat ? 1 / squared : 0;
      rho[x] = warped[x][0] - gx[x] * u[x] - gy[x] * v[x] - was[x];
    }
  }
}

}  // namespace

cv::Mat tv_l1_flow(const cv::Mat& from, const cv::Mat& to, const TvL1Options& options) {
  thread_local Scratch s;
  const auto theta = static_cast<float>(options.theta);
  const auto maximum = static_cast<float>(options.lambda * options.theta);

  // Pyramids.
  int scales = 1;
  s.from.resize(1), s.to.resize(1);
  from.convertTo(s.from[0], CV_32F);
  to.convertTo(s.to[0], CV_32F);
  for (; scales < options.scales; ++scales) {
    cv::Mat small_from, small_to;
    cv::resize(s.from[scales - 1], small_from, {}, options.step, options.step, cv::INTER_LINEAR);
    cv::resize(s.to[scales - 1], small_to, {}, options.step, options.step, cv::INTER_LINEAR);
    if (small_from.cols < kMinSide || small_from.rows < kMinSide) break;
    s.from.push_back(small_from);
    s.to.push_back(small_to);
  }

  s.u.zero(s.from.back().size());
  s.v.zero(s.from.back().size());
  for (int scale = scales - 1; scale >= 0; --scale) {
    const cv::Mat& picture = s.from[scale];
    const cv::Size size = picture.size();
    if (s.u.inside.size() != size) {  // up from the scale before
      for (Bordered* plane : {&s.u, &s.v}) {
        cv::Mat larger;
        cv::resize(plane->inside, larger, size, 0, 0, cv::INTER_LINEAR);
        plane->zero(size);
        larger.convertTo(plane->inside, CV_32F, 1 / options.step);
      }
    }
    for (Bordered* plane : {&s.ux, &s.uy, &s.vx, &s.vy, &s.gx, &s.gy, &s.rho, &s.inverse}) plane->zero(size);
    const Planes planes{size.width,    size.height,       s.gx.first(), s.gy.first(),
                        s.rho.first(), s.inverse.first(), s.u.first(),  s.v.first(),
                        s.ux.first(),  s.uy.first(),      s.vx.first(), s.vy.first()};
    const auto pitch = static_cast<std::ptrdiff_t>(s.u.whole.step1());
    bundle_gradients(s.to[scale], s.bundle);
    for (int warp = 0; warp < options.warps; ++warp) {
      linearise(picture, s);
      if (options.median > 1) {
        for (Bordered* plane : {&s.u, &s.v}) {
          cv::Mat filtered;
          cv::medianBlur(plane->inside, filtered, options.median);
          filtered.copyTo(plane->inside);
        }
      }
      for (int left = options.iterations; left > 0; left -= kSweep) {
        sweep(planes, pitch, std::min(left, kSweep), maximum, theta);
      }
    }
  }
  cv::Mat flow;
  cv::merge(std::vector{s.u.inside, s.v.inside}, flow);
  return flow;
}

}  // namespace freshet::vision
