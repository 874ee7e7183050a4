// aside.h — a task beside the caller's work.
#pragma once

#include <utility>

#include <tbb/task_group.h>

namespace freshet::ingest {

/// Leaving its scope waits for it, so that it never outlives what it refers to.
class Aside {
 public:
  template <class Work>
  explicit Aside(Work&& work) {
    group_.run(std::forward<Work>(work));
  }
  ~Aside() {
    try {
      group_.wait();
    } catch (...) {  // an exception of the caller's work is already on its way
    }
  }
  void wait() { group_.wait(); }

 private:
  tbb::task_group group_;
};

}  // namespace freshet::ingest
