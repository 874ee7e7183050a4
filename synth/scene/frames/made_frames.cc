#include "synth/scene/frames/made_frames.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "freshet/error.h"
#include "synth/sampling/pull_push.h"
#include "synth/scene/frames/footage_frames.h"
#include "synth/scene/scene_marks.h"
#include "synth/transfer/files/design_files.h"
#include "synth/transfer/files/exemplar_files.h"
#include "synth/transfer/transfer.h"

namespace freshet::synth::scene {
namespace {

PatchesTarget target_of(const Scene& scene, const SceneLayer& layer, const PatchesMotion& motion,
                        const LayerPixels& pixels) {
  PatchesTarget target{.scene = &scene, .layer = &layer, .motion = &motion, .picture = {}, .matte = {}};
  // The fluid's own colours go on beyond its matte: copies of its rim bring nothing of what is beside it.
  sampling::pull_push(pixels.colour, pixels.alpha).convertTo(target.picture, CV_8U, 255);
  pixels.alpha.convertTo(target.matte, CV_8U, 255);
  target.strokes = strokes_of(scene, layer, pixels.alpha.size());
  return target;
}

/// How many frames of a design go by before a loop of `frames` begins: its last ones go over into them.
int fade_of(const Scene& asked, const SceneLayer& layer, int design_frames) {
  constexpr int kFewest = 4, kMost = 24;
  if (!asked.loop) return 0;
  if (design_frames < asked.frames + kFewest)
    throw Error(ErrorKind::kInput, asked.file.string(),
                fmt::format("layer {}: its design has {} frames, and a loop of {} needs {} to go over into "
                            "its beginning",
                            layer.name, design_frames, asked.frames, asked.frames + kFewest),
                fmt::format("Design some {} frames, or loop fewer", asked.frames + kMost));
  return std::min({design_frames - asked.frames, kMost, asked.frames - 1});
}

/// The look of an exemplar on a designed motion, frame by frame; the design's last frame stays.
class TransferFrames : public LayerFrames {
 public:
  TransferFrames(const Scene& scene, const SceneLayer& layer, const TransferMotion& motion,
                 const std::stop_token& stop, FrameWork work)
      : at_(motion.at),
        work_(work),
        files_(motion.design_alpha, motion.design_flow, 0),
        frames_(scene.frames),
        fade_(fade_of(scene, layer, files_.frames())),
        exemplar_(motion.exemplar, {.alpha = motion.exemplar_alpha,
                                    .ground = motion.ground,
                                    .patch = transfer::TransferOptions{}.patch,
                                    .frames = std::min(scene.frames + fade_, files_.frames())}) {
    files_.check({}, stop);
    if (motion.ground != media::Ground::kNone) {
      const transfer::TransferOptions options;
      const transfer::Extent extent = transfer::mean_extent(files_.frames(), kSeen, options,
                                                            [this](int i) { return files_.read(i).alpha; });
      exemplar_.fit_body(extent, options);
    }
    exemplar_.check({}, stop);
    transfer::check_outline(files_, exemplar_, motion.design_alpha);
    making_.emplace([this](int t) { return exemplar_.at(t); }, transfer::TransferOptions{});
  }
  const cv::Mat& next() override {
    while (frame_ < fade_) {
      make();
      before_.push_back(out_.clone());
      flow_before_.push_back(flow_);
    }
    leading_ = &flow_;
    if (frame_ < files_.frames()) make();
    // The last frame of a shorter design stays.
    if (frame_ == files_.frames() && frame_ < frames_) flow_ = cv::Mat::zeros(out_.size(), CV_32FC2);
    // Of the loop, from 0 on.
    const int left = frames_ + fade_ - frame_;
    if (left < fade_) {
      const double share = (fade_ - left) / (fade_ + 1.0);
      const auto at = static_cast<std::size_t>(fade_ - 1 - left);
      cv::addWeighted(out_, 1 - share, before_[at], share, 0, out_);
      if (share > 0.5) leading_ = &flow_before_[at];
    }
    return out_;
  }
  /// The design's.
  std::optional<cv::Mat> motion() override { return *leading_; }
  cv::Point at() const override { return at_; }

 private:
  static constexpr int kSeen = 8;  // of the design's frames, for its extent

  void make() {
    const transfer::TargetFrame design = files_.read(frame_++);
    if (work_ == FrameWork::kFramesAndMotion) flow_ = design.flow;
    making_->next(design).bgra.copyTo(out_);
    for (int y = 0; y < out_.rows; ++y) {
      auto* row = out_.ptr<cv::Vec4f>(y);
      for (int x = 0; x < out_.cols; ++x)
        for (int c = 0; c < 3; ++c) row[x][c] *= row[x][3];
    }
  }

  cv::Point at_;
  FrameWork work_;
  transfer::DesignFiles files_;
  int frames_, fade_;
  transfer::ExemplarFiles exemplar_;
  std::optional<transfer::Transfer> making_;
  int frame_ = 0;                // of the design, that is made next
  std::vector<cv::Mat> before_;  // the loop's past: its last frames go over into them
  cv::Mat out_, flow_;
  std::vector<cv::Mat> flow_before_;  // of before_
  const cv::Mat* leading_ = &flow_;   // the flow of what more is seen of
};

}  // namespace

std::unique_ptr<LayerFrames> frames_of_layer(const Scene& scene, const SceneLayer& layer,
                                             const LayerPixels& pixels, const PatchesMaker& patches,
                                             const std::stop_token& stop, FrameWork work) {
  if (const auto* motion = layer.as<PatchesMotion>())
    return std::make_unique<PushedFrames>([target = target_of(scene, layer, *motion, pixels), &patches](
                                              const PushedFrames::Sinks& sinks) { patches(target, sinks); },
                                          work);
  if (const auto* motion = layer.as<TransferMotion>())
    return std::make_unique<TransferFrames>(scene, layer, *motion, stop, work);
  return std::make_unique<FootageFrames>(*layer.as<FootageMotion>(), scene.frames, scene.fps, scene.loop,
                                         stop);
}

}  // namespace freshet::synth::scene
