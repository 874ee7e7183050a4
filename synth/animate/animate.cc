#include "synth/animate/animate.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet_error.h"
#include "synth/animate/clip_luma.h"
#include "synth/animate/colour_model.h"
#include "synth/animate/motion_field.h"
#include "synth/animate/patch_window.h"

namespace freshet::synth {
namespace {

constexpr int kSampledFrames = 12;  // that the appearance model is fitted to
constexpr int kBatch = 8;           // frames rendered at once before they are handed on in order

class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void throw_if_stopped(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, "animate", "stopped");
}

/// All frames of all patches of one clip go into the blender.
void add_clip(const store::Snapshot& snapshot, store::ClipId clip, const Placement& placement,
              const std::vector<std::size_t>& patches, const AnimateOptions& options, Blender& blender,
              AnimateReport& report) {
  Stopwatch watch;
  const store::ClipRecord& record = snapshot.clip(clip);
  const cv::Size source(static_cast<int>(record.width), static_cast<int>(record.height));
  std::vector<PatchWindow> windows;
  std::vector<cv::Rect> needed;
  std::vector<float> scales;
  for (std::size_t p : patches) {
    const PlacedPatch& placed = placement.patches[p];
    windows.emplace_back(source, placed.variant, placed.patch, placement.side);
    needed.push_back(windows.back().needed());
    if (std::find(scales.begin(), scales.end(), placed.variant.scale) == scales.end())
      scales.push_back(placed.variant.scale);
  }
  const ClipLuma luma(snapshot, clip, needed, frames_shown(snapshot, clip, options.frames, options.fps));
  report.decode_s += watch.lap();

  struct Scratch {
    cv::Mat difference, reduced, window;
  };
  oneapi::tbb::enumerable_thread_specific<Scratch> scratches;
  oneapi::tbb::parallel_for(0, options.frames, [&](int frame) {
    Scratch& s = scratches.local();
    luma.difference(frame, s.difference);
    for (float scale : scales) {
      reduce_to_scale(s.difference, scale, s.reduced);
      for (std::size_t i = 0; i < patches.size(); ++i) {
        if (placement.patches[patches[i]].variant.scale != scale) continue;
        windows[i].cut(s.reduced, s.window);
        blender.add(frame, patches[i], s.window);
      }
    }
  });
  report.blend_s += watch.lap();
}

}  // namespace

AnimateReport animate(const store::Snapshot& snapshot, const vision::Settings& settings,
                      const cv::Mat& picture, const cv::Mat& matte, const Placement& placement,
                      const AnimateOptions& options, const std::function<void(const cv::Mat&)>& sink,
                      const std::function<void(const AnimateProgress&)>& progress, std::stop_token stop) {
  check(placement);
  Stopwatch total, watch;
  AnimateReport report;
  report.pieces = placement.patches.size();
  const auto tell = [&](const char* stage, std::size_t done, std::size_t of) {
    if (progress) progress({stage, done, of});
  };

  // The moving part: differences of every clip's patches, merged band by band.
  std::map<store::ClipId, std::vector<std::size_t>> patches_of;
  for (std::size_t p = 0; p < placement.patches.size(); ++p)
    patches_of[placement.patches[p].clip].push_back(p);
  report.clips = patches_of.size();
  Blender blender(placement, options.frames, options.blend);
  std::size_t done = 0;
  for (const auto& [clip, patches] : patches_of) {
    throw_if_stopped(stop);
    tell("blend", done++, patches_of.size());
    add_clip(snapshot, clip, placement, patches, options, blender, report);
  }
  tell("blend", done, patches_of.size());
  watch.lap();

  // The still part: the picture as a long exposure along the assigned motion.
  cv::Mat target, alpha;
  picture.convertTo(target, CV_32F, 1.0 / 255);
  matte.convertTo(alpha, CV_32F, 1.0 / 255);
  const cv::Mat target_luma = luma_of(target);
  const cv::Mat motion = motion_field(snapshot, settings, placement, picture.size());
  const cv::Mat base_luma = base_image(target_luma, alpha, motion, options.base);
  const ColourModel colours = fit_colour(target, target_luma, alpha);
  // What colour does beside luminance keeps its place, as blurred as the rest.
  cv::Mat modelled;
  apply_colour(colours, target_luma, modelled);
  const cv::Mat own_colour = base_image(target - modelled, alpha, motion, options.base);
  report.base_s = watch.lap();

  // The canvas of pieces overhangs the picture: cut it to what is seen.
  const cv::Rect canvas = canvas_of(placement), seen = canvas & cv::Rect({}, picture.size());
  std::vector<cv::Mat> luma(options.frames);
  oneapi::tbb::parallel_for(0, options.frames, [&](int frame) {
    const cv::Mat field = blender.take(frame);
    luma[frame] = base_luma.clone();
    cv::Mat inside = luma[frame](seen);
    cv::add(inside, field(seen - canvas.tl()), inside);
  });
  report.blend_s += watch.lap();

  const auto model_of = [&](std::span<const cv::Mat> frames) {
    return AppearanceModel(target_luma, alpha, frames, options.appearance);
  };
  std::optional<AppearanceModel> model;
  if (options.matching == AppearanceMatching::kSequence) {
    throw_if_stopped(stop);
    tell("match", 0, 1);
    std::vector<cv::Mat> sampled;
    const int count = std::min(options.frames, kSampledFrames);
    for (int i = 0; i < count; ++i) sampled.push_back(luma[i * options.frames / count]);
    model.emplace(model_of(sampled));
    tell("match", 1, 1);
  }
  report.appearance_s = watch.lap();

  // Frames: matched, coloured, laid into the picture through the matte.
  for (int first = 0; first < options.frames; first += kBatch) {
    throw_if_stopped(stop);
    const int count = std::min(kBatch, options.frames - first);
    std::vector<cv::Mat> finished(count);
    oneapi::tbb::parallel_for(0, count, [&](int i) {
      cv::Mat& frame = luma[first + i];
      if (model)
        frame = model->apply(frame);
      else if (options.matching == AppearanceMatching::kFrame)
        frame = model_of(std::span(&frame, 1)).apply(frame);
      cv::Mat colour;
      apply_colour(colours, frame, colour);
      frame.release();
      finished[i] = picture.clone();
      for (int y = 0; y < picture.rows; ++y) {
        const float* a = alpha.ptr<float>(y);
        const cv::Vec3f* moving = colour.ptr<cv::Vec3f>(y);
        const cv::Vec3f* own = own_colour.ptr<cv::Vec3f>(y);
        const cv::Vec3f* still = target.ptr<cv::Vec3f>(y);
        cv::Vec3b* out = finished[i].ptr<cv::Vec3b>(y);
        for (int x = 0; x < picture.cols; ++x) {
          if (a[x] <= 0) continue;
          for (int k = 0; k < 3; ++k) {
            const float value = std::clamp(moving[x][k] + own[x][k], 0.0f, 1.0f);
            out[x][k] = cv::saturate_cast<std::uint8_t>(255 * (a[x] * value + (1 - a[x]) * still[x][k]));
          }
        }
      }
    });
    for (const cv::Mat& frame : finished) sink(frame);
    tell("render", first + count, options.frames);
  }
  report.render_s = watch.lap();
  report.total_s = total.lap();
  return report;
}

}  // namespace freshet::synth
