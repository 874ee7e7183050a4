// synth/transfer/uniform_field.h — every source patch used K or K + 1 times, and made better by exchanges.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "synth/transfer/features.h"
#include "synth/transfer/retrieval.h"

namespace freshet::synth::transfer {

/// A field that keeps Eq. 5 at every moment, and comes nearer to the smallest sum of distances.
///
/// The reversed search of Sec. 4.1 looks for all pairs anew in each retrieval, some seventy distances a target.
/// Here what is known stays, targets exchange their sources where both together are nearer then, and a
/// place whose neighbours go on in the exemplar costs nothing: some six distances a target and pass.
class UniformField {
 public:
  /// Keeps of field what Eq. 5 allows, the nearest first. Other targets get sources that are free, near those of
  /// their neighbours.
  ///
  /// sources, targets  places, in the order of Segments; sources is not empty.
  /// field             as assign_uniformly says; its targets have sources and distances afterwards. Outlives this,
  ///                   as the others do.
  UniformField(const PatchDistance& distance, const std::vector<int>& sources,
               const std::vector<int>& targets, std::uint64_t seed, NearestField& field);

  /// Each target tries where its neighbours' sources go on, a few places near its own and one anywhere. All look
  /// at the field as it is before the pass, and exchange in the order of targets: threads change nothing.
  /// Source   propagation and search of Barnes et al. 2009; exchanges of two as in local search for assignments.
  /// hints    empty, or by target place one more source to try; -1: none.
  void exchange(int pass, std::span<const std::int32_t> hints = {});

 private:
  static constexpr std::size_t kTries = 12;
  using Tries = std::array<std::int32_t, kTries>;  // sources; -1 after the last
  struct Draw {
    std::uint64_t bits;
    std::int32_t anywhere;  // a source
  };
  struct Trade {
    std::int32_t source = -1, partner = -1;  // -1: no source; no partner: the source has a use to spare
    float distance = 0, partners = 0;        // of the target, and of the partner with the target's source
  };

  /// What a source has for a target that would like it: itself, or an exchange with one of its users.
  struct Offer {
    std::int32_t uses = -1, user = -1;  // -1: no source; used by nobody
    float distance = 0;                 // of the user, the farthest of the first few
  };

  void keep_what_is_uniform();
  void fill();
  Tries tries(std::int32_t target, std::int32_t hint, Draw draw, int pass) const;
  Trade best_trade(std::int32_t target, const Tries& tries) const;
  void find_trades(std::size_t from, std::size_t to, int pass, std::span<const std::int32_t> hints);
  std::int32_t beside(std::int32_t target, int dx, int dy) const;
  void list_offers();
  void give(std::int32_t source, std::int32_t target);
  void take(std::int32_t source, std::int32_t target);

  const PatchDistance& distance_;
  const std::vector<int>&sources_, &targets_;
  std::uint64_t seed_;
  NearestField& field_;
  std::int32_t min_uses_;                    // K
  std::int64_t left_over_;                   // R that nobody has taken
  std::vector<std::int32_t> uses_, first_;   // by source place; -1: no source; its first target
  std::vector<std::int32_t> next_, before_;  // by target place: of the same source's targets
  std::vector<Offer> offers_;                // by source place, as a pass finds them
  std::vector<Trade> trades_;                // by target
  std::vector<std::uint8_t> changed_;        // by target place, in this pass
};

}  // namespace freshet::synth::transfer
