#include "synth/flowlines/files/footage_files.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/video/video_reader.h"
#include "stored/clip_frames.h"

namespace freshet::synth::flowlines {
namespace {

/// Takes frames one by one until enough are there.
class Taker {
 public:
  Taker(Footage& footage, const FootageOptions& options) : footage_(footage), options_(options) {}
  /// False when no more are wanted.
  bool take(const media::Frame& frame) {
    if (seen_++ < options_.from) return true;
    if (options_.frames > 0 && footage_.count() >= options_.frames) return false;
    cv::Mat bgr = media::to_bgr(frame);
    const std::size_t bytes = bgr.total() * bgr.elemSize();
    if ((footage_.frames.size() + 1) * bytes > options_.memory_bytes) {
      footage_.notices.push_back(
          fmt::format("the first {} frames are used: more do not fit into {} MB (--memory)", footage_.count(),
                      options_.memory_bytes >> 20));
      return false;
    }
    footage_.frames.push_back(std::move(bgr));
    return true;
  }
  void finish() const {
    if (footage_.frames.empty())
      throw Error(ErrorKind::kInput, footage_.name,
                  fmt::format("it has {} frames, none from number {} on that fits", seen_, options_.from),
                  "Lower --from, or raise --memory");
  }

 private:
  Footage& footage_;
  FootageOptions options_;
  int seen_ = 0;
};

}  // namespace

Footage read_footage(const std::filesystem::path& path, const FootageOptions& options) {
  media::VideoReader reader(path);
  Footage footage{
      .name = path.string(),
      .frames = {},
      .fps = static_cast<double>(reader.info().fps_num) / static_cast<double>(reader.info().fps_den)};
  Taker taker(footage, options);
  bool wanted = true;
  while (wanted) {
    const std::optional<media::Frame> frame = reader.next();
    if (!frame) break;
    wanted = taker.take(*frame);
  }
  if (wanted && !reader.complaint().empty()) footage.notices.push_back(reader.complaint());
  taker.finish();
  return footage;
}

Footage read_footage(const store::Snapshot& snapshot, const std::string& clip,
                     const FootageOptions& options) {
  const std::optional<store::ClipId> id = snapshot.find(clip);
  if (!id) {
    std::string names;
    for (const store::ClipId other : snapshot.clips()) {
      if (names.size() > 200) {
        names += ", ...";
        break;
      }
      names += (names.empty() ? "" : ", ") + snapshot.clip(other).name;
    }
    throw Error(ErrorKind::kNotFound, clip,
                "the store has no clip of this name; it has " + (names.empty() ? std::string("none") : names),
                "Name one of those that freshet store info lists");
  }
  const stored::ClipFrames frames(snapshot, *id);
  const store::ClipRecord& record = snapshot.clip(*id);
  Footage footage{.name = clip,
                  .frames = {},
                  .fps = static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den)};
  Taker taker(footage, options);
  constexpr std::uint32_t kSlab = 16;  // frames of a run of tiles: read together they are decoded once
  bool wanted = true;
  for (std::uint32_t first = 0; wanted && first < frames.size(); first += kSlab)
    for (const media::Frame& frame : frames.read(first, std::min(kSlab, frames.size() - first))) {
      wanted = taker.take(frame);
      if (!wanted) break;
    }
  taker.finish();
  return footage;
}

}  // namespace freshet::synth::flowlines
