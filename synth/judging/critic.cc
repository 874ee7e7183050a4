#include "synth/judging/critic.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "synth/judging/coherence.h"
#include "synth/judging/colour_drift.h"
#include "synth/judging/dents.h"
#include "synth/judging/detail_loss.h"
#include "synth/judging/film_motion.h"
#include "synth/judging/pulse.h"
#include "synth/judging/recurrence.h"
#include "synth/judging/seams.h"
#include "synth/judging/stillness.h"
#include "synth/judging/stretch.h"

namespace freshet::synth::judging {
namespace {

/// Of a speed outside of the kind's: octaves beyond the nearer end of the range are its fault.
Finding speed_finding(const Evidence& film, const FilmMotion& motion, const std::string& kind) {
  Finding finding{.measure = Measure::kSpeed, .reading = mean_speed(film, motion)};
  const SpeedRange range = usual_speed(kind);
  const double side = std::max(film.picture().width, film.picture().height);
  finding.usual = std::clamp(finding.reading.value, range.slow * side, range.fast * side);
  finding.fault = std::min(
      kGravest, std::abs(std::log2(std::max(finding.reading.value, 1e-3) / std::max(finding.usual, 1e-3))));
  return finding;
}

Finding finding_of(Measure measure, Reading reading, const std::string& kind) {
  const Usual usual = usual_of(measure, kind);
  Finding finding{.measure = measure, .reading = std::move(reading), .usual = usual.until};
  const double value = finding.reading.value;
  if (value < usual.from) finding.usual = usual.from;
  if (std::isfinite(value))
    finding.fault = std::min(kGravest, std::max({0.0, value - usual.until, usual.from - value}) / usual.step);
  return finding;
}

/// What is faster than the kind strains faster and is renewed sooner: it is judged over the way that the kind's fast
/// fluid goes in the reading's time.
Reading over_usual_way(Reading stretch, double speed, const Evidence& film, const std::string& kind) {
  const double fast = usual_speed(kind).fast * std::max(film.picture().width, film.picture().height);
  const double share = std::min(1.0, fast / std::max(speed, 1e-3));
  stretch.value *= share;
  for (cv::Mat& map : stretch.map) map *= share;
  return stretch;
}

std::string figure(double value) {
  const double size = std::abs(value);
  return fmt::format("{:.{}f}", value, size < 1 ? 2 : size < 10 ? 1 : 0);
}

}  // namespace

const Finding* Verdict::worst() const {
  const auto most = std::ranges::max_element(findings, {}, &Finding::fault);
  return most != findings.end() && most->fault > 0 ? &*most : nullptr;
}

Verdict judge(const Evidence& film, const std::string& kind, const Asked& asked) {
  if (film.count() < kFewestFrames)
    throw Error(ErrorKind::kInput, "the film",
                fmt::format("it has {} frames; fewer than {} cannot be judged", film.count(), kFewestFrames),
                "Give a longer one");
  if (cv::countNonZero(film.fluid()) == 0)
    throw Error(ErrorKind::kInput, "the matte", "nothing of it is fluid",
                "Give a matte that is white on the fluid");
  const Stopwatch watch;
  const FilmMotion motion = film_motion(film);
  Verdict verdict;
  const auto add = [&](Measure measure, Reading reading) {
    verdict.findings.push_back(finding_of(measure, std::move(reading), kind));
  };
  add(Measure::kRecurrence, recurrence(film));
  add(Measure::kDetailLoss, detail_loss(film));
  add(Measure::kCombing, combing(film));
  add(Measure::kColourDrift, colour_drift(film));
  add(Measure::kPulse, pulse(film));
  const Finding speed = speed_finding(film, motion, kind);
  add(Measure::kStretch, over_usual_way(stretch(film, motion), speed.reading.value, film, kind));
  add(Measure::kSeams, seams(film));
  add(Measure::kDents, dents(film));
  add(Measure::kStillness, stillness(film));
  add(Measure::kAngle, motion_angle(film, motion, asked, kind));
  add(Measure::kAskedSpeed, speed_ratio(film, motion, asked));
  verdict.findings.push_back(speed);
  for (const Finding& finding : verdict.findings) verdict.faults += finding.fault;
  verdict.seconds = film.seconds() + watch.seconds();
  return verdict;
}

const char* fault_words(const Finding& finding) {
  const MeasureWords& words = words_of(finding.measure);
  const bool lacks = finding.reading.value < finding.usual && *words.lack != '\0';
  return lacks ? words.lack : words.fault;
}

std::string place_words(const Finding& finding, const Evidence& film) {
  const Worst worst = worst_of(finding.reading);
  // What is too little is so on the whole: the greatest cell is not its place.
  if (!worst.found || finding.reading.value < finding.usual) return {};
  const cv::Size cells = cells_of(film.size());
  const auto third = [](int at, int of) { return std::min(2, 3 * at / std::max(1, of)); };
  const char* const rows[] = {"upper ", "", "lower "};
  const char* const columns[] = {"left", "middle", "right"};
  const int row = third(worst.cell.y, cells.height);
  std::string words = fmt::format("{}{}", rows[row], columns[third(worst.cell.x, cells.width)]);
  if (finding.reading.map.size() > 1 && worst.span > 0)
    words += fmt::format(", from {:.1f} s on", worst.span * film.count() / (kSpans * film.fps()));
  return words;
}

std::string verdict_words(const Verdict& verdict, const Evidence& film) {
  const Finding* const worst = verdict.worst();
  if (worst == nullptr) return "nothing is beyond what footage of the kind shows";
  const MeasureWords& words = words_of(worst->measure);
  const std::string place = place_words(*worst, film);
  const std::string unit = *words.unit != '\0' ? fmt::format(" {}", words.unit) : "";
  return fmt::format("{}{} ({} {}{}; usual {} {}). To change it: {}", fault_words(*worst),
                     place.empty() ? "" : ", most at the " + place, words.name, figure(worst->reading.value),
                     unit, worst->reading.value < worst->usual ? "from" : "up to", figure(worst->usual),
                     words.remedy);
}

}  // namespace freshet::synth::judging
