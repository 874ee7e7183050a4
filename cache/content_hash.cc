#include "cache/content_hash.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace freshet::cache {

void add_content(KeyHash& hash, const cv::Mat& samples) {
  hash.add(std::int32_t{samples.type()});
  hash.add(std::int32_t{samples.cols});
  hash.add(std::int32_t{samples.rows});
  for (int y = 0; y < samples.rows; ++y)
    hash.bytes(std::as_bytes(std::span(samples.ptr<std::uint8_t>(y),
                                       static_cast<std::size_t>(samples.cols) * samples.elemSize())));
}

Key content_hash(const cv::Mat& samples) {
  KeyHash hash;
  add_content(hash, samples);
  return hash.key();
}

}  // namespace freshet::cache
