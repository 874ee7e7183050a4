#include "synth/matte/matte.h"

#include <algorithm>
#include <array>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "platform/stopwatch.h"

namespace freshet::synth::matte {
namespace {

constexpr int kSheetWidth = 640, kGap = 8, kCheck = 16, kLegend = 20;

cv::Mat cut_out(const cv::Mat& picture, const cv::Mat& alpha) {
  cv::Mat out(picture.size(), CV_8UC3);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const int ground = (x / kCheck + y / kCheck) % 2 != 0 ? 110 : 70;
      const int fraction = alpha.at<std::uint8_t>(y, x);
      const cv::Vec3b& colour = picture.at<cv::Vec3b>(y, x);
      for (int channel = 0; channel < 3; ++channel)
        out.at<cv::Vec3b>(y, x)[channel] =
            static_cast<std::uint8_t>((colour[channel] * fraction + ground * (255 - fraction) + 127) / 255);
    }
  return out;
}

}  // namespace

Matte make_matte(const cv::Mat& picture, const Marks& marks, const MatteOptions& options,
                 const std::string& where, std::stop_token stop) {
  Matte matte;
  Stopwatch watch;
  const cv::Mat region = hard_region(picture, marks, options.region, where, &matte.notices);
  matte.region_s = watch.lap();
  if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, "matte", "stopped");
  matte.alpha = soft_edge(picture, region, marks, options.edge);
  matte.edge_s = watch.lap();
  matte.fraction = cv::mean(matte.alpha)[0] / 255;
  if (cv::countNonZero(matte.alpha) == 0)
    throw Error(ErrorKind::kInput, where, "no pixel came out as fluid: its colours are the background's",
                "Mark more of the fluid, or fluid that looks unlike the background");
  if (cv::countNonZero(matte.alpha < 255) == 0)
    matte.notices.emplace_back("the matte covers the whole picture: mark more background");
  return matte;
}

cv::Mat matte_sheet(const cv::Mat& picture, const Marks& marks, const cv::Mat& alpha) {
  const double scale = std::min(1.0, static_cast<double>(kSheetWidth) / picture.cols);
  const cv::Size size(std::max(1, cvRound(picture.cols * scale)), std::max(1, cvRound(picture.rows * scale)));
  const auto reduced = [&](const cv::Mat& image, int how) {
    cv::Mat out;
    cv::resize(image, out, size, 0, 0, how);
    return out;
  };
  const cv::Mat small = reduced(picture, cv::INTER_AREA), fraction = reduced(alpha, cv::INTER_AREA);
  cv::Mat grey, marked, matte;
  cv::cvtColor(fraction, matte, cv::COLOR_GRAY2BGR);
  cv::cvtColor(small, grey, cv::COLOR_BGR2GRAY);
  cv::cvtColor(grey / 2 + 64, marked, cv::COLOR_GRAY2BGR);
  marked.setTo(cv::Scalar(40, 40, 230), reduced(marks == kBackground, cv::INTER_AREA) > 64);
  marked.setTo(cv::Scalar(40, 220, 40), reduced(marks == kFluid, cv::INTER_AREA) > 64);
  const cv::Mat gap(size.height, kGap, CV_8UC3, cv::Scalar::all(255));
  cv::Mat sheet;
  cv::hconcat(std::vector<cv::Mat>{small, gap, marked, gap, matte, gap, cut_out(small, fraction)}, sheet);
  cv::copyMakeBorder(sheet, sheet, 0, kLegend, 0, 0, cv::BORDER_CONSTANT, cv::Scalar::all(255));
  const std::array kLegends{"the picture", "marks: green fluid, red background", "the matte",
                            "the fluid, cut out"};
  for (int i = 0; i < static_cast<int>(kLegends.size()); ++i)
    cv::putText(sheet, kLegends[static_cast<std::size_t>(i)],
                {i * (size.width + kGap) + 2, size.height + kLegend - 6}, cv::FONT_HERSHEY_SIMPLEX, 0.4,
                cv::Scalar::all(0), 1, cv::LINE_AA);
  return sheet;
}

}  // namespace freshet::synth::matte
