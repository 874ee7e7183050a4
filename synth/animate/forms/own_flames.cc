#include "synth/animate/forms/own_flames.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "platform/smoothstep.h"
#include "synth/animate/forms/flame_columns.h"
#include "synth/animate/forms/form_look.h"
#include "synth/animate/forms/handed_frame.h"
#include "synth/animate/forms/light_level.h"
#include "synth/animate/forms/lit_ground.h"
#include "synth/animate/forms/tongues.h"
#include "synth/animate/still/colour_model.h"
#include "synth/sampling/pull_push.h"

namespace freshet::synth::animate {
namespace {

constexpr double kReach = 0.08;      // sigma of the light around a flame, of the picture's longer side
constexpr double kWideLayout = 0.3;  // of flames (CarriedOptions::wide_layout)
constexpr double kLooks = 0.75;      // of flames (CarriedBaseOptions::looks)
constexpr float kOverAll = 0.02f;    // light: of a tongue that is all there where it has so much
constexpr double kMostly =
    0.5;  // of share_of_light: above it all but tongues stands, as wax, a glass and its rim do
constexpr float kRimLevel = 0.1f;   // of light that hides the ground
constexpr double kOwn = 0.99;       // of a tongue's share: what is its own, and not what burns beside it
constexpr double kRimWidth = 0.03;  // of a tongue's height: width of the soft rim around that
constexpr float kHole = 0.1f,
                kRim = 0.9f;     // alpha: a hole in the matte has less somewhere; its rim ends there
constexpr float kPalest = 1.1f;  // times the blue and the green of flames as bright
constexpr float kFull = 0.15f;   // level of a ground that changes as the clips' does; a darker one less
constexpr double kMostByDay = 0.006, kMostByNight = 0.05;  // luma: deviation of that change over time
constexpr double kSoftSide =
    0.015;  // of the longer side: sigma over which that ends towards the matte's sides
// How flames leap: by so many times what patches are lighter than usual, less what all do together, or the fire would
// beat as a whole; up by at most kMostFlared of their level, down by kMostGone of white (thinned). From kGlow to kBurns
// they begin to flare. None gets lighter than the picture's brightest: it tells no colour for those.
constexpr float kLeap = 8, kMostFlared = 0.3f, kMostGone = 0.7f, kGlow = 0.04f, kBurns = 0.2f;

/// A flame's level as it leaps and dies down where patches are so much lighter than usual, luma. Faint glow does not
/// flare, or it would be haze, and does not go out, or what is around a fire would stand.
float leaping(float level, float lighter, float top) {
  if (lighter < 0) {
    const float gone = std::min(-kLeap * lighter, kMostGone);
    return std::max(thinned(level, gone), (1 - gone) * std::min(level, kGlow));
  }
  const float flares = std::min(kLeap * lighter, kMostFlared);
  return std::max(level, std::min(top, level * (1 + flares * smoothstep(kGlow, kBurns, level))));
}

std::vector<float> shining(const cv::Mat& level) {
  std::vector<float> out;
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x)
      if (level.at<float>(y, x) > kShines) out.push_back(level.at<float>(y, x));
  return out;
}

/// What is carried over a dark gap brought the gap's colour along, grey or blue: a flame is to be no paler than the
/// picture's flames of its brightness are. usual  the colour of these.
cv::Vec3f no_paler(cv::Vec3f light, const cv::Vec3f& usual) {
  const float whole = luma_of(light), of_usual = luma_of(usual);
  if (whole <= 0 || of_usual <= 0) return light;
  for (int k = 0; k < 2; ++k) light[k] = std::min(light[k], kPalest * usual[k] * whole / of_usual);
  light[2] = (whole - kBlueLuma * light[0] - kGreenLuma * light[1]) / kRedLuma;
  return light;
}

/// What shines, as a picture on black: CV_32FC3, code.
cv::Mat flames_on_black(const PartedStill& parted) {
  cv::Mat out(parted.level.size(), CV_32FC3);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      cv::Vec3f& to = out.at<cv::Vec3f>(y, x) = {};
      const cv::Vec3f& light = parted.light.at<cv::Vec3f>(y, x);
      const float level = parted.level.at<float>(y, x), whole = luma_of(light);
      for (int k = 0; k < 3 && level > 0 && whole > 0; ++k)
        to[k] = level_of(std::clamp(light[k] * light_of(level) / whole, 0.0f, 1.0f));
    }
  return out;
}

