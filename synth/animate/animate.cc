#include "synth/animate/animate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "synth/animate/clips/piece_lives.h"
#include "synth/animate/clips/piece_standing.h"
#include "synth/animate/handover.h"
#include "synth/animate/motion/copy_maps.h"
#include "synth/animate/motion/motion_field.h"
#include "synth/animate/motion/motion_sequence.h"
#include "synth/animate/pieces_canvas.h"
#include "synth/animate/renewal.h"
#include "synth/animate/sampling/coarse_samples.h"
#include "synth/animate/sampling/enlarge.h"
#include "synth/animate/sampling/pull_push.h"
#include "synth/animate/staging.h"
#include "synth/animate/still/colour_model.h"
#include "synth/animate/still/finished_frame.h"
#include "synth/animate/still/fluid_planes.h"
#include "synth/animate/still/standing_detail.h"
#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

constexpr int kSampledFrames = 12;  // that the appearance model is fitted to
constexpr int kMinSampledFrames = 4;
constexpr int kSampledPixels = 32 << 20;  // in all of them
constexpr double kMinHalfLife_s = 0.1, kMaxHalfLife_s = 6;
constexpr double kMostLasting = 3;  // times that, of what does not come anew at once
// How far copies go from their own frames: forms should have left their place, but a pool is not to climb its fall.
constexpr double kMinWander_s = 0.4, kMaxWander_s = 6, kMaxWander_px = 220;
// Of a band of which a share s of the variance stands, s of the picture's own is the best guess of what does, and the root
// of s has its variance. Fine bands take the guess: what stands falsely is seen as a veil. From this level on (32 px) the
// light and dark of a scene are to stay as strong as they are.
constexpr double kWideLevel = 3;
constexpr float kMostLevel = 0.08f;   // luma
constexpr float kLively = 0.25f;      // of the fastest places' speed: what is slower is renewed less
constexpr double kLifePatch_px = 48;  // over which the picture's detail lives and goes together
constexpr int kRendered = 8;          // frames rendered at once before they are handed on in order

void throw_if_stopped(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, "animate", "stopped");
}

/// CV_32FC3, 1 is white.
cv::Mat in_units(const cv::Mat& picture) {
  cv::Mat out = picture;
  if (picture.depth() == CV_8U) picture.convertTo(out, CV_32F, 1.0 / 255);
  return out;
}

/// A picture has one light: fires breathe by less than kMostLevel, and what goes beyond it is a clip's flash, or a puff
/// that crosses it.
void limit_level(cv::Mat& level) {
  for (int y = 0; y < level.rows; ++y) {
    auto* at = level.ptr<float>(y);
    for (int x = 0; x < level.cols; ++x) at[x] = kMostLevel * std::tanh(at[x] / kMostLevel);
  }
}

/// Adds this much of what a frame is short of. CV_16SC3, levels.
void add_missing(const cv::Mat& missing, float share, cv::Mat& frame) {
  for (int y = 0; y < frame.rows; ++y) {
    auto* to = frame.ptr<std::uint8_t>(y);
    const auto* more = missing.ptr<std::int16_t>(y);
    for (int i = 0; i < 3 * frame.cols; ++i)
      to[i] = cv::saturate_cast<std::uint8_t>(to[i] + share * static_cast<float>(more[i]));
  }
}

