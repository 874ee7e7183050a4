#include "vision/codebook.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include <oneapi/tbb/parallel_for.h>
#include <Eigen/Core>

#include "freshet/error.h"
#include "platform/random.h"

namespace freshet::vision {
namespace {

constexpr int kBlock = 256;      // descriptors of one product; fixed, so that threads change nothing
constexpr int kFinalRounds = 3;  // of k-means over all words, after the bisections
// Columns counted at run time: with 128 fixed ones g++ 12 sees a loop of Eigen's run out of bounds and warns.
using Block = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Words = Block;
using Vector = Eigen::Matrix<float, kDescriptorSize, 1>;
using Exact = Eigen::Matrix<double, kDescriptorSize, 1>;

// Sums over descriptors in whole numbers: exact, so their order does not matter and threads may share the
// work.
struct GroupMoments {
  std::int64_t count = 0;
  std::int64_t squares = 0;
  std::array<std::int64_t, kDescriptorSize> sum{};

  void add(const GroupMoments& other) {
    count += other.count;
    squares += other.squares;
    for (int d = 0; d < kDescriptorSize; ++d) sum[d] += other.sum[d];
  }
  Exact mean() const {
    Exact mean;
    for (int d = 0; d < kDescriptorSize; ++d)
      mean[d] = static_cast<double>(sum[d]) / static_cast<double>(count);
    return mean;
  }
  // Total squared distance to the mean.
  double error() const {
    if (count == 0) return 0;
    double outer = 0;
    for (const std::int64_t s : sum) outer += static_cast<double>(s) * static_cast<double>(s);
    return std::max(0.0, static_cast<double>(squares) - outer / static_cast<double>(count));
  }
};

// GroupMoments of the descriptors of one block that belong to `group`.
template <typename Member>
GroupMoments block_moments(const Descriptor* values, int count, Member is_member) {
  std::array<std::uint32_t, kDescriptorSize> sum{};  // 256 * 255 fits
  GroupMoments moments;
  for (int i = 0; i < count; ++i) {
    if (!is_member(i)) continue;
    const std::uint8_t* value = values[i].data();
    std::uint32_t squares = 0;
    for (int d = 0; d < kDescriptorSize; ++d) {
      sum[d] += value[d];
      squares += static_cast<std::uint32_t>(value[d]) * value[d];
    }
    moments.squares += squares;
    ++moments.count;
  }
  for (int d = 0; d < kDescriptorSize; ++d) moments.sum[d] = sum[d];
  return moments;
}

int blocks_of(std::size_t count) { return static_cast<int>((count + kBlock - 1) / kBlock); }
int block_size(std::size_t count, int block) {
  return static_cast<int>(std::min<std::size_t>(kBlock, count - static_cast<std::size_t>(block) * kBlock));
}

// Room for a whole block, of which the first rows are used: Eigen frees before it allocates, so that a matrix that is
// resized where there is no memory is freed twice.
Block whole_block() { return Block(kBlock, kDescriptorSize); }

void load(const Descriptor* values, int count, const Vector& centre, Block& block) {
  for (int i = 0; i < count; ++i) {
    for (int d = 0; d < kDescriptorSize; ++d) block(i, d) = static_cast<float>(values[i][d]) - centre[d];
  }
}

// The two halves of a cluster, divided by the plane between two centres.
class Bisection {
 public:
  Bisection(std::span<const Descriptor> members, const GroupMoments& whole)
      : members_(members), whole_(whole), upper_(members.size()), partial_(blocks_of(members.size())) {}

  // Divides by 2-means that starts at `start` and its mirror image about the mean. False when all fall on one
  // side.
  bool run(const Descriptor& start, int iterations) {
    const Exact mean = whole_.mean();
    Exact direction;
    for (int d = 0; d < kDescriptorSize; ++d) direction[d] = start[d] - mean[d];
    if (!divide(mean, direction)) return false;
    for (int i = 0; i < iterations; ++i) {
      const Exact a = high_.mean(), b = low_.mean();
      const GroupMoments before = high_;
      if (!divide((a + b) / 2, a - b)) return false;
      if (before.count == high_.count && before.sum == high_.sum) break;
    }
    return true;
  }

  const std::vector<std::uint8_t>& upper() const { return upper_; }
  const GroupMoments& high() const { return high_; }
  const GroupMoments& low() const { return low_; }

