#include "starter/starter_store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/core/utility.hpp>

#include "freshet/error.h"
#include "ingest/ingest.h"
#include "media/video/plain_video.h"
#include "platform/unfinished_files.h"
#include "query/index/index_builder.h"
#include "store/store.h"
#include "synth/simulate/simulate.h"
#include "vision/settings.h"

namespace freshet::starter {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMaking = "making the starter store";
constexpr const char* kLicence = "CC0-1.0 (simulated by Freshet)";

/// Held by the one process that makes a store; others wait for it. Goes with the process, however that ends.
class MakersLock {
 public:
  MakersLock(const fs::path& path, const Job& job) : path_(path), unfinished_(path) {
    for (;;) {
      fd_ = ::open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
      if (fd_ < 0)
        throw Error(ErrorKind::kIo, path.string(),
                    fmt::format("cannot be written ({})", std::strerror(errno)),
                    "Check the folder and the disk");
      while (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
        if (job.stop.stop_requested()) {
          ::close(fd_);
          throw Error(ErrorKind::kCancelled, path.string(), "stopped");
        }
        if (job.progress) job.progress({"waiting for another process that makes the starter store"});
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
      }
      // Who held it may have removed it meanwhile: then it is no lock any more.
      struct stat held {
      }, named{};
      if (::fstat(fd_, &held) == 0 && ::stat(path.c_str(), &named) == 0 && held.st_ino == named.st_ino)
        return;
      ::close(fd_);
    }
  }
  ~MakersLock() {
    ::unlink(path_.c_str());
    ::close(fd_);
  }
  MakersLock(const MakersLock&) = delete;
  MakersLock& operator=(const MakersLock&) = delete;

 private:
  fs::path path_;
  UnfinishedFile unfinished_;
  int fd_ = -1;
};

/// What is made beside the store, and removed whatever happens.
struct Workshop {
  fs::path store, lock, clips;

  explicit Workshop(const fs::path& file)
      : store(file.string() + ".unfinished"),
        lock(store.string() + "-lock"),
        clips(file.string() + ".clips") {
    clear();
  }
  ~Workshop() { clear(); }
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;

 private:
  void clear() const {
    std::error_code ignored;
    for (const fs::path& path : {store, lock, clips}) fs::remove_all(path, ignored);
  }
};

/// OpenCV takes other instructions on other processors, and DIS flow then has other last bits: while one lives, all
/// take those that each x86-64 has. Of the whole process.
class SameOpenCvEverywhere {
 public:
  SameOpenCvEverywhere() { cv::setUseOptimized(false); }
  ~SameOpenCvEverywhere() { cv::setUseOptimized(before_); }
  SameOpenCvEverywhere(const SameOpenCvEverywhere&) = delete;
  SameOpenCvEverywhere& operator=(const SameOpenCvEverywhere&) = delete;

 private:
  bool before_ = cv::useOptimized();
};

/// Counts frames over all clips: those that are simulated, then those that are taken in.
class Count {
 public:
  Count(const Recipe& recipe, const Job& job) : job_(job) {
    for (const RecipeClip& clip : recipe.clips) of_ += 2 * static_cast<std::size_t>(clip.scene.frames);
  }
  void at(std::size_t frames) const {
    if (job_.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "starter store", "stopped");
    if (job_.progress) job_.progress({kMaking, done_ + frames, of_});
  }
  void finish(int frames) { done_ += static_cast<std::size_t>(frames); }

 private:
  const Job& job_;
  std::size_t done_ = 0, of_ = 0;
};

void film(const RecipeClip& clip, const fs::path& path, const Count& count) {
  fs::create_directories(path.parent_path());
  media::PlainVideo video(path, clip.scene.size, clip.scene.fps);
  synth::simulate::Simulation simulation(clip.scene);
  synth::simulate::SimulatedFrame frame;
  for (std::size_t done = 1; simulation.next(frame); ++done) {
    video.write(frame.picture);
    count.at(done);
  }
  video.finish();
}

void take(store::Store& store, const vision::Settings& settings, const fs::path& clips, const Count& count,
          const Job& job) {
  const std::vector<fs::path> paths{clips};
  // No screening: nobody holds a simulation's camera, and a drifting sky would be taken for a moving one.
  const ingest::IngestReport report = ingest::ingest(
      store, settings, paths, {.licence = kLicence, .force = true},
      [&](const ingest::IngestProgress& at) { count.at(at.frames); }, job.stop);
  if (report.stopped) throw *report.stopped;
  for (const ingest::ClipReport& clip : report.clips)
    if (clip.outcome != ingest::Outcome::kAdded)
      throw Error(ErrorKind::kInput, clip.name,
                  fmt::format("could not be taken in: {}", fmt::join(clip.reasons, "; ")),
                  "Change the recipe");
}

}  // namespace

bool make_store(const fs::path& file, const Recipe& recipe, const Job& job) {
  if (fs::exists(file)) return false;
  if (const fs::path folder = file.parent_path(); !folder.empty()) {
    std::error_code fault;
    fs::create_directories(folder, fault);
    if (fault)
      throw Error(ErrorKind::kIo, folder.string(), fmt::format("cannot be made ({})", fault.message()),
                  "Check the folder above it");
  }
  const MakersLock alone(file.string() + ".making", job);
  if (fs::exists(file)) return false;
  const SameOpenCvEverywhere same;
  const Workshop beside(file);
  const UnfinishedFile unfinished(beside.store), unfinished_lock(beside.lock);
  {
    const vision::Settings settings;
    store::Store store = store::Store::create(beside.store, vision::to_json(settings));
    Count count(recipe, job);
    for (const RecipeClip& clip : recipe.clips) {
      const fs::path path = beside.clips / (clip.name + ".y4m");
      const UnfinishedFile unfinished_clip(path);
      film(clip, path, count);
      count.finish(clip.scene.frames);
      take(store, settings, beside.clips, count, job);
      count.finish(clip.scene.frames);
      fs::remove(path);
    }
    query::build_index(store, {}, job.progress, job.stop);
  }
  fs::rename(beside.store, file);
  return true;
}

fs::path kept_name(const fs::path& folder, const Recipe& recipe) {
  return folder / fmt::format("starter-{}.store", recipe.hash());
}

}  // namespace freshet::starter
