#include "synth/animate/frame_sheet.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "report/sheet_words.h"

namespace freshet::synth::animate {
namespace {

constexpr int kColumns = 3, kGap = 4;

}  // namespace

FrameSheet::FrameSheet(const cv::Mat& picture, const cv::Mat& matte, int frames, const SheetOptions& options)
    : options_(options),
      region_(report::shown_region(matte)),
      picture_(picture.size()),
      frames_(frames),
      shown_(std::min(options.shown, frames)) {
  cells_.push_back({reduced(picture), "the picture"});
}

cv::Mat FrameSheet::reduced(const cv::Mat& picture) const {
  const int width = std::min(options_.width_px, region_.width);
  const int height = std::max(1, static_cast<int>(std::lround(1.0 * region_.height * width / region_.width)));
  cv::Mat out;
  cv::resize(picture(region_), out, {width, height}, 0, 0, cv::INTER_AREA);
  return out;
}

void FrameSheet::add(const cv::Mat& frame) {
  const int next = static_cast<int>(cells_.size()) - 1;
  if (next < shown_ && seen_ == next * frames_ / shown_)
    cells_.push_back(
        {reduced(frame), fmt::format("frame {}, {:.2f} s", options_.first_number + options_.first + seen_,
                                     (options_.first + seen_) / options_.fps)});
  ++seen_;
}

cv::Mat FrameSheet::draw() const {
  const int rows = (static_cast<int>(cells_.size()) + kColumns - 1) / kColumns;
  const cv::Size cell = cells_[0].picture.size();
  const int step = cell.height + report::kSheetLine + kGap;
  cv::Mat sheet(rows * step + kGap, kColumns * (cell.width + kGap) + kGap, CV_8UC3,
                cv::Scalar::all(report::kSheetPaper));
  for (int i = 0; i < static_cast<int>(cells_.size()); ++i) {
    const cv::Point corner(kGap + i % kColumns * (cell.width + kGap), kGap + i / kColumns * step);
    cells_[static_cast<std::size_t>(i)].picture.copyTo(sheet(cv::Rect(corner, cell)));
    report::write_caption(sheet, cells_[static_cast<std::size_t>(i)].words,
                          corner + cv::Point(2, cell.height + report::kSheetLine - 5), cell.width - 2);
  }
  return report::with_legend(
      sheet, {fmt::format("The picture, then {} of {} frames, evenly spread.", cells_.size() - 1, frames_),
              report::crop_words(region_, picture_)});
}

}  // namespace freshet::synth::animate
