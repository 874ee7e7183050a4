// library/opencv_threads.h — OpenCV's own threads held back while the library works.
#pragma once

namespace freshet {

/// OpenCV's threads would compete with ours, which share out whole frames, and not all of its functions give
/// the same bits for any number of them. While one of these lives, OpenCV uses one thread, in all of the
/// process; the last to go restores what was set before the first. Safe from many threads.
class OneOpenCvThread {
 public:
  OneOpenCvThread();
  OneOpenCvThread(const OneOpenCvThread&) = delete;
  OneOpenCvThread& operator=(const OneOpenCvThread&) = delete;
  ~OneOpenCvThread();
};

}  // namespace freshet
