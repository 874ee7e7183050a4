#include "query/mrf/trw_s.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "query/mrf/min_sum.h"

namespace freshet::query {
namespace {

constexpr int kPatience = 5;  // iterations over which the gap must shrink

float subtract_minimum(std::span<float> values) {
  const float minimum = *std::min_element(values.begin(), values.end());
  for (float& value : values) value -= minimum;
  return minimum;
}

// Nodes in their order or against it, each after the neighbours that come before it.
class NodeOrder {
 public:
  NodeOrder(const Mrf& mrf, const Adjacency& adjacency)
      : mrf_(mrf), adjacency_(adjacency), done_(mrf.nodes()) {
    // A run: nodes that follow each other along edges, as those of a lattice's row do.
    for (std::uint32_t node = 0; node < mrf.nodes(); ++node) {
      const auto earlier = adjacency.to_earlier(node);
      const bool follows = std::any_of(earlier.begin(), earlier.end(),
                                       [&](std::uint32_t e) { return mrf.edges[e].p + 1 == node; });
      if (!follows) first_.push_back(node);
    }
    first_.push_back(static_cast<std::uint32_t>(mrf.nodes()));
  }

  std::size_t runs() const { return first_.size() - 1; }

  /// visit(worker, node) for every node; worker < workers.
  template <class Visit>
  void each(std::size_t workers, bool backward, Visit&& visit) {
    ++pass_;
    std::atomic<std::size_t> next = 0;
    // Runs are taken up in order, and a run waits only for runs before it. So the first of those in hand
    // waits for nothing, even when fewer workers run than were asked for.
    const auto work = [&](std::size_t worker) {
      for (std::size_t run; (run = next.fetch_add(1, std::memory_order_relaxed)) < runs();) {
        const std::size_t place = backward ? runs() - 1 - run : run;
        const std::uint32_t first = first_[place], count = first_[place + 1] - first;
        for (std::uint32_t i = 0; i < count; ++i) {
          const std::uint32_t node = backward ? first + count - 1 - i : first + i;
          if (workers > 1) wait_for(node, backward);
          visit(worker, node);
          done_[node].store(pass_, std::memory_order_release);
        }
      }
    };
    if (workers < 2) return work(0);
    // Isolated: a thread that is done takes up no other labelling of a sweep.
    oneapi::tbb::this_task_arena::isolate(
        [&] { oneapi::tbb::parallel_for(std::size_t{0}, workers, work, oneapi::tbb::static_partitioner()); });
  }

 private:
  void wait_for(std::uint32_t node, bool backward) const {
    for (const std::uint32_t e : backward ? adjacency_.to_later(node) : adjacency_.to_earlier(node)) {
      const std::uint32_t other = backward ? mrf_.edges[e].q : mrf_.edges[e].p;
      for (int spins = 0; done_[other].load(std::memory_order_acquire) != pass_; ++spins)
        if (spins >= kMaxSpins) std::this_thread::yield();
    }
  }

  static constexpr int kMaxSpins = 1000;  // some microseconds: a node's work
  const Mrf& mrf_;
  const Adjacency& adjacency_;
  std::vector<std::uint32_t> first_;              // of each run, and the end
  std::vector<std::atomic<std::uint32_t>> done_;  // the last pass in which a node was visited
  std::uint32_t pass_ = 0;
};

class Passes {
 public:
  explicit Passes(const Mrf& mrf)
      : mrf_(mrf),
        adjacency_(mrf),
        order_(mrf, adjacency_),
        message_of_(mrf.edges.size()),
        weight_(mrf.nodes()),
        minimum_(mrf.nodes()) {
    std::size_t length = 0, max_labels = 1;
    for (std::size_t e = 0; e < mrf.edges.size(); ++e) {
      message_of_[e] = length;
      length += std::max(mrf.label_count[mrf.edges[e].p], mrf.label_count[mrf.edges[e].q]);
    }
    for (std::size_t node = 0; node < mrf.nodes(); ++node) {
      max_labels = std::max<std::size_t>(max_labels, mrf.label_count[node]);
      const std::size_t chains =
          std::max(adjacency_.to_earlier(node).size(), adjacency_.to_later(node).size());
      weight_[node] = chains == 0 ? 1.0f : 1.0f / static_cast<float>(chains);
    }
    messages_.resize(length);
    // Passes over tables of less than a megabyte are over before another thread has woken.
    constexpr std::size_t kMinPairsPerThread = std::size_t{1} << 18;
    const auto threads = static_cast<std::size_t>(oneapi::tbb::this_task_arena::max_concurrency());
    workers_.resize(std::max<std::size_t>(
        1, std::min({threads, order_.runs() / 2, mrf.pairwise.size() / kMinPairsPerThread})));
    for (Worker& worker : workers_) {
      worker.belief.resize(max_labels);
      worker.outgoing.resize(max_labels);
    }
  }

