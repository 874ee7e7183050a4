#include "synth/animate/carried/carried_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "platform/smoothstep.h"
#include "synth/animate/clips/piece_lives.h"
#include "synth/animate/clips/piece_standing.h"
#include "synth/animate/motion/copy_maps.h"
#include "synth/animate/motion/deformation.h"
#include "synth/animate/motion/motion_field.h"
#include "synth/animate/motion/motion_sequence.h"
#include "synth/animate/placement/piece_values.h"
#include "synth/animate/still/continued.h"
#include "synth/animate/still/fluid_planes.h"
#include "synth/animate/still/glitter.h"
#include "synth/animate/still/layout_share.h"
#include "synth/animate/still/standing_colour.h"
#include "synth/animate/still/standing_detail.h"
#include "synth/animate/still/standing_layout.h"
#include "synth/sampling/coarse_samples.h"
#include "synth/sampling/pull_push.h"
#include "vision/look/horizon.h"
#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

constexpr double kMinHalfLife_s = 0.1, kMaxHalfLife_s = 6;
// How far places of a copy of flames are astray in its own frame: no farther than they go while it shows, and than this
// share of the way to where there is no flame (light below this, evened), or a narrow flame would have holes. It is
// evened with this sigma. Water and smoke come again no more than in footage; below clouds what is straight would bend.
constexpr double kAstray_px = 20, kAstrayShare = 0.4, kAstrayEven_px = 16;
constexpr double kNoFlame = 0.12;  // luma
// How far copies go from their own frames: forms should have left their place, but a pool is not to climb its fall.
constexpr double kMinWander_s = 0.4, kMaxWander_s = 6, kMaxWander_px = 220;
// Of a band of which a share s of the variance stands, s of the picture's own is the best guess of what does, and the
// root of s has its variance. Fine bands take the guess: what stands falsely is seen as a veil. From this level on (16
// to 32 px) the light and dark of a scene are to stay as strong as they are.
constexpr std::size_t kWideLevel = 3;
constexpr float kLively = 0.25f;               // of the fastest places' speed: what is slower is renewed less
constexpr double kFast = 0.95, kUsual = 0.75;  // quantiles of the fluid's speed
constexpr double kLifePatch_px = 48;           // over which the picture's detail lives and goes together
constexpr double kMaxLevel = 0.08;             // luma: fires breathe by less
// Of texture: how far the usual place's goes until half of it is new, for how many intervals a copy shows, and how far
// copies begin from their own places (sigma).
constexpr double kTextureTravel_px = 36, kShownIntervals = 1.5, kSpread_px = 70;
constexpr double kMaxTextureGain = 1.5;  // two copies that begin displaced agree in nothing: they lose 1.41
constexpr double kMaxLayoutLevel = 2.0 / 255;  // luma: its light is the still's
// Of sparkles: after how long half of them are others, how far they go until a copy goes over to the next, how far
// copies begin from their own places (sigma), over how many times their size they live and go together, and over which
// they fade.
constexpr double kSparkleLife_s = 0.2, kSparkleTravel_px = 0.8, kSparkleSpread_px = 30, kSparklePatch = 2,
                 kSparkleEdge_px = 8;
// Lives in the clips are those of what the flow follows, less noise. On water much is glint or ripple that goes its own
// way and comes anew sooner: there copies live for this share of them, but not for less than this unless the clips do,
// or a sea turns to crumbs (docs/measurements/choices.md).
constexpr double kFollowed = 0.4, kLeastFollowed_s = 0.25;
// How long wide forms go, s, times the square of the share that goes (a pool's live for 3 s, and stand): 1 to 3 for
// clouds, .7 to 1.7 for smoke, up to .6 for water and fire (34 clips). From kWhole* on all goes along, from kBodies* on
// with its light and colour.
constexpr double kWholeFrom_s = 0.7, kWholeSure_s = 1, kBodiesFrom_s = 0.9, kBodiesSure_s = 1.3;
constexpr double kBodiesPatch = 3;  // times kLifePatch_px: a cloud goes over to another copy as a whole
constexpr double kShareReach = 1;   // pieces: neighbours stand alike
// Strain over two half-lives, for which a copy shows: clouds that are drawn out by so much would be torn, and their
// layout stands. So does all of it where a vortex is asked, or a painted swirl would be wound up, and its stars. Smoke
// is drawn out and wound up by nature.
constexpr double kTornFrom = 0.6, kTornSure = 1.5, kVortexFrom = 0.82, kVortexSure = 0.92;
// If a vortex is asked, at least so much of each band's variance stands, finest first (the last from there on), as of a
// fall in dusk (figures: standing_detail.h): brush strokes go, and the whorl that they draw keeps its form.
constexpr std::array kOfWhorl{0.16, 0.35, 0.63, 0.86};
// Of a place's surroundings: less fluid has no mean; less that is torn is a place here and there.
constexpr double kLeastFluid = 1e-3, kHardlyTorn = 0.1;
constexpr double kTornFlames = 0.3;  // CopyOptions::torn: flames are drawn out as they rise
// Flames are carried this much faster than they are to be seen to go, for their feet stand, and what rises has often
// gone out before it arrives; and where they are asked to go, the limit of what they do beside is this much wider.
constexpr float kFlamesCarried = 1.25f;
constexpr double kFlamesBeside = 1.3;

