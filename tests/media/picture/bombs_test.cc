// Files of few bytes that ask for much: memory and time stay in proportion to their pixels.
#include "tests/media/picture/bombs.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <functional>
#include <iostream>

#include "freshet/error.h"
#include "media/frame/decoder.h"
#include "media/picture/capture_time.h"
#include "media/picture/motion_file.h"
#include "media/picture/openraster.h"
#include "media/picture/picture.h"
#include "tests/harness/scratch_folder.h"
#include "tests/media/generated_clip.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

struct Cost {
  std::string end;  // "taken", "refused", or what else became of it
  double seconds = 0;
  long kib = 0;  // at most, beyond what the process had before
};

/// Of this process: what it may address, and what of it is in memory.
std::array<long, 2> kib_of_memory() {
  std::array<long, 2> pages{};
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr || std::fscanf(file, "%ld %ld", &pages[0], &pages[1]) != 2) return {};
  std::fclose(file);
  for (long& each : pages) each *= ::sysconf(_SC_PAGESIZE) >> 10;
  return pages;
}

/// In a child that may have 2 GiB more address space than there is, and 20 s.
Cost cost_of(const std::function<void()>& action) {
  const auto begin = std::chrono::steady_clock::now();
  std::fflush(nullptr);
  std::array<int, 2> pipe{};
  if (::pipe(pipe.data()) != 0) return {};
  const pid_t child = ::fork();
  if (child == 0) {
    if (std::freopen("/dev/null", "w", stderr) == nullptr) ::_exit(4);
    const long at_first = kib_of_memory()[1];
    if (::write(pipe[1], &at_first, sizeof at_first) != sizeof at_first) ::_exit(4);
    const rlim_t limit = (static_cast<rlim_t>(kib_of_memory()[0]) << 10) + (rlim_t{2} << 30);
    const rlimit memory{.rlim_cur = limit, .rlim_max = limit};
    ::setrlimit(RLIMIT_AS, &memory);
    ::alarm(20);
    try {
      action();
      ::_exit(0);
    } catch (const Error& fault) {
      ::_exit(fault.kind() == ErrorKind::kInput ? 1 : 2);
    } catch (...) {
      ::_exit(3);
    }
  }
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  long before = 0;
  if (::read(pipe[0], &before, sizeof before) != sizeof before) return {};
  for (const int end : pipe) ::close(end);
  static constexpr const char* kEnds[] = {"taken", "refused", "another error", "no memory", "no start"};
  Cost cost;
  cost.end = WIFEXITED(status) ? kEnds[WEXITSTATUS(status)] : "signal " + std::to_string(WTERMSIG(status));
  cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  cost.kib = usage.ru_maxrss - before;
  return cost;
}

/// Wrong where it is neither taken nor refused, or costs more than 64 K pixels are worth.
void expect_cheap(const std::string& name, const Cost& cost) {
  EXPECT_TRUE(cost.end == "taken" || cost.end == "refused") << name << ": " << cost.end;
  EXPECT_LT(cost.kib >> 10, 128) << name;
  EXPECT_LT(cost.seconds, 5) << name;
  std::cout << name << ": " << cost.end << ", " << (cost.kib >> 10) << " MiB, " << cost.seconds << " s\n";
}

TEST(PictureBombs, CostNoMoreThanTheirPixels) {
  const ScratchFolder scratch;
  for (const Bomb& bomb : picture_bombs()) {
    const fs::path file = scratch / bomb.name;
    put_bytes(file, {bomb.bytes.begin(), bomb.bytes.end()});
    expect_cheap(bomb.name, cost_of([&] {
                   capture_time(file);
                   if (file.extension() == ".exr" || file.extension() == ".flo") {
                     try {
                       read_motion(file);
                     } catch (const Error&) {
                     }
                   }
                   try {
                     read_deep_picture(file);
                   } catch (const Error&) {
                   }
                   read_still(file);
                 }));
  }
}

TEST(PictureBombs, AsClipsCostNoMoreThanTheirFrames) {
  const ScratchFolder scratch;
  for (const Bomb& bomb : picture_bombs()) {
    const fs::path file = scratch / bomb.name;
    put_bytes(file, {bomb.bytes.begin(), bomb.bytes.end()});
    expect_cheap(bomb.name, cost_of([&] {
                   Decoder decoder(file, {});
                   while (decoder.next()) {
                   }
                 }));
  }
}

TEST(PictureBombs, InOpenRasterCostNoMoreThanItsPixels) {
  const ScratchFolder scratch;
  for (const Bomb& bomb : openraster_bombs()) {
    put_bytes(scratch / bomb.name, {bomb.bytes.begin(), bomb.bytes.end()});
    expect_cheap(bomb.name, cost_of([&] { read_openraster(scratch / bomb.name); }));
  }
}

TEST(PictureBombs, OneThatIsPlantedIsSeen) {
  EXPECT_GT(cost_of([] { std::vector<char>(300u << 20, 'a'); }).kib >> 10, 250);
  EXPECT_EQ(cost_of([] { std::vector<char>(std::size_t{3} << 30, 'a'); }).end, "no memory");
}

}  // namespace
}  // namespace freshet::media
