#include "library/opencv_threads.h"

#include <mutex>

#include <opencv2/core/utility.hpp>

namespace freshet {
namespace {

std::mutex guard;
int holders = 0, threads_before = 0;

}  // namespace

OneOpenCvThread::OneOpenCvThread() {
  const std::lock_guard lock(guard);
  if (holders++ > 0) return;
  threads_before = cv::getNumThreads();
  cv::setNumThreads(1);
}

OneOpenCvThread::~OneOpenCvThread() {
  const std::lock_guard lock(guard);
  if (--holders == 0) cv::setNumThreads(threads_before);
}

}  // namespace freshet