/// Lengths in px are meant for pieces of their own size: enlarged ones are carried as widely.
CarriedBaseOptions enlarged(CarriedBaseOptions options, double scale) {
  options.edge_px *= scale;
  options.look_px *= scale;
  options.step = step_of_maps(scale);
  return options;
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

/// A field that is sampled every few px, for every pixel.
cv::Mat for_every_pixel(const cv::Mat& field, int step, cv::Size size) {
  cv::Mat out;
  cv::warpAffine(field, out, sampling::samples_from_pixels(step), size,
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return out;
}

/// Of the fluid, the speed that a share of 1 - quantile of all places exceeds: px a frame, > 0.
/// fluid   CV_32F, sampled as the field: counted where above 0.5.
float speed_per_frame(const CarryingField& field, const cv::Mat& fluid, double quantile) {
  std::vector<float> within;
  for (int y = 0; y < fluid.rows; ++y)
    for (int x = 0; x < fluid.cols; ++x)
      if (fluid.at<float>(y, x) > 0.5f) within.push_back(field.activity().at<float>(y, x));
  if (within.empty()) return 1;
  const auto at = within.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(within.size()) * quantile);
  std::nth_element(within.begin(), at, within.end());
  return std::max(*at, 1e-3f);
}

/// Vectors of length 1, or 0 where there are none to speak of.
cv::Mat directions(const cv::Mat& motion, cv::Size size) {
  cv::Mat out;
  cv::resize(motion, out, size, 0, 0, cv::INTER_AREA);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      auto& v = out.at<cv::Vec2f>(y, x);
      const float length = std::hypot(v[0], v[1]);
      v = length > 1e-3f ? cv::Vec2f(v / length) : cv::Vec2f(0, 0);
    }
  return out;
}

/// px below a horizon, sampled as a field: CV_32F; empty without one.
cv::Mat nearness(const std::optional<Horizon>& horizon, const CarryingField& field) {
  if (!horizon) return {};
  cv::Mat out(field.size(), CV_32F);
  const auto step = static_cast<float>(field.step());
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x)
      out.at<float>(y, x) = std::max(vision::below(*horizon, {step * (static_cast<float>(x) + 0.5f),
                                                              step * (static_cast<float>(y) + 0.5f)}),
                                     1.0f);
  return out;
}

class CarriedRenderer final : public Renderer {
 public:
  CarriedRenderer(Animation& animation, const StillPart& still, const CarriedOptions& options)
      : animation_(animation),
        whole_(still),
        still_(still),
        options_(options),
        step_px_(step_of_maps(animation.placement.piece_scale)) {
    if (places_class(animation_, kWater)) part_glitter();
    measure_life();
    measure_clips();
    animation.tell("base", 0, 0);
    lay_copies();
    release_for_frames();
    animation.report.base_s += animation.watch.lap();
  }

  int batch() const override { return innovations_ ? innovations_->batch() : animation_.options.frames; }
  cv::Mat motion(int output) const override { return sequence_->at(output); }
  cv::Mat step(int output) const override {
    cv::Mat goes = field_->at(output);
    if (other_way_) {
      goes = goes.clone();  // the field's own is read by others
      other_way_->displacement(output).copyTo(goes, other_way_->share > 0.5);
    }
    return for_every_pixel(goes, field_->step(), still_.alpha.size());
  }

  void read(std::span<const int> outputs) override {
    if (innovations_) innovations_->read(outputs);
  }

  void prepare(std::span<const int> outputs, std::span<const cv::Mat> mattes, std::size_t passed) override {
    if (outputs.front() == 0) begin_as_the_still(mattes.front());
    if (passed < outputs.size()) prepare_copies(outputs[passed], static_cast<int>(outputs.size() - passed));
    if (innovations_) innovations_->advance(outputs, *field_);
  }

