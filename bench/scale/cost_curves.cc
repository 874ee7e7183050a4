// What does a store cost, from ten thousand patches to five million, and how do the costs grow?
//
//   bench_cost_curves SOURCE PICTURE[:MATTE].. --out DIR [--sizes 10000,..,5000000] [--stores DIR]
//                     [--ingest REPORT] [--index-up-to 1000000]
//
// For each size: a store of exactly so many patches, made by bench_scaled_store from SOURCE (or found in
// --stores, made earlier with the same seed); its bytes by part; the time from a new process to the
// candidates of one picture, with the file dropped from the system's cache and without; exact search piece by
// piece on one thread, and 500 pieces on all; memory; labelling 640 x 480 px; reading all of it (store
// verify). Each in a process of its own. REPORT is what `freshet ingest --json` printed of real footage: sums
// over subsets of its clips are the curve of ingest, for the making of generated stores is none.
//
// Leaves DIR/cost_curves.json (cost_curves_plain.json of a build without wide vectors), with exponents.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "bench/harness/arguments.h"
#include "bench/harness/machine.h"
#include "bench/harness/page_cache.h"
#include "bench/harness/seeded_random.h"
#include "bench/harness/subprocess.h"
#include "bench/scale/cost_fits.h"
#include "bench/scale/cost_measure.h"
#include "bench/scale/scaled_store.h"
#include "freshet/error.h"
#include "platform/whole_file.h"

