#include "vision/codebook.h"

#include <algorithm>
#include <limits>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "freshet/error.h"

namespace freshet::vision {
namespace {

// `clusters` random centres, members at most `spread` away on each axis.
std::vector<Descriptor> blobs(int clusters, int members, int spread, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Descriptor> centres(clusters), samples;
  for (auto& centre : centres) {
    for (auto& value : centre) value = static_cast<std::uint8_t>(random() % 200);
  }
  for (int i = 0; i < clusters * members; ++i) {
    Descriptor sample = centres[i % clusters];
    for (auto& value : sample) value = static_cast<std::uint8_t>(value + random() % (spread + 1));
    samples.push_back(sample);
  }
  return samples;
}

double squared_distance(const Codebook& codebook, int word, const Descriptor& d) {
  double sum = 0;
  for (int i = 0; i < kDescriptorSize; ++i) {
    const double difference = codebook.centres[static_cast<std::size_t>(word) * kDescriptorSize + i] - d[i];
    sum += difference * difference;
  }
  return sum;
}

double total_error(const Codebook& codebook, const std::vector<Descriptor>& samples) {
  double sum = 0;
  for (const Descriptor& sample : samples) {
    double best = std::numeric_limits<double>::infinity();
    for (int w = 0; w < codebook.words; ++w) best = std::min(best, squared_distance(codebook, w, sample));
    sum += best;
  }
  return sum;
}

TEST(Codebook, AssignsTheNearestWordAsLoopsFindIt) {
  for (const int count : {64, 500}) {
    const auto samples = blobs(40, 30, 60, 1);
    const Codebook codebook = train_codebook(samples, {.words = count});
    ASSERT_EQ(codebook.words, count);
    std::vector<Word> words(samples.size());
    assign_words(codebook, samples, words);
    int different = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      int nearest = 0;
      for (int w = 1; w < codebook.words; ++w) {
        if (squared_distance(codebook, w, samples[i]) < squared_distance(codebook, nearest, samples[i]))
          nearest = w;
      }
      if (words[i] == nearest) continue;
      ++different;  // only where two words are equally near up to rounding
      EXPECT_NEAR(squared_distance(codebook, words[i], samples[i]),
                  squared_distance(codebook, nearest, samples[i]), 1);
    }
    EXPECT_LE(different, 2);
  }
}

TEST(Codebook, SmallestIndexWinsATie) {
  Codebook codebook{3, std::vector<float>(3 * kDescriptorSize, 10.0f)};
  const std::vector<Descriptor> samples(5, Descriptor{});
  std::vector<Word> words(5, 9);
  assign_words(codebook, samples, words);
  EXPECT_EQ(words, std::vector<Word>(5, 0));
}

TEST(Codebook, FindsSeparateClusters) {
  const auto samples = blobs(16, 50, 10, 2);
  const Codebook codebook = train_codebook(samples, {.words = 16});
  std::vector<Word> words(samples.size());
  assign_words(codebook, samples, words);
  std::set<int> used;
  for (int cluster = 0; cluster < 16; ++cluster) {
    for (std::size_t i = cluster; i < samples.size(); i += 16) EXPECT_EQ(words[i], words[cluster]);
    used.insert(words[cluster]);
  }
  EXPECT_EQ(used.size(), 16u);
}

TEST(Codebook, MoreWordsLeaveLessError) {
  const auto samples = blobs(50, 20, 50, 3);
  double before = std::numeric_limits<double>::infinity();
  for (const int words : {1, 4, 16, 64}) {
    const double error = total_error(train_codebook(samples, {.words = words}), samples);
    EXPECT_LT(error, before);
    before = error;
  }
}

TEST(Codebook, IsTheSameOnAnyNumberOfThreads) {
  const auto samples = blobs(30, 100, 80, 4);
  std::vector<float> centres;
  for (const std::size_t threads : {1, 2, 8}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    const Codebook codebook = train_codebook(samples, {.words = 50});
    if (centres.empty()) centres = codebook.centres;
    EXPECT_EQ(codebook.centres, centres);
  }
  EXPECT_NE(train_codebook(samples, {.words = 50, .seed = 2}).centres, centres);
}

TEST(Codebook, FewDistinctDescriptorsGiveFewWords) {
  std::vector<Descriptor> samples(1000, Descriptor{});
  EXPECT_EQ(train_codebook(samples, {.words = 200}).words, 1);
  samples[3][5] = 1;
  samples[999][7] = 255;
  const Codebook codebook = train_codebook(samples, {.words = 200});
  EXPECT_EQ(codebook.words, 3);
  EXPECT_LT(total_error(codebook, samples), 1e-3);
}

TEST(Codebook, RefusesWhatDoesNotFit) {
  std::vector<Descriptor> samples(3);
  std::vector<Word> words(2);
  EXPECT_THROW(train_codebook({}, {}), Error);
  EXPECT_THROW(train_codebook(samples, {.words = kMaxWords + 1}), Error);
  EXPECT_THROW(assign_words(train_codebook(samples, {}), samples, words), Error);
  EXPECT_THROW(assign_words(Codebook{200, std::vector<float>(5)}, samples, words), Error);
}

}  // namespace
}  // namespace freshet::vision