  cv::Mat finish(int output, const cv::Mat& matte) override {
    // At the beginning the picture is all, then what is new comes in; in a loop it has gone before the end.
    const double still = still_share(output);
    Carried carried = carry(output, 1 - still);
    if (innovations_) add_innovations(output, 1 - still, carried.luma);
    if (animation_.options.form == FrameForm::kFluid)
      return finisher_->finish_fluid(carried.luma, matte, carried.colour());
    cv::Mat frame = finisher_->finish(carried.luma, matte, carried.colour());
    if (!missing_.empty() && still > 0) add_missing(missing_, static_cast<float>(still), frame);
    return frame;
  }

 private:
  /// begun  of what comes anew, 0..1.
  void add_innovations(int output, double begun, cv::Mat& luma) {
    const cv::Mat level = innovations_->level(output);
    if (options_.level_sink.take) {
      const auto enlarged = [&](const cv::Mat& on_canvas) {
        cv::Mat out = cv::Mat::zeros(luma.size(), CV_32F);
        innovations_->add_level(begun * on_canvas, out);
        return out;
      };
      options_.level_sink.take(
          output,
          {.liveliest = enlarged(innovations_->liveliest_level(output, options_.level_sink.deviation)),
           .here = enlarged(innovations_->level_here(output))});
    }
    innovations_->add(output, begun, limited(level, std::lerp(kMaxLevel, kMaxLayoutLevel, share_.mean())),
                      luma);
  }

  /// One output frame before anything comes anew, and before it is coloured.
  struct Carried {
    std::optional<CarriedFrame> frame;  // what brings its colour; where a layout stands it keeps its own
    cv::Mat luma;

    const CarriedFrame* colour() const { return frame ? &*frame : nullptr; }
  };

  /// What goes is the water below its sparkles.
  void part_glitter() {
    if (options_.glitter <= 0 || animation_.options.moving()) return;
    glitter_.emplace(whole_.target, whole_.luma, whole_.alpha, options_.glitter);
    if (!glitter_->any()) return glitter_.reset();
    still_.target = glitter_->ground();
    still_.luma = glitter_->ground_luma();
  }

  /// As long as detail does in the patches that are shown (of water less: kFollowed), but shorter where they are made
  /// to go faster: eddies of one size turn over in a time that falls as their speed rises.
  void measure_life() {
    const PieceLives lives = piece_lives(animation_.snapshot, animation_.placement);
    measured_shares_ = standing_shares(animation_.snapshot, animation_.placement,
                                       vision::levels_within(still_.target.size(), options_.contrast.levels));
    const double goes = 1 - measured_shares_.back(), going_s = goes * goes * lives.forms_s;
    bodies_ = smoothstep(kBodiesFrom_s, kBodiesSure_s, going_s);
    const double whole = smoothstep(kWholeFrom_s, kWholeSure_s, going_s);
    cv::Mat goes_at = still_.assigned_motion;
    if (!places_class(animation_, kFire)) {  // tongues of flames go apart
      goes_at = evened_motion(still_.assigned_motion, still_.alpha, whole);
      still_.asked_motion = apply_guide(goes_at, animation_.options.guide, still_.alpha);
    }
    if (places_class(animation_, kWater))
      still_.asked_motion = falling_freely(still_.asked_motion, animation_.options.guide, whole_.luma,
                                           whole_.alpha, mean_speed(animation_.placement));
    half_life_s_ = options_.half_life_s;
    if (half_life_s_ == 0) {
      const double faster =
          std::pow(pace(goes_at, still_.asked_motion, animation_.matte), options_.life_pace);
      double life_s = lives.overall_s / faster;
      if (places_class(animation_, kWater))
        life_s = std::max(kFollowed * life_s, std::min(life_s, kLeastFollowed_s));
      half_life_s_ = std::clamp(life_s, kMinHalfLife_s, kMaxHalfLife_s);
    }
    animation_.report.half_life_s = half_life_s_;
  }

  /// How the patches move, and what of them comes anew.
  void measure_clips() {
    MotionSums motion(animation_.snapshot, animation_.settings, animation_.placement,
                      animation_.picture.size(), animation_.options.frames, animation_.options.tiles.get());
    if (options_.innovations) {
      innovations_.emplace(animation_, still_.luma, options_.resampling, *options_.innovations);
      innovations_->measure(motion);
      if (options_.level_sink.take) innovations_->settle_levels();
      animation_.report.renewed = innovations_->overall();
    } else {
      // Of the clips' flow alone.
      const auto layers =
          clip_layers(animation_, halved(animation_.placement), options_.resampling, ClipDetail::kInnovation);
      animation_.report.clips = layers.size();
      for (const auto& layer : layers) add_motion(animation_, *layer, motion);
    }
    sequence_ = std::make_shared<const MotionSequence>(std::move(motion).means());
  }

