// platform/shard.h — which part of a list a run takes, where many machines share it.
#pragma once

#include <cstddef>

namespace freshet {

/// Every `count`-th of the list, beginning with the `index`-th (1-based): shards are disjoint, and together the list.
struct Shard {
  int index = 1, count = 1;
  bool takes(std::size_t number) const {
    return number % static_cast<std::size_t>(count) == static_cast<std::size_t>(index - 1);
  }
};

}  // namespace freshet