/// A fire's foot burns on while its flames go up: what comes from below the bed is as what burns above it, mirrored.
cv::Mat fed_from_below(const cv::Mat& flames, const cv::Mat& level) {
  const std::vector<float> bed = beds_of(level);
  cv::Mat fed = flames.clone();
  for (int x = 0; x < level.cols; ++x)
    for (int y = static_cast<int>(bed[x]) + 1; bed[x] >= 0 && y < level.rows; ++y) {
      const int mirrored = static_cast<int>(2 * bed[x]) - y;
      if (mirrored >= 0 && level.at<float>(mirrored, x) > level.at<float>(y, x))
        fed.at<cv::Vec3f>(y, x) = flames.at<cv::Vec3f>(mirrored, x);
    }
  return fed;
}

/// 0 at the sides of a matte, to 1 at some distance from them.
cv::Mat deep_in(const cv::Mat& alpha) {
  cv::Mat soft;
  cv::GaussianBlur(alpha, soft, {}, kSoftSide * std::max(alpha.cols, alpha.rows), 0, cv::BORDER_REPLICATE);
  return cv::max(2 * soft - 1, 0.0);
}

/// Holes in a matte, CV_8U: what it leaves out and has all around, with its soft rim. Rocks at the picture's sides are
/// none.
cv::Mat holes_of(const cv::Mat& alpha) {
  cv::Mat parts, shape, centres;
  const int count = cv::connectedComponentsWithStats(alpha < kRim, parts, shape, centres, 4, CV_32S);
  std::vector<std::uint8_t> hole(count, 0);
  for (int y = 0; y < alpha.rows; ++y)
    for (int x = 0; x < alpha.cols; ++x)
      if (alpha.at<float>(y, x) < kHole) hole[parts.at<int>(y, x)] = 255;
  hole[0] = 0;
  for (int i = 1; i < count; ++i)
    if (shape.at<int>(i, cv::CC_STAT_LEFT) == 0 || shape.at<int>(i, cv::CC_STAT_TOP) == 0 ||
        shape.at<int>(i, cv::CC_STAT_LEFT) + shape.at<int>(i, cv::CC_STAT_WIDTH) == alpha.cols ||
        shape.at<int>(i, cv::CC_STAT_TOP) + shape.at<int>(i, cv::CC_STAT_HEIGHT) == alpha.rows)
      hole[i] = 0;
  cv::Mat out(alpha.size(), CV_8U);
  for (int y = 0; y < alpha.rows; ++y)
    for (int x = 0; x < alpha.cols; ++x) out.at<std::uint8_t>(y, x) = hole[parts.at<int>(y, x)];
  return out;
}

/// What burns, as a picture on black. It goes on behind holes in the matte, or they would go up as dark ones.
struct Burning {
  cv::Mat flames, level;  // as flames_on_black, and PartedStill::level
  cv::Mat holes, trust;   // of the matte, CV_8U and CV_32F; empty where there are none
};

Burning burning_of(const PartedStill& parted, const cv::Mat& alpha) {
  Burning out{
      .flames = flames_on_black(parted), .level = parted.level, .holes = holes_of(alpha), .trust = {}};
  if (cv::countNonZero(out.holes) == 0) {
    out.holes.release();
    return out;
  }
  out.trust = alpha.clone();
  out.trust.setTo(0, out.holes);
  sampling::pull_push(out.flames, out.trust).copyTo(out.flames, out.holes);
  out.level = parted.level.clone();
  level_of(luma_of(light_of(out.flames))).copyTo(out.level, out.holes);
  return out;
}

/// The light alone as a picture.
StillPart light_as_still(const StillPart& still, const Burning& burning, double piece_scale) {
  StillPart light = still;
  light.target = fed_from_below(burning.flames, burning.level);
  light.luma = luma_of(light.target);
  light.behind.release();
  if (!burning.holes.empty()) {
    light.alpha = still.alpha.clone();
    light.alpha.setTo(1, burning.holes);
    for (cv::Mat* motion : {&light.asked_motion, &light.assigned_motion})
      *motion = sampling::pull_push(*motion, burning.trust);
  }
  light.colours = colours_of(light, piece_scale);
  return light;
}

FrameOptions of_light(const FrameOptions& options) {
  FrameOptions out = options;
  out.form = FrameForm::kFluid;
  out.matte_sink = out.motion_sink = {};
  return out;
}

