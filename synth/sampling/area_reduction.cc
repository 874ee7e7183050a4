#include "synth/sampling/area_reduction.h"

#include <algorithm>
#include <cmath>

#include "platform/vectors.h"

namespace freshet::synth::sampling {
namespace {

FRESHET_WIDE void weigh(const float* from, float weight, int n, float* to) {
  for (int i = 0; i < n; ++i) to[i] = weight * from[i];
}

FRESHET_WIDE void add_weighed(const float* from, float weight, int n, float* to) {
  for (int i = 0; i < n; ++i) to[i] += weight * from[i];
}

}  // namespace

AreaReduction::AreaReduction(cv::Size source, cv::Size reduced)
    : across_(taps(source.width, reduced.width, weights_)),
      down_(taps(source.height, reduced.height, weights_)) {}

std::vector<AreaReduction::Taps> AreaReduction::taps(int source, int reduced, std::vector<float>& weights) {
  constexpr double kRounding = 1e-3;  // of a sample: less is an error of rounding
  const double scale = static_cast<double>(source) / reduced;
  std::vector<Taps> all(reduced);
  for (int i = 0; i < reduced; ++i) {
    const double begin = i * scale, end = std::min<double>((i + 1) * scale, source);
    Taps& own = all[i];
    own.first = std::min(source - 1, static_cast<int>(std::floor(begin + kRounding)));
    const int last = std::max(own.first, std::min(source, static_cast<int>(std::ceil(end - kRounding))) - 1);
    own.count = last - own.first + 1;
    own.weights = weights.size();
    for (int k = own.first; k <= last; ++k)
      weights.push_back(
          static_cast<float>((std::min<double>(k + 1, end) - std::max<double>(k, begin)) / (end - begin)));
  }
  return all;
}

cv::Rect AreaReduction::source_of(const cv::Rect& rect) const {
  if (rect.empty()) return {};
  const Taps &left = across_[rect.x], &right = across_[rect.br().x - 1];
  const Taps &top = down_[rect.y], &bottom = down_[rect.br().y - 1];
  return {cv::Point(left.first, top.first),
          cv::Point(right.first + right.count, bottom.first + bottom.count)};
}

void AreaReduction::apply(const cv::Mat& plane, const cv::Rect& rect, cv::Mat& out,
                          std::vector<float>& line) const {
  const cv::Rect source = source_of(rect);
  line.resize(source.width);
  for (int row = rect.y; row < rect.br().y; ++row) {
    const Taps& v = down_[row];
    weigh(plane.ptr<float>(v.first) + source.x, weights_[v.weights], source.width, line.data());
    for (int k = 1; k < v.count; ++k)
      add_weighed(plane.ptr<float>(v.first + k) + source.x, weights_[v.weights + k], source.width,
                  line.data());
    float* to = out.ptr<float>(row);
    for (int column = rect.x; column < rect.br().x; ++column) {
      const Taps& h = across_[column];
      const float* from = line.data() + (h.first - source.x);
      float sum = weights_[h.weights] * from[0];
      for (int k = 1; k < h.count; ++k) sum += weights_[h.weights + k] * from[k];
      to[column] = sum;
    }
  }
}

}  // namespace freshet::synth::sampling
