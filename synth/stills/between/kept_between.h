// synth/stills/between/kept_between.h — flow and pictures between stills, found again from earlier runs.
#pragma once

#include <functional>
#include <vector>

#include <opencv2/core.hpp>

#include "cache/result_cache.h"
#include "synth/stills/between/flow_pair.h"
#include "synth/stills/between/flow_pins.h"

namespace freshet::synth::stills {

/// What a picture between two stills depends on. Not on orders, speeds or other regions: after an edit of
/// those it is the same.
struct BetweenKey {
  cache::Key a, b;              // content_hash of the whole stills: flow reads them beyond the box
  cv::Rect box;                 // px of the stills
  double phase = 0;             // 0..1
  int flow_side = 0;            // px
  std::vector<FlowPin> pins{};  // of the two
};

/// Hands out what an earlier run kept, and keeps what is made. What is kept is what would be made, to the
/// bit. Safe from many threads.
class KeptBetween {
 public:
  /// cache   borrowed; null: all is made, nothing kept.
  explicit KeptBetween(cache::ResultCache* cache) : cache_(cache) {}

  /// flow_between(from, to); both continuous.
  FlowPair flow(const cv::Mat& from, const cv::Mat& to) const;

  /// What `make` gives: a continuous picture of the box's size and that type.
  cv::Mat picture(const BetweenKey& key, int type, const std::function<cv::Mat()>& make) const;

 private:
  cache::ResultCache* cache_;
};

}  // namespace freshet::synth::stills
