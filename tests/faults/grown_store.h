// tests/faults/grown_store.h — a store that grew run by run, and what it held after each.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tests/store/rewrite/slow_salvage.h"

namespace freshet::tools {

/// What a store holds, each by its hash.
struct Holdings {
  std::map<store::ReadableClip, std::uint64_t> clips;
  std::uint64_t codebook = 0;  // 0: none
  std::map<store::ReadableClip, std::uint64_t> words;
};

Holdings holdings_of(const std::string& file);

/// A store that grew clip by clip, with an index after each, and its file after each run.
struct Grown {
  std::vector<std::string> files;
  std::vector<Holdings> states;

  Grown();
  const std::string& last() const { return files.back(); }
};

/// Made when it is first asked for.
const Grown& grown();

}  // namespace freshet::tools
