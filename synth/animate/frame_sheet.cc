#include "synth/animate/frame_sheet.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {
namespace {

constexpr int kColumns = 3, kGap = 4, kLine = 18;
constexpr double kMargin = 0.08;  // around the fluid, of its longer side

/// The fluid and some of what lies around it.
cv::Rect around(const cv::Mat& matte) {
  const cv::Rect whole({}, matte.size()), fluid = cv::boundingRect(matte);
  if (fluid.empty()) return whole;
  const int margin = static_cast<int>(std::lround(kMargin * std::max(fluid.width, fluid.height)));
  return cv::Rect(fluid.x - margin, fluid.y - margin, fluid.width + 2 * margin, fluid.height + 2 * margin) &
         whole;
}

void write(cv::Mat& sheet, const std::string& text, const cv::Point& at) {
  cv::putText(sheet, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.4, cv::Scalar::all(220), 1, cv::LINE_AA);
}

}  // namespace

FrameSheet::FrameSheet(const cv::Mat& picture, const cv::Mat& matte, int frames, const SheetOptions& options)
    : options_(options),
      region_(around(matte)),
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
    cells_.push_back({reduced(frame), fmt::format("frame {}, {:.2f} s", options_.first_number + seen_,
                                                  seen_ / options_.fps)});
  ++seen_;
}

cv::Mat FrameSheet::draw() const {
  constexpr int kLegend = 2 * kLine;
  const int rows = (static_cast<int>(cells_.size()) + kColumns - 1) / kColumns;
  const cv::Size cell = cells_[0].picture.size();
  const int step = cell.height + kLine + kGap;
  cv::Mat sheet(rows * step + kGap + kLegend, kColumns * (cell.width + kGap) + kGap, CV_8UC3,
                cv::Scalar::all(32));
  for (int i = 0; i < static_cast<int>(cells_.size()); ++i) {
    const cv::Point corner(kGap + i % kColumns * (cell.width + kGap), kGap + i / kColumns * step);
    cells_[static_cast<std::size_t>(i)].picture.copyTo(sheet(cv::Rect(corner, cell)));
    write(sheet, cells_[static_cast<std::size_t>(i)].words, corner + cv::Point(2, cell.height + kLine - 5));
  }
  const int below = rows * step + kGap;
  write(sheet, fmt::format("The picture, then {} of {} frames, evenly spread.", cells_.size() - 1, frames_),
        {kGap + 2, below + kLine - 5});
  if (region_.size() != picture_)
    write(sheet,
          fmt::format("Cropped to the matte: {} x {} px at {}, {} of {} x {}.", region_.width, region_.height,
                      region_.x, region_.y, picture_.width, picture_.height),
          {kGap + 2, below + 2 * kLine - 5});
  return sheet;
}

}  // namespace freshet::synth::animate
