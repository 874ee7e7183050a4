#include "synth/matte/hard_region.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "synth/matte/pass_height.h"

namespace freshet::synth::matte {
namespace {

constexpr int kPassSide = 320;  // px, the longer side of the copy on which ways from the marks are looked for
constexpr int kMinSamples = 16;  // of a side: OpenCV clusters each side's colours in five

// Each pixel of the smaller picture is marked as any of the pixels that it stands for is, so that a thin
// stroke survives; where both are, by the more.
Marks reduce(const Marks& marks, cv::Size size) {
  if (marks.size() == size) return marks.clone();
  cv::Mat fluid, background;
  cv::Mat(marks == kFluid).convertTo(fluid, CV_32F);
  cv::Mat(marks == kBackground).convertTo(background, CV_32F);
  cv::resize(fluid, fluid, size, 0, 0, cv::INTER_AREA);
  cv::resize(background, background, size, 0, 0, cv::INTER_AREA);
  Marks out(size, CV_8U, cv::Scalar(kUnknown));
  out.setTo(kBackground, background > 0);
  out.setTo(kFluid, (fluid > 0) & (fluid >= background));
  return out;
}

// The side's marks grow into what is unknown until there are enough of them to learn colours from.
void grow(Marks& marks, Mark side) {
  for (int count = cv::countNonZero(marks == side); count < kMinSamples;) {
    cv::Mat wider;
    cv::dilate(marks == side, wider, cv::Mat());
    marks.setTo(side, wider & (marks == kUnknown));
    const int now = cv::countNonZero(marks == side);
    if (now == count) return;
    count = now;
  }
}

// GrabCut's labels from marks.
cv::Mat labels_of(const Marks& marks, int unknown) {
  cv::Mat labels(marks.size(), CV_8U, cv::Scalar(unknown));
  labels.setTo(cv::GC_BGD, marks == kBackground);
  labels.setTo(cv::GC_FGD, marks == kFluid);
  return labels;
}

// The marked pixels alone, in a row: the colours of both sides are learned from them.
void learn_colours(const cv::Mat& picture, const Marks& marks, cv::Mat& background, cv::Mat& fluid) {
  std::vector<cv::Vec3b> colours;
  std::vector<std::uint8_t> sides;
  for (int y = 0; y < marks.rows; ++y)
    for (int x = 0; x < marks.cols; ++x) {
      const std::uint8_t mark = marks.at<std::uint8_t>(y, x);
      if (mark == kUnknown) continue;
      colours.push_back(picture.at<cv::Vec3b>(y, x));
      sides.push_back(mark == kFluid ? cv::GC_FGD : cv::GC_BGD);
    }
  cv::Mat row = cv::Mat(colours, true).reshape(3, 1), labels = cv::Mat(sides, true).reshape(1, 1);
  cv::grabCut(row, labels, {}, background, fluid, 0, cv::GC_INIT_WITH_MASK);
}

// Islands smaller than `min_area` px that hold no mark of fluid, and holes without one of background.
void drop_specks(cv::Mat& region, const Marks& marks, double min_area) {
  for (const bool holes : {false, true}) {
    cv::Mat parts, statistics, centres;
    const int count = cv::connectedComponentsWithStats(holes ? cv::Mat(~region) : region, parts, statistics,
                                                       centres, 8, CV_32S);
    std::vector<char> keep(static_cast<std::size_t>(count), 0);
    for (int i = 0; i < count; ++i)
      keep[static_cast<std::size_t>(i)] = statistics.at<int>(i, cv::CC_STAT_AREA) >= min_area;
    const Mark own = holes ? kBackground : kFluid;
    for (int y = 0; y < region.rows; ++y)
      for (int x = 0; x < region.cols; ++x)
        if (marks.at<std::uint8_t>(y, x) == own) keep[static_cast<std::size_t>(parts.at<int>(y, x))] = 1;
    for (int y = 0; y < region.rows; ++y)
      for (int x = 0; x < region.cols; ++x) {
        const int part = parts.at<int>(y, x);
        if (part != 0 && !keep[static_cast<std::size_t>(part)])
          region.at<std::uint8_t>(y, x) = holes ? 255 : 0;
      }
  }
}

// What is reached from the marks of background over less than half of what lies on any way from those of fluid. Empty:
// nothing.
cv::Mat beyond_passes(const cv::Mat& picture, const Marks& marks, const cv::Mat& region) {
  const double scale = std::min(1.0, static_cast<double>(kPassSide) / std::max(picture.cols, picture.rows));
  const cv::Size size(std::max(1, cvRound(picture.cols * scale)), std::max(1, cvRound(picture.rows * scale)));
  cv::Mat small;
  cv::resize(picture, small, size, 0, 0, cv::INTER_AREA);
  const Marks small_marks = reduce(marks, size);
  const cv::Mat relief = steepness(small);
  cv::Mat beyond =
      pass_heights(relief, small_marks == kBackground) < 0.5 * pass_heights(relief, small_marks == kFluid);
  cv::resize(beyond, beyond, picture.size(), 0, 0, cv::INTER_NEAREST);
  beyond &= region;
  return cv::countNonZero(beyond) > 0 ? beyond : cv::Mat();
}

// Islands that hold no mark of fluid and lie farther than `reach` px from every one that does. Returns whether there
// were any.
bool drop_far_islands(cv::Mat& region, const Marks& marks, double reach) {
  cv::Mat parts;
  const int count = cv::connectedComponents(region, parts, 8, CV_32S);
  std::vector<char> marked(static_cast<std::size_t>(count), 0);
  for (int y = 0; y < region.rows; ++y)
    for (int x = 0; x < region.cols; ++x)
      if (marks.at<std::uint8_t>(y, x) == kFluid) marked[static_cast<std::size_t>(parts.at<int>(y, x))] = 1;
  marked[0] = 0;
  if (std::ranges::count(marked, 1) == 0) return false;
  cv::Mat elsewhere(region.size(), CV_8U), distance;
  for (int y = 0; y < region.rows; ++y)
    for (int x = 0; x < region.cols; ++x)
      elsewhere.at<std::uint8_t>(y, x) = marked[static_cast<std::size_t>(parts.at<int>(y, x))] ? 0 : 1;
  cv::distanceTransform(elsewhere, distance, cv::DIST_L2, cv::DIST_MASK_5);
  std::vector<char> near = marked;
  for (int y = 0; y < region.rows; ++y)
    for (int x = 0; x < region.cols; ++x)
      if (distance.at<float>(y, x) <= reach) near[static_cast<std::size_t>(parts.at<int>(y, x))] = 1;
  bool any = false;
  for (int y = 0; y < region.rows; ++y)
    for (int x = 0; x < region.cols; ++x)
      if (const int part = parts.at<int>(y, x); part != 0 && !near[static_cast<std::size_t>(part)]) {
        region.at<std::uint8_t>(y, x) = 0;
        any = true;
      }
  return any;
}

// OpenCV clusters colours from random starts of the calling thread's generator: always the same ones here.
class FixedRandom {
 public:
  FixedRandom() : before_(cv::theRNG()) { cv::theRNG() = cv::RNG(20111); }
  ~FixedRandom() { cv::theRNG() = before_; }
  FixedRandom(const FixedRandom&) = delete;
  FixedRandom& operator=(const FixedRandom&) = delete;

