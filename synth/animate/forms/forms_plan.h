// synth/animate/forms/forms_plan.h — whether a picture's fire can burn with forms of clips, and with which.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "stored/decoded_tiles.h"
#include "synth/animate/forms/clip_forms.h"
#include "synth/animate/forms/form_choice.h"
#include "synth/animate/forms/form_player.h"
#include "synth/animate/forms/parted_still.h"

namespace freshet::synth::animate {

/// All that rendering with forms is given.
struct FormsPlan {
  PartedStill still;
  std::vector<store::ClipId> clips;  // that burn, by form
  std::vector<ChosenForm> forms;     // none: the picture has no flames, or no clip has
  std::vector<std::unique_ptr<FormPlayer>> players;
  double fit = 0;    // of forms, 0..1
  std::string lack;  // what speaks against it, for a person; empty: nothing does
};

/// Flames that are lighter by less are no light over a ground (PartedStill::contrast).
inline constexpr double kLeastContrast = 0.2;
/// A fit below this is warned of.
inline constexpr double kFormsFit = 0.6;

/// picture  CV_32FC3, sRGB code. alpha  CV_32F. clips  in the order of their likelihood: the first kFormsClips that can
/// be played are looked at.
/// Cost     every clip looked at is decoded once.
FormsPlan plan_forms(const store::Snapshot& snapshot, int flow_step, const cv::Mat& picture,
                     const cv::Mat& alpha, std::span<const store::ClipId> clips, const FormPlaying& playing,
                     stored::DecodedTiles* tiles);
inline constexpr std::size_t kFormsClips = 16;

}  // namespace freshet::synth::animate
