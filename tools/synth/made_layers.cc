#include "tools/synth/made_layers.h"

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "freshet/error.h"
#include "synth/sampling/pull_push.h"
#include "synth/scene/rendering/footage_frames.h"
#include "synth/scene/scene_marks.h"
#include "synth/transfer/files/design_files.h"
#include "synth/transfer/files/exemplar_files.h"
#include "synth/transfer/transfer.h"
#include "tools/synth/animate_run.h"

namespace freshet::tools {
namespace {

namespace scene = synth::scene;
namespace transfer = synth::transfer;

constexpr std::size_t kAhead = 3;

/// Frames that a function pushes, pulled one by one: it runs in a thread of its own, and waits where it is too far
/// ahead.
class PushedFrames : public scene::LayerFrames {
 public:
  using Sink = std::function<void(const cv::Mat&)>;
  explicit PushedFrames(std::function<void(const Sink&)> make) {
    thread_ = std::jthread([this, make = std::move(make)] {
      try {
        make([this](const cv::Mat& frame) { push(frame); });
      } catch (...) {
        const std::scoped_lock lock(mutex_);
        fault_ = std::current_exception();
      }
      const std::scoped_lock lock(mutex_);
      done_ = true;
      changed_.notify_all();
    });
  }
  ~PushedFrames() override {
    {
      const std::scoped_lock lock(mutex_);
      left_ = true;
      changed_.notify_all();
    }
    thread_.join();
  }

  const cv::Mat& next() override {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !waiting_.empty() || done_; });
    if (!waiting_.empty()) {
      frame_ = waiting_.front();
      waiting_.pop_front();
      changed_.notify_all();
      return frame_;
    }
    if (fault_) std::rethrow_exception(fault_);
    return frame_;  // the last one stays
  }
  cv::Point at() const override { return {0, 0}; }

 private:
  struct Left {};
  void push(const cv::Mat& frame) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_.size() < kAhead || left_; });
    if (left_) throw Left{};  // nobody waits for more: the maker ends
    waiting_.push_back(frame.clone());
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<cv::Mat> waiting_;
  cv::Mat frame_;
  std::exception_ptr fault_;
  bool done_ = false, left_ = false;
  std::jthread thread_;
};

std::unique_ptr<scene::LayerFrames> patches(const scene::Scene& asked, const scene::SceneLayer& layer,
                                            const scene::PatchesMotion& motion,
                                            const scene::LayerPixels& pixels, const RunContext& context) {
  AnimateRequest request;
  request.store = motion.store.string();
  request.words = motion.options;
  request.frames = asked.frames;
  request.fps = asked.fps;
  request.loop = asked.loop;
  request.where = fmt::format("{}: layer {}", asked.file.string(), layer.name);
  if (!motion.class_name.empty()) request.words.insert(request.words.end(), {"--class", motion.class_name});
  const std::vector<hints::Stroke> drawn = scene::strokes_of(asked, layer, pixels.alpha.size());
  if (!motion.strokes.empty())
    request.words.insert(request.words.end(), {"--strokes", motion.strokes.string()});
  // The fluid's own colours go on beyond its matte: copies of its rim bring nothing of what is beside it.
  const cv::Mat own = synth::sampling::pull_push(pixels.colour, pixels.alpha);
  TargetFiles::Loaded& loaded = request.loaded;
  own.convertTo(loaded.picture, CV_8U, 255);
  pixels.alpha.convertTo(loaded.matte, CV_8U, 255);
  loaded.still.bgr = loaded.picture;
  loaded.matte_known = true;
  request.strokes = drawn;
  return std::make_unique<PushedFrames>(
      [request, &context](const PushedFrames::Sink& sink) { animate_layer(request, sink, context); });
}

/// How many frames of a design go by before a loop of `frames` begins: its last ones go over into them.
int fade_of(const scene::Scene& asked, const scene::SceneLayer& layer, int design_frames) {
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
class TransferFrames : public scene::LayerFrames {
 public:
  TransferFrames(const scene::Scene& scene, const scene::SceneLayer& layer,
                 const scene::TransferMotion& motion, const RunContext& context)
      : at_(motion.at),
        files_(motion.design_alpha, motion.design_flow, 0),
        frames_(scene.frames),
        fade_(fade_of(scene, layer, files_.frames())),
        exemplar_(motion.exemplar, {.alpha = motion.exemplar_alpha,
                                    .ground = static_cast<transfer::Ground>(motion.ground),
                                    .patch = transfer::TransferOptions{}.patch,
                                    .frames = std::min(scene.frames + fade_, files_.frames())}) {
    files_.check({}, context.stop);
    if (motion.ground != scene::ExemplarGround::kNone) {
      const transfer::TransferOptions options;
      const transfer::Extent extent = transfer::mean_extent(files_.frames(), kSeen, options,
                                                            [this](int i) { return files_.read(i).alpha; });
      exemplar_.fit_body(extent, options);
    }
    exemplar_.check({}, context.stop);
    transfer::check_outline(files_, exemplar_, motion.design_alpha);
    making_.emplace([this](int t) { return exemplar_.at(t); }, transfer::TransferOptions{});
  }
  const cv::Mat& next() override {
    while (frame_ < fade_) {
      make();
      before_.push_back(out_.clone());
    }
    if (frame_ < files_.frames()) make();
    // Of the loop, from 0 on.
    const int left = frames_ + fade_ - frame_;
    if (left < fade_) {
      const double share = (fade_ - left) / (fade_ + 1.0);
      cv::addWeighted(out_, 1 - share, before_[static_cast<std::size_t>(fade_ - 1 - left)], share, 0, out_);
    }
    return out_;
  }
  cv::Point at() const override { return at_; }

 private:
  static constexpr int kSeen = 8;  // of the design's frames, for its extent

  void make() {
    making_->next(files_.read(frame_++)).bgra.copyTo(out_);
    for (int y = 0; y < out_.rows; ++y) {
      auto* row = out_.ptr<cv::Vec4f>(y);
      for (int x = 0; x < out_.cols; ++x)
        for (int c = 0; c < 3; ++c) row[x][c] *= row[x][3];
    }
  }

  cv::Point at_;
  transfer::DesignFiles files_;
  int frames_, fade_;
  transfer::ExemplarFiles exemplar_;
  std::optional<transfer::Transfer> making_;
  int frame_ = 0;                // of the design, that is made next
  std::vector<cv::Mat> before_;  // the loop's past: its last frames go over into them
  cv::Mat out_;
};

}  // namespace

std::unique_ptr<scene::LayerFrames> frames_of_layer(const scene::Scene& asked, const scene::SceneLayer& layer,
                                                    const scene::LayerPixels& pixels,
                                                    const RunContext& context) {
  if (const auto* motion = layer.as<scene::PatchesMotion>())
    return patches(asked, layer, *motion, pixels, context);
  if (const auto* motion = layer.as<scene::TransferMotion>())
    return std::make_unique<TransferFrames>(asked, layer, *motion, context);
  const auto& footage = *layer.as<scene::FootageMotion>();
  return std::make_unique<scene::FootageFrames>(footage.file, footage.at, asked.frames, asked.loop,
                                                footage.width);
}

}  // namespace freshet::tools
