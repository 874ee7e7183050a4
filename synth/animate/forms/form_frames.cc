#include "synth/animate/forms/form_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "synth/animate/forms/light_level.h"
#include "synth/animate/still/colour_model.h"
#include "vision/flow.h"

namespace freshet::synth::animate {
namespace {

constexpr int kSampled = 12;  // moments that levels are matched by
constexpr double kEdge =
    0.02;  // of the picture's longer side: flames thin out so far within the matte's edge
constexpr double kThinSmooth = 0.012;  // sigma, of the picture's longer side
constexpr float kDrawn = 0.75f;        // of the way to the picture's flames that the clip's are drawn
constexpr double kLitAround = 0.6;     // sigma of the light around a fire, of its height
constexpr int kFlowSide = 200;         // px that flames are drawn and followed on
constexpr double kDrawnSmooth = 0.15, kFlowSmooth = 0.06;  // sigma, of a form's height

cv::Mat bytes_of(const cv::Mat& level, cv::Size size) {
  cv::Mat reduced, out;
  cv::resize(level, reduced, size, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(reduced, reduced, {}, 1.2);
  reduced.convertTo(out, CV_8U, 255);
  return out;
}

cv::Size flow_size(cv::Size size) {
  const double by = std::max(1.0, std::max(size.width, size.height) / static_cast<double>(kFlowSide));
  return {std::max(16, cvRound(size.width / by)), std::max(16, cvRound(size.height / by))};
}

/// A flow means something where there is light: means of what does.
cv::Mat smoothed(const cv::Mat& flow, const cv::Mat& light, double sigma) {
  cv::Mat weight, both, sums, flows;
  light.convertTo(weight, CV_32F, 1.0 / 255, 0.004);
  cv::merge(std::vector<cv::Mat>{weight, weight}, both);
  cv::GaussianBlur(flow.mul(both), flows, {}, sigma, 0, cv::BORDER_REPLICATE);
  cv::GaussianBlur(both, sums, {}, sigma, 0, cv::BORDER_REPLICATE);
  return flows / sums;
}

/// A field of displacements at another size, in px of that.
cv::Mat resized_field(const cv::Mat& field, cv::Size size) {
  cv::Mat out;
  cv::resize(field, out, size, 0, 0, cv::INTER_LINEAR);
  const cv::Scalar by(static_cast<double>(size.width) / field.cols,
                      static_cast<double>(size.height) / field.rows);
  cv::multiply(out, by, out);
  return out;
}

/// values at where each place's displacement, `share` of it, leads. Nothing lies outside.
cv::Mat moved(const cv::Mat& values, const cv::Mat& by, float share) {
  cv::Mat maps(by.size(), CV_32FC2), out;
  for (int y = 0; y < by.rows; ++y)
    for (int x = 0; x < by.cols; ++x)
      maps.at<cv::Vec2f>(y, x) =
          cv::Vec2f(static_cast<float>(x), static_cast<float>(y)) + share * by.at<cv::Vec2f>(y, x);
  cv::remap(values, out, maps, {}, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return out;
}

cv::Mat part_of(const cv::Mat& plane, const cv::Rect& rect) {
  cv::Mat out = cv::Mat::zeros(rect.size(), plane.type());
  const cv::Rect both = rect & cv::Rect({}, plane.size());
  if (!both.empty()) plane(both).copyTo(out(both - rect.tl()));
  return out;
}

/// Levels that flames lose near the matte's edge: 1 at it, 0 within. The picture's own sides are no edge.
cv::Mat beside(const cv::Mat& alpha) {
  cv::Mat gone = cv::Mat::zeros(alpha.size(), CV_32F);
  const cv::Mat inside = alpha > 0.5f;
  if (cv::countNonZero(inside) == inside.size().area()) return gone;
  cv::Mat distance;
  cv::distanceTransform(inside, distance, cv::DIST_L2, 3);
  const double width = std::max(3.0, kEdge * std::max(alpha.cols, alpha.rows));
  for (int y = 0; y < gone.rows; ++y)
    for (int x = 0; x < gone.cols; ++x)
      gone.at<float>(y, x) = static_cast<float>(std::clamp(1 - distance.at<float>(y, x) / width, 0.0, 1.0));
  return gone;
}

}  // namespace

FormFrames::FormFrames(const cv::Mat& picture, const cv::Mat& alpha, const PartedStill& still,
                       const std::vector<ChosenForm>& forms,
                       std::vector<std::unique_ptr<FormPlayer>>& players, const FormFramesOptions& options)
    : picture_(picture),
      alpha_(alpha),
      still_(still),
      forms_(forms),
      players_(players),
      options_(options),
      colours_(still.light, still.level),
      beside_(beside(alpha)) {
  beside_ = cv::max(beside_, kLostBehind * still.before);
  match_levels();
  draw_to_picture();
  follow_flames();
}

float FormFrames::remaining(int index, double seconds) const {
  const double length = std::max(2.0, seconds * options_.fps);
  const int apart = options_.loop ? std::min(index, options_.frames - index) : index;
  return static_cast<float>(std::clamp(1 - apart / length, 0.0, 1.0));
}

void FormFrames::load(int first, int count) {
  std::vector<int> moments(count);
  std::iota(moments.begin(), moments.end(), first);
  for (auto& player : players_) player->load(moments);
}

/// One map for each form, from moments of all of the animation; and how bright the fire is in the mean, place by place.
void FormFrames::match_levels() {
  std::vector<int> sampled;
  for (int i = 0; i < kSampled; ++i) sampled.push_back(i * options_.frames / kSampled);
  sampled.erase(std::unique(sampled.begin(), sampled.end()), sampled.end());
  cv::Mat usual = cv::Mat::zeros(picture_.size(), CV_32F);
  double tallest = 1;
  for (std::size_t f = 0; f < forms_.size(); ++f) {
    players_[f]->load(sampled);
    std::vector<cv::Mat> levels(sampled.size());
    oneapi::tbb::parallel_for(std::size_t{0}, sampled.size(),
                              [&](std::size_t i) { levels[i] = players_[f]->level(sampled[i]); });
    const cv::Rect& rect = players_[f]->rect();
    maps_.emplace_back(part_of(still_.level, rect), levels, forms_[f].seat.top - rect.y,
                       forms_[f].seat.bed - rect.y);
    const cv::Rect both = rect & cv::Rect({}, picture_.size());
    for (cv::Mat& level : levels) maps_.back().apply(level);
    soft_.push_back(softness(part_of(still_.level, rect), levels));
    for (const cv::Mat& level : levels) {
      if (both.empty()) continue;
      cv::Mat sum = usual(both);
      cv::scaleAdd(light_of(level(both - rect.tl())), 1.0 / static_cast<double>(levels.size()), sum, sum);
    }
    tallest = std::max(tallest, forms_[f].seat.height());
  }
  ground_ = std::make_unique<LitGround>(still_, level_of(usual), kLitAround * tallest, options_.lighting);
}

cv::Mat FormFrames::drawn_to_picture(const cv::Mat& level, std::size_t form) const {
  const cv::Rect& rect = players_[form]->rect();
  const cv::Size size = flow_size(rect.size());
  const cv::Mat wanted = bytes_of(part_of(still_.level, rect), size), given = bytes_of(level, size);
  const double sigma = std::max(2.0, kDrawnSmooth * forms_[form].seat.height() * size.height / rect.height);
  const cv::Mat flow = smoothed(vision::optical_flow(wanted, given), cv::max(wanted, given), sigma);
  return resized_field(flow, rect.size());
}

void FormFrames::draw_to_picture() {
  drawn_.resize(forms_.size());
  for (std::size_t f = 0; f < forms_.size(); ++f) {
    players_[f]->load({0});
    drawn_[f].start = drawn_to_picture(placed(f, 0, nullptr), f);
    if (!options_.loop) continue;
    players_[f]->load({options_.frames});
    drawn_[f].end = drawn_to_picture(placed(f, options_.frames, nullptr), f);
  }
}

/// Where the picture's flames come from while they last: back along the clips' flow, frame by frame from the picture
/// on, and in a loop on to it.
void FormFrames::follow_flames() {
  const int lasts = std::min(options_.frames / 2,
                             static_cast<int>(std::ceil(std::max(2.0, options_.handover_s * options_.fps))));
  double tallest = 1;
  for (const ChosenForm& form : forms_) tallest = std::max(tallest, form.seat.height());
  const auto follow = [&](int begin, int step, std::vector<cv::Mat>& into) {
    load(std::min(begin, begin + step * lasts), lasts + 1);
    const cv::Size size = flow_size(picture_.size());
    cv::Mat before = bytes_of(level(begin), size), way = cv::Mat::zeros(size, CV_32FC2);
    into.push_back(cv::Mat::zeros(picture_.size(), CV_32FC2));
    for (int i = 1; i <= lasts; ++i) {
      const cv::Mat now = bytes_of(level(begin + step * i), size);
      const double sigma = std::max(1.5, kFlowSmooth * tallest * size.height / picture_.rows);
      const cv::Mat back = smoothed(vision::optical_flow(now, before), cv::max(now, before), sigma);
      way = back + moved(way, back, 1);
      into.push_back(resized_field(way, picture_.size()));
      before = now;
    }
  };
  follow(0, 1, carried_up_);
  if (options_.loop) follow(options_.frames, -1, carried_down_);
}

cv::Mat FormFrames::placed(std::size_t form, int index, const Drawn* drawn) const {
  cv::Mat level = players_[form]->level(index);
  if (drawn != nullptr) {
    const float left = remaining(index, options_.settle_s), share = kDrawn * left * left * (3 - 2 * left);
    const bool ends = options_.loop && 2 * index > options_.frames;
    if (share > 0) level = moved(level, ends ? drawn->end : drawn->start, share);
  }
  maps_[form].apply(level);
  if (soft_[form] > 0) cv::GaussianBlur(level, level, {}, soft_[form]);
  return level;
}

cv::Mat FormFrames::level(int index) const {
  cv::Mat all = cv::Mat::zeros(picture_.size(), CV_32F);
  for (std::size_t f = 0; f < forms_.size(); ++f) {
    const cv::Rect& rect = players_[f]->rect();
    const cv::Rect both = rect & cv::Rect({}, picture_.size());
    if (both.empty()) continue;
    const cv::Mat own = placed(f, index, &drawn_[f])(both - rect.tl());
    cv::Mat shown = all(both);
    cv::max(shown, own, shown);
  }
  for (int y = 0; y < all.rows; ++y) {
    auto* row = all.ptr<float>(y);
    const auto* gone = beside_.ptr<float>(y);
    for (int x = 0; x < all.cols; ++x)
      if (gone[x] > 0) row[x] = thinned(row[x], gone[x]);
  }
  return all;
}

/// The picture's own flames, gone on and thinned out: CV_32FC3 of light, or empty.
cv::Mat FormFrames::thinned_light(int index) const {
  const float left = remaining(index, options_.handover_s);
  if (left <= 0) return {};
  const bool ends = options_.loop && 2 * index > options_.frames;
  const std::vector<cv::Mat>& ways = ends ? carried_down_ : carried_up_;
  const std::size_t passed = std::min<std::size_t>(ends ? options_.frames - index : index, ways.size() - 1);
  cv::Mat light = moved(still_.light, ways[passed], 1), soft;
  // As whole forms, not by what is light and dark inside them.
  cv::GaussianBlur(moved(still_.level, ways[passed], 1), soft, {},
                   kThinSmooth * std::max(light.cols, light.rows));
  for (int y = 0; y < light.rows; ++y) {
    auto* row = light.ptr<cv::Vec3f>(y);
    for (int x = 0; x < light.cols; ++x) {
      const float level = level_of(luma_of(row[x]));
      if (level <= 0) continue;
      // Colour goes with the level: white that got darker would be grey.
      const float now =
          std::min(level, thinned(0.5f * (level + soft.at<float>(y, x)), (1 - left) * (1 - left)));
      row[x] =
          colours_.at(now) + light_of(now) / light_of(level) * (row[x] - colours_.at(std::min(level, 1.0f)));
    }
  }
  return light;
}

/// All that burns: the brighter of both flames, CV_32F levels.
cv::Mat FormFrames::burning(int index) const {
  cv::Mat all = level(index);
  const cv::Mat own = thinned_light(index);
  const float left = remaining(index, options_.handover_s);
  for (int y = 0; y < all.rows && left > 0; ++y) {
    auto* row = all.ptr<float>(y);
    const auto* picture = own.ptr<cv::Vec3f>(y);
    for (int x = 0; x < all.cols; ++x)
      row[x] = std::max(thinned(row[x], left * left), level_of(luma_of(picture[x])));
  }
  return all;
}

cv::Mat FormFrames::step(int index) const {
  constexpr double kSmooth = 1.5;  // sigma, px at any size, little above that of bytes_of
  constexpr double kDark = 0.1;    // level, from which on flames move whole
  const cv::Mat now = burning(index), from = bytes_of(now, now.size()),
                to = bytes_of(burning(index + 1), now.size());
  cv::Mat way = smoothed(vision::optical_flow(from, to), cv::max(from, to), kSmooth);
  const cv::Mat shines = cv::min(now / kDark, 1.0);
  for (int y = 0; y < way.rows; ++y)
    for (int x = 0; x < way.cols; ++x) way.at<cv::Vec2f>(y, x) *= shines.at<float>(y, x);
  return way;
}

cv::Mat FormFrames::frame(int index) const {
  if (index == 0) return picture_.clone();
  cv::Mat flames = level(index);
  const float left = remaining(index, options_.handover_s);
  const cv::Mat bright = ground_->brightening(flames, 1 - left);
  const cv::Mat own = thinned_light(index);
  cv::Mat out = picture_.clone();
  for (int y = 0; y < out.rows; ++y) {
    auto* to = out.ptr<cv::Vec3f>(y);
    const auto* fluid = alpha_.ptr<float>(y);
    const auto* level = flames.ptr<float>(y);
    const auto* brighter = bright.ptr<float>(y);
    const auto* ground = still_.ground.ptr<cv::Vec3f>(y);
    const auto* picture = own.empty() ? nullptr : own.ptr<cv::Vec3f>(y);
    for (int x = 0; x < out.cols; ++x) {
      if (fluid[x] <= 0) continue;
      const float shown = left > 0 ? thinned(level[x], left * left) : level[x];
      const cv::Vec3f flame = colours_.at(std::min(shown, 1.0f));
      // The brighter one, without an edge where they are alike.
      const float share =
          picture == nullptr ? 1 : std::clamp(0.5f + 8 * (luma_of(flame) - luma_of(picture[x])), 0.0f, 1.0f);
      for (int k = 0; k < 3; ++k) {
        const float light = share == 1 ? flame[k] : picture[x][k] + share * (flame[k] - picture[x][k]);
        const float code = level_of(brighter[x] * ground[x][k] + light);
        to[x][k] += fluid[x] * (code - to[x][k]);
      }
    }
  }
  return out;
}

}  // namespace freshet::synth::animate
