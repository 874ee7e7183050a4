#include "synth/judging/verdict_sheet.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "report/sheet_words.h"

namespace freshet::synth::judging {
namespace {

constexpr int kShown = 5;  // findings
constexpr int kColumns = 3;
constexpr double kTint = 0.6;  // of the reddest cell

/// Cells tinted from what is usual (none) to the worst (kTint).
cv::Mat tinted(const cv::Mat& frame, const cv::Mat& cells, double usual, double worst) {
  cv::Mat tint(cells.size(), CV_32F), large;
  for (int y = 0; y < cells.rows; ++y)
    for (int x = 0; x < cells.cols; ++x) {
      const double value = cells.at<float>(y, x);
      const double share = std::isfinite(value) ? (value - usual) / std::max(1e-6, worst - usual) : 0;
      tint.at<float>(y, x) = static_cast<float>(kTint * std::clamp(share, 0.0, 1.0));
    }
  cv::resize(tint, large, frame.size(), 0, 0, cv::INTER_NEAREST);
  cv::Mat out = frame.clone();
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const float t = large.at<float>(y, x);
      auto& pixel = out.at<cv::Vec3b>(y, x);
      pixel = {cv::saturate_cast<std::uint8_t>(pixel[0] * (1 - t)),
               cv::saturate_cast<std::uint8_t>(pixel[1] * (1 - t)),
               cv::saturate_cast<std::uint8_t>(pixel[2] * (1 - t) + 255 * t)};
    }
  return out;
}

}  // namespace

cv::Mat verdict_sheet(const Verdict& verdict, const Evidence& film) {
  std::vector<const Finding*> gravest;
  for (const Finding& finding : verdict.findings)
    if (finding.fault > 0) gravest.push_back(&finding);
  std::ranges::stable_sort(gravest, std::greater<>{}, &Finding::fault);
  if (gravest.size() > kShown) gravest.resize(kShown);

  const cv::Size size = film.size();
  const int cells = 1 + static_cast<int>(gravest.size()), rows = (cells + kColumns - 1) / kColumns;
  const int columns = std::min(cells, kColumns), row_height = size.height + report::kSheetLine + 6;
  cv::Mat sheet(rows * row_height, columns * (size.width + 4), CV_8UC3, cv::Scalar::all(report::kSheetPaper));
  const auto lay = [&](int at, const cv::Mat& picture, const std::string& words) {
    const cv::Point corner((at % kColumns) * (size.width + 4), (at / kColumns) * row_height);
    picture.copyTo(sheet(cv::Rect(corner, size)));
    report::write_caption(sheet, words, corner + cv::Point(2, size.height + report::kSheetLine - 3),
                          size.width - 4);
  };
  lay(0, film.still(), fmt::format("the still; faults of the film: {:.1f}", verdict.faults));
  for (std::size_t i = 0; i < gravest.size(); ++i) {
    const Finding& finding = *gravest[i];
    const Worst worst = worst_of(finding.reading);
    const int spans = std::max(1, static_cast<int>(finding.reading.map.size()));
    const int frame = (2 * worst.span + 1) * film.count() / (2 * spans);
    cv::Mat picture = film.frames()[static_cast<std::size_t>(std::min(frame, film.count() - 1))].clone();
    if (worst.found) {
      const cv::Mat& map = finding.reading.map[static_cast<std::size_t>(worst.span)];
      picture = tinted(picture, map, finding.usual, worst.value);
      const cv::Point low(worst.cell.x * size.width / map.cols, worst.cell.y * size.height / map.rows);
      cv::rectangle(picture, cv::Rect(low, cv::Size(size.width / map.cols, size.height / map.rows)),
                    {0, 255, 255});
    }
    const MeasureWords& words = words_of(finding.measure);
    lay(static_cast<int>(i) + 1, picture,
        fmt::format("{} {:.2f} {} (usual {:.2f}): fault {:.1f}, {:.1f} s", words.name, finding.reading.value,
                    words.unit, finding.usual, finding.fault, frame / film.fps()));
  }
  return report::with_legend(sheet, {verdict_words(verdict, film)});
}

}  // namespace freshet::synth::judging
