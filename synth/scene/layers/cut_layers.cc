#include "synth/scene/layers/cut_layers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "synth/matte/soft_edge.h"
#include "synth/outline/background.h"

namespace freshet::synth::scene {
namespace {

constexpr double kBandShare = 0.015;  // of the longer side
constexpr int kRim_px = 2;  // around a layer still holds some of its light: nothing is concluded from it

std::uint8_t byte_at(const cv::Mat& matte, int y, int x) { return matte.at<std::uint8_t>(y, x); }

cv::Mat bytes_of(const cv::Mat& matte) {
  cv::Mat bytes;
  matte.convertTo(bytes, CV_8U, matte.depth() == CV_32F ? 255 : 1);
  return bytes;
}

cv::Mat widened(const cv::Mat& mask, double by_px) {
  // A disc of any width by its distance: a structuring element would cost its area.
  if (by_px <= 0) return mask.clone();
  cv::Mat distance;
  cv::distanceTransform(mask == 0, distance, cv::DIST_L2, 5);
  return distance <= by_px;
}

[[noreturn]] void refuse(const LayerMatte& layer, const std::string& fault, const std::string& remedy) {
  throw Error(ErrorKind::kUsage, "layer \"" + layer.name + "\"", fault, remedy);
}

void check(const cv::Mat& picture, std::span<const LayerMatte> layers) {
  if (picture.type() != CV_32FC3 || picture.empty())
    throw Error(ErrorKind::kUsage, "layers", "the picture has not 3 channels of 32 bits",
                "Give media::coded_picture");
  if (layers.empty())
    throw Error(ErrorKind::kUsage, "layers", "there are none", "Give one with the matte rest");
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const LayerMatte& layer = layers[i];
    const bool last = i + 1 == layers.size(), rest = layer.kind == MatteKind::kRest;
    if (last != rest)
      refuse(layer, rest ? "it is the rest, and others lie behind it" : "the furthest layer is not the rest",
             "Let the furthest layer, and it alone, have the matte rest");
    if (rest) continue;
    if (layer.matte.size() != picture.size())
      refuse(layer,
             fmt::format("its matte is {} x {} px, the picture {} x {}", layer.matte.cols, layer.matte.rows,
                         picture.cols, picture.rows),
             "Give a matte of the picture's size");
    if (layer.matte.type() != CV_8U && layer.matte.type() != CV_32F)
      refuse(layer, "its matte is neither of 8 bits nor of 32", "Give one channel of either");
    if (!layer.paint.empty() && (layer.paint.type() != CV_32FC3 || layer.paint.size() != picture.size() ||
                                 layer.kind != MatteKind::kAlpha))
      refuse(layer, "its paint is not of the picture's size and type, or has no alpha", "Give both");
  }
}

// The middle of what is thinner than the band, of which nothing would be sure: masts, ropes, twigs.
cv::Mat spine_of_thin(const cv::Mat& region, double band_px) {
  cv::Mat depth, deepest;
  cv::distanceTransform(region, depth, cv::DIST_L2, 5);
  const cv::Mat wide = widened(depth > 0.5 * band_px, 0.5 * band_px + kRim_px);
  cv::dilate(depth, deepest, cv::Mat::ones(3, 3, CV_8U));
  return region & ~wide & (depth >= deepest);
}

cv::Mat trimap_of(const LayerMatte& layer, const cv::Mat& matte, double band_px) {
  if (layer.kind == MatteKind::kTrimap) {
    cv::Mat trimap(matte.size(), CV_8U, cv::Scalar(128));
    trimap.setTo(255, matte == 255);
    trimap.setTo(0, matte == 0);
    return trimap;
  }
  cv::Mat trimap = matte::trimap_of(matte >= 128, cv::Mat::zeros(matte.size(), CV_8U), band_px);
  trimap.setTo(255, spine_of_thin(matte >= 128, band_px));
  return trimap;
}

// Alpha of the trimap's unsure pixels by the other methods that the house has.
cv::Mat soft_alpha(const cv::Mat& picture, const cv::Mat& trimap, matte::Edge edge) {
  cv::Mat bytes, alpha;
  picture.convertTo(bytes, CV_8U, 255);
  cv::Mat marks = cv::Mat::zeros(trimap.size(), CV_8U);
  marks.setTo(matte::kFluid, trimap == 255);
  marks.setTo(matte::kBackground, trimap == 0);
  // Marks say all that is known: the band would be as wide as the picture, but for its cost.
  cv::Mat depth;
  cv::distanceTransform((trimap != 0) & (trimap != 255), depth, cv::DIST_L2, 5);
  double deepest = 0;
  cv::minMaxLoc(depth, nullptr, &deepest);
  matte::EdgeOptions options{.edge = edge, .width_px = 4 * deepest + 2};
  if (edge == matte::Edge::kGuided) options.guided_radius = 0.125;
  matte::soft_edge(bytes, trimap >= 128, marks, options).convertTo(alpha, CV_32F, 1 / 255.0);
  return alpha;
}

Matting matted(const LayerMatte& layer, const cv::Mat& matte, const cv::Mat& picture,
               const CutOptions& options) {
  cv::Mat alpha;
  if (layer.kind == MatteKind::kAlpha) {
    matte.convertTo(alpha, CV_32F, 1 / 255.0);
    if (!layer.paint.empty()) return {alpha, layer.paint.clone(), picture};
    return estimate_colours(picture, alpha, options.matting);
  }
  const double band =
      options.band_px > 0 ? options.band_px : kBandShare * std::max(picture.cols, picture.rows);
  const cv::Mat trimap = trimap_of(layer, matte, band);
  switch (options.alpha) {
    case AlphaMethod::kBayesian:
      return bayesian_matting(picture, trimap, options.matting);
    case AlphaMethod::kHard:
      cv::Mat(matte >= 128).convertTo(alpha, CV_32F, 1 / 255.0);
      return {alpha, picture, picture};
    case AlphaMethod::kInformationFlow:
      alpha = soft_alpha(picture, trimap, matte::Edge::kInformationFlow);
      break;
    case AlphaMethod::kGuided:
      alpha = soft_alpha(picture, trimap, matte::Edge::kGuided);
      break;
  }
  return estimate_colours(picture, alpha, options.matting);
}

/// The picture with what was taken off it filled in; and where each of its pixels comes from.
struct Behind {
  cv::Mat picture;  // CV_32FC3
  cv::Mat source;   // CV_32SC2; (-1, -1): from nowhere
};

// Navier-Stokes where no stripe reaches. Who looks there sees through a layer that moved further than was said.
void fill_deep(cv::Mat& picture, const cv::Mat& known) {
  if (cv::countNonZero(known == 0) == 0) return;
  cv::Mat bytes, filled;
  picture.convertTo(bytes, CV_8U, 255);
  // It is a guess at any size: on a copy of at most 640 px.
  filled = outline::inpaint_background(bytes, known == 0, {.margin_px = 0});
  filled.convertTo(filled, CV_32F, 1 / 255.0);
  filled.copyTo(picture, known == 0);
}

// What has no source of its own belongs to what the nearest pixel belongs to that has one.
void extend_sources(cv::Mat& source, const cv::Mat& hole, const cv::Mat& known) {
  const cv::Mat open = hole & (known == 0);
  if (cv::countNonZero(open) == 0) return;
  cv::Mat distance, label;
  cv::distanceTransform(known == 0, distance, label, cv::DIST_L2, 5, cv::DIST_LABEL_PIXEL);
  std::vector<cv::Point> place(static_cast<std::size_t>(cv::countNonZero(known)) + 1, cv::Point(-1, -1));
  for (int y = 0; y < hole.rows; ++y)
    for (int x = 0; x < hole.cols; ++x)
      if (byte_at(known, y, x))
        place[static_cast<std::size_t>(label.at<int>(y, x))] = source.at<cv::Point>(y, x);
  for (int y = 0; y < hole.rows; ++y)
    for (int x = 0; x < hole.cols; ++x)
      if (byte_at(open, y, x))
        source.at<cv::Point>(y, x) = place[static_cast<std::size_t>(label.at<int>(y, x))];
}

// hole: the layer and its rim. genuine: what of the picture has not been filled in before.
Behind filled_behind(const LayerMatte& layer, const cv::Mat& picture, const cv::Mat& hole,
                     const cv::Mat& genuine, const CutOptions& options) {
  const double uncover = layer.uncover_px >= 0 ? layer.uncover_px : options.uncover_px;
  cv::Mat known = hole == 0;
  if (cv::countNonZero(known) == 0)
    throw Error(ErrorKind::kInput, "layer \"" + layer.name + "\"",
                "it and those before it cover the whole picture: nothing shows what is behind",
                "Give it a smaller matte, or the layers behind it as paint");
  const cv::Mat stripe = hole & widened(known, uncover + kRim_px);
  cv::Mat source = known & genuine;
  // Where all that is left has been filled in before, copies of copies are better than nothing.
  if (cv::countNonZero(source) < 25 * options.fill.patch_px * options.fill.patch_px) source = known.clone();
  Filled filled = exemplar_fill(picture, {known, stripe, source}, options.fill);
  if (!options.refill.empty()) {
    const cv::Mat again = filled.filled & (options.refill > 0);
    if (cv::countNonZero(again) > 0) {
      FillOptions wider = options.fill;
      wider.search_px = options.refill_search_px;
      const cv::Mat standing = (known | filled.filled) & ~again;
      const Filled redone = exemplar_fill(filled.picture, {standing, again, source}, wider);
      redone.picture.copyTo(filled.picture, redone.filled);
      redone.source.copyTo(filled.source, redone.filled);
    }
  }
  known |= filled.filled;
  fill_deep(filled.picture, known);
  extend_sources(filled.source, hole, known);
  return {filled.picture, filled.source};
}

/// How far the colour behind may be moved from its guess.
float reach_of(float alpha) { return 0.04f + 0.3f * (1 - alpha) * (1 - alpha); }

/// The least alpha, in steps of 1/255, at which a colour of 0..1 over one near the guess gives the picture: white over
/// sky is no half white that only a whiter sky behind it could explain.
float possible_alpha(const cv::Vec3f& picture, float alpha, const cv::Vec3f& behind) {
  const float far = reach_of(alpha);
  float least = alpha;
  for (int c = 0; c < 3; ++c) {
    const float top = std::max(1.0f, picture[c]);
    const float high = std::min(top, behind[c] + far), low = std::max(0.0f, behind[c] - far);
    if (picture[c] > high) least = std::max(least, (picture[c] - high) / (top - high));
    if (picture[c] < low) least = std::max(least, 1 - picture[c] / low);
  }
  return least <= alpha ? alpha : std::min(1.0f, std::ceil(least * 255) / 255);
}

/// Moves two colours by little so that alpha F + (1 - alpha) B is the picture's. B gives way more, for it is guessed
/// and hidden until something moves; but not far, or where alpha is nearly 1 a small error of F would make it any
/// colour: single bright pixels that show when the rim moves away.
void explain(float picture, float alpha, float& front, float& behind) {
  constexpr float kYield = 4;  // variance of B's guess, in F's
  const float beta = 1 - alpha, far = reach_of(alpha);
  const float r = (picture - alpha * front - beta * behind) / (alpha * alpha + kYield * beta * beta);
  const float top = std::max(1.0f, picture);
  behind = std::clamp(behind + std::clamp(kYield * r * beta, -far, far), 0.0f, top);
  front = std::clamp((picture - beta * behind) / alpha, 0.0f, top);
  // What F cannot be, B is after all; and F where there is nearly no B.
  behind = std::clamp((picture - alpha * front) / beta, 0.0f, top);
  front = std::clamp((picture - beta * behind) / alpha, 0.0f, top);
}

// Colours of the layer and of what is behind it that give the picture, pixel by pixel.
// alpha_stands   it was given, and is not found out to be impossible.
void settle(const cv::Mat& picture, Matting& matting, cv::Mat& behind, bool alpha_stands) {
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      float& a = matting.alpha.at<float>(y, x);
      const cv::Vec3f c = picture.at<cv::Vec3f>(y, x);
      cv::Vec3f& f = matting.foreground.at<cv::Vec3f>(y, x);
      cv::Vec3f& b = behind.at<cv::Vec3f>(y, x);
      if (a <= 0) {
        f = {0, 0, 0};
        b = c;
      } else if (a >= 1) {
        f = c;
      } else {
        // Where much of what is behind is seen, it is what was seen; the more is hidden, the more it is the copy.
        const float t = std::clamp((a - 0.1f) / 0.6f, 0.0f, 1.0f), copy = t * t * (3 - 2 * t);
        b = b * copy + matting.background.at<cv::Vec3f>(y, x) * (1 - copy);
        if (!alpha_stands) a = possible_alpha(c, a, b);
        if (a >= 1)
          f = c;
        else
          for (int i = 0; i < 3; ++i) explain(c[i], a, f[i], b[i]);
      }
    }
}