  /// The mean that the field has, px/s.
  cv::Mat carried_motion() const {
    if (!places_class(animation_, kFire)) return still_.asked_motion;
    cv::Mat out = still_.asked_motion.clone();
    const auto fastest = static_cast<float>(fastest_speed(out.size()));
    for (int y = 0; y < out.rows; ++y)
      for (int x = 0; x < out.cols; ++x) {
        auto& v = out.at<cv::Vec2f>(y, x);
        const float speed = std::max(std::hypot(v[0], v[1]), 1e-6f);
        v *= std::clamp(fastest / speed, 1.0f, kFlamesCarried);
      }
    return out;
  }

  /// What is carried, along which field, and what of the picture stands.
  void lay_copies() {
    const FrameOptions& frames = animation_.options;
    CarryingOptions carrying = options_.carrying;
    // Where nothing is asked fluctuations have no limit: with what mixing lost given back, skies went to and fro.
    if (frames.guide.empty() && !frames.guide.horizon) {
      carrying.max_of_asked = 0;
      carrying.max_regain = 1;
    }
    if (places_class(animation_, kFire)) {
      carrying.least_scale = 1;
      carrying.max_of_asked *= kFlamesBeside;
    }
    field_ = std::make_shared<const CarryingField>(sequence_, carried_motion(), frames.frames, frames.fps,
                                                   step_px_, frames.loop, carrying);
    cv::resize(still_.alpha, fluid_, field_->size(), 0, 0, cv::INTER_AREA);
    lay_other_way(carrying);
    const FluidPlanes planes = fluid_planes(still_.target, still_.luma, still_.alpha);
    colour_.emplace(planes, still_.alpha);
    const FluidPlanes whole =
        glitter_ ? fluid_planes(whole_.target, whole_.luma, whole_.alpha) : FluidPlanes{};
    if (glitter_) whole_colour_.emplace(whole, whole_.alpha);
    whorl_ = asked_whorl();
    share_ = layout_share();
    if (share_.stands_somewhere()) lay_texture_copies(planes);
    cv::Mat own_colour;  // beside the model
    if (layout_) {
      cv::Mat modelled;
      apply_colour(whole_.colours, whole_.luma, modelled);
      own_colour = whole_.target - modelled;
    }
    if (share_.goes_somewhere()) {
      const cv::Mat of_exposure = lay_picture_copies(planes);
      if (layout_) {
        stands_ = share_.over_picture(still_.luma.size());
        cv::Mat three;
        cv::merge(std::vector<cv::Mat>(3, stands_), three);
        own_colour = of_exposure + three.mul(own_colour - of_exposure);
        cv::resize(stands_, stands_, {(stands_.cols + 1) / 2, (stands_.rows + 1) / 2}, 0, 0, cv::INTER_AREA);
      } else {
        own_colour = of_exposure;
      }
    }
    if (glitter_) lay_sparkles();
    renew_what_goes();
    finisher_.emplace(
        finisher_of(animation_, whole_, own_colour,
                    copies_ ? ColourCurve(whole_.target, whole_.luma, whole_.alpha) : ColourCurve(),
                    ColourRange(whole_.target, whole_.luma, whole_.alpha)));
    if (!layout_ && !glitter_) return;
    // The bands that a sum of bands falls into are not quite those, and mixed layers agree at first: what the first
    // frame is short of the picture.
    prepare_copies(0, 1);
    const Carried first = carry(0, 0);
    rest_of_still_ = whole_.luma - first.luma;
    if (glitter_ && first.frame) measure_rest_of_colour(whole, *first.frame);
  }

  /// Of water that is thrown up, what comes down. An outline that moves goes up alone. What comes anew (residuals,
  /// which live for .05 s) goes up in all of it.
  void lay_other_way(const CarryingOptions& carrying) {
    const FrameOptions& frames = animation_.options;
    if (!places_class(animation_, kWater) || frames.moving()) return;
    const ComingDown down = coming_down(still_.asked_motion, frames.guide, whole_.luma, whole_.alpha);
    if (down.share.empty()) return;
    other_way_.emplace();
    const auto field = std::make_shared<const CarryingField>(sequence_, down.motion, frames.frames,
                                                             frames.fps, step_px_, frames.loop, carrying);
    other_way_->displacement = [field](int i) { return field->at(i); };
    cv::resize(down.share, other_way_->share, field_->size(), 0, 0, cv::INTER_AREA);
  }

