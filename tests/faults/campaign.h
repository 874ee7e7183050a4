// tests/faults/campaign.h — the stores that campaigns disturb, what disturbs them, and what is right afterwards.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "tests/tools/work_folder.h"

namespace freshet::tools {

/// Campaigns at full length: ./test.sh --long.
bool at_full_length();

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
  /// Killed when it hangs.
  Outcome run(const std::vector<std::string>& arguments) const;
  std::size_t clips_in(const std::string& store) const;

 private:
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

/// What is wrong when the job is run again, undisturbed; empty when it ends as it should.
std::string judge_again(const Campaign& c, const Job& job);

}  // namespace freshet::tools
