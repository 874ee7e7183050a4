// cache/content_hash.h — the hash by which the samples of pictures and fields are known again.
#pragma once

#include <opencv2/core.hpp>

#include "cache/result_cache.h"

namespace freshet::cache {

/// Adds type, size and samples. Of what was read, not of its file: a mask saved again with another compression is the
/// same mask.
void add_content(KeyHash& hash, const cv::Mat& samples);

/// Of one picture alone.
Key content_hash(const cv::Mat& samples);

}  // namespace freshet::cache