  void release_for_frames() {
    still_.release_for_frames(animation_.options.moving());
    options_.freed.release();
    still_.asked_motion.release();
    if (glitter_) glitter_->release_ground();
  }

  void measure_rest_of_colour(const FluidPlanes& planes, const CarriedFrame& first) {
    const auto rest = [](const cv::Mat& whole, const cv::Mat& of_first, cv::Mat& out) {
      cv::Mat sized;
      cv::resize(whole * CarriedFrame::kOne, sized, of_first.size(), 0, 0, cv::INTER_AREA);
      cv::subtract(sized, of_first, out, cv::noArray(), CV_16S);
    };
    rest(planes.luma, first.luma, rest_of_colour_.luma);
    rest(planes.blue, first.blue, rest_of_colour_.blue);
    rest(planes.red, first.red, rest_of_colour_.red);
  }

  /// How far the layout stands where, as it is asked.
  LayoutShare layout_share() const {
    if (options_.layout == Layout::kStands) return LayoutShare(1);
    if (options_.layout == Layout::kGoes || animation_.options.moving()) return LayoutShare(0);
    const PieceValues lattice(animation_.placement);
    const PiecesCanvas canvas(animation_.placement, still_.luma.size());
    std::vector<cv::Mat> shares =
        layout_shares(animation_.snapshot, animation_.placement,
                      std::max(1, vision::levels_within(still_.target.size(), options_.contrast.levels)));
    for (cv::Mat& share : shares) share *= 1 - bodies_;
    for (std::size_t level = kWideLevel; level < shares.size(); ++level)
      shares[level] *= options_.wide_layout;
    for (cv::Mat& share : shares)
      share = canvas.sampled(lattice.over_canvas(share, kShareReach), field_->step(), field_->size());
    if (const cv::Mat torn = torn_apart(); !torn.empty())
      for (cv::Mat& share : shares) cv::max(share, torn, share);
    if (!options_.freed.empty()) {
      cv::Mat kept;
      cv::resize(1 - options_.freed, kept, field_->size(), 0, 0, cv::INTER_AREA);
      for (cv::Mat& share : shares) cv::multiply(share, kept, share);
    }
    return LayoutShare(std::move(shares), still_.alpha);
  }

  /// How far clouds would be torn or wound up that go: CV_32F, 0..1, sampled as the field. Of other fluid: empty.
  cv::Mat torn_apart() const {
    if (!places_class(animation_, kClouds)) return {};
    cv::Mat motion, mass, out;
    cv::resize(still_.asked_motion, motion, field_->size(), 0, 0, cv::INTER_AREA);
    out = strain_rate(motion, step_px_) * (2 * half_life_s_);
    for (int y = 0; y < out.rows; ++y)
      for (int x = 0; x < out.cols; ++x) {
        auto& torn = out.at<float>(y, x);
        torn = static_cast<float>(smoothstep(kTornFrom, kTornSure, static_cast<double>(torn)));
      }
    const double sigma = kLifePatch_px * animation_.placement.piece_scale / step_px_;
    cv::GaussianBlur(out.mul(fluid_), out, {}, sigma, sigma, cv::BORDER_REPLICATE);
    cv::GaussianBlur(fluid_, mass, {}, sigma, sigma, cv::BORDER_REPLICATE);
    out = cv::max((out / (mass + kLeastFluid) - kHardlyTorn) / (1 - kHardlyTorn), 0);
    return cv::max(out, whorl_);
  }

  /// How far a vortex is asked of clouds, 0..1; 0 where the layout is not measured.
  double asked_whorl() const {
    const cv::Mat& asked = animation_.options.guide.direction;
    if (options_.layout != Layout::kMeasured || !places_class(animation_, kClouds) || asked.empty()) return 0;
    cv::Mat way;
    cv::resize(asked, way, field_->size(), 0, 0, cv::INTER_AREA);
    return smoothstep(kVortexFrom, kVortexSure, vortex(way, fluid_));
  }

