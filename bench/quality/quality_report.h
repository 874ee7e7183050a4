// quality_report.h — what was measured, as tables and as JSON.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/quality/quality_measures.h"
#include "synth/judging/critic.h"

namespace freshet::bench {

/// One clip animated in one way, or one of its references.
struct Judged {
  std::string clip, class_name, method{};
  Distance distance{};
  LifetimeCurve lifetime{};           // of the film itself
  double label_s = 0, render_s = 0;   // wall clock
  std::string video{};                // beside the page; may be empty
  synth::judging::Verdict verdict{};  // the critic's; without findings where it was not asked
};

/// Tables have a dozen columns each, or nobody reads them.
enum class FigureGroup { kMotion, kLook, kAsked };
const char* to_string(FigureGroup group);

/// A figure of the tables: how it is headed, and what of a distance it is. Not measured: NaN, and in no mean.
struct Figure {
  const char *key, *head;
  double (*value)(const Distance&);
  int digits;
  FigureGroup group = FigureGroup::kMotion;
  bool more_is_better = false;
  bool is_signed = false;  // in a mean; of the others only sizes count
};
const std::vector<Figure>& figures();
/// With the figure's digits; "-" when not measured.
std::string to_string(const Figure& figure, double value);

/// Mean and median by method, over all clips and by class, a table for each group of figures; a row per
/// method, in the order of first appearance.
std::string summary_table(const std::vector<Judged>& judged);
/// A table for each group of figures: a row per clip and method; signed.
std::string clip_table(const std::vector<Judged>& judged);
nlohmann::json to_json(const std::vector<Judged>& judged);

}  // namespace freshet::bench
