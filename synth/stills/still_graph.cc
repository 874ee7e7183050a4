#include "synth/stills/still_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::stills {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBlurs[] = {.003, .01, .02, .03, .06, .1};  // of the mask's longer side
constexpr double kFloorPart = .9;                            // of the nearest two stills' squared distance

// CV_32FC3, blurred as if nothing lay outside of the mask. weight   CV_32F, the mask itself.
cv::Mat blurred_within(const cv::Mat& still, const cv::Mat& weight, const cv::Mat& weight_blurred,
                       double sigma) {
  cv::Mat values, out;
  still.convertTo(values, CV_32F);
  std::vector<cv::Mat> planes;
  cv::split(values, planes);
  for (cv::Mat& plane : planes) {
    cv::multiply(plane, weight, plane);
    cv::GaussianBlur(plane, plane, {}, sigma, sigma, cv::BORDER_CONSTANT);
    cv::divide(plane, weight_blurred, plane);
    cv::multiply(plane, weight, plane);
  }
  cv::merge(planes, out);
  return out;
}

Square<double> distances_at(std::span<const cv::Mat> stills, const cv::Mat& weight, double sigma) {
  const int n = static_cast<int>(stills.size());
  cv::Mat weight_blurred;
  cv::GaussianBlur(weight, weight_blurred, {}, sigma, sigma, cv::BORDER_CONSTANT);
  weight_blurred = cv::max(weight_blurred, 1e-3);
  std::vector<cv::Mat> blurred(stills.size());
  oneapi::tbb::parallel_for(
      0, n, [&](int i) { blurred[i] = blurred_within(stills[i], weight, weight_blurred, sigma); });
  const double samples = 3 * std::max(1.0, cv::sum(weight)[0]);
  Square<double> rms(n);
  oneapi::tbb::parallel_for(0, n, [&](int i) {
    for (int j = 0; j < i; ++j)
      rms(i, j) = rms(j, i) = std::sqrt(cv::norm(blurred[i], blurred[j], cv::NORM_L2SQR) / samples);
  });
  return rms;
}

double mean_of(const Square<double>& rms) {
  const double pairs = static_cast<double>(rms.n) * std::max(1, rms.n - 1);
  return std::accumulate(rms.values.begin(), rms.values.end(), 0.0) / pairs;
}

// What even the nearest two do not share adds to every distance, by squares, and says nothing of order.
void take_floor(Square<double>& rms) {
  double nearest = kInfinity;
  for (int i = 0; i < rms.n; ++i)
    for (int j = 0; j < i; ++j) nearest = std::min(nearest, rms(i, j));
  for (int i = 0; i < rms.n; ++i)
    for (int j = 0; j < i; ++j)
      rms(i, j) = rms(j, i) = std::sqrt(rms(i, j) * rms(i, j) - kFloorPart * nearest * nearest);
}

void find_parts(StillGraph& graph) {
  const int n = graph.count();
  std::vector<int> found(n, -1), size;
  for (int i = 0; i < n; ++i) {
    if (found[i] >= 0) continue;
    for (int j = i; j < n; ++j)
      if (std::isfinite(graph.distance(i, j))) found[j] = static_cast<int>(size.size());
    size.push_back(static_cast<int>(std::count(found.begin(), found.end(), static_cast<int>(size.size()))));
  }
  std::vector<int> by_size(size.size()), rank(size.size());
  std::iota(by_size.begin(), by_size.end(), 0);
  std::stable_sort(by_size.begin(), by_size.end(), [&](int a, int b) { return size[a] > size[b]; });
  for (std::size_t r = 0; r < by_size.size(); ++r) rank[by_size[r]] = static_cast<int>(r);
  graph.part.resize(n);
  for (int i = 0; i < n; ++i) graph.part[i] = rank[found[i]];
}

}  // namespace

Square<double> still_distances(std::span<const cv::Mat> stills, const cv::Mat& mask, double sigma) {
  const cv::Mat all = mask.empty() ? cv::Mat(stills[0].size(), CV_8U, cv::Scalar(255)) : mask;
  const cv::Rect whole({}, all.size());
  cv::Rect box = cv::boundingRect(all);
  if (box.empty()) box = whole;
  cv::Mat weight;
  cv::Mat(all(box) > 0).convertTo(weight, CV_32F, 1.0 / 255);
  std::vector<cv::Mat> cropped;
  for (const cv::Mat& still : stills) cropped.push_back(still(box));
  if (sigma > 0) return distances_at(cropped, weight, sigma);
  Square<double> mixed(static_cast<int>(stills.size()));
  double level = 0;
  for (const double part : kBlurs) {
    const Square<double> rms =
        distances_at(cropped, weight, std::max(.6, part * std::max(box.width, box.height)));
    const double mean = mean_of(rms);
    if (mean <= 0) continue;
    level += mean / std::size(kBlurs);
    for (std::size_t k = 0; k < rms.values.size(); ++k)
      mixed.values[k] += rms.values[k] / mean / std::size(kBlurs);
  }
  for (double& each : mixed.values) each *= level;
  take_floor(mixed);
  return mixed;
}

int StillGraph::parts() const { return part.empty() ? 0 : 1 + *std::max_element(part.begin(), part.end()); }

std::vector<int> StillGraph::way(int from, int to) const {
  if (!std::isfinite(distance(from, to))) return {};
  std::vector<int> stills{from};
  while (stills.back() != to) stills.push_back(next(stills.back(), to));
  return stills;
}

StillGraph make_graph(const Square<double>& rms, const GraphOptions& options) {
  const int n = rms.n;
  StillGraph graph{.weight = Square<double>(n),
                   .distance = Square<double>(n, kInfinity),
                   .next = Square<int>(n, -1),
                   .edge = Square<unsigned char>(n, 0)};
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) sum += graph.weight(i, j) = i == j ? 0 : std::pow(rms(i, j), options.power);
  const double mean = n > 1 ? sum / (static_cast<double>(n) * (n - 1)) : 0;
  const auto is_among = [](const std::vector<std::pair<int, int>>& pairs, int i, int j) {
    return std::any_of(pairs.begin(), pairs.end(),
                       [&](const auto& each) { return each == std::pair(i, j) || each == std::pair(j, i); });
  };
  double lightest = kInfinity;
  for (const double each : graph.weight.values)
    if (each > 0) lightest = std::min(lightest, each);
  for (const auto& [i, j] : options.join)
    if (i != j) graph.weight(i, j) = graph.weight(j, i) = std::min(graph.weight(i, j), lightest);
  double kept = 0;
  int edges = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      if (i != j && (graph.weight(i, j) > options.cut_above * mean || is_among(options.cut, i, j))) continue;
      graph.distance(i, j) = graph.weight(i, j);
      graph.next(i, j) = j;
      graph.edge(i, j) = i != j;
      kept += graph.weight(i, j);
      edges += i != j;
    }
  graph.mean_edge_weight = edges > 0 ? kept / edges : 0;
  for (int k = 0; options.floyd && k < n; ++k)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if (const double over = graph.distance(i, k) + graph.distance(k, j); over < graph.distance(i, j)) {
          graph.distance(i, j) = over;
          graph.next(i, j) = graph.next(i, k);
        }
  find_parts(graph);
  return graph;
}

}  // namespace freshet::synth::stills
