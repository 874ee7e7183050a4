#include "synth/transfer/draft.h"

#include <algorithm>

#include "platform/random.h"
#include "synth/transfer/vote.h"

namespace freshet::synth::transfer {
namespace {

PixelGrid random_picture(const ExemplarLevel& source, const TargetLevel& target,
                         const TransferOptions& options, std::uint64_t seed) {
  const int side = options.patch, half = side / 2;
  const std::vector<int>&boundary = source.segments[Segment::kBoundary],
        &interior = source.segments[Segment::kInterior];
  const Random random(seed, 0);
  PixelGrid out(target.previous.width, target.previous.height);
  const int squares = out.width / side + 1;
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const double alpha = static_cast<double>(target.blurred_alpha(x, y));
      if (alpha <= options.lower) continue;
      const bool whole = boundary.empty() || (alpha >= options.upper && !interior.empty());
      const std::vector<int>& from = whole ? interior : boundary;
      const std::uint64_t square = static_cast<std::uint64_t>((y / side) * squares + x / side);
      const std::size_t pick = static_cast<std::size_t>(random.bits(square) % from.size());
      const int centre = from[pick];
      out(x, y) = source.now.values[static_cast<std::size_t>(centre + (y % side - half) * source.now.width +
                                                             x % side - half)];
    }
  return out;
}

NearestField refined_field(const NearestField& coarse, const ExemplarLevel& coarse_source,
                           const ExemplarLevel& source, const TargetLevel& target, int margin) {
  NearestField fine(source.now.width, source.now.height, target.previous.width, target.previous.height);
  for (int y = margin; y < fine.target_height - margin; ++y)
    for (int x = margin; x < fine.target_width - margin; ++x) {
      const int in_x = x - margin, in_y = y - margin;
      const int of = coarse.source[static_cast<std::size_t>((in_y / 2 + margin) * coarse.target_width +
                                                            in_x / 2 + margin)];
      if (of < 0) continue;
      ExemplarLevel::Place at = coarse_source.split(of);
      const cv::Size size = source.sizes[static_cast<std::size_t>(at.turn)];
      at.x = std::clamp(2 * at.x + in_x % 2, margin, size.width - 1 - margin);
      at.y = std::clamp(2 * at.y + in_y % 2, margin, size.height - 1 - margin);
      fine.source[static_cast<std::size_t>(y * fine.target_width + x)] = source.join(at);
    }
  return fine;
}

// Of the picture only what no patch of the finer level reaches is left as it is here: all else is voted anew.
PixelGrid doubled(const PixelGrid& coarse, int margin, const TargetLevel& target) {
  PixelGrid out(target.previous.width, target.previous.height);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      out(x, y) = coarse(std::clamp((x - margin) / 2 + margin, 0, coarse.width - 1),
                         std::clamp((y - margin) / 2 + margin, 0, coarse.height - 1));
  return out;
}

// Bits of x and y by turns, the lowest as the highest: in this order tiles fill a grid that becomes finer and finer.
std::uint64_t spread(std::uint32_t x, std::uint32_t y) {
  std::uint64_t bits = 0;
  for (int bit = 0; bit < 32; ++bit)
    bits = bits << 2 | std::uint64_t{x >> bit & 1u} << 1 | std::uint64_t{y >> bit & 1u};
  return bits;
}

}  // namespace

Draft random_draft(const ExemplarLevel& source, const TargetLevel& target, const TransferOptions& options,
                   std::uint64_t seed) {
  return {random_picture(source, target, options, seed),
          NearestField(source.now.width, source.now.height, target.previous.width, target.previous.height)};
}

void start_from_past(const TargetLevel& target, double lambda, PixelGrid& picture) {
  for (std::size_t i = 0; i < picture.values.size(); ++i)
    if (has_past(target.lambda.values[i], lambda)) picture.values[i] = target.previous.values[i];
}

std::vector<std::int32_t> carried_sources(const GridOf<std::int32_t>& carried, const ExemplarLevel& finest,
                                          const ExemplarLevel& source, int halvings, cv::Size target,
                                          int margin) {
  std::vector<std::int32_t> out(static_cast<std::size_t>(target.area()), -1);
  const int middle = (1 << halvings) / 2;
  for_rows(target.height - 2 * margin, [&](int y) {
    const int from_y = std::min((y << halvings) + middle, carried.height - 1);
    std::int32_t* row = out.data() + static_cast<std::ptrdiff_t>(y + margin) * target.width + margin;
    for (int x = 0; x < target.width - 2 * margin; ++x) {
      const std::int32_t place = carried(std::min((x << halvings) + middle, carried.width - 1), from_y);
      // A state may have been left by another exemplar.
      if (place < 0 || place >= static_cast<std::int32_t>(finest.now.values.size())) continue;
      ExemplarLevel::Place at = finest.split(place);
      const cv::Size size = source.sizes[static_cast<std::size_t>(at.turn)];
      at.x = std::clamp(at.x >> halvings, margin, size.width - 1 - margin);
      at.y = std::clamp(at.y >> halvings, margin, size.height - 1 - margin);
      row[x] = source.join(at);
    }
  });
  return out;
}

Draft refined(const Draft& coarse, const ExemplarLevel& coarse_source, const ExemplarLevel& source,
              const TargetLevel& target, const TransferOptions& options) {
  const int margin = options.patch / 2;
  Draft fine{doubled(coarse.picture, margin, target),
             refined_field(coarse.field, coarse_source, source, target, margin)};
  vote(source.now, fine.field, options.patch, options.vote_power, fine.picture);
  return fine;
}

void clear_uncovered(const NearestField& field, int half, PixelGrid& picture) {
  GridOf<std::uint8_t> covered(picture.width, picture.height, 0);
  for (int y = half; y < picture.height - half; ++y)
    for (int x = half; x < picture.width - half; ++x)
      if (field.source[static_cast<std::size_t>(y * picture.width + x)] >= 0)
        for (int dy = -half; dy <= half; ++dy)
          std::fill_n(covered.row(y + dy) + x - half, 2 * half + 1, std::uint8_t{1});
  for (std::size_t i = 0; i < covered.values.size(); ++i)
    if (!covered.values[i]) picture.values[i] = Pixel{};
}

std::vector<int> part_of(const std::vector<int>& sources, int width, std::size_t count, int tile,
                         std::uint64_t seed) {
  struct Drawn {
    std::uint64_t tile;
    std::size_t index;
    bool operator<(const Drawn& other) const {
      return tile != other.tile ? tile < other.tile : index < other.index;
    }
  };
  const std::uint64_t first = scramble(seed);
  std::vector<Drawn> drawn;
  drawn.reserve(sources.size());
  for (const int place : sources) {
    const auto x = static_cast<std::uint32_t>(place % width / tile),
               y = static_cast<std::uint32_t>(place / width / tile);
    drawn.push_back({spread(x, y) ^ first, drawn.size()});
  }
  const auto end = drawn.begin() + static_cast<std::ptrdiff_t>(count);
  std::nth_element(drawn.begin(), end, drawn.end());
  std::vector<int> part;
  part.reserve(count);
  drawn.erase(end, drawn.end());
  std::sort(drawn.begin(), drawn.end(), [](const Drawn& a, const Drawn& b) { return a.index < b.index; });
  for (const Drawn& of : drawn) part.push_back(sources[of.index]);
  return part;
}

}  // namespace freshet::synth::transfer
