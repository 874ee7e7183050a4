// synth/transfer/files/content_hash.h — one number for pictures and fields, to know them again.
#pragma once

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>

namespace freshet::synth::transfer {

/// Of what was read, not of the files: a mask saved again with another compression is the same mask.
class ContentHash {
 public:
  /// Size, type and samples; their order counts.
  void add(const cv::Mat& samples);
  std::string text() const;  // 16 hexadecimal digits

 private:
  std::uint64_t hash_ = 0;
};

}  // namespace freshet::synth::transfer
