#include "synth/flowlines/edited_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "synth/outline/background.h"
#include "synth/sampling/bilinear.h"

namespace freshet::synth::flowlines {
namespace {

constexpr std::size_t kTogether = 8;  // lines that are covered at a time

constexpr int kAbout = 4;            // samples about the nearest that are compared
constexpr float kGoesOn = 1 / 6.0f;  // of half a patch
constexpr float kCutFades = 0.5f;    // of half a patch
constexpr float kLeast = 0.02f;      // of the weightiest: less is not seen

/// Where a pixel lies beside a line.
struct Beside {
  float arc = 0, across = 0;
  float squared = 1e18f;  // of the distance to the nearest sample
};

/// By pixel of a region, about which sample of a line is the nearest: CV_32S.
cv::Mat nearest_samples(const FlowLine& line, const cv::Rect& region) {
  // The region and what of the line lies beside it.
  const cv::Rect all = region | cv::boundingRect(line.points);
  cv::Mat off(all.size(), CV_8U, cv::Scalar(255)), distance, labels;
  const auto cell = [&](int s) {
    const cv::Point2f p = line.points[static_cast<std::size_t>(s)];
    return cv::Point(std::clamp(cvRound(p.x) - all.x, 0, all.width - 1),
                     std::clamp(cvRound(p.y) - all.y, 0, all.height - 1));
  };
  for (int s = 0; s < line.samples(); ++s) off.at<std::uint8_t>(cell(s)) = 0;
  cv::distanceTransform(off, distance, labels, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<int> sample_of(static_cast<std::size_t>(line.samples()) + 1, 0);
  for (int s = line.samples() - 1; s >= 0; --s) {
    const auto label = static_cast<std::size_t>(labels.at<int>(cell(s)));
    if (label < sample_of.size()) sample_of[label] = s;
  }
  cv::Mat out(region.size(), CV_32S);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x)
      out.at<int>(y, x) =
          sample_of[static_cast<std::size_t>(labels.at<int>(y + region.y - all.y, x + region.x - all.x))];
  return out;
}

/// The pixels within half a patch of a line; region is where they may be.
std::vector<Beside> along(const FlowLine& line, float half, cv::Size picture, cv::Rect& region) {
  region = cv::boundingRect(line.points);
  const int edge = static_cast<int>(std::ceil(half)) + 1;
  region = cv::Rect(region.x - edge, region.y - edge, region.width + 2 * edge, region.height + 2 * edge) &
           cv::Rect({0, 0}, picture);
  std::vector<Beside> found(static_cast<std::size_t>(std::max(0, region.area())));
  if (found.empty()) return found;
  const cv::Mat nearest = nearest_samples(line, region);
  for (int y = 0; y < region.height; ++y)
    for (int x = 0; x < region.width; ++x) {
      const cv::Point2f here(static_cast<float>(region.x + x), static_cast<float>(region.y + y));
      Beside& beside = found[static_cast<std::size_t>(y * region.width + x)];
      const int about = nearest.at<int>(y, x);
      for (int s = std::max(0, about - kAbout); s <= std::min(about + kAbout, line.samples() - 1); ++s) {
        const cv::Point2f from = here - line.points[static_cast<std::size_t>(s)];
        const float squared = from.dot(from);
        if (squared > half * half || squared >= beside.squared) continue;
        const cv::Point2f way = tangent(line, s);
        beside = {static_cast<float>(s) + from.dot(way), from.dot({-way.y, way.x}), squared};
      }
    }
  return found;
}

/// A tent: 1 in the middle, 0 half a patch away.
float tent(float distance, float half) { return std::max(0.0f, 1 - std::abs(distance) / half); }
/// How far a place lies beyond a line's ends.
float beyond(float arc, float length) { return std::max({0.0f, -arc, arc - length}); }

/// How far inside the picture, px; below 0 beyond it.
float inside(cv::Point2f p, cv::Size size) {
  return std::min(
      {p.x, p.y, static_cast<float>(size.width - 1) - p.x, static_cast<float>(size.height - 1) - p.y});
}
/// 0..1: fluid that the clip's border cuts off fades towards there, where it is shown further inside; else the cut
/// would stand in the picture as a straight edge.
float uncut(cv::Point2f from, cv::Point2f shown, cv::Size size, float fade) {
  const float source = inside(from, size), place = inside(shown, size);
  return std::clamp(std::max(source, fade - (place - source)) / fade, 0.0f, 1.0f);
}

/// The darkest, or brightest, that each place ever was.
cv::Mat extreme(const std::vector<cv::Mat>& frames, bool darkest) {
  cv::Mat out = frames.front().clone();
  for (const cv::Mat& frame : frames)
    if (darkest)
      cv::min(out, frame, out);
    else
      cv::max(out, frame, out);
  return out;
}

float covered(float weight) {
  const float share = std::clamp(weight / 0.6f, 0.0f, 1.0f);
  return share * share * (3 - 2 * share);
}

/// How far the patches of lines cover each pixel, by the matte below them: where the clip's own fluid rides.
cv::Mat ridden(const std::vector<FlowLine>& lines, float half, const cv::Mat& matte) {
  cv::Mat sum(matte.size(), CV_32F, cv::Scalar(0));
  for (const FlowLine& line : lines) {
    cv::Rect region;
    const std::vector<Beside> found = along(line, half, matte.size(), region);
    for (int i = 0; i < static_cast<int>(found.size()); ++i) {
      const Beside& beside = found[static_cast<std::size_t>(i)];
      if (beside.squared > 1e17f) continue;
      sum.at<float>(region.y + i / region.width, region.x + i % region.width) +=
          tent(beside.across, half) * tent(beyond(beside.arc, line.length()), half);
    }
  }
  for (int y = 0; y < sum.rows; ++y)
    for (int x = 0; x < sum.cols; ++x)
      sum.at<float>(y, x) =
          covered(sum.at<float>(y, x)) * static_cast<float>(matte.at<std::uint8_t>(y, x)) / 255;
  return sum;
}

}  // namespace

EditedView::EditedView(const std::vector<cv::Mat>& frames, cv::Size working, std::vector<FlowLine> inputs,
                       const cv::Mat& matte, const cv::Mat& mean, const EditedViewOptions& options)
    : frames_(&frames), working_(working), options_(options), inputs_(std::move(inputs)), mean_(mean) {
  cv::GaussianBlur(matte, matte_, cv::Size(), std::max(1.0, options.patch_px / 12));
  was_ = ridden(inputs_, static_cast<float>(options.patch_px / 2), matte_);
  behind_ = options.background;
  if (!behind_.empty()) return;
  if (options.ground != Ground::kNone) {
    behind_ = extreme(frames, options.ground == Ground::kBlack);
    return;
  }
  const cv::Mat hole = was_ > 0.05f;
  // Fluid all over leaves nothing to fill in from: then it stands still behind itself.
  behind_ = cv::countNonZero(hole) < 0.9 * static_cast<double>(hole.total())
                ? outline::inpaint_background(mean, hole)
                : mean;
}

void EditedView::lead(const std::vector<EditedLine>& lines) {
  const cv::Size size = matte_.size();
  const auto pixels = static_cast<std::size_t>(size.area());
  best_.resize(pixels * kMostSources);
  count_.assign(pixels, 0);
  all_.assign(pixels, 0.0f);
  std::array<std::vector<Place>, kTogether> covers;
  for (std::size_t first = 0; first < lines.size(); first += kTogether) {
    const std::size_t count = std::min(kTogether, lines.size() - first);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { cover(lines[first + i], covers[i]); });
    for (std::size_t i = 0; i < count; ++i)  // in order: the same for any number of threads
      for (const Place& place : covers[i]) add(place);
  }
  gather();
  removed_ = options_.on_background ? 1 - alpha_ : cv::Mat(cv::max(was_ - alpha_, 0.0f));
}