/// A flame's level is what it does: where its clips' wide forms stand, that is the ground around them. Its foot keeps
/// its place, its tip goes up into what is dark.
CarriedOptions of_flames(CarriedOptions options, const cv::Mat& level) {
  options.wide_layout = kWideLayout;
  options.freed = tips_of(level);
  options.carry.looks = kLooks;
  options.holds_light = false;
  return options;
}

/// A tongue of the picture, as light of its own.
struct OwnTongue {
  Tongue tongue;
  cv::Mat light;     // CV_32FC4, of its box: what shines, and the light of its level
  double later = 0;  // s: where in the clip it begins, so that tongues do not sway in step
};

/// The course of the clip whose flame is a tongue in most frames; among equals, of the calmest.
std::optional<TongueCourse> course_like(const Animation& animation, std::span<const store::ClipId> clips) {
  const store::Snapshot& snapshot = animation.snapshot;
  std::optional<TongueCourse> best;
  for (const store::ClipId clip : clips.first(std::min(clips.size(), kCourseClips))) {
    animation.throw_if_stopped();
    const std::optional<TongueCourse> look = course_of(clip_forms(snapshot, clip, kCourseLook));
    if (!look) continue;
    if (!best || look->tongue > best->tongue ||
        (look->tongue == best->tongue && look->unrest() < best->unrest()))
      best = look;
  }
  return best ? course_of(clip_forms(snapshot, best->clip, kCourseFrames)) : best;
}

/// Mean speed that is asked of the tongues, heights a second, weighted by light; none where none is asked on them.
/// level  of the picture's light. motion, speed  of a guide (apply_guide, MotionGuide), the picture's size.
std::optional<double> asked_speed(const std::vector<Tongue>& tongues, const cv::Mat& level,
                                  const cv::Mat& motion, const cv::Mat& speed) {
  if (speed.empty()) return std::nullopt;
  double sum = 0, weight = 0;
  for (const Tongue& tongue : tongues)
    for (int y = 0; y < tongue.box.height; ++y)
      for (int x = 0; x < tongue.box.width; ++x) {
        const cv::Point at = tongue.box.tl() + cv::Point(x, y);
        if (speed.at<float>(at) < 0) continue;
        const double light = tongue.share.at<float>(y, x) * light_of(level.at<float>(at));
        sum += light * cv::norm(motion.at<cv::Vec2f>(at)) / tongue.height;
        weight += light;
      }
  return weight > 0 ? std::optional(sum / weight) : std::nullopt;
}

/// Where a tongue and its soft rim hide what is behind, CV_8U, of its box.
cv::Mat covered_by(const Tongue& tongue, const cv::Mat& level) {
  cv::Mat covered = (level > kRimLevel) & (tongue.share > kOwn);
  const int rim = 2 * std::max(1, static_cast<int>(std::lround(kRimWidth * tongue.height))) + 1;
  cv::dilate(covered, covered, cv::getStructuringElement(cv::MORPH_ELLIPSE, {rim, rim}));
  return covered;
}

/// Light around a tongue, continued behind it: CV_32FC3, of its box, no more than is there, and than goes on from just
/// beyond its rim.
cv::Mat behind(const cv::Mat& light, const cv::Mat& covered, const Tongue& tongue) {
  const cv::Mat trust = 1 - tongue.share;
  cv::Mat beyond, rest(light.size(), light.type());
  cv::Mat(~covered).convertTo(beyond, CV_32F, 1.0 / 255);
  const cv::Mat fill =
      cv::min(sampling::pull_push(light, trust.mul(trust)), sampling::pull_push(light, beyond));
  for (int y = 0; y < light.rows; ++y)
    for (int x = 0; x < light.cols; ++x)
      for (int k = 0; k < 3; ++k) {
        const float own = light.at<cv::Vec3f>(y, x)[k], share = tongue.share.at<float>(y, x);
        rest.at<cv::Vec3f>(y, x)[k] = own - share * std::max(0.0f, own - fill.at<cv::Vec3f>(y, x)[k]);
      }
  return rest;
}

