#include "synth/matte/marks.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"

namespace freshet::synth::matte {
namespace {

constexpr int kNearPicture = 24;           // of 255: what an editor's or a JPEG's rounding may change
constexpr double kMinPaintedOver = 0.8;    // of what has no mark's colour, that is the picture
constexpr double kMinLeftToJudge = 0.005;  // of the picture, that has no mark's colour

// White, green, black, red, as pure as an editor's brush leaves them.
Mark mark_of(int blue, int green, int red) {
  if (blue >= 230 && green >= 230 && red >= 230) return kFluid;
  if (green >= 180 && blue <= 90 && red <= 90) return kFluid;
  if (blue <= 25 && green <= 25 && red <= 25) return kBackground;
  if (red >= 180 && blue <= 90 && green <= 90) return kBackground;
  return kUnknown;
}

cv::Rect inside(const cv::Rect2d& box, cv::Size picture) {
  const cv::Rect2d cut = box & cv::Rect2d(0, 0, picture.width, picture.height);
  if (!(cut.width > 0) || !(cut.height > 0)) return {};
  const int left = static_cast<int>(std::floor(cut.x)), top = static_cast<int>(std::floor(cut.y));
  return {left, top, static_cast<int>(std::ceil(cut.x + cut.width)) - left,
          static_cast<int>(std::ceil(cut.y + cut.height)) - top};
}

}  // namespace

Marks read_scribbles(const std::filesystem::path& path, const cv::Mat& picture,
                     std::vector<std::string>* notices) {
  const media::DeepPicture file = media::read_deep_picture(path);
  if (file.values.size() != picture.size())
    throw Error(ErrorKind::kInput, path.string(),
                fmt::format("the scribbles are {} x {} px, the picture {} x {}", file.values.cols,
                            file.values.rows, picture.cols, picture.rows),
                "Draw them on a layer over the picture, so that both have one size");
  const auto value = [&](int y, int x, int channel) { return file.values.at<cv::Vec4w>(y, x)[channel] >> 8; };
  // What each pixel would mean by its colour, and how the drawing was made.
  Marks marks(picture.size(), CV_8U, cv::Scalar(kUnknown));
  cv::Mat is_picture(picture.size(), CV_8U, cv::Scalar(0));
  std::int64_t colourless = 0, colourless_picture = 0;
  bool transparent = false;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      if (value(y, x, 3) < 255) transparent = true;
      if (value(y, x, 3) < 128) continue;
      marks.at<std::uint8_t>(y, x) = mark_of(value(y, x, 0), value(y, x, 1), value(y, x, 2));
      int difference = 0;
      for (int channel = 0; channel < 3; ++channel)
        difference =
            std::max(difference, std::abs(value(y, x, channel) - int{picture.at<cv::Vec3b>(y, x)[channel]}));
      is_picture.at<std::uint8_t>(y, x) = difference <= kNearPicture ? 255 : 0;
      if (marks.at<std::uint8_t>(y, x) != kUnknown) continue;
      ++colourless;
      if (difference <= kNearPicture) ++colourless_picture;
    }
  const bool painted_over =
      !transparent &&
      static_cast<double>(colourless) >= kMinLeftToJudge * static_cast<double>(picture.total()) &&
      static_cast<double>(colourless_picture) >= kMinPaintedOver * static_cast<double>(colourless);
  if (painted_over) marks.setTo(kUnknown, is_picture);
  if (cv::countNonZero(marks) == 0)
    throw Error(ErrorKind::kInput, path.string(), "no stroke in it",
                "Draw white or green where the fluid is, black or red where it is not, on a transparent or "
                "grey ground or over the picture");
  if (notices != nullptr) {
    for (const std::string& notice : file.notices) notices->push_back(notice);
    if (painted_over) notices->push_back("taken as painted over the picture: what equals it is unmarked");
  }
  return marks;
}

void keep_within(Marks& marks, const std::vector<cv::Rect2d>& boxes, const std::string& where) {
  cv::Mat outside(marks.size(), CV_8U, cv::Scalar(255));
  for (const cv::Rect2d& box : boxes) {
    const cv::Rect cut = inside(box, marks.size());
    if (cut.empty())
      throw Error(ErrorKind::kUsage, where,
                  fmt::format("the box {:g},{:g},{:g},{:g} has no area in the picture of {} x {} px", box.x,
                              box.y, box.width, box.height, marks.cols, marks.rows),
                  "Give left, top, width and height in px of the picture");
    outside(cut).setTo(0);
  }
  marks.setTo(kBackground, outside & (marks == kUnknown));
}

void lay_over(Marks& below, const Marks& above) { above.copyTo(below, above != kUnknown); }

}  // namespace freshet::synth::matte
