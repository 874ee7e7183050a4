#include "synth/animate/clips/piece_lives.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "stored/patch_life.h"
#include "synth/animate/clips/piece_cells.h"

namespace freshet::synth::animate {
namespace {

constexpr std::size_t kBands = vision::kLifeBands;
constexpr std::size_t kDetailBands = 3;  // finest; what is coarser is form
constexpr double kUnknown_s = 1;
constexpr double kLeastPower = 1e-12;  // bands of patches without any detail count alike

/// A band's half-life where a piece does not know it.
LifeBands usual_lives(const std::vector<LifeBands>& half_life_s) {
  LifeBands usual{};
  for (std::size_t b = 0; b < kBands; ++b) {
    double sum = 0;
    int known = 0;
    for (const LifeBands& life : half_life_s)
      if (life[b] > 0) sum += std::log(life[b]), ++known;
    if (known > 0) usual[b] = std::exp(sum / known);
  }
  for (std::size_t b = 1; b < kBands; ++b)
    if (usual[b] <= 0) usual[b] = usual[b - 1];
  for (std::size_t b = kBands - 1; b-- > 0;)
    if (usual[b] <= 0) usual[b] = usual[b + 1];
  for (double& life : usual)
    if (life <= 0) life = kUnknown_s;
  return usual;
}

double overall(const PieceLives& lives) {
  if (lives.half_life_s.empty()) return kUnknown_s;
  std::vector<double> of_pieces;
  for (std::size_t p = 0; p < lives.half_life_s.size(); ++p) {
    double logs = 0, power = 0;
    for (std::size_t b = 0; b < kDetailBands; ++b) {
      const double weight = lives.power[p][b] + kLeastPower;
      logs += weight * std::log(lives.half_life_s[p][b]);
      power += weight;
    }
    of_pieces.push_back(logs / power);
  }
  const auto middle = of_pieces.begin() + static_cast<std::ptrdiff_t>(of_pieces.size() / 2);
  std::nth_element(of_pieces.begin(), middle, of_pieces.end());
  return std::exp(*middle);
}

}  // namespace

PieceLives piece_lives(const store::Snapshot& snapshot, const Placement& placement) {
  PieceLives lives;
  each_piece(snapshot, placement, stored::life_cells,
             [&](const PlacedPatch& patch, const vision::CellMap* cells, const vision::VariantFrame& frame) {
               stored::PatchLife life;
               if (cells)
                 life = stored::patch_life(*cells, frame, patch.variant.scale, patch.patch, placement.side);
               for (double& half_life : life.half_life_s) half_life /= patch.speed;
               lives.half_life_s.push_back(life.half_life_s);
               lives.power.push_back(life.power);
             });
  const LifeBands usual = usual_lives(lives.half_life_s);
  for (LifeBands& life : lives.half_life_s)
    for (std::size_t b = 0; b < kBands; ++b)
      if (life[b] <= 0) life[b] = usual[b];
  lives.overall_s = overall(lives);
  lives.forms_s = usual.back();
  return lives;
}

}  // namespace freshet::synth::animate
