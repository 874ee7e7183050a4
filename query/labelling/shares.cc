#include "query/labelling/shares.h"

#include <algorithm>
#include <map>
#include <tuple>

#include <fmt/format.h>

namespace freshet::query {
namespace {

constexpr std::size_t kFewPieces = 20;

}  // namespace

LargestShares largest_shares(const Assignment& assignment) {
  LargestShares shares;
  if (assignment.pieces.empty()) return shares;
  std::map<std::uint32_t, std::size_t> clips;
  std::map<std::tuple<std::uint32_t, float, float, bool, int, int>, std::size_t> patches;
  std::size_t most_of_clip = 0, most_of_patch = 0;
  for (const AssignedPiece& piece : assignment.pieces) {
    ++clips[piece.clip];
    const std::size_t uses = ++patches[{piece.clip, piece.variant.scale, piece.variant.rotation_deg,
                                        piece.variant.flip, piece.patch.x, piece.patch.y}];
    most_of_patch = std::max(most_of_patch, uses);
  }
  for (const auto& [clip, uses] : clips) {
    if (uses <= most_of_clip) continue;
    most_of_clip = uses;
    shares.most_used = clip;
  }
  const auto pieces = static_cast<double>(assignment.pieces.size());
  shares.clip = static_cast<double>(most_of_clip) / pieces;
  shares.patch = static_cast<double>(most_of_patch) / pieces;
  return shares;
}

LargestClass largest_class(const Assignment& assignment) {
  if (assignment.pieces.empty()) return {};
  std::map<std::string, std::size_t> pieces;
  for (const AssignedPiece& piece : assignment.pieces) ++pieces[assignment.clips[piece.clip].class_name];
  const auto most = std::ranges::max_element(pieces, {}, [](const auto& each) { return each.second; });
  return {.name = most->first,
          .share = static_cast<double>(most->second) / static_cast<double>(assignment.pieces.size())};
}

std::string to_string(const LargestShares& shares) {
  return fmt::format("largest share of a clip {:.0f}%, of a patch {:.1f}%", 100 * shares.clip,
                     100 * shares.patch);
}

std::string shares_warning(const Assignment& assignment, const LargestShares& shares) {
  if (assignment.pieces.size() < kFewPieces) return {};
  std::string text;
  if (shares.clip > kClipShareWarned) {
    const std::string& name = assignment.clips.at(shares.most_used).name;
    text = fmt::format(
        "{:.0f}% of the pieces come from one clip, {}: what it does, all does; if that looks wrong, leave it "
        "out "
        "with --exclude {}",
        100 * shares.clip, name, name);
  }
  if (shares.patch > kPatchShareWarned)
    text += fmt::format(
        "{}{:.0f}% of the pieces are one and the same patch, which may be seen as a stamp; a greater --reuse "
        "or more clips of this kind help",
        text.empty() ? "" : "; ", 100 * shares.patch);
  return text;
}

}  // namespace freshet::query
