#include "report/sheet_words.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace freshet::report {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX, kEdge = 6;  // px
constexpr double kMargin = 0.08;                            // around what is shown, of its longer side
constexpr double kLetters = 0.4, kSmallLetters = 0.33;

int width_of(const std::string& text, double letters) {
  int baseline = 0;
  return cv::getTextSize(text, kFont, letters, 1, &baseline).width;
}

/// The words of a paragraph in lines of no more than `width` px; a longer word stands alone.
std::vector<std::string> lines_of(const std::string& paragraph, int width) {
  std::vector<std::string> lines;
  std::istringstream words(paragraph);
  std::string line;
  for (std::string word; words >> word;) {
    const std::string longer = line.empty() ? word : line + " " + word;
    if (!line.empty() && width_of(longer, kLetters) > width) {
      lines.push_back(line);
      line = word;
    } else {
      line = longer;
    }
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

}  // namespace

void write_caption(cv::Mat& sheet, const std::string& text, cv::Point at, int width) {
  const double letters = width_of(text, kLetters) > width ? kSmallLetters : kLetters;
  std::string shown = text;
  for (std::size_t kept = text.size(); kept > 0 && width_of(shown, letters) > width;)
    shown = text.substr(0, --kept) + "...";
  cv::putText(sheet, shown, at, kFont, letters, cv::Scalar::all(kSheetInk), 1, cv::LINE_AA);
}

cv::Rect shown_region(const cv::Mat& mask) {
  const cv::Rect whole({}, mask.size()), shown = cv::boundingRect(mask);
  if (shown.empty()) return whole;
  const int margin = static_cast<int>(std::lround(kMargin * std::max(shown.width, shown.height)));
  return cv::Rect(shown.x - margin, shown.y - margin, shown.width + 2 * margin, shown.height + 2 * margin) &
         whole;
}

std::string crop_words(const cv::Rect& region, cv::Size picture) {
  if (region.size() == picture) return "";
  return fmt::format("Cropped to the matte: {} x {} px at {}, {} of {} x {}.", region.width, region.height,
                     region.x, region.y, picture.width, picture.height);
}

cv::Mat with_legend(const cv::Mat& sheet, const std::vector<std::string>& paragraphs) {
  std::vector<std::string> lines;
  for (const std::string& paragraph : paragraphs)
    for (std::string& line : lines_of(paragraph, sheet.cols - 2 * kEdge)) lines.push_back(std::move(line));
  if (sheet.empty() || lines.empty()) return sheet;
  const int height = static_cast<int>(lines.size()) * kSheetLine + kEdge;
  cv::Mat out;
  cv::copyMakeBorder(sheet, out, 0, height, 0, 0, cv::BORDER_CONSTANT, cv::Scalar::all(kSheetPaper));
  for (std::size_t i = 0; i < lines.size(); ++i)
    write_caption(out, lines[i], {kEdge, sheet.rows + static_cast<int>(i + 1) * kSheetLine - 4},
                  sheet.cols - 2 * kEdge);
  return out;
}

}  // namespace freshet::report