 private:
  cv::RNG before_;
};

}  // namespace

cv::Mat hard_region(const cv::Mat& picture, const Marks& marks, const RegionOptions& options,
                    const std::string& where, std::vector<std::string>* notices) {
  const auto note = [&](const char* text) {
    if (notices != nullptr) notices->emplace_back(text);
  };
  Marks complete = marks.clone();
  const bool fluid_marked = cv::countNonZero(marks == kFluid) > 0;
  const bool background_marked = cv::countNonZero(marks == kBackground) > 0;
  if (!fluid_marked && !background_marked)
    throw Error(ErrorKind::kInput, where, "nothing is marked", "Mark where the fluid is and where it is not");
  if (!background_marked) {
    note("no background is marked: the picture's border is taken for it");
    const int rim = std::max(2, std::min(marks.cols, marks.rows) / 50);
    cv::Mat border(marks.size(), CV_8U, cv::Scalar(255));
    if (marks.cols > 2 * rim && marks.rows > 2 * rim)
      border(cv::Rect(rim, rim, marks.cols - 2 * rim, marks.rows - 2 * rim)).setTo(0);
    complete.setTo(kBackground, border & (marks == kUnknown));
    if (cv::countNonZero(complete == kBackground) == 0)
      throw Error(ErrorKind::kInput, where,
                  "the whole border of the picture is marked as fluid, and nothing as background",
                  "Mark some background too, or use the whole picture: no matte is needed for that");
  }
  if (!fluid_marked) {
    if (cv::countNonZero(complete == kUnknown) == 0)
      throw Error(ErrorKind::kInput, where, "the whole picture is marked as background",
                  "Leave out or mark where the fluid is");
    note("no fluid is marked: all that is not background may be fluid");
  }

  // 1. A copy small enough to be cut in bounded time.
  const double scale = std::min(
      1.0, std::sqrt(static_cast<double>(options.max_pixels) / static_cast<double>(picture.total())));
  const cv::Size size(std::max(1, cvRound(picture.cols * scale)), std::max(1, cvRound(picture.rows * scale)));
  cv::Mat small;
  if (size == picture.size())
    small = picture;
  else
    cv::resize(picture, small, size, 0, 0, cv::INTER_AREA);
  Marks small_marks = reduce(complete, size);
  grow(small_marks, kBackground);
  if (fluid_marked) grow(small_marks, kFluid);

  // 2. Colours from the marks alone, one cut with them, then a few that adapt them.
  const FixedRandom fixed;
  cv::Mat background, fluid, labels = labels_of(small_marks, cv::GC_PR_FGD);
  const auto samples = [&](Mark side) { return cv::countNonZero(small_marks == side); };
  const int unknown = samples(kUnknown);
  if (unknown > 0 && fluid_marked && samples(kFluid) >= 5 && samples(kBackground) >= 5) {
    learn_colours(small, small_marks, background, fluid);
    cv::grabCut(small, labels, {}, background, fluid, 1, cv::GC_EVAL_FREEZE_MODEL);
    if (options.iterations > 0)
      cv::grabCut(small, labels, {}, background, fluid, options.iterations, cv::GC_EVAL);
  } else if (unknown >= 5 && samples(kBackground) >= 5) {
    cv::grabCut(small, labels, {}, background, fluid, std::max(3, options.iterations), cv::GC_INIT_WITH_MASK);
  }
  const auto found = [&]() -> cv::Mat { return (labels == cv::GC_FGD) | (labels == cv::GC_PR_FGD); };
  cv::Mat region = found();

  // 3. Colours alone take what is beyond a border too: a sky of the sea's colours. It is cut once more without.
  if (fluid_marked && background_marked) {
    const cv::Mat beyond = beyond_passes(small, small_marks, region);
    if (!beyond.empty()) {
      labels.setTo(cv::GC_BGD, beyond);
      if (!fluid.empty()) cv::grabCut(small, labels, {}, background, fluid, 1, cv::GC_EVAL);
      region = found();
    }
  }
  drop_specks(region, small_marks, options.min_island * static_cast<double>(size.area()));
  if (fluid_marked &&
      drop_far_islands(region, small_marks, options.reach * std::max(size.width, size.height)))
    note("what has the fluid's colours but lies apart from all marks is left out: mark it, if it is fluid");

  // 4. Back to the picture's size, where the marks hold to the pixel.
  if (size != picture.size()) {
    cv::resize(region, region, picture.size(), 0, 0, cv::INTER_LINEAR);
    region = region > 127;
  }
  region.setTo(255, complete == kFluid);
  region.setTo(0, complete == kBackground);
  return region;
}

}  // namespace freshet::synth::matte