 private:
  bool divide(const Exact& middle, const Exact& direction) {
    const Vector centre = middle.cast<float>(), normal = direction.cast<float>();
    oneapi::tbb::parallel_for(0, blocks_of(members_.size()), [&](int b) {
      const int count = block_size(members_.size(), b);
      const std::size_t first = static_cast<std::size_t>(b) * kBlock;
      thread_local Block block = whole_block();
      thread_local Eigen::VectorXf side(kBlock);
      load(members_.data() + first, count, centre, block);
      side.head(count).noalias() = block.topRows(count) * normal;
      for (int i = 0; i < count; ++i) upper_[first + i] = side[i] > 0;
      partial_[b] =
          block_moments(members_.data() + first, count, [&](int i) { return upper_[first + i] != 0; });
    });
    high_ = {};
    for (const GroupMoments& part : partial_) high_.add(part);
    low_.count = whole_.count - high_.count;
    low_.squares = whole_.squares - high_.squares;
    for (int d = 0; d < kDescriptorSize; ++d) low_.sum[d] = whole_.sum[d] - high_.sum[d];
    return high_.count > 0 && low_.count > 0;
  }

  std::span<const Descriptor> members_;
  const GroupMoments& whole_;
  std::vector<std::uint8_t> upper_;
  std::vector<GroupMoments> partial_;
  GroupMoments high_, low_;
};

struct Cluster {
  std::size_t first = 0, count = 0;  // a range of the permuted samples
  GroupMoments moments;
  double error = 0;  // 0: cannot be divided
};

// Divides clusters[which]; its members are permuted so that each half is a range again, in their old order.
bool bisect(std::vector<Descriptor>& samples, std::vector<Cluster>& clusters, std::size_t which,
            int iterations, SplitMix64& random) {
  Cluster& cluster = clusters[which];
  const std::span<Descriptor> members(samples.data() + cluster.first, cluster.count);
  Bisection bisection(members, cluster.moments);
  bool divided = false;
  for (int attempt = 0; attempt < 8 && !divided; ++attempt) {
    divided = bisection.run(members[random.next() % members.size()], iterations);
  }
  for (std::size_t i = 0; i < members.size() && !divided; ++i) {
    // Nearly all alike: what differs from the first has the mean between them.
    if (members[i] != members[0]) divided = bisection.run(members[i], 0);
  }
  if (!divided) {
    cluster.error = 0;
    return false;
  }
  std::vector<Descriptor> ordered;
  ordered.reserve(members.size());
  for (const int side : {1, 0}) {
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (bisection.upper()[i] == side) ordered.push_back(members[i]);
    }
  }
  std::copy(ordered.begin(), ordered.end(), members.begin());
  const auto high_count = static_cast<std::size_t>(bisection.high().count);
  const Cluster low{cluster.first + high_count, cluster.count - high_count, bisection.low(),
                    bisection.low().error()};
  cluster = {cluster.first, high_count, bisection.high(), bisection.high().error()};
  clusters.push_back(low);
  return true;
}

// Words and what the products need of them, about a common centre.
struct Centred {
  Vector centre;
  Words words;
  std::vector<float> half_squares;

