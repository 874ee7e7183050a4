// tests/synth/takes/trial_scene.h — a picture whose fluid a made clip moves, labelled by hand.
#pragma once

#include "synth/takes/trial.h"
#include "tests/synth/animate/measured_clip.h"

namespace freshet::synth::takes {

struct TrialScene {
  animate::FlowingStore store{{animate::measured({.size = {200, 160}, .frames = 30, .steady = {2, 1}})}};
  cv::Mat picture = cv::Mat(144, 192, CV_8UC3), matte = cv::Mat(144, 192, CV_8U, cv::Scalar(0));
  query::Assignment assignment;
  query::MotionGuide asked;
  animate::Playing playing;
  animate::AnimateOptions options;

  TrialScene() {
    assignment.picture = picture.size();
    assignment.clips = {{"0.mkv", "water", "", "hash of 0.mkv"}};
    for (int y = 0; y + 48 <= 144; y += 24)
      for (int x = 0; x + 48 <= 192; x += 24)
        assignment.pieces.push_back({.corner = {x, y}, .clip = 0, .variant = {}, .patch = {x / 2, y / 2}});
    cv::RNG(3).fill(picture, cv::RNG::UNIFORM, 0, 255);
    cv::GaussianBlur(picture, picture, {}, 2);
    matte(cv::Rect(10, 10, 160, 110)).setTo(255);
    options.frames = 24;
  }
  Subject subject() const {
    return {.snapshot = store.snapshot(),
            .settings = store.settings(),
            .picture = picture,
            .matte = matte,
            .assignment = assignment,
            .asked = asked,
            .playing = playing,
            .options = options,
            .kind = "water"};
  }
};

}  // namespace freshet::synth::takes
