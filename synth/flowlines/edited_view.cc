#include "synth/flowlines/edited_view.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "synth/animate/motion/background.h"

namespace freshet::synth::flowlines {
namespace {

constexpr std::size_t kMostSources = 4;  // of a pixel: the weightiest patches
constexpr float kLeast = 0.02f;          // of the weightiest: less is not seen

/// Where a pixel lies beside a line.
struct Beside {
  float arc = 0, across = 0;
  float squared = 1e18f;  // of the distance to the nearest sample
};

/// The pixels within half a patch of a line; region is where they may be.
std::vector<Beside> along(const FlowLine& line, float half, cv::Size picture, cv::Rect& region) {
  region = cv::boundingRect(line.points);
  const int edge = static_cast<int>(std::ceil(half)) + 1;
  region = cv::Rect(region.x - edge, region.y - edge, region.width + 2 * edge, region.height + 2 * edge) &
           cv::Rect({0, 0}, picture);
  std::vector<Beside> found(static_cast<std::size_t>(std::max(0, region.area())));
  for (int s = 0; s < line.samples(); ++s) {
    const cv::Point2f p = line.points[static_cast<std::size_t>(s)], way = tangent(line, s);
    const cv::Rect near = cv::Rect(cvFloor(p.x - half), cvFloor(p.y - half), 2 * edge, 2 * edge) & region;
    for (int y = near.y; y < near.y + near.height; ++y)
      for (int x = near.x; x < near.x + near.width; ++x) {
        const cv::Point2f from = cv::Point2f(static_cast<float>(x), static_cast<float>(y)) - p;
        const float squared = from.dot(from);
        Beside& beside =
            found[static_cast<std::size_t>(y - region.y) * static_cast<std::size_t>(region.width) +
                  static_cast<std::size_t>(x - region.x)];
        if (squared > half * half || squared >= beside.squared) continue;
        beside = {static_cast<float>(s) + from.dot(way), from.dot({-way.y, way.x}), squared};
      }
  }
  return found;
}

/// A tent: 1 in the middle, 0 half a patch away.
float tent(float distance, float half) { return std::max(0.0f, 1 - std::abs(distance) / half); }
/// How far a place lies beyond a line's ends.
float beyond(float arc, float length) { return std::max({0.0f, -arc, arc - length}); }

cv::Vec3f sampled(const cv::Mat& frame, float x, float y) {
  const float cx = std::clamp(x, 0.0f, static_cast<float>(frame.cols - 1));
  const float cy = std::clamp(y, 0.0f, static_cast<float>(frame.rows - 1));
  const int x0 = static_cast<int>(cx), y0 = static_cast<int>(cy);
  const int x1 = std::min(x0 + 1, frame.cols - 1), y1 = std::min(y0 + 1, frame.rows - 1);
  const float fx = cx - static_cast<float>(x0), fy = cy - static_cast<float>(y0);
  const auto* top = frame.ptr<cv::Vec3b>(y0);
  const auto* low = frame.ptr<cv::Vec3b>(y1);
  cv::Vec3f out;
  for (int c = 0; c < 3; ++c)
    out[c] = (static_cast<float>(top[x0][c]) * (1 - fx) + static_cast<float>(top[x1][c]) * fx) * (1 - fy) +
             (static_cast<float>(low[x0][c]) * (1 - fx) + static_cast<float>(low[x1][c]) * fx) * fy;
  return out;
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

EditedView::EditedView(const std::vector<cv::Mat>& frames, cv::Size working,
                       const std::vector<FlowLine>& inputs, const std::vector<EditedLine>& lines,
                       const cv::Mat& matte, const cv::Mat& mean, const EditedViewOptions& options)
    : frames_(&frames), working_(working), options_(options), mean_(mean) {
  cv::Mat soft;
  cv::GaussianBlur(matte, soft, cv::Size(), std::max(1.0, options.patch_px / 12));
  cover(inputs, lines, soft);
  const cv::Mat was = ridden(inputs, static_cast<float>(options.patch_px / 2), soft);
  removed_ = options.on_background ? 1 - alpha_ : cv::Mat(cv::max(was - alpha_, 0.0f));
  behind_ = options.background;
  if (!behind_.empty()) return;
  if (options.ground != Ground::kNone) {
    behind_ = extreme(frames, options.ground == Ground::kBlack);
    return;
  }
  cv::Mat average, hole = was > 0.05f;
  mean.convertTo(average, CV_8U);
  // Fluid all over leaves nothing to fill in from: then it stands still behind itself.
  behind_ = cv::countNonZero(hole) < 0.9 * static_cast<double>(hole.total())
                ? animate::inpaint_background(average, hole)
                : average;
}

void EditedView::cover(const std::vector<FlowLine>& inputs, const std::vector<EditedLine>& lines,
                       const cv::Mat& matte) {
  const cv::Size size = matte.size();
  const auto half = static_cast<float>(options_.patch_px / 2);
  std::vector<std::vector<Source>> of_pixel(static_cast<std::size_t>(size.area()));
  for (const EditedLine& edited : lines) {
    const FlowLine& input = inputs[static_cast<std::size_t>(edited.input)];
    const bool unchanged = edited.line.points == input.points && edited.line.speed == 1;
    cv::Rect region;
    const std::vector<Beside> found = along(edited.line, half, size, region);
    for (int i = 0; i < static_cast<int>(found.size()); ++i) {
      const Beside& beside = found[static_cast<std::size_t>(i)];
      if (beside.squared > 1e17f) continue;
      const int x = region.x + i % region.width, y = region.y + i / region.width;
      const float arc = input_arc(edited, input, beside.arc, options_.correspondence);
      const float weight =
          tent(beside.across, half) *
          tent(std::max(beyond(beside.arc, edited.line.length()), beyond(arc, input.length())), half);
      cv::Point2f from(static_cast<float>(x), static_cast<float>(y));
      if (!unchanged) {
        const cv::Point2f way = tangent(input, cvRound(arc));
        from = at(input, arc) + cv::Point2f(-way.y, way.x) * beside.across;
      }
      const bool seen = from.x >= -0.5f && from.y >= -0.5f &&
                        from.x <= static_cast<float>(size.width) - 0.5f &&
                        from.y <= static_cast<float>(size.height) - 0.5f;
      if (weight > 1e-4f && seen)
        of_pixel[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
                 static_cast<std::size_t>(x)]
            .push_back({from.x, from.y, weight});
    }
  }
  alpha_ = cv::Mat(size, CV_32F, cv::Scalar(0));
  first_.assign(1, 0);
  first_.reserve(of_pixel.size() + 1);
  for (std::size_t p = 0; p < of_pixel.size(); ++p) {
    std::vector<Source>& of = of_pixel[p];
    std::stable_sort(of.begin(), of.end(),
                     [](const Source& a, const Source& b) { return a.weight > b.weight; });
    float all = 0;
    for (const Source& source : of) all += source.weight;
    if (of.size() > kMostSources) of.resize(kMostSources);
    float sum = 0, fluid = 0;
    for (const Source& source : of) {
      const int sx = std::clamp(cvRound(source.x), 0, size.width - 1);
      const int sy = std::clamp(cvRound(source.y), 0, size.height - 1);
      sum += source.weight;
      fluid += source.weight * static_cast<float>(matte.at<std::uint8_t>(sy, sx)) / 255;
    }
    if (sum > 0)
      alpha_.at<float>(static_cast<int>(p) / size.width, static_cast<int>(p) % size.width) =
          covered(all) * fluid / sum;
    share_out(of);
    sources_.insert(sources_.end(), of.begin(), of.end());
    first_.push_back(static_cast<std::uint32_t>(sources_.size()));
  }
}

/// Two patches that were turned differently show the same texture in two places: averaged, it is soft, and slower to
/// the eye and to flow. Where textures are cut, the weightiest patch therefore counts for most.
void EditedView::share_out(std::vector<Source>& of) const {
  if (of.empty()) return;
  if (options_.render.mixing == Mixing::kCut) {
    const float most = of.front().weight;
    for (Source& source : of) {
      const float share = source.weight / most;
      source.weight = share * share * share * share * share * share;
    }
    std::erase_if(of, [](const Source& source) { return source.weight < kLeast; });
  }
  float sum = 0;
  for (const Source& source : of) sum += source.weight;
  for (Source& source : of) source.weight /= sum;
}

cv::Vec4f EditedView::fluid(const std::vector<Moment>& moments, std::size_t first, std::size_t last) const {
  cv::Vec3f sum(0, 0, 0);
  const float down = static_cast<float>(working_.height) / static_cast<float>(alpha_.rows);
  const float along_x = static_cast<float>(working_.width) / static_cast<float>(alpha_.cols);
  for (std::size_t i = first; i < last; ++i) {
    const Source& source = sources_[i];
    const int wx = std::clamp(cvRound((source.x + 0.5f) * along_x - 0.5f), 0, working_.width - 1);
    const int wy = std::clamp(cvRound((source.y + 0.5f) * down - 0.5f), 0, working_.height - 1);
    const Moment& moment = moments[static_cast<std::size_t>(wy) * static_cast<std::size_t>(working_.width) +
                                   static_cast<std::size_t>(wx)];
    std::array<cv::Vec3f, 4> values;
    for (std::size_t k = 0; k < static_cast<std::size_t>(moment.count); ++k)
      values[k] = sampled((*frames_)[moment.frame[k]], source.x, source.y);
    const cv::Point from(std::clamp(cvRound(source.x), 0, mean_.cols - 1),
                         std::clamp(cvRound(source.y), 0, mean_.rows - 1));
    sum += mixed(values, moment, mean_.at<cv::Vec3f>(from), options_.render.likeness.at<float>(from),
                 options_.render.mixing) *
           source.weight;
  }
  float alpha = 1;
  const float brightest = std::max({sum[0], sum[1], sum[2]}), darkest = std::min({sum[0], sum[1], sum[2]});
  if (options_.ground == Ground::kBlack) alpha = std::clamp(brightest / 255, 0.0f, 1.0f);
  if (options_.ground == Ground::kWhite) alpha = std::clamp(1 - darkest / 255, 0.0f, 1.0f);
  return {sum[0], sum[1], sum[2], alpha};
}

void EditedView::render(const std::vector<Moment>& moments, cv::Mat& frame) const {
  tbb::parallel_for(0, frame.rows, [&](int y) {
    auto* to = frame.ptr<cv::Vec3b>(y);
    const auto* behind = behind_.ptr<cv::Vec3b>(y);
    for (int x = 0; x < frame.cols; ++x) {
      const float alpha = alpha_.at<float>(y, x), gone = removed_.at<float>(y, x);
      if (alpha <= 0 && gone <= 0) continue;
      const std::size_t p =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.cols) + static_cast<std::size_t>(x);
      const cv::Vec4f fluid_here =
          alpha > 0 ? this->fluid(moments, first_[p], first_[p + 1]) : cv::Vec4f(0, 0, 0, 0);
      // On a ground the colours are already times alpha, less the ground's own light.
      const float ground = options_.ground == Ground::kWhite ? 255 * (1 - fluid_here[3]) : 0;
      const float opaque = options_.ground == Ground::kNone ? 1 : fluid_here[3];
      for (int c = 0; c < 3; ++c) {
        const float under =
            (gone * static_cast<float>(behind[x][c]) + (1 - alpha - gone) * static_cast<float>(to[x][c]));
        // What is seen through the fluid is what lies behind it, not the clip, which still has its own.
        const float through = alpha * (1 - opaque) * static_cast<float>(behind[x][c]);
        to[x][c] = cv::saturate_cast<std::uint8_t>(alpha * (fluid_here[c] - ground) + through + under);
      }
    }
  });
}

}  // namespace freshet::synth::flowlines
