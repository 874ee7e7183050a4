#include "bench/labelling/labelling_run.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "bench/harness/machine.h"
#include "bench/harness/page_cache.h"
#include "bench/harness/subprocess.h"
#include "query/labelling/labelling.h"
#include "store/store.h"

namespace freshet::bench {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kAlone = "--alone";

/// One run's seconds by stage, since `start` on the clock of all processes.
json label_alone(const LabellingCase& asked, double start) {
  json run;
  double since = start;
  const auto lap = [&](const char* stage) {
    const double now = wall_seconds();
    run[stage] = now - std::exchange(since, now);
  };
  lap("start");
  const PictureArgument read = picture_of(asked);
  lap("picture");
  const store::Snapshot snapshot = store::Store::open_read(asked.store).snapshot();
  const query::SearchBase base = query::open_search(snapshot);
  lap("store");
  const query::Labelling labelling = query::label(snapshot, base, read.picture, read.matte);
  lap("label");
  run["total"] = since - start;
  run["cut"] = labelling.seconds.cut;
  run["search"] = labelling.seconds.search;
  run["tables"] = labelling.seconds.costs;
  run["solver"] = labelling.seconds.minimize;
  run["cpu"] = process_seconds();
  run["peak_mb"] = memory_now()["peak"].get<double>() / 1e6;
  run["gap"] = labelling.assignment.gap();
  return run;
}

json run_apart(const LabellingCase& asked) {
  const fs::path answer = fs::temp_directory_path() / fmt::format("labelling_{}.json", getpid());
  std::vector<std::string> arguments{"bench_labelling",
                                     kAlone,
                                     asked.store.string(),
                                     asked.picture,
                                     std::to_string(asked.size.width),
                                     std::to_string(asked.size.height),
                                     answer.string(),
                                     fmt::format("{:.9f}", wall_seconds())};
  run_subprocess(std::move(arguments), asked.picture, "labelling in a process of its own failed");
  json run = json::parse(std::ifstream(answer));
  fs::remove(answer);
  return run;
}

}  // namespace

PictureArgument picture_of(const LabellingCase& asked) {
  PictureArgument read = read_picture_argument(asked.picture);
  if (asked.size.empty()) return read;
  cv::resize(read.picture.clone(), read.picture, asked.size, 0, 0, cv::INTER_AREA);
  cv::resize(read.matte.clone(), read.matte, asked.size, 0, 0, cv::INTER_AREA);
  return read;
}

json median_labelling(const LabellingCase& asked, int runs, Pages pages) {
  std::map<std::string, std::vector<double>> values;
  double cached = 0;
  for (int i = 0; i < runs; ++i) {
    if (pages == Pages::kDropped) {
      drop_from_cache(asked.store);
      drop_from_cache(asked.picture.substr(0, asked.picture.rfind(':')));
    }
    cached = std::max(cached, cached_fraction(asked.store));
    const json run = run_apart(asked);
    for (const auto& [name, value] : run.items()) values[name].push_back(value.get<double>());
  }
  json medians{{"runs", runs}, {"cached", cached}};
  for (auto& [name, of_runs] : values) {
    std::sort(of_runs.begin(), of_runs.end());
    const std::size_t middle = of_runs.size() / 2;
    medians[name] = of_runs.size() % 2 == 1 ? of_runs[middle] : (of_runs[middle - 1] + of_runs[middle]) / 2;
  }
  medians["most_total"] = values.at("total").back();
  return medians;
}

bool label_as_asked(int argc, char** argv) {
  if (argc != 8 || argv[1] != std::string(kAlone)) return false;
  const LabellingCase asked{argv[2], argv[3], {std::stoi(argv[4]), std::stoi(argv[5])}};
  std::ofstream(argv[6]) << label_alone(asked, std::stod(argv[7])).dump();
  return true;
}

}  // namespace freshet::bench
