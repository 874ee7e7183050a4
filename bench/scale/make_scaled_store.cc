// How does a store of any size behave, without the footage for it? This makes one.
//
//   bench_scaled_store SOURCE OUT --patches N [--seed S] [--json FILE]
//
// SOURCE is a store of real clips with its index; OUT a new one of exactly N patches: jittered windows of
// SOURCE's clips (bench/scale/jittered_clip.h), with their words, spectra and textureness. A store of N patches
// holds the first N of a larger one with the same seed.

#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>

#include "bench/harness/arguments.h"
#include "bench/harness/machine.h"
#include "bench/scale/scaled_store.h"
#include "freshet/error.h"

namespace {

using namespace freshet;

int run(int argc, char** argv) {
  bench::Arguments app("Makes a store of any size from jittered repetitions of a real one's clips");
  bench::ScaleOptions options;
  std::string source, out, json;
  app.option("SOURCE", source, "A store of real clips, with its index").required();
  app.option("OUT", out, "The store to make").required();
  app.option("--patches", options.patches, "Patches of the store");
  app.option("--seed", options.seed, "Of everything that is drawn");
  app.option("--json", json, "Write the report to this file");
  app.parse(argc, argv);

  const bench::Machine machine = bench::this_machine();
  const store::Store store = store::Store::open_read(source);
  std::uint64_t reported = 0;
  const bench::ScaleReport report =
      bench::write_scaled_store(store.snapshot(), out, options, [&](std::uint64_t patches) {
        if (patches / 100'000 == reported) return;
        reported = patches / 100'000;
        fmt::print(stderr, "{} patches\n", patches);
      });
  fmt::print("{}\n{} patches in {} clips, {} bytes, {:.1f} s\n", bench::to_string(machine), report.patches,
             report.clips, report.bytes, report.seconds);
  if (!json.empty()) {
    std::ofstream(json) << nlohmann::json{{"machine", bench::to_json(machine)},
                                          {"source", store.path().filename().string()},
                                          {"patches", report.patches},
                                          {"seed", options.seed},
                                          {"clips", report.clips},
                                          {"bytes", report.bytes},
                                          {"seconds", report.seconds}}
                               .dump(2)
                        << "\n";
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);  // as the program does: frames and clips are what threads share
  try {
    return run(argc, argv);
  } catch (const Error& error) {
    fmt::print(stderr, "bench_scaled_store: {}\n", error.what());
    return 1;
  }
}
