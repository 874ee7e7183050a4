// studio/drawing/stills.h — what a person says of a moving scene from stills.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core.hpp>

namespace freshet::studio {

class Fields;

/// What a person says of an order of stills that was found.
struct StillsPath {
  std::string region;
  std::vector<std::string> names;  // of the stills' files, two or more
  bool refused = false;            // not walked at all; else in this order alone
  bool operator==(const StillsPath&) const = default;
};

/// Where something of one still lies in another, px of the upright files; (0, 0) is the first pixel's outer corner.
struct StillsPin {
  std::string from, to;  // the stills' files
  cv::Point2f at, goes;  // in the one, and in the other
  double reach = 80;     // px, 1..100000
  bool operator==(const StillsPin&) const = default;
};

/// A moving scene from some stills of it.
struct Stills {
  double seconds = 8;  // 0.4..120
  double speed = 1;    // 0.05..20
  bool loop = true;
  int split = 1;      // parts of each region, 1..8
  bool full = false;  // the stills' size, not a draft's
  std::vector<StillsPath> paths;
  std::vector<StillsPin> pins = {};
  bool operator==(const Stills&) const = default;
};

/// Checks everything, as document_from_json says.
Stills read_stills(const Fields& fields);
nlohmann::json stills_json(const Stills& stills);

}  // namespace freshet::studio
