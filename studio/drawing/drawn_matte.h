// studio/drawing/drawn_matte.h — the mattes and maps that a document's scribbles and brushes mean.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "studio/drawing/document.h"

namespace freshet::studio {

struct DrawnMatte {
  cv::Mat alpha;                     // CV_8U, the picture's size
  std::vector<std::string> notices;  // for a person
};

/// How much care a matte is made with: a draft is there in a tenth of a second, for the eye.
enum class Care { kDraft, kFull };

/// The fluid's matte; nothing while the document says too little for one (no mark of fluid). As `synth matte` makes it,
/// with what was painted laid over.
/// picture  CV_8UC3. alpha   the picture's own, or empty. given   the matte of MatteBase::kFile and kWhole, else empty.
/// Throws   Error{kInput} as synth::matte::make_matte, Error{kCancelled}.
std::optional<DrawnMatte> draw_matte(const Document& document, const cv::Mat& picture, const cv::Mat& alpha,
                                     const cv::Mat& given, Care care, std::stop_token stop = {});

/// What stands in front of the fluid, CV_8U; empty: nothing.
cv::Mat draw_held(const Document& document, cv::Size picture);

/// How fast clips play where, as `synth animate --retiming-map` reads it: CV_8UC3, grey; empty: as everywhere.
cv::Mat draw_tempo(const Document& document, cv::Size picture);

/// Lays painted lines and areas over a matte, in order, with smooth edges.
void paint(const std::vector<Drawn>& lines, cv::Mat& matte);

}  // namespace freshet::studio
