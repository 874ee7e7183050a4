#include "tests/faults/campaign.h"

#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <stdexcept>
#include <thread>

namespace freshet::tools {

namespace fs = std::filesystem;

bool at_full_length() { return std::getenv("FRESHET_LONG") != nullptr; }

Walk::Walk(std::string name, std::size_t cases) : name_(std::move(name)), order_(cases) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (!at_full_length()) return;
  if (const char* const from = std::getenv("FRESHET_LONG_FROM"); from != nullptr)
    begun_ = skipped_ = std::min(cases, static_cast<std::size_t>(std::stoul(from)));
  const char* const minutes = std::getenv("FRESHET_LONG_MINUTES");
  if (minutes == nullptr) return;
  end_ = start_ + std::chrono::seconds(60 * std::stol(minutes));
  std::shuffle(order_.begin(), order_.end(), std::mt19937(31));
}

bool Walk::next() {
  const Clock::time_point now = Clock::now();
  if (begun_ == order_.size() || now >= end_) return false;
  if (at_full_length() && now - said_ > std::chrono::minutes(1)) {
    std::cerr << name_ << ": " << begun_ << " of " << order_.size() << "\n";
    said_ = now;
  }
  ++begun_;
  return true;
}

Walk::~Walk() {
  const auto took = std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - start_);
  std::cout << name_ << ": " << begun_ - skipped_ << " of " << order_.size() << " cases, " << took.count()
            << " s\n";
}

Campaign::Campaign() : failing_(FRESHET_FAILING_CALLS) {
  for (int i = 1; i <= 3; ++i) {
    const std::string number = std::to_string(i);
    must({"synth", "simulate", "river", "--size", "96x96", "--frames", "16", "--seed", number, "-o",
          "clip" + number + ".mkv"});
  }
  must(ingest("one.store", {"clip1.mkv"}));
  fs::copy_file(folder / "one.store", folder / "all.store");
  must(ingest("all.store", {"clip2.mkv", "clip3.mkv"}));
  fs::copy_file(folder / "all.store", folder / "indexed.store");
  must({"index", "indexed.store"});
  must(ingest("rest.store", {"clip2.mkv", "clip3.mkv"}));
  fs::copy_file(folder / "rest.store", folder / "loose.store");  // with free pages, and an index
  must(ingest("loose.store", {"clip1.mkv"}));
  must({"index", "loose.store"});
  one = digest(folder / "one.store");
  rest = digest(folder / "rest.store");
  all = digest(folder / "all.store");
  indexed = digest(folder / "indexed.store");
}

void Campaign::must(const std::vector<std::string>& arguments) const {
  const Outcome outcome = run(arguments);
  if (outcome.exit_code != 0)
    throw std::runtime_error("the campaign's stores cannot be made: " + outcome.err);
}

std::vector<std::string> Campaign::ingest(const std::string& store, const std::vector<std::string>& clips) {
  std::vector<std::string> arguments{"ingest", store, "--no-index", "--force"};
  arguments.insert(arguments.end(), clips.begin(), clips.end());
  return arguments;
}

void Campaign::begin_with(const std::string& store, const std::string& name) const {
  for (const char* ending : {"", "-lock", ".making", ".making-lock"}) fs::remove(folder / (name + ending));
  if (!store.empty()) fs::copy_file(folder / store, folder / name);
}

std::string Campaign::judge(const std::string& store, const std::set<std::string>& digests) const {
  if (!fs::exists(folder / store)) return digests.contains("") ? "" : "the store is gone";
  const Outcome hash = run({"store", "digest", store});  // it too reads every clip, and the account
  if (at_full_length() || hash.exit_code != 0) {
    const Outcome verify = run({"store", "verify", store});
    if (verify.exit_code != 0) return "verify: " + verify.out + verify.err;
  }
  if (hash.exit_code != 0) return "digest: " + hash.err;
  if (!digests.contains(hash.out)) return "it is another store";
  return "";
}

Outcome Campaign::run(const std::vector<std::string>& arguments) const { return folder.freshet(arguments); }