/// Continues the ground behind a tongue and its soft rim from around them. What the ground loses is the tongue's light;
/// below the foot, where all is lit as it is, it loses nothing.
void glow_behind(PartedStill& parted, const Tongue& tongue) {
  const cv::Mat level = parted.level(tongue.box);
  cv::Mat ground = parted.ground(tongue.box), light = parted.light(tongue.box),
          covered = covered_by(tongue, level);
  covered.rowRange(static_cast<int>(tongue.foot), level.rows).setTo(255);
  if (cv::countNonZero(~covered) == 0) return;
  cv::Mat trust;
  cv::Mat(~covered).convertTo(trust, CV_32F, 1.0 / 255);
  const cv::Mat fill = sampling::pull_push(ground, trust);
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x) {
      if (covered.at<std::uint8_t>(y, x) == 0) continue;
      for (int k = 0; k < 3; ++k) {
        float &under = ground.at<cv::Vec3f>(y, x)[k], &over = light.at<cv::Vec3f>(y, x)[k];
        const float least = y < static_cast<int>(tongue.foot) ? -under : 0;
        const float more = tongue.share.at<float>(y, x) *
                           std::clamp(fill.at<cv::Vec3f>(y, x)[k] - under, least, std::max(0.0f, over));
        under += more;
        over -= more;
      }
    }
}

/// Takes its tongues out of what is parted.
std::vector<OwnTongue> taken_out(PartedStill& parted, const std::vector<Tongue>& tongues,
                                 const TongueCourse& course) {
  std::vector<OwnTongue> out;
  const double seconds = static_cast<double>(course.sways.size()) / course.fps;
  for (const Tongue& tongue : tongues) {
    OwnTongue own{.tongue = tongue,
                  .light = cv::Mat(tongue.box.size(), CV_32FC4),
                  .later = seconds * static_cast<double>(out.size()) / static_cast<double>(tongues.size())};
    glow_behind(parted, tongue);
    cv::Mat light = parted.light(tongue.box), level = parted.level(tongue.box);
    const cv::Mat rest = behind(light, covered_by(tongue, level), tongue), of_rest = luma_of(rest);
    for (int y = 0; y < light.rows; ++y)
      for (int x = 0; x < light.cols; ++x) {
        const cv::Vec3f taken = light.at<cv::Vec3f>(y, x) - rest.at<cv::Vec3f>(y, x);
        const float lit = light_of(level.at<float>(y, x)),
                    less = std::clamp(of_rest.at<float>(y, x), 0.0f, lit);
        own.light.at<cv::Vec4f>(y, x) = {taken[0], taken[1], taken[2], lit - less};
        level.at<float>(y, x) = level_of(less);
      }
    rest.copyTo(light);
    out.push_back(own);
  }
  return out;
}

class OwnFlames final : public Renderer {
 public:
  OwnFlames(Animation& animation, const StillPart& still, PartedStill parted, const OwnFlamesOptions& options)
      : animation_(animation),
        picture_(still.target),
        colours_(parted.light, parted.level),
        ground_(parted, parted.level, kReach * std::max(still.target.cols, still.target.rows),
                options.lighting),
        parted_(std::move(parted)),
        options_(options),
        tongues_(found_tongues(still.asked_motion)),
        burning_(burning_of(parted_, still.alpha)),
        light_(light_as_still(still, burning_, animation.placement.piece_scale)),
        light_options_(of_light(animation.options)),
        inner_{.snapshot = animation.snapshot,
               .settings = animation.settings,
               .picture = light_.target,
               .matte = animation.matte,
               .placement = animation.placement,
               .options = light_options_,
               .progress = animation.progress,
               .stop = animation.stop},
        carried_(make_renderer(inner_, light_, with_level(of_flames(options.carried, burning_.level)))) {
    AnimateReport& report = animation_.report;
    report.clips = inner_.report.clips;
    report.half_life_s = inner_.report.half_life_s;
    report.renewed = inner_.report.renewed;
    report.base_s += animation_.watch.lap();
    own_ = parted_.light - light_of(burning_.flames);
    burning_ = {};
    if (rest_stands_) own_.setTo(0);  // all of its light is shown
    inside_ = deep_in(still.alpha);
    reach_ = reach_of(parted_.level);
    top_ = brightest(shining(parted_.level));
    shines_ = std::max(cv::mean(parted_.level)[0], 1e-6);
    light_.release_for_frames(false);
  }

  int batch() const override { return carried_->batch(); }
  cv::Mat motion(int output) const override { return carried_->motion(output); }
  cv::Mat step(int output) const override { return carried_->step(output); }
  void read(std::span<const int> outputs) override {
    carried_->read(outputs);
    animation_.report.decode_s += animation_.watch.lap();
  }
  void prepare(std::span<const int> outputs, std::span<const cv::Mat> mattes, std::size_t passed) override {
    carried_->prepare(outputs, mattes, passed);
  }

