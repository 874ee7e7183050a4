// synth/animate/animate.h — a still picture animated with the patches assigned to it.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "query/search/motion_guide.h"
#include "query/stored/decoded_tiles.h"
#include "store/store.h"
#include "synth/animate/blend/blend.h"
#include "synth/animate/clips/clip_layer.h"
#include "synth/animate/motion/carrying_field.h"
#include "synth/animate/motion/moving_boundary.h"
#include "synth/animate/placement/placement.h"
#include "synth/animate/still/appearance.h"
#include "synth/animate/still/base_image.h"
#include "synth/animate/still/carried_base.h"
#include "synth/animate/still/lost_contrast.h"
#include "vision/settings.h"

namespace freshet::synth::animate {

/// How frames are made.
enum class Method {
  kCarried,  // motion from the patches, look from the picture: the picture is carried along the patches' motion
  kPaper,    // Okabe et al. 2011, Sec. 6: the patches' differences on a long exposure of the picture
};

enum class AppearanceMatching {
  kNone,
  kFrame,     // the paper's: each frame by itself; it pumps
  kSequence,  // one model for the whole animation
};

/// What the sink is given. kFluid over the picture is the whole; so it is over what lies behind a moving outline
/// (behind_fluid), where that is guessed once the still that the whole begins with has gone.
enum class FrameForm {
  kWhole,  // CV_8UC3: the picture with the fluid in it
  kFluid,  // CV_32FC4: the fluid alone, its colour (1 is white) times its matte, and the matte; nothing rounded
};

struct AnimateOptions {
  int frames = 96;
  int from = 0;   // only the frames from this one on are made and handed on, the same as if all were
  int until = 0;  // only the frames before this one; 0: all
  FrameForm form = FrameForm::kWhole;
  double fps = 25;
  bool loop = false;  // the last frame is followed by the first, without a seam
  Resampling resampling = Resampling::kFlow;
  /// Frames are made in batches that fit into this, as far as the picture itself leaves room: beside the
  /// batch some 280 bytes per pixel are needed (0.26 GB at 1280 x 720, 2.3 GB at 3840 x 2160). When all
  /// frames fit, each clip is read once, else about three times.
  std::size_t memory_bytes = std::size_t{2000} << 20;
  BlendOptions blend;
  BaseImageOptions base;
  Method method = Method::kCarried;
  /// kCarried: the motion, and the copies of the picture that it carries.
  CarryingOptions carrying;
  CarriedBaseOptions carry;
  LostContrastOptions contrast;
  /// kCarried: how long detail lives that is carried along, s, until half of it is left; 0: as long as in the clips
  /// that are shown.
  double half_life_s = 0;
  /// kCarried: how much shorter detail lives where the fluid is made to go faster than its patches (pace): lives are
  /// divided by pace to this power. Eddies of one size turn over in a time that falls as their speed rises. .5 and 1
  /// bring clouds' spectrum from 4.2 to 4.0 and 3.8 dB and all kinds nearer in detail; at 1 fire's lives are too short.
  double life_pace = 0.5;
  /// kCarried: of what stays in its place in the patches (standing_shares), how much the picture keeps, 0..1; 0: all
  /// that is fluid goes.
  double standing = 1;
  /// kCarried: of what comes anew in the patches from frame to frame, how much does so in the picture, 0..1, and by how
  /// much an innovation is amplified at most (RenewalOptions).
  double renewal = 1;
  double max_renewal_gain = 4;
  /// kCarried: the motion alone: nothing comes from the patches' pixels, neither innovations nor their light, and no
  /// frame of a clip is read. For a first look: a third of the time.
  bool motion_alone = false;
  /// What was asked of the motion: the picture is blurred and carried so (apply_guide).
  query::MotionGuide guide{};
  /// kPaper: contrast and levels brought to the picture's.
  AppearanceMatching matching = AppearanceMatching::kSequence;
  AppearanceOptions appearance;
  BoundaryOptions boundary;
  /// Of the snapshot, decoded for earlier animations; null: none are kept. It changes the time taken, and nothing else.
  std::shared_ptr<query::DecodedTiles> tiles{};
  std::function<void(const cv::Mat&)> matte_sink;  // each frame's matte, CV_32F 0..1
  /// kCarried: where what lies at a pixel goes until the next frame, CV_32FC2, px, the picture's size; 0 beside the
  /// matte.
  std::function<void(const cv::Mat&)> motion_sink;
};

/// Where the time went, and with what.
struct AnimateReport {
  std::size_t clips = 0, pieces = 0;
  int batches = 1;         // of frames
  double half_life_s = 0;  // of all detail; 0: none was carried
  double renewed = 0;      // of the variance of the patches' detail, what is new in each frame, 0..1
  double decode_s = 0, blend_s = 0, base_s = 0, appearance_s = 0, render_s = 0, total_s = 0;
};

/// Renders the animation frame by frame into `sink`: the picture's size, in order, one at a time, while the next
/// ones are made. The sinks of mattes and motion are called in order too, from another thread.
///
/// picture    CV_8UC3 BGR, or CV_32FC3: sRGB code, 1 is white.
/// matte      CV_8U, same size; where it is 0 every output pixel equals the picture's.
/// placement  clips that do not last frames / fps seconds are played again by their loop rules (timeline.h).
///            With `loop`, clips play whole numbers of their loops, each beginning at another moment.
/// Throws     Error{kInput} when the placement does not pass check(), or a clip is too short for the
///            animation and for a loop rule; Error{kCancelled} when stopped.
/// Memory     see AnimateOptions::memory_bytes. The same frames for any of it, and any number of threads.
/// Source     Okabe et al. 2011, Sec. 6.
AnimateReport animate(const store::Snapshot& snapshot, const vision::Settings& settings,
                      const cv::Mat& picture, const cv::Mat& matte, const Placement& placement,
                      const AnimateOptions& options, const std::function<void(const cv::Mat&)>& sink,
                      const ProgressFunction& progress = {}, std::stop_token stop = {});

}  // namespace freshet::synth::animate
