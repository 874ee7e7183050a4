#include "studio/found_takes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "query/labelling/shares.h"
#include "studio/clip_strip.h"
#include "studio/jobs/jobs.h"
#include "synth/takes/trial.h"

namespace freshet::studio {
namespace {

namespace takes = synth::takes;
namespace judging = synth::judging;
using Json = nlohmann::json;

constexpr int kStripEvery = 2;       // frames: strips play half as many a second
constexpr int kMarkSide = 256;       // px, of the map of what is worst
constexpr double kReddest = 0.6;     // of a mark
constexpr double kSeenFault = 0.25;  // what is less is not marked

/// playing   the factor that it plays at now.
Json change_of(const takes::Take& take, const Document& document, double playing, double half_life_s) {
  Json change = Json::object();
  const bool speeds =
      std::ranges::any_of(document.strokes, [](const DrawnStroke& line) { return !!line.speed; });
  if (take.own_speeds) change["own_speeds"] = true;
  if (take.speed != 1 && speeds && !take.own_speeds) change["pace"] = take.speed;
  if (take.own_speeds || (take.speed != 1 && !speeds))
    change["speed"] = std::clamp(playing * take.speed, 0.05, 20.0);
  if (take.life != 1) change["detail_life"] = std::clamp(take.life * half_life_s, 0.01, 60.0);
  if (take.layout) change["layout"] = *take.layout == synth::animate::Layout::kStands ? "stands" : "goes";
  if (take.forms) change["flames"] = "clips";
  return change;
}

std::string strip_of(const judging::Evidence& film) {
  std::vector<cv::Mat> frames;
  for (std::size_t i = 0; i < film.frames().size(); i += kStripEvery) frames.push_back(film.frames()[i]);
  return frames.empty() ? "" : encoded(clip_strip(frames, film.size().width));
}

/// How much each cell is beyond what is usual, 0..1: of the measure and the time that are worst there.
cv::Mat worst_cells(const judging::Verdict& verdict) {
  cv::Mat worst;
  for (const judging::Finding& finding : verdict.findings) {
    if (finding.fault < kSeenFault) continue;
    const judging::Worst most = judging::worst_of(finding.reading);
    if (!most.found || most.value <= finding.usual) continue;
    for (const cv::Mat& map : finding.reading.map) {
      if (worst.empty()) worst = cv::Mat(map.size(), CV_32F, cv::Scalar(0));
      for (int y = 0; y < map.rows; ++y)
        for (int x = 0; x < map.cols; ++x) {
          const double value = map.at<float>(y, x);
          if (!std::isfinite(value)) continue;
          const double share =
              (value - finding.usual) / (most.value - finding.usual) * std::min(1.0, finding.fault);
          float& cell = worst.at<float>(y, x);
          cell = std::max(cell, static_cast<float>(std::clamp(share, 0.0, 1.0)));
        }
    }
  }
  return worst;
}

std::string red_png(const cv::Mat& cells, const cv::Mat& fluid) {
  const double factor = static_cast<double>(kMarkSide) / std::max(fluid.cols, fluid.rows);
  cv::Mat alpha, within;
  const cv::Size size(std::max(1, cvRound(fluid.cols * factor)), std::max(1, cvRound(fluid.rows * factor)));
  cv::resize(cells, alpha, size, 0, 0, cv::INTER_CUBIC);
  cv::resize(fluid, within, size, 0, 0, cv::INTER_AREA);
  alpha.convertTo(alpha, CV_8U, 255 * kReddest);
  cv::multiply(alpha, within, alpha, 1.0 / 255);
  cv::Mat mark;
  const cv::Mat none(size, CV_8U, cv::Scalar(40)), all(size, CV_8U, cv::Scalar(255));
  cv::merge(std::vector<cv::Mat>{none, none, all, alpha}, mark);
  return encoded_png(mark);
}

/// "the same forms come back, lower left, from 1.3 s on".
std::string says(const judging::Verdict& verdict, const judging::Evidence& film) {
  const judging::Finding* const worst = verdict.worst();
  if (worst == nullptr || worst->fault < kSeenFault) return "";
  const std::string place = judging::place_words(*worst, film);
  return judging::fault_words(*worst) + (place.empty() ? "" : ", " + place);
}

}  // namespace

FoundTakes find_takes(const LabelledPicture& labelled, const Document& document, const ReelScene& scene,
                      const Job& job) {
  const Rendering made = rendering_of(labelled, document, scene, document.frames, document.fps);
  const std::string kind = query::largest_class(made.assignment).name;
  const std::vector<takes::Take> planned = takes::plan_takes(
      kind, made.options, made.asked,
      {.speed = true, .layout = document.layout.empty(), .life = true, .method = true}, kTakes);
  const auto told = [&](std::size_t done) {
    if (job.progress) job.progress({"takes", done, planned.size()});
  };
  const takes::Trial trial = takes::try_takes({.snapshot = labelled.store->snapshot,
                                               .settings = labelled.store->base.settings,
                                               .picture = scene.picture,
                                               .matte = scene.matte,
                                               .assignment = made.assignment,
                                               .asked = made.asked,
                                               .playing = made.playing,
                                               .options = made.options,
                                               .kind = kind},
                                              planned, {}, told, job.stop);
  FoundTakes found{.number = next_number(), .key = frames_key(document), .json = {}};
  Json list = Json::array();
  for (const takes::JudgedTake& judged : trial.takes) {
    const bool failed = !judged.failed.empty();
    found.strips.push_back(failed ? "" : strip_of(judged.film));
    list.push_back({{"name", judged.take.name},
                    {"faults", failed ? Json() : Json(judged.verdict.faults)},
                    {"says", failed ? judged.failed : says(judged.verdict, judged.film)},
                    {"change", change_of(judged.take, document, made.playing.factor, trial.half_life_s)}});
  }
  const takes::JudgedTake& present = trial.takes.front();
  if (const cv::Mat cells = worst_cells(present.verdict); !cells.empty())
    found.worst = red_png(cells, present.film.fluid());
  found.json = json_text(
      {{"number", found.number}, {"takes", list}, {"best", trial.best}, {"marked", !found.worst.empty()}});
  return found;
}

}  // namespace freshet::studio
