#include "tests/synth/transfer/made_pictures.h"

#include <numeric>

#include <gtest/gtest.h>

#include "tests/synth/transfer/made_exemplar.h"

namespace freshet::synth::transfer {
namespace {

void fill(const cv::Mat& bgra, Features& features, Segments& segments) {
  const PixelGrid picture = premultiplied(bgra);
  put_now(picture, features);
  put_previous(picture, features);
  const Grid alpha = blurred(alpha_of(picture), 2);
  put_blurred_alpha(alpha, 3, features);
  segment(alpha, 0.1, 0.9, 2, segments);
}

}  // namespace

MadePictures::MadePictures(cv::Size source_size, cv::Size target_size, std::uint64_t seed)
    : source(source_size.width, source_size.height), target(target_size.width, target_size.height) {
  fill(blot(source_size, seed), source, from);
  fill(blot(target_size, seed + 100), target, to);
  lambda.assign(target.values.size() / kChannels, 0.2f);
}

void expect_uniform(const NearestField& field, const std::vector<int>& sources,
                    const std::vector<int>& targets) {
  std::vector<std::size_t> used(field.source_places(), 0);
  for (const int target : targets) {
    const std::int32_t source = field.source[static_cast<std::size_t>(target)];
    ASSERT_GE(source, 0);
    ++used[static_cast<std::size_t>(source)];
  }
  const std::size_t min_uses = targets.size() / sources.size();
  std::size_t once_more = 0;
  for (const int source : sources) {
    const std::size_t uses = used[static_cast<std::size_t>(source)];
    ASSERT_TRUE(uses == min_uses || uses == min_uses + 1) << uses;
    once_more += uses == min_uses + 1;
  }
  EXPECT_EQ(once_more, targets.size() % sources.size());
  EXPECT_EQ(std::accumulate(used.begin(), used.end(), std::size_t{0}), targets.size());  // no other source
}

}  // namespace freshet::synth::transfer
