#include "bench/quality/prior/optimised_still.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "bench/quality/prior/begun_transfer.h"
#include "bench/quality/prior/carried.h"
#include "synth/transfer/transfer.h"

namespace freshet::bench {
namespace {

using namespace synth::transfer;

// px that the fluid goes on the average from one key frame to the next, at least. Patches lie on whole pixels: what
// goes less than half of one stands.
constexpr double kStep = 2;
int frames_a_step(const cv::Mat& matte, const cv::Mat& flow, int frames) {
  std::vector<cv::Mat> parts;
  cv::split(flow, parts);
  cv::Mat speed;
  cv::magnitude(parts[0], parts[1], speed);
  const double mean = cv::mean(speed, matte)[0];
  return mean > 0 ? static_cast<int>(std::ceil(std::min(kStep / mean, std::max(1.0, frames - 1.0)))) : 1;
}

// px by which the still is mirrored beyond its edges, so that patches there are whole; nothing beyond comes into view.
constexpr int kBeyond = 8;

cv::Mat mirrored(const cv::Mat& picture) {
  cv::Mat wide;
  cv::copyMakeBorder(picture, wide, kBeyond, kBeyond, kBeyond, kBeyond, cv::BORDER_REFLECT_101);
  return wide;
}

cv::Mat laid_over(const cv::Mat& still, const cv::Mat& matte, const cv::Mat& bgra) {
  cv::Mat frame = still.clone();
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x) {
      const cv::Vec4f made = bgra.at<cv::Vec4f>(y, x);
      const float share = static_cast<float>(matte.at<std::uint8_t>(y, x)) / 255.0f;
      if (made[3] == 0) continue;
      cv::Vec3b& shown = frame.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c)
        shown[c] = cv::saturate_cast<std::uint8_t>((1 - share) * static_cast<float>(shown[c]) +
                                                   share * 255 * made[c]);
    }
  return frame;
}

}  // namespace

std::vector<cv::Mat> optimise_still(const cv::Mat& still, const cv::Mat& matte, const cv::Mat& flow,
                                    int frames) {
  const TransferOptions options{
      .patch = 9, .lambda = 1, .eta = 0, .vote_power = 0.6, .retrieval = Retrieval::kNearest};
  cv::Mat bgra(still.size(), CV_8UC4);
  cv::mixChannels(std::vector{still, matte}, std::vector{bgra}, std::vector{0, 0, 1, 1, 2, 2, 3, 3});
  bgra = mirrored(bgra);
  const int step = frames_a_step(matte, flow, frames);
  const TargetFrame design{.alpha = mirrored(matte), .flow = mirrored(flow * step)};
  Transfer transfer([&](int) { return ExemplarFrame{bgra}; }, options);
  begin_with_still(bgra, design.flow, options, transfer);
  std::vector<cv::Mat> keys{still.clone()};
  while (static_cast<int>(keys.size() - 1) * step < frames - 1)
    keys.push_back(
        laid_over(still, matte, transfer.next(design).bgra(cv::Rect({kBeyond, kBeyond}, still.size()))));
  std::vector<cv::Mat> made;
  for (int t = 0; t < frames; ++t) {
    const auto key = static_cast<std::size_t>(t / step);
    if (t % step == 0) {
      made.push_back(keys[key]);
      continue;
    }
    const cv::Mat gone = carried(keys[key], flow * (t % step), cv::BORDER_REFLECT_101),
                  coming = carried(keys[key + 1], flow * (t % step - step), cv::BORDER_REFLECT_101);
    cv::Mat both, seen;
    const double share = t % step / static_cast<double>(step);
    cv::addWeighted(gone, (1 - share) / 255, coming, share / 255, 0, both, CV_32F);
    cv::cvtColor(both, seen, cv::COLOR_BGR2BGRA);
    made.push_back(laid_over(still, matte, seen));
  }
  return made;
}

}  // namespace freshet::bench
