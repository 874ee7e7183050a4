// query/benchmark/search_report.h — what a search benchmark found out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/machine.h"

namespace freshet::query {

/// Fractions of the best 1, 10, 100 that an answer holds, mean over pieces; a patch that scores as well as
/// the last of them counts. `worst` is the minimum recall@100 of a piece.
struct Recall {
  double at_1 = 0, at_10 = 0, at_100 = 0, worst = 0;
};

struct SearchTimes {
  double median_ms = 0, p99_ms = 0;  // a piece, asked by itself, CPU time of one core
  double all_threads_ms = 0;         // a piece of a batch, wall clock of all threads
};

struct SettingResult {
  std::string name;
  std::size_t pieces = 0;  // that were asked
  SearchTimes times;
  Recall recall;
  std::optional<double> energy_loss;  // of labelling, above that with exact candidates; a fraction
};

struct FilterResult {
  std::string condition, setting;
  double admitted = 0;  // fraction of rows, mean over pieces
  SearchTimes times;
  double recall = 0;         // @100
  std::size_t short_of = 0;  // pieces with fewer answers than there are
};

struct IndexResult {
  std::string name, what;
  bool is_exact = false;
  std::string skipped;                 // why there is no result; empty: there is one
  std::string package;                 // to install; with `skipped`
  std::size_t rows = 0;                // that it was built of
  double build_seconds = 0;            // one core
  double projected_build_seconds = 0;  // of all rows, when it was built of fewer; 0: it was not
  bool from_store = false;
  std::size_t bytes = 0;  // of memory
  std::vector<SettingResult> settings;
  std::vector<FilterResult> filters;
};

struct SearchReport {
  report::Machine machine;
  std::string store;                             // file name
  std::size_t clips = 0, patches = 0, rows = 0;  // in the store; searched among
  int words = 0;
  std::string held_out;
  std::vector<std::string> pictures;
  std::vector<std::size_t> picture_pieces;
  std::size_t pieces = 0;              // asked
  std::size_t checked = 0, wrong = 0;  // pieces whose exact answer was compared with brute force
  std::string labelled;                // the picture; empty: none
  std::size_t labelled_pieces = 0;     // of it
  double build_limit_s = 0, setting_limit_s = 0;
  std::vector<IndexResult> indexes;
};

nlohmann::json to_json(const SearchReport& report);

/// "On 246,477 patches hnswlib is nearest: recall@100 .992 in 2.6 ms per piece; exact takes 0.5 ms": of the
/// indexes that were built of all rows and reach a recall@100 of .9, the fastest beside the exact one.
/// Empty when there is none.
std::string verdict(const SearchReport& report);

}  // namespace freshet::query
