// platform/likeness.h — which of some names was meant by one that is none of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "platform/text.h"

namespace freshet {

/// The name that the fewest changes (a byte put in, left out or exchanged; case counts for nothing) make of
/// `given`, the first of equals; "" where all need more than a third of its bytes.
template <class Names>
std::string likest(std::string_view given, const Names& names) {
  const std::string asked = lower_case(std::string(given));
  std::string found;
  std::size_t fewest = asked.size() / 3 + 1;
  for (const std::string& name : names) {
    const std::string other = lower_case(name);
    std::vector<std::size_t> changes(other.size() + 1);
    std::iota(changes.begin(), changes.end(), std::size_t{0});
    for (std::size_t i = 0; i < asked.size(); ++i) {
      std::size_t corner = std::exchange(changes[0], i + 1);
      for (std::size_t k = 0; k < other.size(); ++k) {
        const std::size_t exchanged = corner + (asked[i] != other[k]);
        corner = changes[k + 1];
        changes[k + 1] = std::min({exchanged, corner + 1, changes[k] + 1});
      }
    }
    if (changes.back() >= fewest) continue;
    fewest = changes.back();
    found = name;
  }
  return found;
}

/// What a remedy begins with: "Did you mean NAME? ", or nothing.
template <class Names>
std::string did_you_mean(std::string_view given, const Names& names) {
  const std::string name = likest(given, names);
  return name.empty() ? "" : "Did you mean \"" + name + "\"? ";
}

}  // namespace freshet
