// bench/harness/frame_sizes.h — the values of a bench's --sizes, read.
#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "bench/harness/arguments.h"

namespace freshet::bench {

/// "WIDTHxHEIGHT", px, each side 64 or more.
inline std::optional<cv::Size> parse_size(const std::string& text) {
  cv::Size size;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &size.width, &size.height, &rest) != 2) return {};
  if (size.width < 64 || size.height < 64) return {};
  return size;
}

/// Adds --sizes; texts that are no size end the bench with what is wrong.
inline void add_sizes(Arguments& app, std::vector<std::string>& texts) {
  app.option("--sizes", texts, "Sizes, px").split_at(',').checked([](const std::string& text) {
    return parse_size(text) ? "" : text + " is not WIDTHxHEIGHT of at least 64 px";
  });
}

/// Of texts that add_sizes() has checked.
inline std::vector<cv::Size> parse_sizes(const std::vector<std::string>& texts) {
  std::vector<cv::Size> sizes;
  for (const std::string& text : texts) sizes.push_back(parse_size(text).value());
  return sizes;
}

}  // namespace freshet::bench
