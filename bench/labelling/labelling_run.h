// bench/labelling/labelling_run.h — a picture labelled in a process of its own, from start to assignment.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>

#include "bench/harness/picture_argument.h"

namespace freshet::bench {

/// What a labelling is asked for.
struct LabellingCase {
  std::filesystem::path store;
  std::string picture;  // PICTURE[:MATTE]
  cv::Size size;        // px, that it is brought to; empty: its own
};

/// Read, and brought to the size.
PictureArgument picture_of(const LabellingCase& asked);

enum class Pages {
  kAsTheyAre,
  kDropped,  // the store's and the picture's are asked out of the system's cache before each run
};

/// Medians over runs of query::label with its defaults, a new process of this program each:
///   "total"     seconds from before the process is started to the assignment; of it "start", "picture",
///               "store" (both indexes), "cut", "search", "tables" and "solver"
///   "cpu"       seconds of all threads
///   "peak_mb", "gap", "runs", "most_total"
///   "cached"    the maximum fraction of the store that was in the cache before a run
nlohmann::json median_labelling(const LabellingCase& asked, int runs, Pages pages);

/// The new process's part: true, and all done, when the command line is one that median_labelling gives.
bool label_as_asked(int argc, char** argv);

}  // namespace freshet::bench
