#include "synth/scene/frames/made_frames.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "media/picture/motion_file.h"
#include "synth/scene/scene_file.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::synth::scene {
namespace {

/// A design whose flow says which of its frames it is of: (1 + frame / 10, -2) px.
class Design {
 public:
  explicit Design(int frames) {
    std::filesystem::create_directories(folder_ / "alpha");
    std::filesystem::create_directories(folder_ / "flow");
    cv::Mat mask(40, 40, CV_8U, cv::Scalar(0)), look(32, 32, CV_8UC3);
    cv::circle(mask, {20, 20}, 14, 255, -1);
    cv::GaussianBlur(mask, mask, {}, 2);
    cv::RNG(3).fill(look, cv::RNG::UNIFORM, 0, 256);
    cv::imwrite((folder_ / "look.png").string(), look);
    cv::imwrite((folder_ / "look_alpha.png").string(), mask(cv::Rect(4, 4, 32, 32)));
    for (int i = 0; i < frames; ++i) {
      cv::imwrite((folder_ / fmt::format("alpha/{:03}.png", i)).string(), mask);
      media::write_motion(folder_ / fmt::format("flow/{:03}.flo", i),
                          cv::Mat(mask.size(), CV_32FC2, cv::Scalar(1 + i / 10.0, -2)));
    }
  }
  /// Which of the design's frames the motion of each frame of a scene is of; -1: none, nothing moves.
  std::vector<int> frames_of_motion(int frames, bool loop) const {
    const Scene scene = parse_scene(
        fmt::format("picture = \"none.png\"\nframes = {}\nloop = {}\n[[layer]]\nname = \"smoke\"\nmotion = "
                    "\"transfer\"\ndesign_alpha = \"alpha\"\ndesign_flow = \"flow\"\nexemplar = "
                    "\"look.png\"\nexemplar_alpha = \"look_alpha.png\"\n",
                    frames, loop),
        folder_ / "scene.toml");
    const auto layer = frames_of_layer(scene, scene.layers[0], {}, {}, {}, FrameWork::kFramesAndMotion);
    std::vector<int> found;
    for (int i = 0; i < frames; ++i) {
      const cv::Size size = layer->next().size();
      const std::optional<cv::Mat> motion = layer->motion();
      EXPECT_TRUE(motion && motion->size() == size);
      const cv::Vec2f at = motion->at<cv::Vec2f>(5, 7);
      EXPECT_EQ(at[1], at[0] == 0 ? 0.0f : -2.0f);
      found.push_back(at[0] == 0 ? -1 : cvRound((at[0] - 1) * 10));
    }
    return found;
  }

 private:
  ScratchFolder folder_;
};

TEST(TransferFrames, MotionIsTheDesignsOfTheCourseOfWhichMoreIsSeen) {
  const Design design(14);
  EXPECT_EQ(design.frames_of_motion(5, false), (std::vector<int>{0, 1, 2, 3, 4}));
  // Six frames go by before the loop begins, and its last three show more of them than of what comes after its end: the
  // flow of the design's frame 5 leads to its frame 6, with which the loop begins.
  EXPECT_EQ(design.frames_of_motion(8, true), (std::vector<int>{6, 7, 8, 9, 10, 3, 4, 5}));
}

TEST(TransferFrames, WhatStaysDoesNotMove) {
  const Design design(3);
  EXPECT_EQ(design.frames_of_motion(5, false), (std::vector<int>{0, 1, -1, -1, -1}));
  EXPECT_EQ(design.frames_of_motion(3, false), (std::vector<int>{0, 1, 2}));
}

}  // namespace
}  // namespace freshet::synth::scene
