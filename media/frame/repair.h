// media/frame/repair.h — what interlacing and coarse compression did to a video, undone as far as it can be.
#pragma once

#include <string>

namespace freshet::media {

/// Repairs change pixels: frames are then no longer the decoder's own, which is why none is made unasked.
struct Repairs {
  bool deinterlace = false;  // both fields of a frame become one whole picture of the earlier one's time
  bool deblock = false;      // the borders of 8 x 8 blocks are smoothed

  bool any() const { return deinterlace || deblock; }
  bool operator==(const Repairs&) const = default;
};

/// FFmpeg's filters that do it, as its -vf takes them: "bwdif=mode=send_frame,deblock=filter=strong";
/// empty without repairs.
std::string filter_text(const Repairs& repairs);

}  // namespace freshet::media