  /// The picture as a long exposure along its motion, and the copies that are carried over it. Returns the exposure's
  /// colour.
  cv::Mat lay_picture_copies(const FluidPlanes& planes) {
    const FrameOptions& frames = animation_.options;
    const double scale = animation_.placement.piece_scale;
    Exposure exposure = expose(animation_, still_, options_.base);
    exposure_ = exposure.luma;
    // What goes whole comes in and goes out whole, as clouds and smoke do (all that neither water nor fire has the most
    // of). On water a mirror is hardly seen, and costs less.
    const bool in_air = !places_class(animation_, kWater) && !places_class(animation_, kFire);
    const Sides sides =
        bodies_ > 0 || in_air ? crossed_sides(still_.asked_motion, still_.alpha, step_px_) : Sides{};
    base_.emplace(continued(planes, still_.alpha, sides), enlarged(options_.carry, scale));
    // As far as the fastest fluid goes in that time: what stands in the picture's order is not to be mixed up.
    const double wander_s =
        std::clamp(kMaxWander_px * scale / (fastest() * frames.fps), kMinWander_s, kMaxWander_s);
    CopyOptions copies = copy_options(half_life_s_);
    copies.wander = static_cast<int>(std::lround(wander_s * frames.fps));
    if (places_class(animation_, kFire)) {
      copies.astray = astray(copies.interval);
      copies.torn = kTornFlames;
    }
    copies_.emplace([field = field_](int i) { return field->at(i); }, base_->places(), field_->step(), copies,
                    std::nullopt, other_way_);
    standing_.emplace(planes, still_.alpha, shares_that_stand());
    return exposure.colour;
  }

  /// The picture's texture, and the copies of it that are carried over the layout.
  void lay_texture_copies(const FluidPlanes& planes) {
    const FrameOptions& frames = animation_.options;
    const double scale = animation_.placement.piece_scale;
    // Detail that is carried far is unlike itself before it arrives, whatever speed is asked.
    const double usual_per_s = speed_per_frame(*field_, fluid_, kUsual) * frames.fps;
    const CopyOptions copies = copy_options(std::min(half_life_s_, kTextureTravel_px * scale / usual_per_s));
    const LayoutMotion motion{.direction = directions(still_.asked_motion, field_->size()),
                              .travel = field_->activity() * (kShownIntervals * copies.interval),
                              .step = step_px_};
    std::vector<double> shares = measured_shares_;
    shares.pop_back();
    for (std::size_t level = 0; level < shares.size(); ++level)
      shares[level] = std::max(shares[level], whorl_ * kOfWhorl[std::min(level, kOfWhorl.size() - 1)]);
    layout_.emplace(planes, still_.alpha, motion, shares);
    texture_base_.emplace(continued(planes, still_.alpha, {}), enlarged(options_.carry, scale),
                          layout_->texture());
    texture_copies_.emplace([field = field_](int i) { return field->at(i); }, texture_base_->places(),
                            field_->step(), copies,
                            CopyStarts{.direction = motion.direction,
                                       .edges = layout_->edges(),
                                       .spread = kSpread_px * scale / step_px_,
                                       .nearness = nearness(frames.guide.horizon, *field_)},
                            other_way_);
  }

  /// Copies of the sparkles, which stay about where they are.
  void lay_sparkles() {
    const FrameOptions& frames = animation_.options;
    const double scale = animation_.placement.piece_scale;
    const cv::Mat& where = glitter_->where();
    sparkle_base_.emplace(
        continued(fluid_planes(still_.target, still_.luma, where), where, {}),
        CarriedBaseOptions{
            .look_px = options_.carry.look_px * scale, .edge_px = kSparkleEdge_px * scale, .step = step_px_},
        glitter_->texture());
    CopyOptions copies = copy_options(kSparkleLife_s / mean_speed(animation_.placement));
    copies.patch = kSparklePatch * glitter_->size_px() / step_px_;
    const double goes_px = speed_per_frame(*field_, fluid_, kUsual) * copies.interval;
    const double slower = std::min(1.0, kSparkleTravel_px * scale / goes_px);
    sparkle_copies_.emplace([field = field_, slower](int i) { return cv::Mat(field->at(i) * slower); },
                            sparkle_base_->places(), field_->step(), copies,
                            CopyStarts{.direction = cv::Mat(field_->size(), CV_32FC2, cv::Scalar(0, 1)),
                                       .edges = cv::Mat::zeros(field_->size(), CV_32F),
                                       .spread = kSparkleSpread_px * scale / step_px_,
                                       .nearness = nearness(frames.guide.horizon, *field_)});
  }

  void prepare_copies(int first, int count) {
    if (sparkle_copies_) sparkle_copies_->prepare(first, count);
    if (copies_) copies_->prepare(first, count);
    if (texture_copies_) texture_copies_->prepare(first, count);
  }

  /// How far a frame is the picture itself.
  double still_share(int output) const {
    if (!copies_) return texture_copies_->still(output);
    if (!texture_copies_) return copies_->still(output);
    return std::lerp(copies_->still(output), texture_copies_->still(output), share_.mean());
  }

