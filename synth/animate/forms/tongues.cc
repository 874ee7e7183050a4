#include "synth/animate/forms/tongues.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "synth/animate/forms/light_level.h"

namespace freshet::synth::animate {
namespace {

constexpr std::array kShining{0.1f, 0.2f, 0.35f, 0.5f,
                              0.7f};  // levels: a tongue may stand in light of its own
constexpr int kLeastArea = 12;        // px: what is smaller is a spark
constexpr double kLeastPart = 0.1;    // of all light
constexpr double kThin = 0.5;         // of the radius that a body holds
constexpr double kSmooth = 0.12;      // of its mean level, how far that varies inside a tongue
constexpr std::size_t kLooks = 8;     // frames of a clip that tell whether its flame is a tongue
constexpr double kUpper = 0.4;        // of a body: nothing crosses it there
constexpr double kEdge = 0.25;        // of a tongue's width
constexpr double kAxisSide =
    3.0;  // frames: over which a course is smoothed, its sampling noise being a pixel's
constexpr double kLowest = 0.6, kHighest = 1.6;
constexpr int kHeights = 8;       // of a body, at which its speed is read
constexpr double kCutOff = 0.05;  // of sways, how many may be cut off at their bounds

double median_of(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

/// Where a flame's axis goes aside, and its height, in px; its light may be 0.
struct Stance {
  double lean = 0, bow = 0, height = 0;
};

Sway bounded(double lean, double bow, double stretch) {
  return {std::clamp(lean, -kMostSway, kMostSway), std::clamp(bow, -kMostSway, kMostSway),
          std::clamp(stretch, kLowest, kHighest)};
}

Stance stance_of(const cv::Mat& level, const Seat& seat) {
  const int left = static_cast<int>(seat.first), right = static_cast<int>(seat.last);
  const int bed = std::clamp(static_cast<int>(std::lround(seat.bed)), 0, level.rows - 1);
  std::vector<double> light(bed + 1, 0.0), centre(bed + 1, 0.0);
  double all = 0;
  for (int y = 0; y <= bed; ++y) {
    for (int x = left; x < right; ++x) {
      const double l = light_of(level.at<std::uint8_t>(y, x) / 255.0f);
      light[y] += l;
      centre[y] += l * x;
    }
    if (light[y] > 0) centre[y] /= light[y];
    all += light[y];
  }
  if (all <= 0) return {};
  int top = 0;
  for (double above = 0; top < bed && above + light[top] < all / 40; ++top) above += light[top];
  const double height = std::max(1, bed - top);
  // centre = foot + lean up + bow up^2, by least squares.
  cv::Matx33d products = cv::Matx33d::zeros();
  cv::Vec3d sums(0, 0, 0), axis;
  for (int y = top; y <= bed; ++y) {
    const double up = (bed - y) / height;
    const cv::Vec3d row(1, up, up * up);
    products += light[y] * row * row.t();
    sums += light[y] * centre[y] * row;
  }
  if (!cv::solve(products, sums, axis, cv::DECOMP_CHOLESKY)) return {0, 0, height};
  return {axis[1], axis[2], height};
}

void smooth(std::vector<double>& values) {
  cv::Mat row(1, static_cast<int>(values.size()), CV_64F, values.data());
  cv::Mat out;
  cv::GaussianBlur(row, out, {0, 1}, 0.5 * kAxisSide, 0, cv::BORDER_REFLECT);
  out.copyTo(row);
}

/// Opening by a disc. Cost: two distance transforms, whatever its radius.
cv::Mat opened(const cv::Mat& inside, double radius) {
  cv::Mat out;
  cv::distanceTransform(inside <= radius, out, cv::DIST_L2, 5);
  return out <= radius;
}

/// A part without what is thin: a rim that crosses a flame, or what is lit around it.
cv::Mat body_of(const cv::Mat& part) {
  cv::Mat inside, pieces, shape, centres;
  cv::distanceTransform(part, inside, cv::DIST_L2, 5);
  double radius = 0;
  cv::minMaxLoc(inside, nullptr, &radius);
  const int count =
      cv::connectedComponentsWithStats(opened(inside, kThin * radius), pieces, shape, centres, 8, CV_32S);
  int largest = 0;
  for (int i = 1; i < count; ++i)
    if (largest == 0 || shape.at<int>(i, cv::CC_STAT_AREA) > shape.at<int>(largest, cv::CC_STAT_AREA))
      largest = i;
  if (largest == 0) return part;
  // Its tip and its foot are thin, too.
  const cv::Mat body = pieces == largest;
  const cv::Rect box = cv::boundingRect(body);
  cv::Mat allowed = body.clone();
  allowed.rowRange(0, box.y + static_cast<int>(kUpper * box.height)).setTo(255);
  allowed(cv::Rect(box.x, box.y, box.width, part.rows - box.y)).setTo(255);
  cv::connectedComponents(part & allowed, pieces, 8, CV_32S);
  cv::Point in;
  cv::minMaxLoc(body, nullptr, nullptr, nullptr, &in);
  return pieces == pieces.at<int>(in);
}

/// How far the level of a body varies inside of its rim, of its mean.
double roughness(const cv::Mat& level, const cv::Mat& body) {
  cv::Mat inside;
  cv::distanceTransform(body, inside, cv::DIST_L2, 5);
  double radius = 0;
  cv::minMaxLoc(inside, nullptr, &radius);
  cv::Scalar mean, deviation;
  cv::meanStdDev(level, mean, deviation, inside > 0.5 * radius);
  return mean[0] > 0 ? deviation[0] / mean[0] : 0;
}

/// Upright, as long as it has to be for its width.
bool is_slender(const cv::Mat& body) {
  std::vector<cv::Point> points;
  cv::findNonZero(body, points);
  const cv::RotatedRect box = cv::minAreaRect(points);
  const cv::Rect upright = cv::boundingRect(points);
  return upright.height > upright.width &&
         std::max(box.size.width, box.size.height) >= kSlender * std::min(box.size.width, box.size.height);
}

bool is_solid(const cv::Mat& core, int area) {
  std::vector<std::vector<cv::Point>> outline;
  cv::findContours(core, outline, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  std::vector<cv::Point> hull;
  cv::convexHull(outline.front(), hull);
  cv::Mat filled = cv::Mat::zeros(core.size(), CV_8U);
  cv::fillConvexPoly(filled, hull, 1);
  return area >= kSolid * cv::countNonZero(filled);
}

double lit(const cv::Mat& light, const cv::Mat& where) {
  return cv::mean(light, where)[0] * cv::countNonZero(where);
}

/// The lowest row of a body above which it is whole: what burns beside a wick stands as the wick does.
int foot_of(const cv::Mat& core, const cv::Rect& box) {
  for (int y = box.y + static_cast<int>(kUpper * box.height); y < box.br().y; ++y) {
    const cv::Mat row = core.row(y);
    const int shining = cv::countNonZero(row);
    if (shining > 0 && cv::boundingRect(row).width > shining) return y;
  }
  return box.br().y;
}

/// Parts that have so much light.
std::vector<int> bright(const cv::Mat& parts, int count, const cv::Mat& light, double least) {
  std::vector<double> lit(count, 0.0);
  for (int y = 0; y < parts.rows; ++y)
    for (int x = 0; x < parts.cols; ++x) lit[parts.at<int>(y, x)] += light.at<float>(y, x);
  std::vector<int> out;
  for (int i = 1; i < count; ++i)
    if (lit[i] >= least) out.push_back(i);
  return out;
}

Tongue tongue_of(const cv::Mat& core) {
  const cv::Rect box = cv::boundingRect(core);
  const int around = static_cast<int>(std::ceil(2 * kMostSway * box.height)) + box.width,
            foot = foot_of(core, box);
  Tongue tongue{
      .box = cv::Rect(box.x - around, box.y - around, box.width + 2 * around, box.height + 2 * around) &
             cv::Rect({}, core.size()),
      .share = {},
      .foot = 0,
      .height = static_cast<double>(foot - box.y)};
  tongue.foot = foot - tongue.box.y;
  return tongue;
}

/// Its own edge is a tongue's; what glows beyond it, as far as it is wide, unless that is nearer to what else burns.
cv::Mat share_of(const std::vector<cv::Mat>& cores, std::size_t own, const cv::Mat& level,
                 const cv::Rect& box) {
  const cv::Mat core = cores[own](box);
  const double width = cv::countNonZero(core) / static_cast<double>(cv::boundingRect(core).height);
  cv::Mat mine, others, theirs;
  cv::distanceTransform(core == 0, mine, cv::DIST_L2, 5);
  others = (level(box) > kShining.front()) & (mine > kEdge * width);
  for (std::size_t i = 0; i < cores.size(); ++i)
    if (i != own) cv::bitwise_or(others, cores[i](box), others);
  cv::distanceTransform(others == 0, theirs, cv::DIST_L2, 5);
  cv::Mat share(box.size(), CV_32F);
  for (int y = 0; y < box.height; ++y)
    for (int x = 0; x < box.width; ++x) {
      const double near = mine.at<float>(y, x) / width, other = theirs.at<float>(y, x) / width;
      share.at<float>(y, x) =
          static_cast<float>(std::clamp(1 + other - near, 0.0, 1.0) * std::clamp(2 - near, 0.0, 1.0));
    }
  return share;
}

}  // namespace

std::vector<Tongue> tongues_of(const cv::Mat& level) {
  const cv::Mat light = light_of(level);
  const double all = cv::sum(light)[0];
  std::vector<Tongue> tongues;
  std::vector<cv::Mat> cores;  // CV_8U
  cv::Mat taken = cv::Mat::zeros(level.size(), CV_8U), parts, shape, centres;
  for (const float from : kShining) {
    const int count = cv::connectedComponentsWithStats(level > from, parts, shape, centres, 8, CV_32S);
    for (const int i : bright(parts, count, light, kLeastPart * all)) {
      const cv::Rect around =
          cv::Rect(shape.at<int>(i, cv::CC_STAT_LEFT) - 1, shape.at<int>(i, cv::CC_STAT_TOP) - 1,
                   shape.at<int>(i, cv::CC_STAT_WIDTH) + 2, shape.at<int>(i, cv::CC_STAT_HEIGHT) + 2) &
          cv::Rect({}, level.size());
      const cv::Mat body = body_of(parts(around) == i);
      const int area = cv::countNonZero(body);
      const double part = lit(light(around), body) / all;
      if (area < kLeastArea || !is_slender(body) || !is_solid(body, area) ||
          cv::countNonZero(body & taken(around)) > 0 || part < kLeastPart ||
          roughness(level(around), body) > kSmooth)
        continue;
      cv::Mat core = cv::Mat::zeros(level.size(), CV_8U);
      body.copyTo(core(around));
      cv::bitwise_or(taken, core, taken);
      cores.push_back(core);
      tongues.push_back(tongue_of(core));
    }
  }
  for (std::size_t i = 0; i < tongues.size(); ++i)
    tongues[i].share = share_of(cores, i, level, tongues[i].box);
  return tongues;
}

double share_of_light(const std::vector<Tongue>& tongues, const cv::Mat& level) {
  const cv::Mat light = light_of(level);
  cv::Mat of_tongues = cv::Mat::zeros(level.size(), CV_32F), lit_by = cv::Mat::zeros(level.size(), CV_8U);
  for (const Tongue& tongue : tongues) {
    cv::Mat share = of_tongues(tongue.box);
    cv::max(share, tongue.share, share);
    const int foot = tongue.box.y + static_cast<int>(tongue.foot);
    const cv::Rect below(tongue.box.x, foot, tongue.box.width, tongue.box.br().y - foot);
    if (below.empty()) continue;
    const cv::Mat body = level(below) > kShining.front();
    if (cv::countNonZero(body) > 0 && roughness(level(below), body) <= kSmooth)
      lit_by(below).setTo(255, body);
  }
  const double all = cv::sum(light)[0] - lit(light, lit_by);
  of_tongues.setTo(0, lit_by);
  return all > 0 ? std::min(1.0, light.dot(of_tongues) / all) : 0;
}

cv::Mat swayed(const cv::Mat& light, const Tongue& tongue, const Sway& sway) {
  cv::Mat map(light.size(), CV_32FC2), out;
  for (int y = 0; y < light.rows; ++y) {
    // Below its foot it stands.
    const double up = std::max(0.0, (tongue.foot - (y + 0.5)) / tongue.height) / sway.stretch;
    const double aside = tongue.height * up * (sway.lean + up * sway.bow);
    const double row = up > 0 ? tongue.foot - up * tongue.height - 0.5 : y;
    for (int x = 0; x < light.cols; ++x)
      map.at<cv::Vec2f>(y, x) = {static_cast<float>(x - aside), static_cast<float>(row)};
  }
  cv::remap(light, out, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return out;
}

Sway TongueCourse::at(double seconds) const {
  const double last = static_cast<double>(sways.size() - 1);
  if (last == 0) return sways.front();
  double at = std::fmod(std::max(0.0, seconds) * fps, 2 * last);
  if (at > last) at = 2 * last - at;
  const auto first = std::min(static_cast<std::size_t>(at), sways.size() - 2);
  const double more = at - static_cast<double>(first);
  const Sway &a = sways[first], &b = sways[first + 1];
  return {a.lean + more * (b.lean - a.lean), a.bow + more * (b.bow - a.bow),
          a.stretch + more * (b.stretch - a.stretch)};
}

double TongueCourse::unrest() const {
  double sum = 0;
  for (std::size_t i = 1; i < sways.size(); ++i) {
    const Sway &a = sways[i - 1], &b = sways[i];
    sum += std::abs(b.lean - a.lean) + std::abs(b.bow - a.bow) + std::abs(b.stretch - a.stretch);
  }
  return fps * sum / static_cast<double>(sways.size());
}

double TongueCourse::speed() const {
  if (sways.size() < 2) return 0;
  double sum = 0;
  for (std::size_t i = 1; i < sways.size(); ++i) {
    const Sway &a = sways[i - 1], &b = sways[i];
    for (int k = 0; k < kHeights; ++k) {
      const double up = (k + 0.5) / kHeights;
      sum += std::hypot(up * (b.lean - a.lean + up * (b.bow - a.bow)), up * (b.stretch - a.stretch));
    }
  }
  return fps * sum / static_cast<double>(kHeights * (sways.size() - 1));
}

namespace {

TongueCourse widened(TongueCourse course, double times) {
  for (Sway& sway : course.sways)
    sway = bounded(times * sway.lean, times * sway.bow, 1 + times * (sway.stretch - 1));
  return course;
}

/// Factor by which all sways but kCutOff of them can grow within their bounds.
double room_of(const TongueCourse& course) {
  std::vector<double> rooms;
  for (const Sway& sway : course.sways) {
    const double taller = sway.stretch - 1;
    double room = kMostSway / std::max({std::abs(sway.lean), std::abs(sway.bow), 1e-9});
    if (taller != 0) room = std::min(room, ((taller > 0 ? kHighest : kLowest) - 1) / taller);
    rooms.push_back(room);
  }
  const auto cut = rooms.begin() + static_cast<std::ptrdiff_t>(kCutOff * static_cast<double>(rooms.size()));
  std::ranges::nth_element(rooms, cut);
  return *cut;
}

}  // namespace

TongueCourse halfway_to_usual(TongueCourse course) {
  const double unrest = course.unrest();
  return widened(std::move(course), unrest > 0 ? std::sqrt(kUsualUnrest / unrest) : 1);
}

TongueCourse as_fast_as(TongueCourse course, double speed) {
  const double now = course.speed();
  if (now <= 0) return course;
  course = widened(std::move(course), std::min(speed / now, room_of(course)));
  const double then = course.speed();
  if (speed > then && then > 0) course.fps *= std::min(speed / then, kQuickest);
  return course;
}

namespace {

/// Of kLooks frames, in how many the clip has a tongue.
double tongue_share(const ClipForms& forms) {
  const std::size_t looks = std::min(forms.levels.size(), kLooks);
  std::size_t are = 0;
  for (std::size_t i = 0; i < looks; ++i) {
    cv::Mat level;
    forms.levels[i * forms.levels.size() / looks].convertTo(level, CV_32F, 1.0 / 255);
    are += tongues_of(level).empty() ? 0 : 1;
  }
  return static_cast<double>(are) / static_cast<double>(looks);
}

}  // namespace

std::optional<TongueCourse> course_of(const ClipForms& forms) {
  // Where there are several seats, all of them together come last.
  const std::size_t seats = forms.seats.size() > 1 ? forms.seats.size() - 1 : forms.seats.size();
  if (seats == 0 || forms.levels.empty()) return std::nullopt;
  const auto end = forms.seats.begin() + static_cast<std::ptrdiff_t>(seats);
  const Seat& seat = *std::max_element(forms.seats.begin(), end,
                                       [](const Seat& a, const Seat& b) { return a.share < b.share; });
  std::vector<double> leans, bows, heights;
  for (const cv::Mat& level : forms.levels) {
    const Stance stance = stance_of(level, seat);
    leans.push_back(stance.lean);
    bows.push_back(stance.bow);
    heights.push_back(stance.height);
  }
  const double lean = median_of(leans), bow = median_of(bows), height = median_of(heights);
  if (height <= 0) return std::nullopt;
  for (std::vector<double>* values : {&leans, &bows, &heights}) smooth(*values);
  TongueCourse course{.clip = forms.clip, .fps = forms.fps, .sways = {}, .tongue = tongue_share(forms)};
  for (std::size_t i = 0; i < leans.size(); ++i)
    course.sways.push_back(
        bounded((leans[i] - lean) / height, (bows[i] - bow) / height, heights[i] / height));
  return course;
}

}  // namespace freshet::synth::animate