// A further layer's matte where something nearer was taken off: as it is where the copy comes from.
void carry_matte(cv::Mat& matte, const cv::Mat& hole, const cv::Mat& source) {
  cv::Mat carried = matte.clone();
  for (int y = 0; y < matte.rows; ++y)
    for (int x = 0; x < matte.cols; ++x) {
      if (!byte_at(hole, y, x)) continue;
      if (const cv::Point from = source.at<cv::Point>(y, x); from.x >= 0)
        carried.at<std::uint8_t>(y, x) = std::max(byte_at(matte, y, x), byte_at(matte, from.y, from.x));
    }
  matte = carried;
}

void to_eight_bits(cv::Mat& alpha) {
  cv::Mat bytes;
  alpha.convertTo(bytes, CV_8U, 255);
  bytes.convertTo(alpha, CV_32F, 1 / 255.0);
}

/// What is left of the picture, and of the mattes, as layers come off it.
class Cutter {
 public:
  Cutter(const cv::Mat& picture, std::span<const LayerMatte> layers, const CutOptions& options)
      : layers_(layers),
        options_(options),
        picture_(picture.clone()),
        filled_(cv::Mat::zeros(picture.size(), CV_8U)) {
    for (const LayerMatte& layer : layers)
      mattes_.push_back(layer.kind == MatteKind::kRest ? cv::Mat() : bytes_of(layer.matte));
  }

