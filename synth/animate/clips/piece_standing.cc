#include "synth/animate/clips/piece_standing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "platform/smoothstep.h"
#include "stored/patch_standing.h"
#include "synth/animate/clips/piece_cells.h"
#include "synth/animate/placement/piece_values.h"

namespace freshet::synth::animate {
namespace {

constexpr std::size_t kBands = vision::kLifeBands;
constexpr double kCertain = 0.99;
constexpr double kLayoutFrom = 0.05, kLayoutSure = 0.25;

double logit(double share) {
  const double inside = std::clamp(share, 1 - kCertain, kCertain);
  return std::log(inside / (1 - inside));
}

/// By band of a piece; nothing where no clip knows.
std::optional<std::array<double, kBands>> mean_standing(const store::Snapshot& snapshot,
                                                        const Placement& placement) {
  std::array<double, kBands> sum{};
  int known = 0;
  each_piece(snapshot, placement, stored::standing_cells,
             [&](const PlacedPatch& patch, const vision::CellMap* cells, const vision::VariantFrame& frame) {
               if (!cells) return;
               const std::array<double, kBands> own =
                   stored::patch_standing(*cells, frame, patch.variant.scale, patch.patch, placement.side);
               for (std::size_t b = 0; b < kBands; ++b) sum[b] += own[b];
               ++known;
             });
  if (known == 0) return std::nullopt;
  for (double& share : sum) share /= known;
  return sum;
}

}  // namespace

std::vector<double> standing_shares(const store::Snapshot& snapshot, const Placement& placement, int levels) {
  std::vector<double> shares(static_cast<std::size_t>(levels) + 1, 0.0);
  const auto bands = mean_standing(snapshot, placement);
  if (!bands) return shares;
  // Of the reduced picture that the pieces lie on, a level is a finer one.
  const double finer = std::log2(placement.piece_scale);
  const double coarsest = logit((*bands)[kBands - 1]);
  const double step = std::max(0.0, coarsest - logit((*bands)[kBands - 2]));
  for (std::size_t level = 0; level < shares.size(); ++level) {
    const double at = std::max(0.0, static_cast<double>(level) - finer), beyond = at - (kBands - 1);
    if (beyond > 0) {
      shares[level] = 1 / (1 + std::exp(-(coarsest + beyond * step)));
      continue;
    }
    const auto below = std::min(static_cast<std::size_t>(at), kBands - 2);
    shares[level] = std::lerp((*bands)[below], (*bands)[below + 1], at - static_cast<double>(below));
  }
  return shares;
}

std::vector<cv::Mat> layout_shares(const store::Snapshot& snapshot, const Placement& placement, int levels) {
  const PieceValues lattice(placement);
  std::vector<cv::Mat> shares;
  for (int level = 0; level < levels; ++level) shares.push_back(lattice.none());
  const double finer = std::log2(placement.piece_scale);
  std::size_t piece = 0;
  each_piece(
      snapshot, placement, stored::layout_cells,
      [&](const PlacedPatch& patch, const vision::CellMap* cells, const vision::VariantFrame& frame) {
        const cv::Point at = lattice.at(piece++);
        if (!cells) return;
        const std::array<double, kBands> own =
            stored::patch_layout(*cells, frame, patch.variant.scale, patch.patch, placement.side);
        for (std::size_t level = 0; level < shares.size(); ++level) {
          const double band = std::clamp(static_cast<double>(level) - finer, 0.0, kBands - 1.0);
          const auto below = std::min(static_cast<std::size_t>(band), kBands - 2);
          const double found = std::lerp(own[below], own[below + 1], band - static_cast<double>(below));
          shares[level].at<float>(at) = static_cast<float>(smoothstep(kLayoutFrom, kLayoutSure, found));
        }
      });
  return shares;
}

}  // namespace freshet::synth::animate