  /// px a frame.
  float fastest() const {
    cv::Mat deep;
    cv::extractChannel((base_ ? base_ : texture_base_)->places().own(), deep, 0);
    return speed_per_frame(*field_, deep, kFast);
  }

  /// CopyOptions::astray of flames.
  cv::Mat astray(int interval) const {
    const double scale = animation_.placement.piece_scale, sigma = kAstrayEven_px * scale / step_px_;
    cv::Mat lit, deep_px;
    cv::resize(still_.luma.mul(still_.alpha), lit, field_->size(), 0, 0, cv::INTER_AREA);
    cv::GaussianBlur(lit, lit, {}, sigma, sigma, cv::BORDER_REPLICATE);
    cv::copyMakeBorder(lit > kNoFlame, lit, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(255));
    cv::distanceTransform(lit, deep_px, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    deep_px = deep_px(cv::Rect({1, 1}, field_->size())) * (kAstrayShare * step_px_);
    cv::Mat out = cv::min(cv::min(interval * field_->activity(), deep_px), kAstray_px * scale);
    cv::GaussianBlur(out, out, {}, sigma, sigma, cv::BORDER_REPLICATE);
    return out;
  }

  CopyOptions copy_options(double life_s) const {
    const FrameOptions& frames = animation_.options;
    const int loop_frames = frames.loop ? frames.frames : 0;
    return {.interval = CopyMaps::interval_of(life_s, frames.fps, loop_frames),
            .loop_frames = loop_frames,
            .patch = std::lerp(1, kBodiesPatch, bodies_) * kLifePatch_px * animation_.placement.piece_scale /
                     step_px_};
  }

  /// What stands is not renewed: a rock in the matte, or what an artist holds still.
  void renew_what_goes() {
    renewing_ = field_->activity() / (kLively * fastest());
    cv::multiply(renewing_, renewing_, renewing_);
    renewing_ = cv::min(renewing_, 1.0);
    if (innovations_) renewing_ = innovations_->restrict_to(renewing_, field_->step());
  }

  /// By level of the picture, what of it keeps its place.
  std::vector<double> shares_that_stand() const {
    std::vector<double> shares = measured_shares_;
    for (std::size_t level = 0; level < shares.size(); ++level) {
      const double guessed = 0.5 * std::min(1.0, static_cast<double>(level) / kWideLevel);
      shares[level] = (1 - bodies_) * options_.standing * std::pow(shares[level], 1 - guessed);
    }
    return shares;
  }

  /// What is carried of an output frame, before anything comes anew: `anew` of what will.
  Carried carry(int output, double anew) {
    Carried carried;
    if (copies_) carried = carry_picture(output, anew);
    if (layout_) {
      cv::Mat laid = carry_texture(output, anew);
      if (copies_) {
        share_.mix(laid, *layout_, carried.luma);
        cv::multiply(carried.frame->fraction, 1 - stands_, carried.frame->fraction, 1, CV_16S);
      } else {
        carried.luma = laid;
      }
      if (!glitter_) add_rest_of_still(output, carried.luma);
    }
    if (glitter_) add_sparkles(output, carried);
    if (options_.holds_light && bodies_ < 1)
      (glitter_ ? whole_colour_ : colour_)
          ->hold(carried.luma, carried.frame ? &*carried.frame : nullptr, 1 - bodies_);
    if (glitter_) {
      add_rest_of_still(output, carried.luma);
      if (carried.frame && !rest_of_colour_.luma.empty() && still_share(output) > 0) {
        const auto add_rest = [&](const cv::Mat& rest, cv::Mat& plane) {
          cv::addWeighted(rest, still_share(output), plane, 1, 0, plane);
        };
        add_rest(rest_of_colour_.luma, carried.frame->luma);
        add_rest(rest_of_colour_.blue, carried.frame->blue);
        add_rest(rest_of_colour_.red, carried.frame->red);
      }
    }
    return carried;
  }

  void add_rest_of_still(int output, cv::Mat& luma) const {
    if (!rest_of_still_.empty()) cv::scaleAdd(rest_of_still_, still_share(output), luma, luma);
  }

  void add_sparkles(int output, Carried& to) const {
    const std::vector<CopyMap> copies = sparkle_copies_->at(output);
    cv::Mat brought;
    show_carried(sparkle_base_->frame(copies), {}, brought);
    glitter_->add(brought, copies, step_px_, to.luma, to.frame ? &*to.frame : nullptr);
  }

  std::vector<double> renewed_shares(int levels, double anew) const {
    return innovations_ ? innovations_->shares(levels, anew)
                        : std::vector<double>(static_cast<std::size_t>(levels));
  }

  /// The picture with its forms.
  Carried carry_picture(int output, double anew) {
    Carried carried;
    const std::vector<CopyMap> copies = copies_->at(output);
    carried.frame = base_->frame(copies);
    show_carried(*carried.frame, exposure_, carried.luma);
    if (animation_.options.moving()) carried.luma = sampling::pull_push(carried.luma, still_.alpha);
    restore_contrast(carried.luma, copies, step_px_, renewed_shares(standing_->levels(), anew), renewing_,
                     *standing_, anew, options_.contrast);
    return carried;
  }

  /// Its texture over its layout: luma.
  cv::Mat carry_texture(int output, double anew) {
    const std::vector<CopyMap> copies = texture_copies_->at(output);
    cv::Mat luma;
    show_carried(texture_base_->frame(copies), {}, luma);
    LostContrastOptions contrast = options_.contrast;
    contrast.max_gain = std::max(contrast.max_gain, kMaxTextureGain);
    lay_texture(luma, copies, step_px_, renewed_shares(layout_->levels(), anew), renewing_, *layout_,
                contrast);
    return luma;
  }

  /// With a moving outline, what lies behind the fluid is guessed where nobody gives it, and shows through a thin matte
  /// from the first frame on. What that is short of the picture is added there, and goes as the still frame does.
  void begin_as_the_still(const cv::Mat& matte) {
    const FrameOptions& frames = animation_.options;
    if (!frames.moving() || frames.form != FrameForm::kWhole || !frames.outline.background.empty()) return;
    prepare_copies(0, 1);
    const Carried first = carry(0, 0);
    cv::Mat whole;
    still_.target.convertTo(whole, CV_8U, 255);
    cv::subtract(whole, finisher_->finish(first.luma, matte, first.colour()), missing_, cv::noArray(),
                 CV_16S);
  }

  Animation& animation_;
  const StillPart& whole_;
  // What is carried of it: where water glitters, the ground of its sparkles. asked_motion: of all but fire evened.
  StillPart still_;
  CarriedOptions options_;
  const int step_px_;                    // of the field and of copies' maps
  double half_life_s_ = 0;               // of carried detail
  double bodies_ = 0;                    // how far wide forms go whole, with their light and colour, 0..1
  std::vector<double> measured_shares_;  // by level, and of the low-pass rest: how much stands in the patches
  std::optional<Innovations> innovations_;
  std::shared_ptr<const MotionSequence> sequence_;
  std::shared_ptr<const CarryingField> field_;
  std::optional<OtherWay> other_way_;  // of what is thrown up and comes down
  cv::Mat fluid_;                      // CV_32F, the matte as the field is sampled
  cv::Mat renewing_;  // CV_32F, sampled as the field: how much of what comes anew is for a place, 0..1
  std::optional<StandingColour> colour_, whole_colour_;  // of what is carried, and with its sparkles
  double whorl_ = 0;                                     // how far a vortex is asked of clouds, 0..1
  LayoutShare share_{0};
  // Of what goes with its forms, where anything does.
  cv::Mat exposure_;  // luma
  std::optional<CarriedBase> base_;
  std::optional<CopyMaps> copies_;
  std::optional<StandingDetail> standing_;
  // Of what stands, where anything does.
  std::optional<StandingLayout> layout_;
  std::optional<CarriedBase> texture_base_;
  std::optional<CopyMaps> texture_copies_;
  // Of sparkles, where water glitters.
  std::optional<Glitter> glitter_;
  std::optional<CarriedBase> sparkle_base_;
  std::optional<CopyMaps> sparkle_copies_;
  CarriedFrame rest_of_colour_;  // what the first frame is short of the picture, in what it was carried as
  cv::Mat rest_of_still_;        // CV_32F: the picture's luma less the first frame's
  cv::Mat stands_;  // CV_32F, of half the width and height: with both, share_ of all levels together
  std::optional<FrameFinisher> finisher_;
  cv::Mat missing_;  // the picture less the first frame, CV_16SC3, levels; or empty
};

}  // namespace

std::unique_ptr<Renderer> make_renderer(Animation& animation, const StillPart& still,
                                        const CarriedOptions& options) {
  animation.report.method = "carried";
  // Fluid that leaves the still outline would bring what lies beyond it.
  if (options.layout == Layout::kStands && animation.options.moving())
    throw Error(ErrorKind::kUsage, "--layout stands",
                "the outline moves, and a layout has none beyond the matte",
                "Leave out --boundary moving, or --layout stands");
  return std::make_unique<CarriedRenderer>(animation, still, options);
}

}  // namespace freshet::synth::animate