void EditedView::cover(const EditedLine& edited, std::vector<Place>& places) const {
  places.clear();
  if (edited.line.samples() < 2) return;
  const cv::Size size = matte_.size();
  const auto half = static_cast<float>(options_.patch_px / 2);
  const FlowLine& input = inputs_[static_cast<std::size_t>(edited.input)];
  const bool unchanged = edited.line.points == input.points && edited.line.speeds.empty();
  const ArcMap arc_of(edited.line, input, options_.correspondence);
  // A little beyond the clip its border goes on: lines that end at the picture's edge left holes there where they turn.
  const float more = 0.5f + half * kGoesOn;
  const cv::Rect2f seen(-more, -more, static_cast<float>(size.width) - 1 + 2 * more,
                        static_cast<float>(size.height) - 1 + 2 * more);
  cv::Rect region;
  const std::vector<Beside> found = along(edited.line, half, size, region);
  for (int i = 0; i < static_cast<int>(found.size()); ++i) {
    const Beside& beside = found[static_cast<std::size_t>(i)];
    if (beside.squared > 1e17f) continue;
    const int x = region.x + i % region.width, y = region.y + i / region.width;
    const float arc = arc_of(beside.arc);
    float weight =
        tent(beside.across, half) *
        tent(std::max(beyond(beside.arc, edited.line.length()), beyond(arc, input.length())), half);
    cv::Point2f from(static_cast<float>(x), static_cast<float>(y));
    if (!unchanged) {
      const cv::Point2f way = tangent(input, cvRound(arc));
      from = at(input, arc) + cv::Point2f(-way.y, way.x) * beside.across;
    }
    weight *= uncut(from, {static_cast<float>(x), static_cast<float>(y)}, size, half * kCutFades);
    if (weight > 1e-4f && seen.contains(from))
      places.push_back(
          {static_cast<std::uint32_t>(y * size.width + x), {from.x, from.y, weight, edited.time}});
  }
}

