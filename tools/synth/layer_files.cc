#include "tools/synth/layer_files.h"

#include "freshet/error.h"
#include "media/picture/exr_picture.h"
#include "media/picture/picture_sequence.h"
#include "media/video/output_format.h"
#include "tools/console/output_names.h"

namespace freshet::tools {
namespace {

constexpr std::string_view kLayer = "{layer}";
constexpr const char* kFilm = "(film)";  // no layer's name has brackets

}  // namespace

LayerFiles::LayerFiles(const std::string& name, const synth::scene::Scene& scene, cv::Size size,
                       std::int64_t first_number)
    : number_(first_number) {
  if (name.empty()) return;
  const std::size_t at = name.find(kLayer);
  const media::OutputFormat format = media::output_format(name, scene.frames);
  if (!format.alpha())
    throw Error(ErrorKind::kUsage, "--layers-out " + name, "the ending names no format with alpha",
                "Use " + media::written_endings([](const media::FileFormat& each) { return each.alpha; }));
  if (at == std::string::npos && !format.light())
    throw Error(ErrorKind::kUsage, "--layers-out " + name, "it does not say where the layer's name stands",
                "For example --layers-out 'layers/{layer}.mov'; all layers go into one file in .exr alone");
  layers_.emplace(cv::Mat(size, CV_32FC3, cv::Scalar::all(0)), cv::Mat(size, CV_8UC3, cv::Scalar::all(0)),
                  cv::Mat(size, CV_8U, cv::Scalar(255)), media::Layer::kFluid,
                  format.light() ? media::AlphaForm::kPremultiplied : media::AlphaForm::kStraight,
                  format.samples());
  const FrameNumbers numbers{.first = first_number,
                             .last = first_number + scene.frames - 1,
                             .from = first_number,
                             .to = first_number + scene.frames - 1};
  for (const synth::scene::SceneLayer& layer : scene.layers) names_.push_back(layer.name);
  if (at == std::string::npos) {
    check_frames_output(name, numbers);
    parts_ = name;
    files_.push_back(name);
    return;
  }
  media::VideoWriterOptions options;
  options.first_number = first_number;
  for (const std::string& layer : names_) {
    std::string file = name;
    file.replace(at, kLayer.size(), layer);
    check_frames_output(file, numbers);
    sinks_.push_back(std::make_unique<media::PictureSink>(file, size, scene.frames, scene.fps, options));
    files_.push_back(file);
  }
}

void LayerFiles::write(synth::scene::SceneAnimation& animation) {
  if (!parts_.empty()) write_parts(animation);
  for (std::size_t i = 0; i < sinks_.size(); ++i) {
    animation.layer(i, layer_);
    sinks_[i]->write(layers_->frame(layer_));
  }
}

void LayerFiles::write_parts(synth::scene::SceneAnimation& animation) {
  std::vector<cv::Mat> motions = animation.motions();
  std::vector<media::ExrPart> parts;
  animation.whole(layer_);
  parts.push_back({kFilm, layers_->frame(layer_)});
  for (std::size_t i = 0; i < names_.size(); ++i) {
    animation.layer(i, layer_);
    if (!motions[i].empty()) {
      cv::extractChannel(layer_, alpha_, 3);
      motions[i].setTo(cv::Scalar::all(0), alpha_ == 0);
    }
    parts.push_back({names_[i], layers_->frame(layer_), motions[i]});
  }
  const std::filesystem::path file =
      media::is_pattern(parts_) ? media::numbered(parts_, number_++) : std::filesystem::path(parts_);
  media::write_exr_parts(file, parts, media::ExrSamples::kHalf);
}

void LayerFiles::finish() {
  for (const auto& sink : sinks_) sink->finish();
}

}  // namespace freshet::tools
