// report/sheet_words.h — sheets that a person looks at: what of a picture they show, captions, a legend below.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::report {

inline constexpr int kSheetLine = 18;                    // px from one line of words to the next
inline constexpr int kSheetPaper = 32, kSheetInk = 220;  // greys of a sheet's ground and of words

/// Words in one line, in the sheet's upright letters: smaller where they would not fit, and cut where even that does
/// not help, with three dots. What is no ASCII is drawn as "?".
/// at   the line's left end, at its foot. width   px that it may take.
void write_caption(cv::Mat& sheet, const std::string& text, cv::Point at, int width);

/// What of a picture a sheet shows: where a mask is above 0, and a twelfth of that around it; of an empty mask all.
/// mask   CV_8U.
cv::Rect shown_region(const cv::Mat& mask);
/// "Cropped to the matte: 120 x 90 px at 40, 30 of 640 x 480."; empty where all is shown.
std::string crop_words(const cv::Rect& region, cv::Size picture);

/// The sheet, CV_8UC3, with these words below it, in lines as long as it is wide. An empty sheet stays empty.
cv::Mat with_legend(const cv::Mat& sheet, const std::vector<std::string>& paragraphs);

}  // namespace freshet::report