Outcome Campaign::run_for(const Stopped& stopped, const std::vector<std::string>& arguments) const {
  using namespace std::chrono;
  const int limit_s = 20 + static_cast<int>(stopped.seconds);
  const Started started = folder.start_freshet(arguments, limit_s, stopped.environment);
  const auto has_ended = [&] {
    siginfo_t ended{};
    return waitid(P_PID, static_cast<id_t>(started.process), &ended, WEXITED | WNOHANG | WNOWAIT) != 0 ||
           ended.si_pid != 0;
  };
  const auto end = steady_clock::now() + duration<double>(stopped.seconds);
  while (!has_ended()) {
    const bool has_said =
        !stopped.until.empty() && text_of(started.out).find(stopped.until) != std::string::npos;
    if (has_said) std::this_thread::sleep_for(milliseconds(stopped.rest_ms));
    if (has_said || steady_clock::now() >= end) {
      ::kill(started.process, SIGINT);
      break;
    }
    std::this_thread::sleep_for(milliseconds(5));
  }
  return WorkFolder::wait(started);
}

Outcome Campaign::run_failing(const std::vector<std::string>& arguments,
                              const std::vector<std::string>& environment) const {
  return WorkFolder::wait(folder.start(failing_, arguments, 120, environment));
}

std::size_t Campaign::clips_in(const std::string& store) const {
  const Outcome info = run({"store", "info", store, "--json"});
  if (info.exit_code != 0) return 0;
  const nlohmann::json json = nlohmann::json::parse(info.out);
  return json.contains("clips") ? json["clips"].size() : 0;
}

const Campaign& campaign() {
  static const Campaign made;
  return made;
}

std::vector<Job> rewrites() {
  const Campaign& c = campaign();
  return {{"compact", "loose.store", {"store", "compact", "f.store"}, c.indexed, c.indexed},
          {.name = "remove",
           .begins_with = "loose.store",
           .arguments = {"store", "remove", "f.store", "clip1.mkv"},
           .before = c.indexed,
           .after = c.rest,
           .once = true},
          {.name = "merge",
           .begins_with = "",
           .arguments = {"store", "merge", "one.store", "rest.store", "-o", "f.store"},
           .before = "",
           .after = c.all,
           .once = true},
          {.name = "repair",
           .begins_with = "",
           .arguments = {"store", "repair", "loose.store", "-o", "f.store"},
           .before = "",
           .after = c.indexed,
           .once = true}};
}

std::vector<Job> jobs() {
  const Campaign& c = campaign();
  std::vector<Job> all{{"ingest into a new store", "", c.ingest("f.store", {"clip1.mkv"}), "", c.one, true},
                       {"ingest into a store", "one.store", c.ingest("f.store", {"clip2.mkv", "clip3.mkv"}),
                        c.one, c.all, true},
                       {"index", "all.store", {"index", "f.store"}, c.all, c.indexed}};
  for (Job& job : rewrites()) all.push_back(std::move(job));
  return all;
}

std::string judge_again(const Campaign& c, const Job& job) {
  if (!job.once || !c.judge("f.store", {job.after}).empty()) {
    const Outcome again = c.run(job.arguments);
    if (again.exit_code != 0) return "run again: " + again.err;
  }
  if (const std::string wrong = c.judge("f.store", {job.after}); !wrong.empty()) return wrong;
  return fs::exists(c.folder / "f.store.making") ? "f.store.making was left" : "";
}

std::string judge_file(const Outcome& outcome) {
  if (outcome.exit_code == 137 || outcome.signal == SIGKILL) return "it hung, or took all memory";
  if (outcome.signal != 0 || outcome.exit_code < 0 || outcome.exit_code > 2)
    return "it died, " + std::to_string(outcome.exit_code) + ": " + outcome.err;
  if (outcome.err.find("unexpected") != std::string::npos) return outcome.err;
  if (outcome.exit_code != 0 && outcome.err.find("freshet: ") == std::string::npos) return "it says nothing";
  if (outcome.peak_kib > kMaxFileKib) return "it took " + std::to_string(outcome.peak_kib >> 10) + " MiB";
  return "";
}

}  // namespace freshet::tools