/// Keeps a pixel's weightiest sources, in their order.
void EditedView::add(const Place& place) {
  all_[place.pixel] += place.source.weight;
  Source* best = best_.data() + place.pixel * kMostSources;
  std::uint8_t& count = count_[place.pixel];
  std::size_t at = count;
  while (at > 0 && best[at - 1].weight < place.source.weight) --at;
  if (at == kMostSources) return;
  if (count < kMostSources) ++count;
  for (std::size_t i = count - 1u; i > at; --i) best[i] = best[i - 1];
  best[at] = place.source;
}

void EditedView::gather() {
  const cv::Size size = matte_.size();
  alpha_.create(size, CV_32F);
  mean_.copyTo(fluid_mean_);
  first_.assign(1, 0);
  sources_.clear();
  for (std::size_t p = 0; p < count_.size(); ++p) {
    const std::span<Source> of(best_.data() + p * kMostSources, count_[p]);
    float sum = 0, fluid = 0;
    for (const Source& source : of) {
      const int sx = std::clamp(cvRound(source.x), 0, size.width - 1);
      const int sy = std::clamp(cvRound(source.y), 0, size.height - 1);
      sum += source.weight;
      fluid += source.weight * static_cast<float>(matte_.at<std::uint8_t>(sy, sx)) / 255;
    }
    alpha_.at<float>(static_cast<int>(p) / size.width, static_cast<int>(p) % size.width) =
        sum > 0 ? covered(all_[p]) * fluid / sum : 0.0f;
    share_out(of);
    if (alpha_.at<float>(static_cast<int>(p) / size.width, static_cast<int>(p) % size.width) > 0) {
      cv::Vec3f average(0, 0, 0);
      for (std::size_t i = first_.back(); i < sources_.size(); ++i)
        average += sampling::bilinear<cv::Vec3f, cv::Vec3b>(mean_, sources_[i].x, sources_[i].y) *
                   sources_[i].weight;
      fluid_mean_.ptr<cv::Vec3b>()[p] = average;
    }
    first_.push_back(static_cast<std::uint32_t>(sources_.size()));
  }
}

/// Two patches that were turned differently show the same texture in two places: averaged, it is soft, and slower to
/// the eye and to flow. Where textures are cut, the weightiest patch therefore counts for most.
void EditedView::share_out(std::span<Source> of) {
  const auto from = static_cast<std::ptrdiff_t>(sources_.size());
  for (const Source& source : of) {
    const float share = source.weight / of.front().weight;
    const bool sharp = options_.render.mixing == Mixing::kCut;
    const float weight = sharp ? share * share * share * share * share * share : share;
    if (weight >= kLeast) sources_.push_back({source.x, source.y, weight, source.time});
  }
  float sum = 0;
  for (auto source = sources_.begin() + from; source != sources_.end(); ++source) sum += source->weight;
  for (auto source = sources_.begin() + from; source != sources_.end(); ++source) source->weight /= sum;
}