  cv::Mat finish(int output, const cv::Mat& matte) override {
    const float still = remaining(output);
    const Carried carried = output == 0 ? Carried{parted_.level, parted_.light, {}} : carry(output, matte);
    const cv::Mat& level = carried.level;
    cv::Mat swaying, shining = level;
    if (!tongues_.empty()) {
      swaying = cv::Mat::zeros(level.size(), CV_32FC4);
      shining = level.clone();
    }
    for (const OwnTongue& own : tongues_) {
      const cv::Mat light = swayed(own.light, own.tongue, sway(own, output));
      swaying(own.tongue.box) += light;
      cv::Mat of_tongue, within = shining(own.tongue.box);
      cv::extractChannel(light, of_tongue, 3);
      level_of(light_of(within) + of_tongue).copyTo(within);
    }
    const cv::Mat more = ground_.brightening(shining, output == 0 ? 0.0f : 1.0f);
    cv::Mat frame(level.size(), CV_32FC3);
    for (int y = 0; y < frame.rows; ++y)
      for (int x = 0; x < frame.cols; ++x) {
        const cv::Vec3f picture = picture_.at<cv::Vec3f>(y, x);
        const cv::Vec4f tongue = swaying.empty() ? cv::Vec4f() : swaying.at<cv::Vec4f>(y, x);
        // A tongue sways over what lies beside the matte, too.
        const float share = std::max(matte.at<float>(y, x), std::min(1.0f, tongue[3] / kOverAll));
        cv::Vec3f& to = frame.at<cv::Vec3f>(y, x) = picture;
        if (share <= 0 || output == 0) continue;
        // Where light has gone on, none of its own colour stays behind: it would be blue on white.
        const float now = level.at<float>(y, x), before = parted_.level.at<float>(y, x);
        const float kept = now < before ? light_of(now) / light_of(before) : 1.0f;
        const cv::Vec3f flame = carried.light.at<cv::Vec3f>(y, x) +
                                still * kept * kept * own_.at<cv::Vec3f>(y, x) +
                                cv::Vec3f(tongue[0], tongue[1], tongue[2]);
        const cv::Vec3f ground = lit(y, x, more.at<float>(y, x), carried.lighter.at<float>(y, x));
        for (int k = 0; k < 3; ++k) {
          const float code = level_of(std::max(0.0f, ground[k] + flame[k]));
          to[k] += share * (code - to[k]);
        }
      }
    return handed_on(frame, picture_, matte, animation_.options.form);
  }

 private:
  /// What the patches and the carried flames do in an output frame.
  struct Carried {
    cv::Mat level, light;  // as PartedStill has them: of the flames, where they may be
    cv::Mat lighter;       // CV_32F, luma: how much lighter than usual what the patches show is
  };
  Carried carry(int output, const cv::Mat& matte) {
    const cv::Mat fluid = carried_->finish(output, matte);
    const LighterPatches lighter = taken_level(output, fluid.size());
    if (rest_stands_) return {parted_.level, parted_.light, lighter.liveliest};
    const float own_colours = remaining(output),
                together = static_cast<float>(cv::mean(lighter.here.mul(parted_.level))[0] / shines_);
    Carried carried{.level = cv::Mat(fluid.size(), CV_32F),
                    .light = cv::Mat(fluid.size(), CV_32FC3),
                    .lighter = lighter.liveliest};
    for (int y = 0; y < fluid.rows; ++y)
      for (int x = 0; x < fluid.cols; ++x) {
        const cv::Vec4f f = fluid.at<cv::Vec4f>(y, x);
        cv::Vec3f& light = carried.light.at<cv::Vec3f>(y, x) = {};
        for (int k = 0; k < 3 && f[3] > 0; ++k) light[k] = light_of(f[k] / f[3]);
        const float now = level_of(luma_of(light));
        const float leaps = leaping(now, lighter.here.at<float>(y, x) - together, top_);
        const float shown =
            thinned(leaps * reach_.at<float>(y, x), kLostBehind * parted_.before.at<float>(y, x));
        // What flares has the colour of flames that are as light: its own, lighter, would be yellow.
        const float flares = std::clamp((leaps - now) / (kMostFlared * now + 1e-6f), 0.0f, 1.0f);
        const cv::Vec3f as_light = colours_.at(shown);
        light += flares * (as_light * (luma_of(light) / std::max(luma_of(as_light), 1e-6f)) - light);
        const cv::Vec3f usual = no_paler(light, as_light);
        light = usual + own_colours * (light - usual);
        if (now > 0) light *= light_of(shown) / light_of(now);
        carried.level.at<float>(y, x) = shown;
      }
    return carried;
  }

