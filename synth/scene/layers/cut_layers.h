// synth/scene/layers/cut_layers.h — a picture taken apart: layers with soft edges, and what lies behind each.
#pragma once

#include <functional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/layers/bayesian_matting.h"
#include "synth/scene/layers/exemplar_fill.h"

namespace freshet::synth::scene {

enum class MatteKind {
  kRegion,  // inside from 128 on; alpha is found in a band along its edge
  kTrimap,  // 255 inside, 0 outside, all else unsure
  kAlpha,   // alpha itself, CV_8U or CV_32F 0..1: colours alone are found
  kRest,    // no matte: all that the layers before leave. The last layer, and only it
};
/// What a matte looks like: of black and white alone a region; with one grey besides a trimap; else alpha.
/// matte  CV_8U, CV_32F.
MatteKind kind_of_matte(const cv::Mat& matte);

struct LayerMatte {
  std::string name;  // for messages
  cv::Mat matte{};   // CV_8U, or CV_32F 0..1, of the picture's size; empty for kRest
  MatteKind kind = MatteKind::kRegion;
  cv::Mat paint{};  // CV_32FC3, sRGB code: its colour, painted and not cut, with kAlpha; empty: the picture's
  double uncover_px =
      -1;  // how far its motion can uncover what lies behind it; negative: CutOptions::uncover_px
};

enum class AlphaMethod {
  kBayesian,         // bayesian_matting
  kInformationFlow,  // synth/matte/soft_edge; colours as estimate_colours
  kGuided,           // the same
  kHard,             // the region itself, and the picture's own colours: a cut with scissors
};
AlphaMethod parse_alpha_method(const std::string& name);  // "bayesian", ...; Error{kUsage}
const char* to_string(AlphaMethod method);

struct CutOptions {
  AlphaMethod alpha = AlphaMethod::kBayesian;
  double band_px = 0;  // of a region, half of it to either side of its edge; 0: 1.5 % of the longer side
  MattingOptions matting{};
  FillOptions fill{};
  double uncover_px = 32;  // a stripe so wide is filled with patches, what lies deeper by Navier-Stokes
  cv::Mat refill{};        // CV_8U or empty: where above 0, filled stripes are filled again, as follows
  int refill_search_px = 192;
};

/// A layer as it is composited.
struct CutLayer {
  std::string name;
  cv::Mat colour;  // CV_32FC3, sRGB code, straight; 0 where alpha is 0: resample it times alpha
  cv::Mat alpha;   // CV_32F, 0..1, multiples of 1/255: eight bits hold it
  cv::Mat filled;  // CV_8U, 255: where the picture shows something nearer, so that this was filled in
  /// CV_32SC2: the place that what lies behind is a copy of, its own beside the layer. Empty: the rest.
  cv::Mat source{};
  double matting_s = 0, filling_s = 0;
};

/// Called before each layer with its place and name.
using CutProgress = std::function<void(std::size_t layer, const std::string& name)>;

/// Takes layers off a picture, from the nearest on: alpha and colours of each, then what lies behind it, which is the
/// picture that the next one is taken from. Where something is filled in, the mattes of the layers further back go on
/// as they are where the copies come from: what is behind a tree before a lake is lake, and ripples with it.
///
/// picture   CV_32FC3, sRGB code (media::coded_picture).
/// Returns   a layer for each matte, in their order. Laid over each other unmoved, (colour times alpha, over) in
///           32 bits give the picture to 1e-4; rounded to 8 or 16 bits within a level; but for what is painted.
/// Throws    Error{kUsage}: no mattes, the rest not last or missing, a matte of another size or type.
///           Error{kInput} naming the layer: nothing of it in the picture; it leaves nothing that could be behind it.
///           Error{kCancelled}.
/// Cost      bench/choices/layers.cc. The same for any number of threads.
/// Source    Chuang, Goldman, Zheng, Curless, Salesin, Szeliski 2005, Sec. 2. Theirs draws each trimap on the picture
///           as filled so far; ours has all mattes from the start, and carries them along.
std::vector<CutLayer> cut_layers(const cv::Mat& picture, std::span<const LayerMatte> nearest_first,
                                 const CutOptions& options = {}, const CutProgress& progress = {},
                                 std::stop_token stop = {});

/// The layers over each other, CV_32FC3.
cv::Mat composited(std::span<const CutLayer> nearest_first);

}  // namespace freshet::synth::scene
