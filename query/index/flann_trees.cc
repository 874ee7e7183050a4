#include "query/index/flann_trees.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

namespace freshet::query {
namespace {

// FLANN loads, searches and destroys by recursion. Its own trees of a million rows are some 50 deep.
constexpr std::size_t kMaxDepth = 1000;
constexpr int kMaxTrees = 1024;
constexpr int kCentreChoices = 4;  // flann_centers_init_t

// flann_datatype_t and flann_algorithm_t; another number in one of them is undefined behaviour.
constexpr std::uint32_t kBytes = 4;
std::uint32_t type_of(FlannKind kind) {
  return kind == FlannKind::kKdTree ? 1 : kind == FlannKind::kKMeans ? 2 : 5;
}

struct Fault {
  std::string text;
};

class TreeWalk {
 public:
  TreeWalk(std::span<const std::byte> bytes, std::size_t rows, std::size_t bins)
      : bytes_(bytes), rows_(rows), bins_(bins) {}

  void walk(FlannKind kind) {
    index(kind);
    switch (kind) {
      case FlannKind::kKdTree: {
        const auto trees = count(1, kMaxTrees, "trees");
        for (int t = 0; t < trees; ++t) tree([&](bool) { return kd_node(); });
        break;
      }
      case FlannKind::kKMeans:
        branches();
        skip(2 * sizeof(std::int32_t));  // iterations and memory of its making
        number("boundary of clusters");
        count(0, kCentreChoices - 1, "choice of centres");
        tree([&](bool) { return kmeans_node(); });
        break;
      case FlannKind::kHierarchical: {
        branches();
        const auto trees = count(1, kMaxTrees, "trees");
        count(0, kCentreChoices - 1, "choice of centres");
        skip(sizeof(std::int32_t));  // the largest leaf when it was built
        for (int t = 0; t < trees; ++t) tree([&](bool root) { return hierarchical_node(root); });
        break;
      }
    }
    if (!bytes_.empty()) throw Fault{"it has bytes after its trees"};
  }

 private:
  template <class T>
  T take() {
    if (bytes_.size() < sizeof(T)) throw Fault{"it ends in the midst of its trees"};
    T value;
    std::memcpy(&value, bytes_.data(), sizeof(T));
    bytes_ = bytes_.subspan(sizeof(T));
    return value;
  }
  void skip(std::size_t bytes) {
    if (bytes_.size() < bytes) throw Fault{"it ends in the midst of its trees"};
    bytes_ = bytes_.subspan(bytes);
  }
  void number(const char* what) {
    if (!std::isfinite(take<float>())) throw Fault{std::string("its ") + what + " is no number"};
  }
  int count(int least, int greatest, const char* what) {
    const auto value = take<std::int32_t>();
    if (value < least || value > greatest) throw Fault{"it has " + std::to_string(value) + " as " + what};
    return value;
  }
  void expect(std::uint64_t value, std::uint64_t expected, const char* what) {
    if (value != expected)
      throw Fault{std::string(what) + " are " + std::to_string(value) + ", expected " +
                  std::to_string(expected)};
  }

  /// What every index of FLANN begins with.
  void index(FlannKind kind) {
    skip(24 + 16);  // signature and version
    expect(take<std::uint32_t>(), kBytes, "elements of its type");
    expect(take<std::uint32_t>(), type_of(kind), "indexes of its type");
    expect(take<std::uint64_t>(), rows_, "its rows");
    expect(take<std::uint64_t>(), bins_, "its bins");
    skip(2 * sizeof(std::uint64_t));  // compression and the first block's size: there is none
    expect(take<std::uint64_t>(), rows_, "its rows");
    expect(take<std::uint64_t>(), bins_, "its bins");
    skip(sizeof(std::uint64_t));  // rows when it was built
    expect(take<std::uint8_t>(), 0, "bytes of histograms");
    skip(sizeof(std::uint64_t));  // the last number of a row
    expect(take<std::uint64_t>(), 0, "other numbers of rows");
    expect(take<std::uint8_t>(), 0, "rows that were taken out");
    expect(take<std::uint64_t>(), 0, "rows that were taken out");
  }
  void branches() { branches_ = count(2, 1 << 20, "branches"); }

  /// read_node(root) takes a node and returns how many children follow.
  template <class ReadNode>
  void tree(const ReadNode& read_node) {
    seen_.assign(rows_, false);
    seen_count_ = 0;
    std::vector<std::uint64_t> open{1};  // nodes that are still to come, by level
    while (!open.empty()) {
      if (open.back() == 0) {
        open.pop_back();
        continue;
      }
      --open.back();
      if (open.size() > kMaxDepth) throw Fault{"a tree is more than " + std::to_string(kMaxDepth) + " deep"};
      if (const std::uint64_t children = read_node(open.size() == 1)) open.push_back(children);
    }
    expect(seen_count_, rows_, "a tree's rows");
  }

  void row(std::uint64_t row) {
    if (row >= rows_ || seen_[row])
      throw Fault{"row " + std::to_string(row) + " is not there, or twice in a tree"};
    seen_[row] = true;
    ++seen_count_;
  }
  /// The rows of a leaf; their number.
  std::uint64_t leaf() {
    const auto points = take<std::uint64_t>();
    for (std::uint64_t i = 0; i < points; ++i) row(take<std::uint64_t>());
    return points;
  }
  std::uint64_t children() {
    const auto children = take<std::uint64_t>();
    if (children != 0) expect(children, static_cast<std::uint64_t>(branches_), "a node's branches");
    return children;
  }

  std::uint64_t kd_node() {
    const auto feature = take<std::int32_t>();
    const auto bound = take<float>();  // of a leaf FLANN never sets it
    const auto is_leaf = take<std::uint8_t>();
    if (is_leaf == 1) {
      row(feature < 0 ? ~std::uint64_t{0} : static_cast<std::uint64_t>(feature));
      return 0;
    }
    if (is_leaf != 0 || feature < 0 || static_cast<std::size_t>(feature) >= bins_ || !std::isfinite(bound))
      throw Fault{"a node divides by what is not there"};
    return 2;
  }

  std::uint64_t kmeans_node() {
    for (std::size_t i = 0; i < bins_; ++i) number("centre");
    number("radius");
    number("variance");
    const auto size = take<std::int32_t>();
    const std::uint64_t below = children();
    if (below == 0 && (size < 0 || leaf() != static_cast<std::uint64_t>(size)))
      throw Fault{"a leaf has not as many rows as it says"};
    return below;
  }

  std::uint64_t hierarchical_node(bool root) {
    const auto centre = take<std::uint64_t>();
    if (centre >= rows_ && !(root && centre == ~std::uint64_t{0})) throw Fault{"a centre is no row"};
    const std::uint64_t below = children();
    if (below == 0) leaf();
    return below;
  }

  std::span<const std::byte> bytes_;
  std::size_t rows_, bins_;
  int branches_ = 0;
  std::vector<bool> seen_;
  std::uint64_t seen_count_ = 0;
};

}  // namespace

std::string fault_of_flann_trees(FlannKind kind, std::span<const std::byte> bytes, std::size_t rows,
                                 std::size_t bins) {
  try {
    TreeWalk(bytes, rows, bins).walk(kind);
    return {};
  } catch (const Fault& fault) {
    return fault.text;
  }
}

}  // namespace freshet::query
