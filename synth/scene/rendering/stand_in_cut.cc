#include "synth/scene/rendering/stand_in_cut.h"

#include "synth/animate/sampling/pull_push.h"

namespace freshet::synth::scene {

std::vector<LayerPixels> stand_in_cut(const cv::Mat& picture, const std::vector<cv::Mat>& mattes,
                                      const Scene& scene) {
  std::vector<LayerPixels> pixels(scene.layers.size());
  cv::Mat open(picture.size(), CV_32F, cv::Scalar(1)), colour = picture.clone();
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    if (!scene.layers[i].is_cut()) continue;
    cv::Mat alpha(picture.size(), CV_32F, cv::Scalar(1));
    if (!mattes[i].empty()) mattes[i].convertTo(alpha, CV_32F, 1.0 / 255);
    pixels[i].alpha = mattes[i].empty() ? alpha : animate::pull_push(alpha, open);
    pixels[i].colour = colour.clone();
    open = open.mul(1 - alpha);
    colour = animate::pull_push(picture, open);
  }
  return pixels;
}

}  // namespace freshet::synth::scene
