#include "tests/tools/sample.h"

#include <stdexcept>

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

void must(const Outcome& outcome) {
  if (outcome.exit_code != 0) throw std::runtime_error("the sample cannot be made: " + outcome.err);
}

Sample make(const WorkFolder& folder) {
  fs::create_directories(folder / "clips/fall");
  fs::create_directories(folder / "clips/river");
  const auto simulate = [&](const char* preset, const char* seed, int frames, const std::string& out) {
    must(folder.freshet({"synth", "simulate", preset, "--size", "192x144", "--frames", std::to_string(frames),
                         "--seed", seed, "-o", out}));
  };
  simulate("waterfall", "1", kFrames, "clips/fall/1.mkv");
  simulate("waterfall", "2", kFrames, "clips/fall/2.mkv");
  simulate("river", "1", kRiverFrames, "clips/river/1.mkv");
  must(folder.freshet({"synth", "simulate", "waterfall", "--size", "192x144", "--frames", "1", "--seed", "7",
                       "-o", "still.png", "--alpha", "matte.png"}));
  must(folder.freshet({"ingest", "sample.store", "clips"}));
  return {.clips = folder / "clips",
          .store = folder / "sample.store",
          .still = folder / "still.png",
          .matte = folder / "matte.png"};
}

}  // namespace

const Sample& sample() {
  static const WorkFolder folder;
  static const Sample made = make(folder);
  return made;
}

const std::string& sample_digest() {
  static const std::string answer = digest(sample().store);
  return answer;
}

fs::path copy_of_store(const WorkFolder& folder, const std::string& name) {
  fs::copy_file(sample().store, folder / name);
  return folder / name;
}

}  // namespace freshet::tools