  CutLayer cut(std::size_t at) {
    const LayerMatte& layer = layers_[at];
    CutLayer out{.name = layer.name, .colour = {}, .alpha = {}, .filled = {}};
    if (layer.kind == MatteKind::kRest) {
      out.colour = picture_;
      out.alpha = cv::Mat::ones(picture_.size(), CV_32F);
      out.filled = filled_;
      return out;
    }
    Stopwatch watch;
    if (cv::countNonZero(mattes_[at] >= (layer.kind == MatteKind::kRegion ? 128 : 1)) == 0)
      throw Error(ErrorKind::kInput, "layer \"" + layer.name + "\"", "its matte is black: nothing is in it",
                  "Paint white what belongs to it");
    Matting matting = matted(layer, mattes_[at], picture_, options_);
    to_eight_bits(matting.alpha);
    out.matting_s = watch.lap();

    const cv::Mat covered = matting.alpha > 0, rim = widened(covered, kRim_px);
    Behind behind = filled_behind(layer, picture_, rim, filled_ == 0, options_);
    if (layer.paint.empty())
      settle(picture_, matting, behind.picture, layer.kind == MatteKind::kAlpha);
    else
      picture_.copyTo(behind.picture, ~covered);
    for (std::size_t further = at + 1; further < layers_.size(); ++further)
      if (!mattes_[further].empty()) carry_matte(mattes_[further], rim, behind.source);
    out.colour = matting.foreground;
    out.colour.setTo(cv::Scalar::all(0), ~covered);
    out.alpha = matting.alpha;
    out.filled = filled_ & covered;
    out.source = behind.source;
    picture_ = behind.picture;
    filled_ |= rim;
    out.filling_s = watch.lap();
    return out;
  }

