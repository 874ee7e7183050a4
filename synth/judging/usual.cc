#include "synth/judging/usual.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace freshet::synth::judging {
namespace {

constexpr std::array<MeasureWords, kMeasures> kWords{{
    {Measure::kRecurrence, "comes_again", "", "the same forms come back", "",
     "a shorter --detail-life, --layout stands for falls and rapids, --method forms for fires"},
    {Measure::kDetailLoss, "detail_loss", "octaves", "detail is lost in fog", "",
     "a longer --detail-life, or a smaller --speed"},
    {Measure::kCombing, "combing", "", "detail is drawn out into strands", "its strands are torn",
     "a smaller --speed for strands, --layout goes or a smaller --renewal for what is torn"},
    {Measure::kColourDrift, "colour_drift", "levels", "colours leave the picture's",
     "its light and dark hardly move",
     "a longer --detail-life or --hold where colours leave, --layout goes or a greater --speed where nothing "
     "moves"},
    {Measure::kPulse, "pulse", "levels", "its level pulses", "its level is too steady",
     "a smaller --renewal, or other clips (--exclude)"},
    {Measure::kStretch, "stretch", "octaves", "the motion tears it apart", "it slides as one piece",
     "strokes that diverge less, or another --variation"},
    {Measure::kSeams, "seams", "per mille", "hard edges show", "",
     "a longer --detail-life, or --boundary static"},
    {Measure::kDents, "dents", "px", "a straight border is dented", "",
     "--horizon auto where water ends there, --hold along that border, or a tighter --matte"},
    {Measure::kStillness, "stillness", "", "it stands still", "",
     "faster strokes, a greater --speed, or a smaller --standing"},
    {Measure::kAngle, "angle", "degrees", "it goes elsewhere than asked", "",
     "fewer strokes, of which none cross"},
    {Measure::kAskedSpeed, "asked_speed", "octaves", "its speed is not the one asked", "",
     "--takes 1, or other speeds"},
    {Measure::kSpeed, "speed", "px/s", "it is faster than the kind is", "it is slower than the kind is",
     "--speed"},
}};

constexpr double kAny = -1e9;  // of what is no fault, however small

// Rows as Measure, columns as kKinds. Until: the upper quartile of 22 clips judged as films of their own first frame;
// from: below the least of them; step: about the distance from the median to the greatest
// (docs/measurements/critic.md). What footage hardly has (strands, stillness) gets a step that was seen in films.
constexpr std::array<std::array<Usual, 4>, kMeasures> kUsual{{
    // comes_again
    {{{kAny, .20, .15}, {kAny, .22, .15}, {kAny, .20, .15}, {kAny, .15, .15}}},
    // detail_loss
    {{{kAny, .10, .15}, {kAny, .25, .25}, {kAny, .15, .20}, {kAny, .30, .20}}},
    // combing
    {{{-.03, .03, .05}, {-.05, .05, .05}, {-.03, .03, .05}, {-.03, .03, .05}}},
    // colour_drift
    {{{2, 14, 8}, {15, 35, 15}, {3, 14, 8}, {15, 30, 15}}},
    // pulse
    {{{.2, 1, .7}, {1, 6.5, 4}, {.1, 1, .8}, {.5, 2, 1}}},
    // stretch
    {{{.1, .4, .3}, {.2, 1.2, .5}, {.1, .25, .25}, {.1, .25, .25}}},
    // seams
    {{{kAny, .1, .5}, {kAny, .3, 1}, {kAny, .1, .5}, {kAny, .25, .5}}},
    // dents
    {{{kAny, .5, .5}, {kAny, .5, .8}, {kAny, .5, .8}, {kAny, 1, 1}}},
    // stillness
    {{{kAny, .02, .1}, {kAny, .05, .1}, {kAny, .02, .1}, {kAny, .02, .1}}},
    // angle
    {{{kAny, 25, 20}, {kAny, 30, 20}, {kAny, 25, 20}, {kAny, 25, 20}}},
    // asked_speed: what was asked weighs something, and no more than what breaks the film
    {{{kAny, .5, 1}, {kAny, .5, 1}, {kAny, .5, 1}, {kAny, .5, 1}}},
    // speed, which has a range
    {{{kAny, 0, 1}, {kAny, 0, 1}, {kAny, 0, 1}, {kAny, 0, 1}}},
}};

// Quartiles of the same clips, columns as kKinds.
constexpr std::array<SpeedRange, 4> kSpeeds{
    {{.033, .043, .126}, {.10, .21, .28}, {.04, .10, .17}, {.03, .10, .13}}};

}  // namespace

const MeasureWords& words_of(Measure measure) { return kWords[static_cast<std::size_t>(measure)]; }

Usual usual_of(Measure measure, std::string_view kind) {
  const auto& row = kUsual[static_cast<std::size_t>(measure)];
  Usual mean{.from = 0, .until = 0, .step = 0};
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    if (kKinds[i] == kind) return row[i];
    mean.from += row[i].from / kKinds.size();
    mean.until += row[i].until / kKinds.size();
    mean.step += row[i].step / kKinds.size();
  }
  return mean;
}

SpeedRange usual_speed(std::string_view kind) {
  SpeedRange all{.slow = kSpeeds[0].slow, .natural = 0, .fast = kSpeeds[0].fast};
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    if (kKinds[i] == kind) return kSpeeds[i];
    all.slow = kSpeeds[i].slow < all.slow ? kSpeeds[i].slow : all.slow;
    all.fast = kSpeeds[i].fast > all.fast ? kSpeeds[i].fast : all.fast;
    all.natural += kSpeeds[i].natural / kKinds.size();
  }
  return all;
}

double speed_of(std::string_view kind, std::string_view pace, cv::Size picture) {
  const SpeedRange range = usual_speed(kind);
  const double sides = pace == "slow" ? range.slow : pace == "fast" ? range.fast : range.natural;
  return sides * std::max(picture.width, picture.height);
}

}  // namespace freshet::synth::judging
