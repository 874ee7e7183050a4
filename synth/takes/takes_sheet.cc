#include "synth/takes/takes_sheet.h"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "report/sheet_words.h"

namespace freshet::synth::takes {
namespace {

constexpr int kMoments = 5, kGap = 4;  // frames of a row, px between them

}  // namespace

cv::Mat takes_sheet(const Trial& trial) {
  const judging::Evidence& first = trial.takes.front().film;
  const cv::Rect region = report::shown_region(first.matte());
  const int width = kMoments * (region.width + kGap), height = region.height + report::kSheetLine + kGap;
  cv::Mat sheet(height * static_cast<int>(trial.takes.size()), width, CV_8UC3,
                cv::Scalar::all(report::kSheetPaper));
  for (std::size_t i = 0; i < trial.takes.size(); ++i) {
    const JudgedTake& take = trial.takes[i];
    const int top = static_cast<int>(i) * height;
    for (int m = 0; m < kMoments && take.film.count() > 0; ++m) {
      const int frame = m * (take.film.count() - 1) / (kMoments - 1);
      take.film.frames()[static_cast<std::size_t>(frame)](region).copyTo(
          sheet(cv::Rect(m * (region.width + kGap), top, region.width, region.height)));
    }
    if (i == trial.best) cv::rectangle(sheet, cv::Rect(0, top, width - kGap, region.height), {0, 200, 0}, 2);
    const std::string figures =
        take.failed.empty() ? fmt::format(", faults {:.1f}", take.verdict.faults) : "";
    report::write_caption(sheet, fmt::format("{}{}: {}", take.take.name, figures, why(trial, i)),
                          {2, top + region.height + report::kSheetLine - 3}, width - 4);
  }
  return sheet;
}

cv::Mat with_takes(const cv::Mat& sheet, const Trial& trial) {
  const cv::Mat takes = takes_sheet(trial);
  cv::Mat both(sheet.rows + takes.rows, std::max(sheet.cols, takes.cols), CV_8UC3,
               cv::Scalar::all(report::kSheetPaper));
  sheet.copyTo(both(cv::Rect({0, 0}, sheet.size())));
  takes.copyTo(both(cv::Rect({0, sheet.rows}, takes.size())));
  return both;
}

}  // namespace freshet::synth::takes