  CarriedOptions with_level(CarriedOptions options) {
    options.level_sink = {
        .take =
            [this](int output, LighterPatches lighter) {
              const std::lock_guard lock(guard_);
              lighter_[output] = std::move(lighter);
            },
        .deviation = std::lerp(kMostByDay, kMostByNight, ground_.darkness() * ground_.darkness())};
    return options;
  }
  LighterPatches taken_level(int output, cv::Size size) {
    const std::lock_guard lock(guard_);
    auto found = lighter_.extract(output);
    if (!found) return {cv::Mat::zeros(size, CV_32F), cv::Mat::zeros(size, CV_32F)};
    return std::move(found.mapped());
  }

  /// The ground as flames light it, and as that of the clips' fires glows, glimmers and is hazy: near a side of the
  /// matte as beyond it.
  cv::Vec3f lit(int y, int x, float more, float lighter) const {
    const cv::Vec3f& ground = parted_.ground.at<cv::Vec3f>(y, x);
    const float code = level_of(luma_of(ground)), before = light_of(code);
    if (before <= 0) return more * ground;
    const float change = inside_.at<float>(y, x) * std::min(1.0f, code / kFull) * lighter;
    return ground * (more * light_of(code + change) / before);
  }

  std::vector<OwnTongue> found_tongues(const cv::Mat& asked_motion) {
    const std::vector<Tongue> tongues = tongues_of(parted_.level);
    if (tongues.empty()) return {};
    course_ = course_like(animation_, options_.clips);
    if (!course_) return {};
    const std::optional<double> asked =
        asked_speed(tongues, parted_.level, asked_motion, animation_.options.guide.speed);
    course_ = asked ? as_fast_as(*std::move(course_), *asked / options_.pace)
                    : halfway_to_usual(*std::move(course_));
    animation_.report.tongues = tongues.size();
    animation_.report.sways_as = course_->clip;
    rest_stands_ = share_of_light(tongues, parted_.level) > kMostly;
    return taken_out(parted_, tongues, *course_);
  }

  /// Upright at frame 0, and at the end of a loop.
  Sway sway(const OwnTongue& own, int output) const {
    const Sway of_clip = course_->at(own.later + options_.pace * output / animation_.options.fps);
    const double going = 1 - remaining(output);
    return {going * of_clip.lean, going * of_clip.bow, 1 + going * (of_clip.stretch - 1)};
  }

  /// Of what the picture's light has beyond its picture on black, how much is left: 1 at frame 0, to 0.
  float remaining(int output) const {
    const FrameOptions& options = animation_.options;
    const int apart = options.loop ? std::min(output, options.frames - output) : output;
    const double left = 1 - apart / std::max(2.0, options_.handover_s * options.fps);
    return static_cast<float>(std::clamp(left, 0.0, 1.0));
  }

  Animation& animation_;
  const cv::Mat picture_;  // CV_32FC3
  LightColours colours_;
  LitGround ground_;
  PartedStill parted_;  // less its tongues
  const OwnFlamesOptions options_;
  std::optional<TongueCourse> course_;
  bool rest_stands_ = false;
  const std::vector<OwnTongue> tongues_;
  Burning burning_;  // until frames are made
  StillPart light_;
  const FrameOptions light_options_;
  Animation inner_;
  std::mutex guard_;
  std::map<int, LighterPatches> lighter_;  // by output frame, until it is finished
  std::unique_ptr<Renderer> carried_;
  cv::Mat own_;        // CV_32FC3: the light less what its picture on black shows
  cv::Mat inside_;     // CV_32F, 0..1: of the matte, how far from its sides
  cv::Mat reach_;      // CV_32F, 0..1: where light may be
  double shines_ = 0;  // mean level of the picture's light
  float top_ = 1;      // level: flames leap no higher
};

}  // namespace

std::unique_ptr<Renderer> own_flames(Animation& animation, const StillPart& still, PartedStill parted,
                                     const OwnFlamesOptions& options) {
  return std::make_unique<OwnFlames>(animation, still, std::move(parted), options);
}

}  // namespace freshet::synth::animate