 private:
  std::span<const LayerMatte> layers_;
  const CutOptions& options_;
  cv::Mat picture_;
  cv::Mat filled_;               // CV_8U: what of the picture is not what it showed
  std::vector<cv::Mat> mattes_;  // CV_8U
};

}  // namespace

AlphaMethod parse_alpha_method(const std::string& name) {
  for (const AlphaMethod method :
       {AlphaMethod::kBayesian, AlphaMethod::kInformationFlow, AlphaMethod::kGuided, AlphaMethod::kHard})
    if (name == to_string(method)) return method;
  throw Error(ErrorKind::kUsage, "matting by " + name, "no such method",
              "One of bayesian, information-flow, guided, hard");
}

const char* to_string(AlphaMethod method) {
  switch (method) {
    case AlphaMethod::kBayesian:
      return "bayesian";
    case AlphaMethod::kInformationFlow:
      return "information-flow";
    case AlphaMethod::kGuided:
      return "guided";
    case AlphaMethod::kHard:
      return "hard";
  }
  return "";
}

MatteKind kind_of_matte(const cv::Mat& matte) {
  const cv::Mat bytes = bytes_of(matte);
  std::array<bool, 256> seen{};
  for (int y = 0; y < bytes.rows; ++y)
    for (int x = 0; x < bytes.cols; ++x) seen[byte_at(bytes, y, x)] = true;
  const auto greys = std::count(seen.begin() + 1, seen.end() - 1, true);
  if (greys == 0) return MatteKind::kRegion;
  return greys == 1 && seen[0] && seen[255] ? MatteKind::kTrimap : MatteKind::kAlpha;
}

