// synth/animate/forms/form_frames.h — flames of clips over the picture's ground, frame by frame.
#pragma once

#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/animate/forms/form_choice.h"
#include "synth/animate/forms/form_look.h"
#include "synth/animate/forms/form_player.h"
#include "synth/animate/forms/lit_ground.h"
#include "synth/animate/forms/parted_still.h"

namespace freshet::synth::animate {

struct FormFramesOptions {
  int frames = 96;
  double fps = 25;
  bool loop = false;
  double handover_s = 0.2;  // after which nothing of the picture's own flames is left
  double settle_s = 0.6;    // after which the clip's flames, drawn to the picture's at first, burn as filmed
  /// How far the ground follows the light that falls on it by day (LitGround), 0..1.
  double lighting = 0.5;
};

/// Each pixel is ground, lit by the fire's level, plus the brighter of: flames of the clips, in the picture's levels
/// and colours; and at first the picture's own flames, which go up along the clips' flow and thin out. Frame 0 is the
/// picture, and so, in a loop, is the one after the last.
class FormFrames {
 public:
  /// still, forms, players   alive as long as this; a player for each form.
  /// picture  CV_32FC3, sRGB code. alpha  CV_32F, 0..1.
  FormFrames(const cv::Mat& picture, const cv::Mat& alpha, const PartedStill& still,
             const std::vector<ChosenForm>& forms, std::vector<std::unique_ptr<FormPlayer>>& players,
             const FormFramesOptions& options);

  /// Before frames that follow each other.
  void load(int first, int count);
  /// Where all that burns in a loaded frame goes until the next, which is loaded too: CV_32FC2, px, the picture's size;
  /// 0 where it is dark. The last frame leads to the one that would follow. Safe from many threads. Cost   two frames'
  /// levels, and vision::optical_flow at the picture's size.
  cv::Mat step(int index) const;
  /// CV_32FC3, sRGB code, of a loaded frame: the picture where alpha is 0. Safe from many threads.
  cv::Mat frame(int index) const;

 private:
  struct Drawn {
    cv::Mat start,
        end;  // CV_32FC2, px of rect(): from a place to where its light comes from, at first and at last
  };
  int period() const { return options_.frames; }
  /// How much of a transition of so many seconds is still to go: 1 at frame 0 (and, in a loop, at its end), to 0.
  float remaining(int index, double seconds) const;
  cv::Mat placed(std::size_t form, int index, const Drawn* drawn) const;
  cv::Mat level(int index) const;
  void match_levels();
  void draw_to_picture();
  void follow_flames();
  cv::Mat drawn_to_picture(const cv::Mat& level, std::size_t form) const;
  cv::Mat thinned_light(int index) const;
  cv::Mat burning(int index) const;

  const cv::Mat picture_, alpha_;
  const PartedStill& still_;
  const std::vector<ChosenForm>& forms_;
  std::vector<std::unique_ptr<FormPlayer>>& players_;
  FormFramesOptions options_;
  LightColours colours_;
  std::vector<LevelMaps> maps_;
  std::vector<double> soft_;  // sigma, px, by form
  std::vector<Drawn> drawn_;
  std::vector<cv::Mat> carried_up_,
      carried_down_;  // by frame of a handover: where the picture's flames come from
  cv::Mat beside_;  // CV_32F: levels that flames lose at the matte's edge, and behind what stands before them
  std::unique_ptr<LitGround> ground_;
};

}  // namespace freshet::synth::animate
