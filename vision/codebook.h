// vision/codebook.h — visual words: clusters of SIFT descriptors by repeated bisection.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vision/dense_sift.h"

namespace freshet::vision {

/// The number of a visual word, below kMaxWords.
using Word = std::uint16_t;
inline constexpr int kMaxWords = 1024;  // of a codebook

struct CodebookOptions {
  int words = 200;      // at most kMaxWords; Okabe et al. 2011 tried 100, 200, 300, 500 and kept 200
  int iterations = 10;  // of 2-means inside a bisection
  std::uint64_t seed = 1;
};

/// Centres of the words, words * kDescriptorSize floats.
struct Codebook {
  int words = 0;
  std::vector<float> centres;
};

/// Splits the cluster of largest total squared error in two, until there are `words` of them; then a few
/// rounds of k-means over all. Fewer distinct descriptors than words give fewer words. Deterministic for a
/// given order of samples. Products through Eigen, vectors centred first.
/// Source   Zhao, Karypis, Fayyad 2005 (as cited by Okabe et al. 2011, Sec. 4).
Codebook train_codebook(std::span<const Descriptor> samples, const CodebookOptions& options = {});

/// Nearest word (smallest index on ties) of each descriptor. All threads; same for any number.
void assign_words(const Codebook& codebook, std::span<const Descriptor> descriptors, std::span<Word> words);

}  // namespace freshet::vision
