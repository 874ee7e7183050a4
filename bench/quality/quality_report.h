// quality_report.h — what was measured, as tables and as JSON.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/quality/quality_measures.h"

namespace freshet::bench {

/// One clip animated in one way, or one of its references.
struct Judged {
  std::string clip, class_name, method{};
  Distance distance{};
  double label_s = 0, render_s = 0;  // wall clock
  std::string video{};               // beside the page; may be empty
};

/// A figure of the tables: how it is headed, and what of a distance it is. In a mean, only sizes count.
struct Figure {
  const char *key, *head;
  double Distance::*value;
  int digits;
  bool more_is_better = false;
};
const std::vector<Figure>& figures();

/// Mean and median by method, over all clips and by class; a row per method, in the order of first
/// appearance.
std::string summary_table(const std::vector<Judged>& judged);
/// A row per clip and method; signed.
std::string clip_table(const std::vector<Judged>& judged);
nlohmann::json to_json(const std::vector<Judged>& judged);

}  // namespace freshet::bench
