#include "stored/clip_loop.h"

#include <algorithm>

#include "freshet/error.h"
#include "media/frame/frame.h"
#include "stored/clip_frames.h"
#include "stored/clip_metadata.h"

namespace freshet::stored {
namespace {

std::optional<vision::LoopRule> measured(const store::Snapshot& snapshot, store::ClipId clip) {
  const store::ClipRecord& record = snapshot.clip(clip);
  if (record.frame_count < vision::kMinLoopFrames) return std::nullopt;
  const ClipFrames frames(snapshot, clip);
  vision::LoopFinder finder(static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den));
  constexpr std::uint32_t kSlab = 16;
  for (std::uint32_t first = 0; first < frames.size(); first += kSlab)
    for (const media::Frame& frame : frames.read(first, std::min(kSlab, frames.size() - first)))
      finder.add(media::to_luma(frame));
  return finder.finish();
}

}  // namespace

std::optional<vision::LoopRule> loop_rule(const store::Snapshot& snapshot, store::ClipId clip) {
  const ClipMetadata metadata = metadata_of(snapshot, clip);
  if (!metadata.loop_known) return measured(snapshot, clip);
  const std::optional<vision::LoopRule>& rule = metadata.loop;
  if (!rule) return std::nullopt;
  const store::ClipRecord& record = snapshot.clip(clip);
  const std::uint64_t half = rule->fade / 2;
  if (rule->from <= rule->to || rule->fade > rule->length() || rule->fade < 2 || half > rule->to ||
      rule->from + half >= record.frame_count || !(rule->distance >= 0))
    throw Error(ErrorKind::kDamaged, record.name, "its loop rule does not fit its frames",
                "Run freshet store verify");
  return rule;
}

}  // namespace freshet::stored
