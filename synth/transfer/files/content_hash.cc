#include "synth/transfer/files/content_hash.h"

#include <xxhash.h>

#include "platform/text.h"

namespace freshet::synth::transfer {

void ContentHash::add(const cv::Mat& samples) {
  const int shape[3] = {samples.cols, samples.rows, samples.type()};
  hash_ = XXH3_64bits_withSeed(shape, sizeof shape, hash_);
  for (int y = 0; y < samples.rows; ++y)
    hash_ = XXH3_64bits_withSeed(samples.ptr(y), samples.elemSize() * static_cast<std::size_t>(samples.cols),
                                 hash_);
}

std::string ContentHash::text() const { return hex(hash_); }

}  // namespace freshet::synth::transfer
