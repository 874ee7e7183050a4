// media/frame/repair.h — what interlacing and coarse compression did to a video, undone as far as it can be; HDR
// brought to SDR; and lying pictures set upright.
#pragma once

#include <string>

namespace freshet::media {

/// Repairs change pixels: frames are then no longer the decoder's own, which is why none is made unasked. To turn them
/// only changes their places.
struct Repairs {
  bool upright = false;  // frames stored lying (a phone's) are turned as a player turns them, without loss
  bool deinterlace = false;  // both fields of a frame become one whole picture of the earlier one's time
  bool deblock = false;      // the borders of 8 x 8 blocks are smoothed
  bool sdr = false;          // HDR (PQ, HLG) becomes BT.709; what is no HDR is left alone

  bool any() const { return deinterlace || deblock; }  // of what looks at a video's fields and blocks
  bool operator==(const Repairs&) const = default;
};

/// FFmpeg's filters that do it, as its -vf takes them: "bwdif=mode=send_frame,deblock=filter=strong";
/// empty without repairs.
/// rotation   degrees clockwise that a player turns the frames by: 0, 90, 180 or 270.
/// HDR    linear light, of which 203 cd/m2 (ITU-R BT.2408: white) is 1, in BT.709's primaries; from .3 on it is
///        compressed up to 1000 cd/m2 (mobius), whatever the file's own metadata say; clipped above.
std::string filter_text(const Repairs& repairs, int rotation = 0);

}  // namespace freshet::media