  void forward() {
    order_.each(workers_.size(), false, [&](std::size_t number, std::uint32_t node) {
      Worker& worker = workers_[number];
      const auto belief = gather(node, worker);
      for (const std::uint32_t e : adjacency_.to_later(node)) {
        const Mrf::Edge& edge = mrf_.edges[e];
        prepare(node, belief, e, worker);
        const std::span<float> message(messages_.data() + message_of_[e], mrf_.label_count[edge.q]);
        min_over_rows(mrf_.table(edge), belief.size(), message.size(), worker.outgoing.data(),
                      message.data());
        subtract_minimum(message);
      }
    });
  }

  /// Returns the lower bound.
  double backward() {
    order_.each(workers_.size(), true, [&](std::size_t number, std::uint32_t node) {
      Worker& worker = workers_[number];
      const auto belief = gather(node, worker);
      double minimum = subtract_minimum(belief);
      for (const std::uint32_t e : adjacency_.to_earlier(node)) {
        const Mrf::Edge& edge = mrf_.edges[e];
        prepare(node, belief, e, worker);
        const std::span<float> message(messages_.data() + message_of_[e], mrf_.label_count[edge.p]);
        min_over_columns(mrf_.table(edge), message.size(), belief.size(), worker.outgoing.data(),
                         message.data());
        minimum += subtract_minimum(message);
      }
      minimum_[node] = minimum;
    });
    double bound = 0;
    for (const double minimum : minimum_) bound += minimum;
    return bound;
  }

  /// After a backward pass: earlier neighbours speak by their labels, later ones by their messages.
  void read_labels(Labels& labels) {
    for (std::size_t node = 0; node < mrf_.nodes(); ++node) {
      const std::span<float> cost(workers_[0].belief.data(), mrf_.label_count[node]);
      const auto unary = mrf_.unary_of(node);
      std::copy(unary.begin(), unary.end(), cost.begin());
      for (const std::uint32_t e : adjacency_.to_earlier(node)) {
        const Mrf::Edge& edge = mrf_.edges[e];
        const PairCost* row = mrf_.table(edge) + std::size_t{labels[edge.p]} * cost.size();
        for (std::size_t l = 0; l < cost.size(); ++l) cost[l] += row[l];
      }
      for (const std::uint32_t e : adjacency_.to_later(node)) add_message(e, cost);
      labels[node] = static_cast<std::uint32_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
    }
  }

 private:
  // A thread's place for a node.
  struct Worker {
    std::vector<float> belief, outgoing;
  };

  void add_message(std::uint32_t e, std::span<float> to) const {
    const float* message = messages_.data() + message_of_[e];
    for (std::size_t l = 0; l < to.size(); ++l) to[l] += message[l];
  }

  std::span<float> gather(std::size_t node, Worker& worker) const {
    const std::span<float> belief(worker.belief.data(), mrf_.label_count[node]);
    const auto unary = mrf_.unary_of(node);
    std::copy(unary.begin(), unary.end(), belief.begin());
    for (const std::uint32_t e : adjacency_.to_earlier(node)) add_message(e, belief);
    for (const std::uint32_t e : adjacency_.to_later(node)) add_message(e, belief);
    return belief;
  }

  // What the node says along edge e: its fraction of its belief, less what the other end told it.
  void prepare(std::size_t node, std::span<const float> belief, std::uint32_t e, Worker& worker) const {
    const float* message = messages_.data() + message_of_[e];
    for (std::size_t l = 0; l < belief.size(); ++l)
      worker.outgoing[l] = weight_[node] * belief[l] - message[l];
  }

  const Mrf& mrf_;
  Adjacency adjacency_;
  NodeOrder order_;
  std::vector<std::size_t> message_of_;
  std::vector<float> weight_;
  std::vector<float> messages_;
  std::vector<double> minimum_;  // of a node: what it adds to the bound
  std::vector<Worker> workers_;
};

}  // namespace

Solution trw_s(const Mrf& mrf, const TrwsOptions& options) {
  Solution best;
  best.labels = unary_minimum(mrf);
  best.energy = energy(mrf, best.labels);
  if (mrf.edges.empty()) {
    best.lower_bound = best.energy;
    return best;
  }
  Passes passes(mrf);
  Labels labels(mrf.nodes());
  std::vector<double> gaps;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    passes.forward();
    best.lower_bound = std::max(best.lower_bound, passes.backward());
    passes.read_labels(labels);
    if (const double found = energy(mrf, labels); found < best.energy) {
      best.energy = found;
      best.labels = labels;
    }
    best.iterations = iteration + 1;
    gaps.push_back((best.energy - best.lower_bound) / std::max(std::abs(best.lower_bound), 1e-30));
    if (gaps.back() <= options.gap) break;
    if (iteration >= kPatience && gaps[iteration - kPatience] - gaps.back() < options.min_gap_decrease) break;
  }
  // The bound's own rounding must not let it pass an energy that a labelling reaches.
  best.lower_bound = std::min(best.lower_bound, best.energy);
  return best;
}

}  // namespace freshet::query
