// bench/harness/frame_sizes.h — the values of a bench's --sizes, read.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

namespace freshet::bench {

/// texts   "WIDTHxHEIGHT", px. Throws CLI::ValidationError for another text and for sides below 64 px.
inline std::vector<cv::Size> parse_sizes(const std::vector<std::string>& texts) {
  std::vector<cv::Size> sizes;
  for (const std::string& text : texts) {
    cv::Size size;
    if (std::sscanf(text.c_str(), "%dx%d", &size.width, &size.height) != 2 || size.width < 64 ||
        size.height < 64)
      throw CLI::ValidationError("--sizes", text + " is not WIDTHxHEIGHT of at least 64 px");
    sizes.push_back(size);
  }
  return sizes;
}

}  // namespace freshet::bench
