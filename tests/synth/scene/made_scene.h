// tests/synth/scene/made_scene.h — a small drawn scene: a tree, a boat and its lake, sky and shore.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "synth/scene/rendering/scene_animation.h"
#include "synth/scene/scene_file.h"
#include "synth/scene/scene_marks.h"

namespace freshet::synth::scene {

inline const cv::Size kMadeSize(160, 120);

/// Layers: tree, boat, lake, sky, (rest). wind   lines of the table [wind].
inline std::string made_scene_text(const std::string& wind, const std::string& more = {}) {
  return "picture = \"still.png\"\nframes = 20\nfps = 20\nloop = true\n[wind]\n" + wind + R"(
[[layer]]
name = "tree"
matte = "tree.png"
motion = "tree"
armature = [30, 80, 30, 20]
mass = 2
shimmer = 0.5
[[layer]]
name = "boat"
matte = "boat.png"
motion = "boat"
hull = [80, 90, 120, 90]
[[layer]]
name = "lake"
matte = "lake.png"
motion = "water"
horizon = [0, 58, 160, 58]
amplitude = 6
tile = 64
[[layer]]
name = "sky"
matte = "sky.png"
motion = "clouds"
)" + more;
}

/// The layers' pixels, made and not cut, so that their truth is known.
class MadeScene {
 public:
  explicit MadeScene(const std::string& text) : scene_(parse_scene(text, "made.toml")) {
    cv::Mat noise(kMadeSize, CV_32FC3);
    cv::RNG random(5);
    random.fill(noise, cv::RNG::UNIFORM, 0.2, 0.8);
    cv::GaussianBlur(noise, noise, {}, 1.0);
    cv::RNG(6).fill(picture_ = cv::Mat(kMadeSize, CV_32FC3), cv::RNG::UNIFORM, 0, 0.2);
    picture_ += noise;
    // As bytes hold it.
    cv::Mat bytes;
    picture_.convertTo(bytes, CV_8U, 255);
    bytes.convertTo(picture_, CV_32F, 1.0 / 255);
    const auto alpha = [](auto&& draw) {
      cv::Mat out(kMadeSize, CV_32F, cv::Scalar(0));
      draw(out);
      return out;
    };
    const std::vector<cv::Mat> alphas{alpha([](cv::Mat& a) { a(cv::Rect(15, 15, 30, 66)).setTo(1); }),
                                      alpha([](cv::Mat& a) { a(cv::Rect(78, 70, 44, 22)).setTo(1); }),
                                      alpha([](cv::Mat& a) { a(cv::Rect(0, 60, 160, 60)).setTo(1); }),
                                      alpha([](cv::Mat& a) { a(cv::Rect(0, 0, 160, 50)).setTo(1); }),
                                      alpha([](cv::Mat& a) { a.setTo(1); })};
    for (std::size_t i = 0; i < scene_.layers.size(); ++i)
      pixels_.push_back(i < alphas.size() ? LayerPixels{picture_, alphas[i]} : LayerPixels{});
  }
  Scene& scene() { return scene_; }
  const cv::Mat& picture() const { return picture_; }
  std::vector<LayerPixels>& pixels() { return pixels_; }
  SceneAnimation& animation() {
    if (!animation_) {
      read_marks(scene_, kMadeSize);
      animation_ = std::make_unique<SceneAnimation>(scene_, pixels_, kMadeSize);
    }
    return *animation_;
  }

 private:
  Scene scene_;
  cv::Mat picture_;
  std::vector<LayerPixels> pixels_;
  std::unique_ptr<SceneAnimation> animation_;
};

}  // namespace freshet::synth::scene
