#include "synth/matte/matte.h"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "report/sheet_words.h"

namespace freshet::synth::matte {
namespace {

constexpr int kSheetWidth = 1280, kGap = 8, kCheck = 16;

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

MadeMatte make_matte(const cv::Mat& picture, const Marks& marks, const MatteOptions& options,
                     const std::string& where, std::stop_token stop) {
  MadeMatte matte;
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
  const cv::Rect region = report::shown_region((alpha > 0) | (marks == kFluid));
  const double scale = std::min(1.0, static_cast<double>(kSheetWidth) / region.width);
  const cv::Size size(std::max(1, cvRound(region.width * scale)),
                      std::max(1, cvRound(region.height * scale)));
  const auto reduced = [&](const cv::Mat& image) {
    cv::Mat out;
    cv::resize(image(region), out, size, 0, 0, cv::INTER_AREA);
    return out;
  };
  const cv::Mat small = reduced(picture), fraction = reduced(alpha);
  cv::Mat grey, marked, matte;
  cv::cvtColor(fraction, matte, cv::COLOR_GRAY2BGR);
  cv::cvtColor(small, grey, cv::COLOR_BGR2GRAY);
  cv::cvtColor(grey / 2 + 64, marked, cv::COLOR_GRAY2BGR);
  marked.setTo(cv::Scalar(40, 40, 230), reduced(marks == kBackground) > 64);
  marked.setTo(cv::Scalar(40, 220, 40), reduced(marks == kFluid) > 64);
  const std::array cells{small, marked, matte, cut_out(small, fraction)};
  const std::array words{"the picture", "marks: green fluid, red beside it", "the matte: white is fluid",
                         "the fluid, cut out"};
  const int step = size.height + report::kSheetLine + kGap;
  cv::Mat sheet(2 * step + kGap, 2 * (size.width + kGap) + kGap, CV_8UC3,
                cv::Scalar::all(report::kSheetPaper));
  for (int i = 0; i < 4; ++i) {
    const cv::Point corner(kGap + i % 2 * (size.width + kGap), kGap + i / 2 * step);
    cells[static_cast<std::size_t>(i)].copyTo(sheet(cv::Rect(corner, size)));
    report::write_caption(sheet, words[static_cast<std::size_t>(i)],
                          corner + cv::Point(2, size.height + report::kSheetLine - 5), size.width - 2);
  }
  return report::with_legend(
      sheet, {report::crop_words(region, picture.size()),
              scale == 1 ? std::string("Full size: a pixel of the sheet is a pixel of the picture.")
                         : fmt::format("Reduced to {:.0f} %.", 100 * scale)});
}

}  // namespace freshet::synth::matte