std::vector<CutLayer> cut_layers(const cv::Mat& picture, std::span<const LayerMatte> nearest_first,
                                 const CutOptions& options, const CutProgress& progress,
                                 std::stop_token stop) {
  check(picture, nearest_first);
  if (!options.refill.empty() && (options.refill.type() != CV_8U || options.refill.size() != picture.size()))
    throw Error(ErrorKind::kUsage, "refill", "the region has another size than the picture",
                "Paint it over the picture");
  Cutter cutter(picture, nearest_first, options);
  std::vector<CutLayer> layers;
  for (std::size_t i = 0; i < nearest_first.size(); ++i) {
    if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, "layers", "stopped");
    if (progress) progress(i, nearest_first[i].name);
    layers.push_back(cutter.cut(i));
  }
  return layers;
}

cv::Mat composited(std::span<const CutLayer> nearest_first) {
  cv::Mat out = cv::Mat::zeros(nearest_first.back().colour.size(), CV_32FC3);
  for (auto layer = nearest_first.rbegin(); layer != nearest_first.rend(); ++layer)
    for (int y = 0; y < out.rows; ++y)
      for (int x = 0; x < out.cols; ++x) {
        const float a = layer->alpha.at<float>(y, x);
        cv::Vec3f& under = out.at<cv::Vec3f>(y, x);
        under = layer->colour.at<cv::Vec3f>(y, x) * a + under * (1 - a);
      }
  return out;
}

}  // namespace freshet::synth::scene