/// What a pixel that edited lines cover shows of the fluid, and how much of its detail mixing cost.
void EditedView::show(std::span<const std::vector<Moment>> moments, std::size_t pixel) {
  cv::Vec3f sum(0, 0, 0);
  float lost = 0;
  const float down = static_cast<float>(working_.height) / static_cast<float>(alpha_.rows);
  const float along_x = static_cast<float>(working_.width) / static_cast<float>(alpha_.cols);
  for (std::size_t i = first_[pixel]; i < first_[pixel + 1]; ++i) {
    const Source& source = sources_[i];
    const int wx = std::clamp(cvRound((source.x + 0.5f) * along_x - 0.5f), 0, working_.width - 1);
    const int wy = std::clamp(cvRound((source.y + 0.5f) * down - 0.5f), 0, working_.height - 1);
    const std::vector<Moment>& shown = moments[static_cast<std::size_t>(source.time)];
    const Moment& moment = shown[static_cast<std::size_t>(wy) * static_cast<std::size_t>(working_.width) +
                                 static_cast<std::size_t>(wx)];
    std::array<cv::Vec3f, 4> values;
    for (std::size_t k = 0; k < static_cast<std::size_t>(moment.count); ++k)
      values[k] = sampling::bilinear<cv::Vec3f, cv::Vec3b>((*frames_)[moment.frame[k]], source.x, source.y);
    const cv::Point from(std::clamp(cvRound(source.x), 0, mean_.cols - 1),
                         std::clamp(cvRound(source.y), 0, mean_.rows - 1));
    sum += mixed(values, moment) * source.weight;
    lost +=
        lost_detail(moment, options_.render.likeness.at<float>(from), options_.render.mixing) * source.weight;
  }
  auto& to = fluid_.ptr<cv::Vec3b>()[pixel];
  for (int c = 0; c < 3; ++c) to[c] = cv::saturate_cast<std::uint8_t>(sum[c]);
  lost_.ptr<float>()[pixel] = lost;
}

float EditedView::opacity(const cv::Vec3b& fluid) const {
  if (options_.ground == Ground::kBlack)
    return static_cast<float>(std::max({fluid[0], fluid[1], fluid[2]})) / 255;
  if (options_.ground == Ground::kWhite)
    return 1 - static_cast<float>(std::min({fluid[0], fluid[1], fluid[2]})) / 255;
  return 1;
}

void EditedView::render(std::span<const std::vector<Moment>> moments, cv::Mat& frame) {
  frame.copyTo(fluid_);
  lost_.create(frame.size(), CV_32F);
  const auto pixel_of = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.cols) + static_cast<std::size_t>(x);
  };
  tbb::parallel_for(0, frame.rows, [&](int y) {
    lost_.row(y).setTo(0);
    for (int x = 0; x < frame.cols; ++x)
      if (alpha_.at<float>(y, x) > 0) show(moments, pixel_of(x, y));
  });
  if (options_.render.mixing != Mixing::kFeather)
    return_detail_(fluid_, fluid_mean_, lost_, options_.render.detail_px);
  tbb::parallel_for(0, frame.rows, [&](int y) {
    auto* to = frame.ptr<cv::Vec3b>(y);
    const auto *behind = behind_.ptr<cv::Vec3b>(y), *fluid = fluid_.ptr<cv::Vec3b>(y);
    for (int x = 0; x < frame.cols; ++x) {
      const float alpha = alpha_.at<float>(y, x), gone = removed_.at<float>(y, x);
      if (alpha <= 0 && gone <= 0) continue;
      // On a ground the colours are already times alpha, less the ground's own light.
      const float opaque = opacity(fluid[x]);
      const float ground = options_.ground == Ground::kWhite ? 255 * (1 - opaque) : 0;
      for (int c = 0; c < 3; ++c) {
        const float under =
            (gone * static_cast<float>(behind[x][c]) + (1 - alpha - gone) * static_cast<float>(to[x][c]));
        // What is seen through the fluid is what lies behind it, not the clip, which still has its own.
        const float through = alpha * (1 - opaque) * static_cast<float>(behind[x][c]);
        to[x][c] = cv::saturate_cast<std::uint8_t>(alpha * (static_cast<float>(fluid[x][c]) - ground) +
                                                   through + under);
      }
    }
  });
}

}  // namespace freshet::synth::flowlines