  Centred(const std::vector<float>& centres, int count) : words(count, kDescriptorSize), half_squares(count) {
    const Eigen::Map<const Words> given(centres.data(), count, kDescriptorSize);
    centre = given.colwise().mean().transpose();
    words = given.rowwise() - centre.transpose();
    for (int w = 0; w < count; ++w) half_squares[w] = 0.5f * words.row(w).squaredNorm();
  }
};

// |x - w|^2 / 2 less |x|^2 / 2, for a block of descriptors at once; the smallest index wins ties.
void assign_block(const Centred& centred, const Descriptor* values, int count, Word* assigned) {
  thread_local Block block = whole_block();
  thread_local Eigen::MatrixXf room(kBlock, kMaxWords);
  load(values, count, centred.centre, block);
  auto products = room.topLeftCorner(count, centred.words.rows());  // a word's column contiguous
  products.noalias() = block.topRows(count) * centred.words.transpose();
  std::array<float, kBlock> best;
  std::array<std::int32_t, kBlock> word{};
  best.fill(std::numeric_limits<float>::infinity());
  for (int w = 0; w < products.cols(); ++w) {
    const float* product = products.col(w).data();
    const float half = centred.half_squares[w];
    for (int i = 0; i < count; ++i) {
      const float distance = half - product[i];
      word[i] = distance < best[i] ? w : word[i];
      best[i] = distance < best[i] ? distance : best[i];
    }
  }
  for (int i = 0; i < count; ++i) assigned[i] = static_cast<Word>(word[i]);
}

void assign_all(const Centred& centred, std::span<const Descriptor> descriptors, std::span<Word> words) {
  oneapi::tbb::parallel_for(0, blocks_of(descriptors.size()), [&](int b) {
    const std::size_t first = static_cast<std::size_t>(b) * kBlock;
    assign_block(centred, descriptors.data() + first, block_size(descriptors.size(), b),
                 words.data() + first);
  });
}

// One round of k-means: words move to the mean of what is nearest; a word that nothing is nearest to stays.
void k_means_round(std::span<const Descriptor> samples, Codebook& codebook, std::vector<Word>& words) {
  assign_all(Centred(codebook.centres, codebook.words), samples, words);
  std::vector<std::vector<std::int64_t>> sums(codebook.words, std::vector<std::int64_t>(kDescriptorSize));
  std::vector<std::int64_t> counts(codebook.words);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ++counts[words[i]];
    std::int64_t* sum = sums[words[i]].data();
    for (int d = 0; d < kDescriptorSize; ++d) sum[d] += samples[i][d];
  }
  for (int w = 0; w < codebook.words; ++w) {
    for (int d = 0; d < kDescriptorSize && counts[w] > 0; ++d) {
      codebook.centres[static_cast<std::size_t>(w) * kDescriptorSize + d] =
          static_cast<float>(static_cast<double>(sums[w][d]) / static_cast<double>(counts[w]));
    }
  }
}

}  // namespace

Codebook train_codebook(std::span<const Descriptor> samples, const CodebookOptions& options) {
  if (options.words < 1 || options.words > kMaxWords || options.iterations < 0) {
    throw Error(ErrorKind::kUsage, "codebook",
                std::to_string(options.words) + " words; 1 to " + std::to_string(kMaxWords) + " expected");
  }
  if (samples.empty()) throw Error(ErrorKind::kInput, "codebook", "no descriptors to learn words from");

  std::vector<Descriptor> ordered(samples.begin(), samples.end());
  Cluster all{0, ordered.size(), {}, 0};
  for (int b = 0; b < blocks_of(ordered.size()); ++b) {
    all.moments.add(block_moments(ordered.data() + static_cast<std::size_t>(b) * kBlock,
                                  block_size(ordered.size(), b), [](int) { return true; }));
  }
  all.error = all.moments.error();
  std::vector<Cluster> clusters{all};
  SplitMix64 random(options.seed);
  while (static_cast<int>(clusters.size()) < options.words) {
    const auto worst = std::max_element(clusters.begin(), clusters.end(),
                                        [](const Cluster& a, const Cluster& b) { return a.error < b.error; });
    // Rounding leaves some error in a cluster of equal descriptors; the bisection itself finds those.
    if (worst->error <= 0) break;
    bisect(ordered, clusters, static_cast<std::size_t>(worst - clusters.begin()), options.iterations, random);
  }

  Codebook codebook{static_cast<int>(clusters.size()), {}};
  for (const Cluster& cluster : clusters) {
    const Exact mean = cluster.moments.mean();
    for (int d = 0; d < kDescriptorSize; ++d) codebook.centres.push_back(static_cast<float>(mean[d]));
  }
  std::vector<Word> words(samples.size());
  for (int round = 0; round < kFinalRounds; ++round) k_means_round(samples, codebook, words);
  return codebook;
}

void assign_words(const Codebook& codebook, std::span<const Descriptor> descriptors, std::span<Word> words) {
  if (codebook.words < 1 || codebook.words > kMaxWords ||
      codebook.centres.size() != static_cast<std::size_t>(codebook.words) * kDescriptorSize) {
    throw Error(ErrorKind::kDamaged, "codebook",
                std::to_string(codebook.words) + " words and " + std::to_string(codebook.centres.size()) +
                    " values do not agree");
  }
  if (words.size() != descriptors.size()) {
    throw Error(ErrorKind::kUsage, "codebook", "room for as many words as descriptors expected");
  }
  assign_all(Centred(codebook.centres, codebook.words), descriptors, words);
}

}  // namespace freshet::vision
