#include "stored/middle_frame.h"

#include "media/frame/frame.h"
#include "stored/clip_frames.h"

namespace freshet::stored {

cv::Mat middle_frame(const store::Snapshot& snapshot, store::ClipId clip) {
  const ClipFrames frames(snapshot, clip);
  return media::to_bgr(frames.read(frames.size() / 2));
}

}  // namespace freshet::stored
