#include "synth/judging/coherence.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::judging {
namespace {

constexpr std::size_t kSampledFrames = 16;
constexpr double kTensorSigma = 6;  // px

struct Tensor {
  cv::Mat apart, strength;  // CV_32F: difference and sum of its eigenvalues
};

Tensor structure_tensor(const cv::Mat& luma) {
  cv::Mat dx, dy, xx, xy, yy;
  cv::Sobel(luma, dx, CV_32F, 1, 0);
  cv::Sobel(luma, dy, CV_32F, 0, 1);
  cv::GaussianBlur(dx.mul(dx), xx, {}, kTensorSigma);
  cv::GaussianBlur(dx.mul(dy), xy, {}, kTensorSigma);
  cv::GaussianBlur(dy.mul(dy), yy, {}, kTensorSigma);
  Tensor tensor;
  cv::magnitude(xx - yy, 2 * xy, tensor.apart);
  tensor.strength = xx + yy;
  return tensor;
}

/// Weighted by strength, by cell.
cv::Mat coherence_by_cell(const cv::Mat& luma, const cv::Mat& matte) {
  const Tensor tensor = structure_tensor(luma);
  return cell_means(tensor.apart, matte) / (cell_means(tensor.strength, matte) + 1);
}

}  // namespace

std::vector<std::size_t> spread_frames(std::size_t frames) {
  const std::size_t count = std::min(kSampledFrames, frames);
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < count; ++i) indices.push_back(count > 1 ? i * (frames - 1) / (count - 1) : 0);
  return indices;
}

double mean_coherence(std::span<const cv::Mat> luma, const cv::Mat& matte) {
  const std::vector<std::size_t> chosen = spread_frames(luma.size());
  const cv::Mat mask = matte > 127;
  std::vector<double> coherence(chosen.size());
  oneapi::tbb::parallel_for(std::size_t{0}, chosen.size(), [&](std::size_t i) {
    const Tensor tensor = structure_tensor(luma[chosen[i]]);
    coherence[i] = cv::mean(tensor.apart, mask)[0] / (cv::mean(tensor.strength, mask)[0] + 1e-6);
  });
  double sum = 0;
  for (double value : coherence) sum += value;
  return sum / static_cast<double>(coherence.size());
}

Reading combing(const Evidence& film) {
  Reading reading;
  const cv::Mat own = coherence_by_cell(film.still_luma(), film.matte());
  const std::vector<std::size_t> chosen = spread_frames(film.luma().size());
  std::vector<cv::Mat> cells(chosen.size());
  oneapi::tbb::parallel_for(std::size_t{0}, chosen.size(), [&](std::size_t i) {
    cells[i] = coherence_by_cell(film.luma()[chosen[i]], film.matte()) - own;
  });
  reading.value = mean_of(mean_of(cells));
  std::vector<std::vector<cv::Mat>> spans(kSpans);
  for (std::size_t i = 0; i < chosen.size(); ++i)
    spans[static_cast<std::size_t>(span_of(static_cast<int>(chosen[i]), film.count()))].push_back(cells[i]);
  for (const auto& span : spans)
    if (!span.empty()) reading.map.push_back(mean_of(span));
  return reading;
}

}  // namespace freshet::synth::judging