/// A field that is sampled every few px, for every pixel; 0 where nothing is fluid.
cv::Mat for_every_pixel(const cv::Mat& field, int step, const cv::Mat& alpha) {
  cv::Mat out;
  cv::warpAffine(field, out, samples_from_pixels(step), alpha.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  out.setTo(cv::Scalar::all(0), alpha <= 0);
  return out;
}

/// One layer a clip, in the clips' order.
std::vector<std::unique_ptr<ClipLayer>> layers_of(const store::Snapshot& snapshot,
                                                  const vision::Settings& settings,
                                                  const Placement& placement, const AnimateOptions& options) {
  std::map<store::ClipId, std::vector<std::size_t>> patches_of;
  for (std::size_t p = 0; p < placement.patches.size(); ++p)
    patches_of[placement.patches[p].clip].push_back(p);
  std::vector<std::unique_ptr<ClipLayer>> layers;
  for (auto& [clip, patches] : patches_of) {
    // Cross-fades of different clips should not fall together: steps of the golden ratio spread them.
    const double phase = std::fmod(0.618034 * static_cast<double>(layers.size()), 1.0);
    layers.push_back(std::make_unique<ClipLayer>(
        snapshot, clip, settings.flow_step, placement, std::move(patches),
        TimelineOptions{.frames = options.frames, .fps = options.fps, .loop = options.loop, .phase = phase},
        options.resampling,
        options.method == Method::kCarried ? ClipDetail::kInnovation : ClipDetail::kDifference,
        options.tiles.get()));
  }
  return layers;
}

/// As many output frames as fit into the memory that the picture's own planes leave.
int batch_of(const std::vector<std::unique_ptr<ClipLayer>>& layers, cv::Size picture, cv::Size canvas,
             const AnimateOptions& options) {
  double fixed = static_cast<double>(kPictureBytesPerPixel) * picture.area(), clip_bytes = 0;
  for (const auto& layer : layers) {
    fixed += static_cast<double>(layer->average_bytes());
    clip_bytes = std::max(clip_bytes, static_cast<double>(layer->bytes_per_output()));
  }
  const double per_frame = canvas.area() * sizeof(float) * 4 / 3.0 + clip_bytes;
  const double fit = (static_cast<double>(options.memory_bytes) - fixed) / per_frame;
  if (fit >= options.frames) return options.frames;
  // In slabs of 16: a tile is decoded for all of its frames.
  return std::min(options.frames, std::max(16, static_cast<int>(fit) / 16 * 16));
}

/// The picture's luma as a long exposure along the motion; and what its colour does beside its luminance,
/// which keeps its place and is as blurred: CV_32FC3, BGR.
std::pair<cv::Mat, cv::Mat> exposed(const cv::Mat& target, const cv::Mat& luma, const ColourModel& colours,
                                    const cv::Mat& alpha, const cv::Mat& motion,
                                    const BaseImageOptions& options) {
  std::array<cv::Mat, 3> own;
  {
    cv::Mat modelled;
    apply_colour(colours, luma, modelled);
    cv::split(target - modelled, own.data());
  }
  // The model keeps luma: two of the three colours tell the third, and one pass blurs all.
  cv::Mat together;
  cv::merge(std::vector<cv::Mat>{luma, own[0], own[2]}, together);
  std::array<cv::Mat, 3> blurred;
  cv::split(base_image(together, alpha, motion, options), blurred.data());
  const cv::Mat green = -(kBlueLuma * blurred[1] + kRedLuma * blurred[2]) / kGreenLuma;
  cv::Mat own_colour;
  cv::merge(std::vector<cv::Mat>{blurred[1], green, blurred[2]}, own_colour);
  return {blurred[0], own_colour};
}

/// Adds how what is shown of a clip moves, output frame by output frame: of its flow in memory, where all of that is.
void add_motion(const store::Snapshot& snapshot, const Placement& placement, const ClipLayer& layer,
                MotionSums& sums) {
  const ClipLuma& luma = layer.luma();
  const HeldFlow held{luma.flow_region(), [&luma](std::uint32_t frame) { return luma.flow(frame); }};
  for (const ClipLayer::Played& group : layer.played()) {
    const PlacedPatch& one = placement.patches[group.patches.front()];
    PlayedPatches played{.clip = one.clip, .patches = group.patches, .shown = {}};
    const std::uint32_t last = snapshot.clip(one.clip).flow.frames - 1;
    bool all_held = true;
    for (const Moment& moment : group.moments) {
      // In a cross-fade the louder of the two moments moves the fluid.
      const auto at = static_cast<std::uint32_t>(moment.louder());
      played.shown.push_back({.frame = at, .rate = one.speed});
      all_held = all_held && luma.holds_flow(std::min(at, last));
    }
    sums.add(played, all_held ? &held : nullptr);
  }
}

/// Lengths in px are meant for pieces of their own size: enlarged ones are blurred, carried and matched as
/// widely. And a loop is one for all.
AnimateOptions enlarged(AnimateOptions options, double scale) {
  options.base.max_length_px *= scale;
  options.base.max_sigma_px *= scale;
  options.carry.edge_px *= scale;
  options.carry.look_px *= scale;
  options.appearance.region_px = static_cast<int>(std::lround(options.appearance.region_px * scale));
  options.appearance.levels += static_cast<int>(std::lround(std::log2(scale)));
  return options;
}

/// One animation, step by step: what stands still, what moves, and frames of both.
class Animation {
 public:
  Animation(const store::Snapshot& snapshot, const vision::Settings& settings, const cv::Mat& picture,
            const cv::Mat& matte, const Placement& placement, const AnimateOptions& asked,
            const ProgressFunction& progress, std::stop_token stop)
      : snapshot_(snapshot),
        settings_(settings),
        picture_(picture),
        matte_(matte),
        placement_(placement),
        options_(enlarged(asked, placement.piece_scale)),
        carried_(options_.method == Method::kCarried),
        detail_placement_(carried_ ? halved(placement) : placement),
        motion_alone_(carried_ && options_.motion_alone),
        moving_(options_.boundary.boundary == Boundary::kMoving),
        canvas_(detail_placement_, picture.size()),
        progress_(progress),
        stop_(std::move(stop)) {
    if (carried_) {
      options_.blend.low_band = LowBand::kShared;
      options_.matching = AppearanceMatching::kNone;
      if (motion_alone_) options_.renewal = 0;
    }
  }

  AnimateReport run(const std::function<void(const cv::Mat&)>& sink) {
    // What is wrong with the background is said before the work.
    if (moving_) behind_ = behind_fluid(picture_, matte_, options_.boundary);
    read_still();
    lay_out();
    merge_differences();
    expose();
    if (options_.matching == AppearanceMatching::kSequence) match();
    render(sink);
    for (const auto& layer : layers_) report_.decode_s += layer->read_s();
    report_.blend_s -= report_.decode_s;
    report_.total_s = total_.seconds();
    return report_;
  }

 private:
  void tell(const char* stage, std::size_t done, std::size_t of) const {
    if (progress_) progress_({stage, done, of});
  }

  /// The picture's luma and colours, and how its fluid is to go.
  void read_still() {
    target_ = in_units(picture_);
    target_luma_ = luma_of(target_);
    matte_.convertTo(alpha_, CV_32F, 1.0 / 255);
    oneapi::tbb::parallel_invoke(
        [&] {
          assigned_motion_ = motion_field(snapshot_, settings_, placement_, picture_.size());
          mean_motion_ = apply_guide(assigned_motion_, options_.guide);
        },
        [&] {
          colours_ = fit_colour(target_, target_luma_, alpha_,
                                static_cast<int>(std::lround(12 * placement_.piece_scale)));
        });
    report_.base_s = watch_.lap();
  }

  /// The clips, how many frames are in hand at once, and which ones the appearance model is fitted to.
  void lay_out() {
    layers_ = layers_of(snapshot_, settings_, detail_placement_, options_);
    batch_ =
        motion_alone_ ? options_.frames : batch_of(layers_, picture_.size(), canvas_.rect().size(), options_);
    in_one_ = batch_ == options_.frames;
    report_.pieces = placement_.patches.size();
    report_.clips = layers_.size();
    report_.batches = (options_.frames + batch_ - 1) / batch_;
    order_.resize(options_.frames);
    std::iota(order_.begin(), order_.end(), 0);
    // A region's histograms hold as many pixels whatever the picture's size; samples of a large picture would
    // not fit, and need not be as many.
    const int sampled = std::min({options_.frames, kSampledFrames,
                                  std::max(kMinSampledFrames, kSampledPixels / picture_.size().area())});
    for (int i = 0; i < sampled; ++i) samples_.push_back(i * options_.frames / sampled);
    if (!motion_alone_) blender_.emplace(detail_placement_, std::max(batch_, sampled), options_.blend);
    if (carried_) measure_lives();
  }

  void blend(ClipLayer& layer, std::span<const int> outputs) {
    throw_if_stopped(stop_);
    layer.add(outputs, *blender_);
    layer.release();
  }

  /// The moving part: the averages of every clip's patches, then their differences, merged band by band.
  void merge_differences() {
    if (motion_alone_) return measure_motion();
    const bool whole_loop = options_.loop && options_.resampling == Resampling::kNearest && !carried_;
    std::vector<double> change(options_.frames, 0.0);
    // What comes anew is carried on from frame to frame, and nothing comes back from frames behind the last wanted; a
    // model is fitted to samples of all.
    const auto needed = static_cast<std::size_t>(carried_ ? until() : options_.frames);
    std::optional<MotionSums> motion;
    if (carried_ || moving_)
      motion.emplace(snapshot_, settings_, placement_, picture_.size(), options_.frames,
                     options_.tiles.get());
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      throw_if_stopped(stop_);
      tell("blend", i, layers_.size());
      const std::span<const int> first = in_one_ ? std::span<const int>(order_).first(needed) : samples_;
      // Before all frames are held: it needs the samples alone, and what it holds is kept for the next step.
      if (carried_) renewal_->measure(*layers_[i], samples_);
      layers_[i]->measure(first, whole_loop ? &change : nullptr);
      if (motion) add_motion(snapshot_, placement_, *layers_[i], *motion);
      // Samples are for the model alone: without one, they would be left in the blender.
      if (in_one_ || options_.matching == AppearanceMatching::kSequence)
        blend(*layers_[i], first);
      else
        layers_[i]->release();
    }
    tell("blend", layers_.size(), layers_.size());
    if (carried_) renewal_->settle(), report_.renewed = renewal_->overall();
    if (motion) sequence_ = std::make_shared<const MotionSequence>(std::move(*motion).means());
    // Made of whole frames, a loop begins after the transition that changes the picture least (else its
    // timelines see to the seam).
    if (whole_loop)
      first_ = static_cast<int>((std::min_element(change.begin(), change.end()) - change.begin() + 1) %
                                options_.frames);
    report_.blend_s = watch_.lap();
  }

  /// The motion of what is shown, from the flow of the clips alone.
  void measure_motion() {
    MotionSums motion(snapshot_, settings_, placement_, picture_.size(), options_.frames,
                      options_.tiles.get());
    for (const auto& layer : layers_) add_motion(snapshot_, placement_, *layer, motion);
    sequence_ = std::make_shared<const MotionSequence>(std::move(motion).means());
  }

  /// The still part: the picture as a long exposure along the assigned motion, and what is carried over it.
  void expose() {
    tell("base", 0, 0);
    cv::Mat own_colour;
    std::tie(base_luma_, own_colour) =
        exposed(target_, target_luma_, colours_, alpha_, mean_motion_, options_.base);
    if (carried_) {
      const int loop_frames = options_.loop ? options_.frames : 0;
      CarryingOptions carrying = options_.carrying;
      if (options_.guide.direction.empty() && options_.guide.speed.empty()) carrying.max_of_asked = 0;
      field_ = std::make_shared<const CarryingField>(sequence_, mean_motion_, options_.frames, options_.fps,
                                                     CarriedBase::kStep, options_.loop, carrying);
      const FluidPlanes planes = fluid_planes(target_, target_luma_, alpha_);
      carried_base_.emplace(planes, alpha_, options_.carry);
      // As far as the fastest fluid goes in that time: what stands in the picture's order is not to be mixed up.
      const double wander_s =
          std::clamp(kMaxWander_px * placement_.piece_scale / (fast_per_frame() * options_.fps), kMinWander_s,
                     kMaxWander_s);
      copies_.emplace(
          [field = field_](int i) { return field->at(i); }, carried_base_->places(), field_->step(),
          CopyOptions{.interval = CopyMaps::interval_of(lasting_life(), options_.fps, loop_frames),
                      .loop_frames = loop_frames,
                      .wander = static_cast<int>(std::lround(wander_s * options_.fps)),
                      .patch = kLifePatch_px * placement_.piece_scale / CarriedBase::kStep});
      renewing_ = renewing_places();
      cv::Mat renewing_pieces = canvas_.cut_samples(renewing_, field_->step());
      if (!motion_alone_) {
        cv::multiply(renewing_, canvas_.sampled(renewal_->places(), field_->step(), renewing_.size()),
                     renewing_);
        cv::multiply(renewing_pieces, renewal_->places(), renewing_pieces);
        renewing_counts_ = Renewal::counts_of(renewing_pieces);
      }
      standing_.emplace(planes, alpha_, shares_that_stand());
    }
    // The fluid's layers go on beyond the still matte, for a moving one to uncover.
    if (moving_)
      for (cv::Mat* layer : {&own_colour, &colours_.slope, &colours_.offset})
        *layer = pull_push(*layer, alpha_);
    finisher_.emplace(colours_, carried_ ? ColourCurve(target_, target_luma_, alpha_) : ColourCurve(),
                      own_colour, moving_ ? behind_ : target_);
    report_.base_s += watch_.lap();
  }

  /// By level of the picture, what of it keeps its place.
  std::vector<double> shares_that_stand() const {
    const int levels = vision::levels_within(target_.size(), options_.contrast.levels);
    std::vector<double> shares = standing_shares(snapshot_, placement_, levels);
    for (std::size_t level = 0; level < shares.size(); ++level)
      shares[level] =
          std::pow(shares[level], 1 - 0.5 * std::min(1.0, static_cast<double>(level) / kWideLevel));
    for (double& share : shares) share *= options_.standing;
    return shares;
  }

  /// Of the fluid, the speed that one place in twenty exceeds: px a frame, > 0.
  float fast_per_frame() const {
    const cv::Mat &activity = field_->activity(), &places = carried_base_->places();
    std::vector<float> within;
    for (int y = 0; y < activity.rows; ++y)
      for (int x = 0; x < activity.cols; ++x)
        if (places.at<cv::Vec4f>(y, x)[0] > 0.5f) within.push_back(activity.at<float>(y, x));
    if (within.empty()) return 1;
    const auto fast = within.begin() + static_cast<std::ptrdiff_t>(within.size() * 19 / 20);
    std::nth_element(within.begin(), fast, within.end());
    return std::max(*fast, 1e-3f);
  }
  /// What stands is not renewed: a rock in the matte, or what an artist holds still.
  cv::Mat renewing_places() const {
    cv::Mat out = field_->activity() / (kLively * fast_per_frame());
    cv::multiply(out, out, out);
    return cv::min(out, 1.0);
  }
  /// How long what does not come anew at once is to live, so that all together keeps half for as long as the patches'
  /// detail does.
  double lasting_life() const {
    if (motion_alone_ || options_.half_life_s > 0) return half_life_s_;
    const double lasting = std::log(2.0) + std::log(1 - renewal_->overall());
    return half_life_s_ * std::min(kMostLasting, lasting > 0 ? std::log(2.0) / lasting : kMostLasting);
  }
  /// As long as detail does in the patches that are shown, but shorter where they are made to go faster: eddies of
  /// one size turn over in a time that falls as their speed rises.
  void measure_lives() {
    const PieceLives patches = piece_lives(snapshot_, placement_);
    const double faster = std::pow(pace(assigned_motion_, mean_motion_, matte_), options_.life_pace);
    half_life_s_ = options_.half_life_s > 0
                       ? options_.half_life_s
                       : std::clamp(patches.overall_s / faster, kMinHalfLife_s, kMaxHalfLife_s);
    report_.half_life_s = half_life_s_;
    if (motion_alone_) return;
    renewal_.emplace(
        detail_placement_, canvas_, target_luma_, *blender_,
        RenewalOptions{
            .share = options_.renewal, .max_gain = options_.max_renewal_gain, .fps = options_.fps});
  }

  /// One output frame before it is coloured.
  struct Made {
    cv::Mat luma;
    std::optional<CarriedFrame> brought;
  };

  /// What is carried of an output frame, before anything comes anew: `anew` of what will.
  Made carry(int output, double anew) {
    Made made;
    const std::vector<CopyMap> copies = copies_->at(output);
    made.brought = carried_base_->frame(copies);
    show_carried(*made.brought, base_luma_, made.luma);
    if (moving_) made.luma = pull_push(made.luma, alpha_);
    std::vector<double> shares(static_cast<std::size_t>(standing_->levels()));
    for (std::size_t level = 0; !motion_alone_ && level < shares.size(); ++level)
      shares[level] = anew * renewal_->share_of_picture(static_cast<int>(level));
    const cv::Mat stands = restore_contrast(made.luma, copies, CarriedBase::kStep, shares, renewing_,
                                            *standing_, anew, options_.contrast);
    standing_->colour(*made.brought, stands);
    return made;
  }

  /// Luminance of an output frame, whose differences lie in a slot of the blender; once.
  Made make(int output, int slot, const cv::Mat& renewed) {
    Made made;
    cv::Mat field;
    if (carried_) {
      // At the beginning the picture is all, then what is new comes in; in a loop it has gone before the end.
      const double anew = 1 - copies_->still(output);
      made = carry(output, anew);
      if (motion_alone_) return made;
      field = renewed;
      renewal_->show(field, made.luma, anew, renewing_counts_);
      cv::Mat level = blender_->take_level(slot);
      limit_level(level);
      cv::scaleAdd(level, anew, field, field);
    } else {
      base_luma_.copyTo(made.luma);
      if (moving_) made.luma = pull_push(made.luma, alpha_);
      field = blender_->take(slot);
    }
    add_enlarged(field, canvas_.rect(), canvas_.scale(), made.luma);
    return made;
  }

  /// With a moving outline, what lies behind the fluid is guessed where nobody gives it, and shows through a thin matte
  /// from the first frame on. What that is short of the picture is added there, and goes as the still frame does.
  void begin_as_the_still(const cv::Mat& fluid) {
    if (!moving_ || !carried_ || options_.form != FrameForm::kWhole || !options_.boundary.background.empty())
      return;
    copies_->prepare(0, 1);
    cv::Mat whole;
    target_.convertTo(whole, CV_8U, 255);
    cv::subtract(whole, finish(carry(0, 0), fluid, 0), missing_, cv::noArray(), CV_16S);
  }

  /// The innovations of successive output frames, which lie in the blender from `slot` on, carried on.
  void renew(std::span<const int> outputs, int slot, std::vector<cv::Mat>& renewed) {
    if (motion_alone_) return;
    oneapi::tbb::parallel_for(std::size_t{0}, outputs.size(), [&](std::size_t i) {
      renewed[i] = blender_->take_detail(slot + static_cast<int>(i));
    });
    for (std::size_t i = 0; i < outputs.size(); ++i)
      renewed[i] = renewal_->advance(field_->at(outputs[i] - 1), CarriedBase::kStep, renewed[i]);
  }

  int until() const {
    return options_.until > 0 ? std::min(options_.until, options_.frames) : options_.frames;
  }

  AppearanceModel model_of(std::span<const cv::Mat> frames) const {
    return AppearanceModel(target_luma_, alpha_, frames, options_.appearance);
  }

  /// One model of contrast and levels for the whole animation.
  void match() {
    throw_if_stopped(stop_);
    tell("match", 0, 1);
    std::vector<cv::Mat> lumas(samples_.size());
    oneapi::tbb::parallel_for(std::size_t{0}, samples_.size(), [&](std::size_t i) {
      lumas[i] = make(samples_[i], in_one_ ? samples_[i] : static_cast<int>(i), {}).luma;
    });
    model_.emplace(model_of(lumas));
    if (in_one_)
      for (std::size_t i = 0; i < samples_.size(); ++i) ready_[samples_[i]] = lumas[i];
    tell("match", 1, 1);
    report_.appearance_s = watch_.lap();
  }

  /// Matched, coloured, laid into the picture through the matte.
  cv::Mat finish(Made made, const cv::Mat& fluid, int output) const {
    if (model_)
      made.luma = model_->apply(made.luma);
    else if (options_.matching == AppearanceMatching::kFrame)
      made.luma = model_of(std::span(&made.luma, 1)).apply(made.luma);
    const CarriedFrame* const brought = made.brought ? &*made.brought : nullptr;
    if (options_.form == FrameForm::kFluid) return finisher_->finish_fluid(made.luma, fluid, brought);
    cv::Mat frame = finisher_->finish(made.luma, fluid, brought);
    if (!missing_.empty() && copies_->still(output) > 0)
      add_missing(missing_, static_cast<float>(copies_->still(output)), frame);
    return frame;
  }

  /// Frames, in order, some made at once while those before are handed on.
  void render(const std::function<void(const cv::Mat&)>& sink) {
    std::rotate(order_.begin(), order_.begin() + first_, order_.end());
    std::optional<BoundarySequence> boundary;
    if (moving_)
      boundary.emplace(
          alpha_, mean_motion_, options_.fps, options_.boundary.matte,
          [this](int i) { return sequence_->at(order_[static_cast<std::size_t>(i) % order_.size()]); },
          options_.loop ? options_.frames : 0, options_.boundary.held);
    Handover handover(sink);
    const int from = std::clamp(options_.from, 0, until());
    for (int first = 0; first < until(); first += batch_) {
      const int count = std::min(batch_, until() - first);
      const std::span<const int> outputs = std::span(order_).subspan(first, count);
      if (!in_one_) {
        for (const auto& layer : layers_) blend(*layer, outputs);
        report_.blend_s += watch_.lap();
      }
      for (int done = 0; done < count; done += kRendered) {
        throw_if_stopped(stop_);
        std::vector<cv::Mat> finished(std::min(kRendered, count - done)), mattes(finished.size(), alpha_);
        // Of the frames before the first wanted only what goes on from frame to frame is made.
        const std::size_t passed =
            std::min(finished.size(), static_cast<std::size_t>(std::max(0, from - first - done)));
        if (boundary)
          for (cv::Mat& fluid : mattes) fluid = boundary->next();
        if (first + done == 0) begin_as_the_still(mattes.front());
        if (options_.matte_sink)
          for (std::size_t i = passed; i < mattes.size(); ++i) options_.matte_sink(mattes[i]);
        if (options_.motion_sink && carried_)
          for (std::size_t i = passed; i < mattes.size(); ++i)
            options_.motion_sink(for_every_pixel(field_->at(outputs[done + i]), field_->step(), mattes[i]));
        std::vector<cv::Mat> renewed(finished.size());
        if (carried_) {
          if (passed < finished.size())
            copies_->prepare(outputs[done + passed], static_cast<int>(finished.size() - passed));
          renew(outputs.subspan(done, finished.size()), in_one_ ? outputs[done] : done, renewed);
        }
        oneapi::tbb::parallel_for(std::size_t{0}, finished.size(), [&](std::size_t i) {
          if (i < passed && motion_alone_) return;
          if (i < passed) return blender_->drop(in_one_ ? outputs[done + i] : done + static_cast<int>(i));
          const int output = outputs[done + i];
          const auto found = ready_.find(output);
          Made made = found != ready_.end()
                          ? Made{std::exchange(found->second, {}), std::nullopt}
                          : make(output, in_one_ ? output : done + static_cast<int>(i), renewed[i]);
          finished[i] = finish(std::move(made), mattes[i], output);
        });
        finished.erase(finished.begin(), finished.begin() + static_cast<std::ptrdiff_t>(passed));
        handover.take(std::move(finished));
        tell("render", std::min(first + done + kRendered, until()), until());
      }
      report_.render_s += watch_.lap();
    }
    handover.wait();
    report_.render_s += watch_.lap();
  }

  const store::Snapshot& snapshot_;
  const vision::Settings& settings_;
  const cv::Mat &picture_, &matte_;
  const Placement& placement_;
  AnimateOptions options_;
  const bool carried_;
  const Placement detail_placement_;  // innovations are found and merged at half the size
  const bool motion_alone_, moving_;
  const PiecesCanvas canvas_;
  const ProgressFunction& progress_;
  std::stop_token stop_;
  Stopwatch total_, watch_;
  AnimateReport report_;

  std::vector<std::unique_ptr<ClipLayer>> layers_;
  std::optional<Blender> blender_;
  int batch_ = 0, first_ = 0;  // frames in hand; the frame that a loop begins with
  bool in_one_ = false;
  std::vector<int> order_, samples_;       // output frames
  cv::Mat target_, target_luma_;           // the picture, CV_32FC3, and its luma, CV_32F; 1 is white
  cv::Mat assigned_motion_, mean_motion_;  // CV_32FC2, px/s: the patches' own, and as it is asked
  cv::Mat behind_, alpha_, base_luma_;
  cv::Mat missing_;  // the picture less the first frame, CV_16SC3, levels; or empty
  ColourModel colours_;
  std::shared_ptr<const MotionSequence> sequence_;
  cv::Mat renewing_;  // CV_32F, sampled as the field: how much of what comes anew is for a place, 0..1
  std::vector<cv::Mat> renewing_counts_;  // the same on the canvas, for Renewal::show
  std::optional<StandingDetail> standing_;
  double half_life_s_ = 0;  // of carried detail
  std::shared_ptr<const CarryingField> field_;
  std::optional<CopyMaps> copies_;
  std::optional<Renewal> renewal_;
  std::optional<CarriedBase> carried_base_;
  std::optional<FrameFinisher> finisher_;
  std::optional<AppearanceModel> model_;
  std::map<int, cv::Mat> ready_;  // by output frame: luminance made already, for the model
};

}  // namespace

AnimateReport animate(const store::Snapshot& snapshot, const vision::Settings& settings,
                      const cv::Mat& picture, const cv::Mat& matte, const Placement& placement,
                      const AnimateOptions& options, const std::function<void(const cv::Mat&)>& sink,
                      const ProgressFunction& progress, std::stop_token stop) {
  check(placement);
  return Animation(snapshot, settings, picture, matte, placement, options, progress, std::move(stop))
      .run(sink);
}

}  // namespace freshet::synth::animate
