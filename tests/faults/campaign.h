// tests/faults/campaign.h — the stores that campaigns disturb, what disturbs them, and what is right afterwards.
#pragma once

#include <chrono>
#include <cstddef>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/kept_loaded.h"
#include "tests/tools/work_folder.h"

namespace freshet::tools {

/// Campaigns at full length: ./test.sh --long.
bool at_full_length();

/// The cases of a campaign in turn. At full length all of them; where FRESHET_LONG_MINUTES says for how many minutes,
/// in an order that is mixed, until these are over. FRESHET_LONG_FROM: so many of the order are left out, those of an
/// earlier run. Says how many there were, at full length once a minute as well.
class Walk {
 public:
  Walk(std::string name, std::size_t cases);
  Walk(const Walk&) = delete;
  Walk& operator=(const Walk&) = delete;
  ~Walk();
  /// Whether there is another one, which is then at().
  bool next();
  std::size_t at() const { return order_[begun_ - 1]; }

 private:
  using Clock = std::chrono::steady_clock;
  std::string name_;
  std::vector<std::size_t> order_;
  std::size_t skipped_ = 0, begun_ = 0;
  Clock::time_point start_ = Clock::now(), said_ = start_, end_ = Clock::time_point::max();
};

/// attempt(case) for the cases that a Walk comes by; the rest is left out after a fatal failure.
template <class Case, class Attempt>
void walk(const std::string& name, const std::vector<Case>& cases, const Attempt& attempt) {
  for (Walk walk(name, cases.size()); !testing::Test::HasFatalFailure() && walk.next();)
    attempt(cases[walk.at()]);
}

/// attempt(round, random) where the cases are rounds, which differ by what is drawn: the same in a round by itself.
template <class Attempt>
void walk_rounds(const std::string& name, std::size_t rounds, const Attempt& attempt) {
  for (Walk walk(name, rounds); !testing::Test::HasFatalFailure() && walk.next();) {
    SCOPED_TRACE("round " + std::to_string(walk.at()));
    std::mt19937 random(static_cast<unsigned>(walk.at()));
    attempt(walk.at(), random);
  }
}

/// Three small clips, and the stores that undisturbed runs make of them.
struct Campaign {
  WorkFolder folder;
  std::string one, rest, all,
      indexed;  // digests: of the first clip, of the others, of all, and with an index

  Campaign();
  static std::vector<std::string> ingest(const std::string& store, const std::vector<std::string>& clips);
  /// A store of the campaign under a new name, or none.
  void begin_with(const std::string& store, const std::string& name) const;
  /// Empty when the store is whole and has one of these digests (an empty digest: it need not be there); else
  /// what is wrong.
  std::string judge(const std::string& store, const std::set<std::string>& digests) const;
  /// Killed when it hangs. It ends with its main (WorkFolder::freshet): how processes end is tried by the campaigns of
  /// kills, of failing calls and of circumstances.
  Outcome run(const std::vector<std::string>& arguments) const;
  /// Stopped by SIGINT after so many seconds, or `rest_ms` after it has said `until`; killed by SIGALRM 20 s later.
  struct Stopped {
    double seconds = 0;
    std::string until = {};  // in what it writes to stdout; empty: nothing
    int rest_ms = 0;
    std::vector<std::string> environment = {};
  };
  Outcome run_for(const Stopped& stopped, const std::vector<std::string>& arguments) const;
  /// With tests/faults/failing_calls.cc before it, whose variables the environment has.
  Outcome run_failing(const std::vector<std::string>& arguments,
                      const std::vector<std::string>& environment) const;
  std::size_t clips_in(const std::string& store) const;

 private:
  KeptLoaded failing_;

  void must(const std::vector<std::string>& arguments) const;
};

/// Made when it is first asked for.
const Campaign& campaign();

/// A command that changes or makes f.store.
struct Job {
  std::string name;
  std::string begins_with;  // a store of the campaign
  std::vector<std::string> arguments;
  std::string before, after;  // digests of f.store; empty: it is not there
  bool in_steps = false;      // states between are possible: a clip of several may have been committed
  bool once = false;          // done again, it is refused
};

/// What writes a store anew: it is done, or nothing has happened.
std::vector<Job> rewrites();
/// These, and ingest and index.
std::vector<Job> jobs();

/// What is wrong with the answer to a file, however broken; empty when nothing is.
std::string judge_file(const Outcome& outcome);
inline constexpr long kMaxFileKib = 1 << 20;  // of memory, for small files

/// What is wrong when the job is run again, undisturbed; empty when it ends as it should.
std::string judge_again(const Campaign& c, const Job& job);

}  // namespace freshet::tools
