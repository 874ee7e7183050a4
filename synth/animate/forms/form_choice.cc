#include "synth/animate/forms/form_choice.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "synth/animate/forms/light_level.h"
#include "vision/dot.h"

namespace freshet::synth::animate {
namespace {

// A seat's canvas, of the seat's box: room for flames that lean and leap, of its height.
constexpr double kAbove = 0.5, kBeside = 0.35, kBelow = 0.12;
constexpr double kNarrowest = 0.75, kWidest = 1.35;  // a form's width, of the width that its height asks for
constexpr double kMeanBlur = 0.06, kFrameBlur = 0.02;  // sigma, of the seat's height
constexpr double kMaxEnlarged = 1.5;                   // beyond it softness shows
constexpr double kCut = 0.7;                           // what a form costs that its frame cuts on all sides
constexpr double kOtherSize = 0.12;                    // what a form of twice the size costs, log2
constexpr double kOtherShape = 0.5;  // what half or twice the width costs that it can have, log2
constexpr double kBusyness = 0.75;   // what twice as busy flames cost, log2
constexpr double kFlames = 0.35,
                 kNoFlames = 0.6;     // as_one: below it a clip's light is all flames, above none
constexpr double kAsOne = 0.35;       // what is left of the fit of one that is none
constexpr int kCanvasRows = 100;      // that a seat's canvas is compared on
constexpr std::size_t kNarrowed = 8;  // best by their means: whose frames are looked at
constexpr double kApart = 0.3;        // of the clip: two seats that share it are so far apart in time

struct Laid {
  std::size_t clip = 0, seat = 0;
  bool mirrored = false;
  double across = 1, down = 1;  // px of the picture a sample of the clip
  double stretched = 1;         // wider than it would have to be, or the other way round: times
  double mean = 0, fit = 0;     // likeness
  std::uint32_t first = 0;
};

double cosine(const cv::Mat& a, const cv::Mat& b) {
  const double aa = vision::dot(a, a), bb = vision::dot(b, b);
  return aa > 0 && bb > 0 ? vision::dot(a, b) / std::sqrt(aa * bb) : 0;
}

cv::Mat blurred(const cv::Mat& level, double sigma) {
  cv::Mat out;
  cv::GaussianBlur(level, out, {}, std::max(sigma, 0.3), 0, cv::BORDER_CONSTANT);
  return out;
}

/// How much goes on inside of flames, whatever their brightness.
double busyness(const cv::Mat& level) {
  cv::Mat across, down;
  cv::Sobel(level, across, CV_32F, 1, 0);
  cv::Sobel(level, down, CV_32F, 0, 1);
  return (cv::norm(across, cv::NORM_L1) + cv::norm(down, cv::NORM_L1) + 1e-6) /
         (cv::norm(level, cv::NORM_L1) + 1e-6);
}

/// Where the picture's seat is compared.
struct Canvas {
  cv::Rect2d rect;  // px of the picture
  double by = 1;    // px of the picture a sample
  cv::Size size;
  cv::Mat level, soft, softer;
};

Canvas canvas_of(const cv::Mat& level, const Seat& seat) {
  Canvas canvas;
  const double h = seat.height(), left = std::max(0.0, seat.left - kBeside * h);
  const double right = std::min<double>(level.cols, seat.right + kBeside * h);
  const double top = std::max(0.0, seat.top - kAbove * h),
               bottom = std::min<double>(level.rows, seat.bed + kBelow * h);
  canvas.rect = {left, top, right - left, bottom - top};
  canvas.by = canvas.rect.height / kCanvasRows;
  canvas.size = {std::clamp(cvRound(canvas.rect.width / canvas.by), 4, 6 * kCanvasRows), kCanvasRows};
  const cv::Rect cut =
      cv::Rect(cvFloor(left), cvFloor(top), cvCeil(right) - cvFloor(left), cvCeil(bottom) - cvFloor(top)) &
      cv::Rect({}, level.size());
  cv::Mat own = level(cut).clone();
  for (int x = 0; x < own.cols; ++x)
    if (cut.x + x < seat.first || cut.x + x >= seat.last) own.col(x).setTo(0);
  cv::resize(own, canvas.level, canvas.size, 0, 0, cv::INTER_AREA);
  canvas.soft = blurred(canvas.level, kFrameBlur * h / canvas.by);
  canvas.softer = blurred(canvas.level, kMeanBlur * h / canvas.by);
  return canvas;
}

/// From the canvas to the clip's samples.
cv::Matx23d clip_from_canvas(const Canvas& canvas, const Seat& still, const Seat& form, const Laid& laid) {
  const double axis = (still.left + still.right) / 2, form_axis = (form.left + form.right) / 2;
  const double sign = laid.mirrored ? -1 : 1;
  const double a = sign * canvas.by / laid.across, d = canvas.by / laid.down;
  return {a, 0, form_axis + sign * (canvas.rect.x + 0.5 * canvas.by - axis) / laid.across - 0.5,
          0, d, form.bed + (canvas.rect.y + 0.5 * canvas.by - still.bed) / laid.down - 0.5};
}

cv::Mat on_canvas(const cv::Mat& level, const Canvas& canvas, const cv::Matx23d& map, const Seat& form) {
  // What burns beside it belongs to another seat.
  const int first = std::clamp(cvFloor(form.first), 0, level.cols - 1);
  const int last = std::clamp(cvCeil(form.last), first + 1, level.cols);
  cv::Matx23d within = map;
  within(0, 2) -= first;
  cv::Mat out;
  cv::warpAffine(level.colRange(first, last), out, within, canvas.size,
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT);
  return out;
}

/// How much of a form the frame's sides cut off, and its top: 0..1.
double cut_off(const ClipForms& clip, const Seat& form) {
  const cv::Mat& mean = clip.mean;
  double most = 0, left = 0, right = 0, top = 0;
  cv::minMaxLoc(mean, nullptr, &most);
  if (most <= 0) return 1;
  const int y0 = std::clamp(cvFloor(form.top), 0, mean.rows - 1),
            y1 = std::clamp(cvCeil(form.bed), y0 + 1, mean.rows);
  if (form.first <= 0) left = cv::mean(mean.col(0).rowRange(y0, y1))[0];
  if (form.last >= mean.cols) right = cv::mean(mean.col(mean.cols - 1).rowRange(y0, y1))[0];
  const int x0 = std::clamp(cvFloor(form.left), 0, mean.cols - 1),
            x1 = std::clamp(cvCeil(form.right), x0 + 1, mean.cols);
  top = cv::mean(mean.row(0).colRange(x0, x1))[0];
  return std::min(1.0, (left + right + top) / most);
}

double drawback(const ClipForms& clip, const Seat& form, const Laid& laid) {
  const double enlarged = std::max(laid.across, laid.down) / clip.by;
  const double soft = enlarged > kMaxEnlarged ? std::sqrt(kMaxEnlarged / enlarged) : 1;
  // Small fires flicker faster than large ones.
  const double size = std::exp2(-kOtherSize * std::abs(std::log2(laid.down / clip.by)));
  const double shape = std::exp2(-kOtherShape * std::abs(std::log2(laid.stretched)));
  const double burns = std::clamp((kNoFlames - clip.as_one) / (kNoFlames - kFlames), kAsOne, 1.0);
  return soft * size * shape * burns * (1 - kCut * cut_off(clip, form));
}

std::vector<Laid> by_means(const Canvas& canvas, const Seat& seat, std::span<const ClipForms> clips) {
  std::vector<Laid> all;
  for (std::size_t c = 0; c < clips.size(); ++c)
    for (std::size_t s = 0; s < clips[c].seats.size(); ++s)
      for (const bool mirrored : {false, true}) {
        const Seat& form = clips[c].seats[s];
        if (form.height() < 4 || form.width() < 2) continue;
        Laid laid{.clip = c, .seat = s, .mirrored = mirrored, .down = seat.height() / form.height()};
        const double wanted = seat.width() / form.width();
        laid.across = std::clamp(wanted, kNarrowest * laid.down, kWidest * laid.down);
        laid.stretched = wanted / laid.across;
        const cv::Mat mean =
            on_canvas(clips[c].mean, canvas, clip_from_canvas(canvas, seat, form, laid), form);
        laid.mean = cosine(mean, canvas.softer) * drawback(clips[c], form, laid);
        all.push_back(laid);
      }
  std::stable_sort(all.begin(), all.end(), [](const Laid& a, const Laid& b) { return a.mean > b.mean; });
  all.resize(std::min(all.size(), kNarrowed));
  return all;
}

/// The most alike frame, of those that enough others follow.
void find_first(const Canvas& canvas, const Seat& seat, const ClipForms& clip, double frames,
                std::span<const ChosenForm> chosen, Laid& laid) {
  const Seat& form = clip.seats[laid.seat];
  const cv::Matx23d map = clip_from_canvas(canvas, seat, form, laid);
  const auto count = static_cast<int>(clip.levels.size());
  const int until = std::max(count / 3, count - static_cast<int>(std::ceil(frames)));
  std::vector<double> alike(std::max(1, std::min(until, count)), 0.0);
  oneapi::tbb::parallel_for(std::size_t{0}, alike.size(), [&](std::size_t i) {
    for (const ChosenForm& other : chosen)
      if (other.clip == laid.clip && std::abs(static_cast<double>(i) - other.first) < kApart * count) return;
    cv::Mat level;
    on_canvas(clip.levels[i], canvas, map, form).convertTo(level, CV_32F, 1.0 / 255);
    alike[i] = cosine(blurred(level, kFrameBlur * seat.height() / canvas.by), canvas.soft);
  });
  const auto best = std::max_element(alike.begin(), alike.end());
  laid.first = static_cast<std::uint32_t>(best - alike.begin());
  cv::Mat level;
  on_canvas(clip.levels[laid.first], canvas, map, form).convertTo(level, CV_32F, 1.0 / 255);
  const double finer = std::abs(std::log2(busyness(level) / busyness(canvas.level)));
  laid.fit = (0.5 * laid.mean + 0.5 * *best) * std::exp2(-kBusyness * finer);
}

ChosenForm in_pixels(const Canvas& canvas, const Seat& seat, const ClipForms& clip, const Laid& laid) {
  const Seat& form = clip.seats[laid.seat];
  const cv::Matx23d map = clip_from_canvas(canvas, seat, form, laid);
  // The canvas in the clip, as far as that reaches.
  double x0 = map(0, 0) * -0.5 + map(0, 2) + 0.5,
         x1 = map(0, 0) * (canvas.size.width - 0.5) + map(0, 2) + 0.5;
  if (x0 > x1) std::swap(x0, x1);
  const double y0 = map(1, 1) * -0.5 + map(1, 2) + 0.5,
               y1 = map(1, 1) * (canvas.size.height - 0.5) + map(1, 2) + 0.5;
  const double across = clip.source.width / static_cast<double>(clip.mean.cols);
  const double down = clip.source.height / static_cast<double>(clip.mean.rows);
  const auto corner = cv::Point(cvFloor(across * std::max(x0, form.first)), cvFloor(down * y0));
  const auto end = cv::Point(cvCeil(across * std::min(x1, form.last)), cvCeil(down * y1));
  ChosenForm chosen{.clip = laid.clip,
                    .from = cv::Rect(corner, end) & cv::Rect({}, clip.source),
                    .to = {},
                    .mirrored = laid.mirrored,
                    .first = laid.first,
                    .fit = laid.fit,
                    .seat = seat};
  const double axis = (seat.left + seat.right) / 2, form_axis = (form.left + form.right) / 2;
  const auto x_of = [&](double px) {
    return axis + (laid.mirrored ? -1 : 1) * (px / across - form_axis) * laid.across;
  };
  const auto y_of = [&](double px) { return seat.bed + (px / down - form.bed) * laid.down; };
  double left = x_of(chosen.from.x), right = x_of(chosen.from.br().x);
  if (left > right) std::swap(left, right);
  chosen.to = {left, y_of(chosen.from.y), right - left, y_of(chosen.from.br().y) - y_of(chosen.from.y)};
  return chosen;
}

}  // namespace

std::vector<ChosenForm> choose_forms(const PartedStill& still, std::span<const ClipForms> clips,
                                     double seconds) {
  // Seats are found on as coarse samples as the clips'.
  std::vector<ChosenForm> chosen;
  for (const Seat& seat : seats_reduced(still.level, kFormSamples)) {
    if (seat.height() < 8 || seat.width() < 4) continue;
    const Canvas canvas = canvas_of(still.level, seat);
    std::vector<Laid> laid = by_means(canvas, seat, clips);
    for (Laid& one : laid)
      find_first(canvas, seat, clips[one.clip], seconds * clips[one.clip].fps, chosen, one);
    const auto best = std::max_element(laid.begin(), laid.end(),
                                       [](const Laid& a, const Laid& b) { return a.fit < b.fit; });
    if (best == laid.end() || best->fit <= 0) continue;
    ChosenForm form = in_pixels(canvas, seat, clips[best->clip], *best);
    if (!form.from.empty()) chosen.push_back(form);
  }
  return chosen;
}

double overall_fit(std::span<const ChosenForm> forms) {
  double share = 0, fit = 0;
  for (const ChosenForm& form : forms) share += form.seat.share, fit += form.seat.share * form.fit;
  return share > 0 ? fit / share : 0;
}

}  // namespace freshet::synth::animate