namespace {

using namespace freshet;
using nlohmann::json;
namespace fs = std::filesystem;

#ifdef FRESHET_WIDE_VECTORS
constexpr const char* kVectors = "wide";
#else
constexpr const char* kVectors = "plain";
#endif
constexpr int kOrders = 25;  // of real clips

struct Command {
  std::string source, out, stores, ingest;
  std::vector<std::string> pictures;
  std::vector<std::uint64_t> sizes{10'000,  30'000,    100'000,   246'477,
                                   500'000, 1'000'000, 2'000'000, 5'000'000};
  std::uint64_t seed = 1, index_up_to = 1'000'000;
  bool keep = false;
};

json read_json(const fs::path& path) {
  json value = json::parse(std::ifstream(path), nullptr, false);
  if (value.is_discarded()) throw Error(ErrorKind::kInput, path.string(), "is not JSON");
  return value;
}

/// One measurement in a new process of this program.
json measured_apart(const std::string& what, const fs::path& store, const Command& command) {
  const fs::path answer = store.string() + ".measured";
  std::vector<std::string> arguments{"bench_cost_curves", "--measure", what, store.string(), answer.string()};
  arguments.insert(arguments.end(), command.pictures.begin(), command.pictures.end());
  bench::run_subprocess(std::move(arguments), store.string(), "the measurement \"" + what + "\" failed");
  json result = read_json(answer);
  fs::remove(answer);
  return result;
}

/// The store of a size, and how long it took to make; one that is there already is taken as it is.
fs::path made_store(const store::Snapshot& source, const Command& command, std::uint64_t patches,
                    json& size) {
  const fs::path path = fs::path(command.stores) / fmt::format("scaled_{}_{}.store", patches, command.seed);
  const fs::path beside = path.string() + ".json";
  if (!fs::exists(beside)) {
    fs::remove(path);  // unfinished
    const bench::ScaleReport report =
        bench::write_scaled_store(source, path, {.patches = patches, .seed = command.seed});
    write_whole_file(beside, json{{"generate_s", report.seconds}, {"clips", report.clips}}.dump());
  }
  size.update(read_json(beside));
  return path;
}

json measured_size(const store::Snapshot& source, const Command& command, std::uint64_t patches) {
  json size{{"patches", patches}};
  const fs::path path = made_store(source, command, patches, size);
  bench::drop_from_cache(path);
  size["cached_before_cold"] = bench::cached_fraction(path);
  size["cold"] = measured_apart("open", path, command);
  measured_apart("open", path, command);
  size["warm"] = measured_apart("open", path, command);
  size["search"] = measured_apart("search", path, command);
  size["label"] = measured_apart("label", path, command);
  size["keep"] = measured_apart("keep", path, command);
  size["bytes"] = size["keep"]["bytes"];
  if (size["keep"]["patches"] != patches) {
    throw Error(ErrorKind::kInput, path.string(),
                fmt::format("holds {} patches", size["keep"]["patches"].get<std::uint64_t>()),
                "Remove it, so that it is made again");
  }
  if (patches <= command.index_up_to) {
    const fs::path copy = path.string() + ".index";
    fs::copy_file(path, copy, fs::copy_options::overwrite_existing);
    size["index"] = measured_apart("index", copy, command);
    fs::remove(copy);
    fs::remove(copy.string() + "-lock");
  }
  if (!command.keep) {
    for (const char* ending : {"", "-lock", ".json"}) fs::remove(path.string() + ending);
  }
  return size;
}

/// Sums over subsets of the clips that a run of ingest added: means over drawn orders.
json ingest_sums(const json& report) {
  std::vector<json> clips;
  for (const json& clip : report.at("clips")) {
    if (clip.at("outcome") == "added" && clip.at("patches") > 0) clips.push_back(clip);
  }
  double whole = 0;
  for (const json& clip : clips) whole += clip.at("patches").get<double>();
  json sums = json::array();
  for (const double asked : {10e3, 20e3, 50e3, 100e3, 200e3, whole}) {
    if (asked > whole) continue;
    double patches = 0, seconds = 0, bytes = 0, count = 0;
    for (std::uint64_t order = 0; order < kOrders; ++order) {
      bench::SeededRandom random(order);
      for (std::size_t i = clips.size(); i > 1; --i) std::swap(clips[i - 1], clips[random.below(i)]);
      double taken = 0;
      for (std::size_t i = 0; i < clips.size() && taken < asked; ++i) {
        taken += clips[i].at("patches").get<double>();
        seconds += clips[i].at("seconds").at("total").get<double>() / kOrders;
        bytes += clips[i].at("stored_bytes").get<double>() / kOrders;
        count += 1.0 / kOrders;
      }
      patches += taken / kOrders;
    }
    sums.push_back({{"patches", patches}, {"seconds", seconds}, {"bytes", bytes}, {"clips", count}});
  }
  return sums;
}

void print_size(const json& size) {
  fmt::print("{:>9}{:>7}{:>9.1f}{:>9.2f}{:>9.2f}{:>9.3f}{:>9.3f}{:>9.3f}{:>9.0f}{:>9.2f}{:>9.2f}\n",
             size["patches"].get<std::uint64_t>(), size["clips"].get<int>(),
             size["bytes"]["file"].get<double>() / 1e6, size["cold"]["seconds"]["total"].get<double>(),
             size["warm"]["seconds"]["total"].get<double>(), size["search"]["median_ms"].get<double>(),
             size["search"]["p99_ms"].get<double>(), size["search"]["batch_s"].get<double>(),
             size["search"]["memory"]["peak"].get<double>() / 1e6,
             size["label"]["seconds"]["total"].get<double>(), size["keep"]["verify_s"].get<double>());
  std::fflush(stdout);
}

int measure_child(int argc, char** argv) {
  if (argc < 6) throw Error(ErrorKind::kUsage, "--measure", "WHAT STORE ANSWER PICTURE.. expected");
  const std::vector<std::string> pictures(argv + 5, argv + argc);
  write_whole_file(argv[4], bench::measure(argv[3], bench::parse_measurement(argv[2]), pictures).dump());
  return 0;
}

int run(int argc, char** argv) {
  bench::Arguments app("Costs of stores against their number of patches");
  Command command;
  app.option("SOURCE", command.source, "A store of real clips, with its index").required();
  app.option("PICTURE", command.pictures, "PICTURE[:MATTE]; the first is opened and labelled").required();
  app.option("--out", command.out, "Folder of the JSON").required();
  app.option("--sizes", command.sizes, "Patches of each store").split_at(',');
  app.option("--stores", command.stores, "Folder of the stores [that of --out]");
  app.flag("--keep", command.keep, "Leave the stores where they are, for another run");
  app.option("--ingest", command.ingest, "What `freshet ingest --json` printed");
  app.option("--index-up-to", command.index_up_to, "Patches up to which `freshet index` is timed");
  app.option("--seed", command.seed, "Of the stores");
  app.parse(argc, argv);
  if (command.stores.empty()) command.stores = command.out;
  fs::create_directories(command.out);
  fs::create_directories(command.stores);

  const store::Store store = store::Store::open_read(command.source);
  const store::Snapshot source = store.snapshot();
  std::uint64_t patches = 0;
  for (const store::ClipId clip : source.clips()) patches += source.clip(clip).rows;
  json result{{"machine", bench::to_json(bench::this_machine())},
              {"vectors", kVectors},
              {"source", {{"clips", source.clips().size()}, {"patches", patches}}},
              {"seed", command.seed},
              {"sizes", json::array()}};
  if (!command.ingest.empty()) result["ingest"] = ingest_sums(read_json(command.ingest));
  const fs::path json_file =
      fs::path(command.out) /
      (std::string(kVectors) == "plain" ? "cost_curves_plain.json" : "cost_curves.json");

  fmt::print("{}, {} vectors\n", bench::to_string(bench::this_machine()), kVectors);
  fmt::print("{:>9}{:>7}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n", "patches", "clips", "MB", "cold s",
             "warm s", "ms piece", "p99", "500 s", "peak MB", "label s", "verify s");
  std::sort(command.sizes.begin(), command.sizes.end());
  for (const std::uint64_t size : command.sizes) {
    result["sizes"].push_back(measured_size(source, command, size));
    print_size(result["sizes"].back());
    result["fits"] = bench::cost_fits(result);
    write_whole_file(json_file, result.dump(2) + "\n");  // after each: the next one may take an hour
  }

  fmt::print("\n{:<10}{:<26}{:<12}{:>9}{:>8}{:>10}\n", "", "", "", "exponent", "error", ">= 200 k");
  for (const json& fit : result["fits"]) {
    fmt::print(
        "{:<10}{:<26}{:<12}{:>9.2f}{:>8.2f}{:>10}\n", fit["group"].get<std::string>(),
        fit["name"].get<std::string>(), fit["unit"].get<std::string>(), fit["exponent"].get<double>(),
        fit["error"].get<double>(),
        fit.contains("large_exponent") ? fmt::format("{:.2f}", fit["large_exponent"].get<double>()) : "");
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);  // as the program does
  try {
    return argc > 1 && std::string(argv[1]) == "--measure" ? measure_child(argc, argv) : run(argc, argv);
  } catch (const Error& error) {
    fmt::print(stderr, "bench_cost_curves: {}\n", error.what());
    return 1;
  }
}
