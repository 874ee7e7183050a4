// What happens around a run: signals, other programs' copies, a slow disk, a clock that jumps, a disk that cannot be
// written.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>
#include <thread>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/faults/campaign.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

/// Seconds of CPU that a process has used so far; 0 when it has ended.
double cpu_seconds(pid_t process) {
  const std::string text = text_of("/proc/" + std::to_string(process) + "/stat");
  if (text.rfind(')') == std::string::npos) return 0;
  std::istringstream fields(text.substr(text.rfind(')') + 2));
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  long user = 0, system = 0;
  fields >> user >> system;
  return static_cast<double>(user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

struct Interrupted {
  Outcome outcome;
  double cpu_after = 0;  // seconds that it went on for
};

Interrupted interrupt(const Campaign& c, const std::vector<std::string>& arguments, int number,
                      std::chrono::microseconds after) {
  const Started started = c.folder.start_freshet(arguments);
  std::this_thread::sleep_for(after);
  const double at_signal = cpu_seconds(started.process);
  ::kill(started.process, number);
  double at_end = at_signal;
  for (siginfo_t info{}; info.si_pid == 0;) {
    at_end = std::max(at_end, cpu_seconds(started.process));
    if (waitid(P_PID, static_cast<id_t>(started.process), &info, WEXITED | WNOWAIT | WNOHANG) != 0) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return {WorkFolder::wait(started), at_end - at_signal};
}

/// Files that the campaign's folder has, but for the store and its lock.
std::set<std::string> others(const Campaign& c) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(c.folder.path())) names.insert(entry.path().filename());
  names.erase("f.store");
  names.erase("f.store-lock");
  return names;
}

/// Files that libraries read, and computations that know of no request to stop, for many seconds.
TEST(Interrupts, AtAnyStageOfEveryCommandTakeASecond) {
  const Campaign& c = campaign();
  cv::Mat large(5000, 6000, CV_8UC3), matte(large.size(), CV_8U, cv::Scalar(0));
  cv::randu(large, 0, 255);
  matte(cv::Rect(1000, 1000, 3000, 3000)).setTo(255);
  cv::GaussianBlur(matte, matte, {}, 40);
  cv::imwrite((c.folder / "large.png").string(), large, {cv::IMWRITE_PNG_COMPRESSION, 1});
  cv::imwrite((c.folder / "large_matte.png").string(), matte);
  c.folder.file(
      "large.toml",
      "picture = \"large.png\"\nframes = 100\n[[layer]]\nname = \"a\"\nmatte = \"large_matte.png\"\nmotion = "
      "\"clouds\"\n[[layer]]\nname = \"b\"\nmotion = \"still\"\nmatte = \"rest\"\n");
  fs::create_directory(c.folder / "large_stills");
  for (int i = 0; i < 4; ++i) {
    cv::randu(large, 0, 255);
    cv::imwrite((c.folder / ("large_stills/" + std::to_string(i) + ".png")).string(), large,
                {cv::IMWRITE_PNG_COMPRESSION, 1});
  }
  ASSERT_EQ(c.folder
                .run({"ffmpeg", "-v", "error", "-y", "-f", "lavfi", "-i",
                      "testsrc2=size=1920x1080:rate=25:duration=3", "-c:v", "libx264", "-preset", "ultrafast",
                      "large.mp4"})
                .exit_code,
            0);
  cv::Mat tree(1080, 1920, CV_8U, cv::Scalar(0));
  tree(cv::Rect(600, 300, 500, 700)).setTo(255);
  cv::imwrite((c.folder / "large_tree.png").string(), tree);
  c.folder.file("large_tour.toml", "horizon = 500\n[[thing]]\nmatte = \"large_tree.png\"\n");
  c.begin_with("indexed.store", "q.store");
  ASSERT_EQ(c.run({"synth", "simulate", "plume", "--frames", "2", "--size", "640x480", "--overwrite", "-o",
                   "design"})
                .exit_code,
            0);
  const std::vector<std::vector<std::string>> commands{
      {"ingest", "l.store", "large.mp4", "--force"},
      {"query", "candidates", "q.store", "large.png", "--matte", "large_matte.png"},
      {"query", "label", "q.store", "large.png", "--whole", "--frames", "8", "-o", "s.json"},
      {"query", "bench", "q.store"},
      {"synth", "animate", "q.store", "large.png", "--matte", "large_matte.png", "--frames", "8", "-o",
       "s.mkv"},
      {"synth", "animate", "q.store", "large.png", "--whole", "--method", "paper", "--frames", "8", "-o",
       "s.mkv"},
      {"synth", "matte", "large.png", "--box", "1000,1000,4000,4000", "-o", "s.png"},
      {"synth", "scene", "large.toml", "-o", "s.mkv"},
      {"synth", "layers", "large.toml", "-o", "s.ora"},
      {"synth", "sweep", "q.store", "large.png", "--whole", "--frames", "8", "--vary", "speed=0.5,1", "-o",
       "s_sweep"},
      {"synth", "transfer", "--design", "design", "--exemplar", "large.png", "--ground", "black", "-o",
       "s.mkv"},
      {"synth", "flowlines", "large.mp4", "-o", "s.mkv"},
      {"synth", "tour", "large.mp4", "large_tour.toml", "-o", "s.mkv"},
      {"synth", "stills", "large_stills", "-o", "s.mkv"},
      {"synth", "simulate", "fireball", "--size", "1920x1080", "--grid", "1024", "-o", "s_design"},
      {"synth", "simulate", "smoke", "--size", "1920x1080", "-o", "s.mkv"}};
  struct Case {
    const std::vector<std::string>* command;
    int number, after_ms;
  };
  std::vector<Case> cases;
  int turn = 0;
  for (const auto& command : commands)
    for (const int after_ms : at_full_length()
                                  ? std::vector{30, 100, 300, 700, 1500, 3000, 6000, 12000, 25000}
                                  : std::vector{300, 2500})
      cases.push_back({&command, ++turn % 2 == 0 ? SIGINT : SIGTERM, after_ms});
  double most = 0;
  int stopped = 0;
  walk("stages", cases, [&](const Case& tried) {
    const auto before = others(c);
    const auto [outcome, cpu_after] =
        interrupt(c, *tried.command, tried.number, std::chrono::milliseconds(tried.after_ms));
    const std::string what = (*tried.command)[0] + ' ' + (*tried.command)[1] + " after " +
                             std::to_string(tried.after_ms) + " ms: " + outcome.err;
    EXPECT_TRUE(outcome.signal == tried.number || outcome.exit_code == 0 || outcome.exit_code == 1)
        << what << outcome.exit_code;
    // As many seconds of CPU as there are cores, and what a busy machine delays.
    EXPECT_LT(cpu_after, 1.0 * std::thread::hardware_concurrency() + 0.3) << what;
    most = std::max(most, cpu_after);
    stopped += outcome.signal != 0 ? 1 : 0;
    for (const std::string& name : others(c))
      if (!before.contains(name)) {
        EXPECT_TRUE(name.ends_with("-lock") || name.starts_with("s.") || name.starts_with("s_") ||
                    name.starts_with("l.store"))
            << what << name;
        fs::remove_all(c.folder / name);
      }
  });
  std::cout << stopped << " of " << cases.size() << " stopped; at most " << most
            << " s of CPU after the signal\n";
  EXPECT_GT(stopped, static_cast<int>(cases.size()) / 2);
}

TEST(Interrupts, AtAnyInstantEndWithinASecondsWorkAndLeaveNothing) {
  const Campaign& c = campaign();
  std::mt19937 random(29);
  std::vector<Job> all = jobs();
  all.push_back(
      {.name = "simulate",
       .begins_with = "",
       .arguments = {"synth", "simulate", "river", "--size", "96x96", "--frames", "48", "-o", "s.mkv"},
       .before = "",
       .after = ""});
  struct Kind {
    Job job;
    std::chrono::microseconds took{};
  };
  std::vector<Kind> cases;
  for (const Job& job : all) {
    c.begin_with(job.begins_with, "f.store");
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(c.run(job.arguments).exit_code, 0) << job.name;
    const auto took =
        std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);
    fs::remove(c.folder / "s.mkv");
    cases.insert(cases.end(), at_full_length() ? 300 : 2, {job, took});
  }
  double most = 0;
  int stopped = 0;
  walk("signals", cases, [&](const Kind& tried) {
    const Job& job = tried.job;
    c.begin_with(job.begins_with, "f.store");
    const auto before = others(c);
    const int number = random() % 2 == 0 ? SIGINT : SIGTERM;
    const auto [outcome, cpu_after] =
        interrupt(c, job.arguments, number,
                  std::chrono::microseconds(random() % static_cast<std::uint32_t>(tried.took.count())));
    const std::string what = job.name + ": " + outcome.err;
    EXPECT_TRUE(outcome.exit_code == 0 || outcome.signal == number) << what << outcome.exit_code;
    most = std::max(most, cpu_after);
    stopped += outcome.signal != 0 ? 1 : 0;
    if (job.name == "simulate") {
      EXPECT_EQ(fs::exists(c.folder / "s.mkv"), outcome.exit_code == 0) << what;
      fs::remove(c.folder / "s.mkv");
    } else {
      EXPECT_EQ(judge_again(c, job), "") << what;
    }
    EXPECT_EQ(others(c), before) << what;
  });
  std::cout << stopped << " stopped; at most " << most << " s of CPU after the signal\n";
  EXPECT_GT(stopped, 0);
  EXPECT_LT(most, 1.0);
}

TEST(Circumstances, ACopyThatIsTakenWhileItIsWrittenIsTrueOrRefused) {
  const Campaign& c = campaign();
  c.begin_with("one.store", "pair.store");
  ASSERT_EQ(c.run(c.ingest("pair.store", {"clip2.mkv"})).exit_code, 0);
  const std::set<std::string> states{c.one, digest(c.folder / "pair.store"), c.all};
  int copies = 0, refused = 0;
  for (int round = 0; round < (at_full_length() ? 30 : 1); ++round) {
    c.begin_with("one.store", "f.store");
    const Started started = c.folder.start_freshet(c.ingest("f.store", {"clip2.mkv", "clip3.mkv"}));
    std::vector<std::string> taken;
    for (siginfo_t info{}; info.si_pid == 0 && taken.size() < 40;) {
      std::string bytes;
      // A chunk now and a chunk then, as a slow copy is.
      std::ifstream from(c.folder / "f.store", std::ios::binary);
      std::string chunk(1 << 16, '\0');
      while (from.read(chunk.data(), static_cast<std::streamsize>(chunk.size())), from.gcount() > 0) {
        bytes.append(chunk, 0, static_cast<std::size_t>(from.gcount()));
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
      taken.push_back(std::move(bytes));
      if (waitid(P_PID, static_cast<id_t>(started.process), &info, WEXITED | WNOWAIT | WNOHANG) != 0) break;
    }
    ASSERT_EQ(WorkFolder::wait(started).exit_code, 0);
    EXPECT_EQ(c.judge("f.store", {c.all}), "");
    for (const std::string& bytes : taken) {
      c.begin_with("", "copy.store");
      c.folder.file("copy.store", bytes);
      const Outcome hash = c.run({"store", "digest", "copy.store"});
      ++copies;
      if (hash.exit_code == 0) {
        EXPECT_TRUE(states.contains(hash.out)) << hash.out;
      } else {
        ++refused;
        EXPECT_EQ(hash.exit_code, 3) << hash.signal << hash.err;
        EXPECT_NE(hash.err.find("copy.store"), std::string::npos) << hash.err;
      }
    }
  }
  std::cout << copies << " copies, " << refused << " refused\n";
  EXPECT_GT(copies, 2);
}

TEST(Circumstances, ASlowDiskAndAClockThatJumpsChangeNothing) {
  const Campaign& c = campaign();
  for (const char* how : {"FRESHET_FAULT=slow:1", "FRESHET_CLOCK_JUMPS=1"}) {
    c.begin_with("", "f.store");
    for (const std::vector<std::string>& arguments :
         {c.ingest("f.store", {"clip1.mkv", "clip2.mkv", "clip3.mkv"}), {"index", "f.store"}}) {
      const Outcome outcome = c.run_failing(arguments, {"FRESHET_FAULT_FILES=f.store", how});
      ASSERT_EQ(outcome.exit_code, 0) << how << ": " << outcome.err;
    }
    EXPECT_EQ(c.judge("f.store", {c.indexed}), "") << how;
  }
}

TEST(Circumstances, OfAReadOnlyMountAllCanBeReadAndNothingIsWritten) {
  const Campaign& c = campaign();
  if (c.folder.run({"unshare", "-rm", "sh", "-c", "mount -t tmpfs t /mnt"}).exit_code != 0)
    GTEST_SKIP() << "needs a mount of its own: run where unshare -rm and mount work";
  fs::remove_all(c.folder / "sealed");
  fs::create_directories(c.folder / "sealed");
  fs::copy_file(c.folder / "indexed.store", c.folder / "sealed/a.store");
  const auto there = [&](const std::vector<std::string>& arguments) {
    std::vector<std::string> command{
        "unshare",
        "-rm",
        "sh",
        "-c",
        "mount --bind sealed sealed && mount -o remount,bind,ro sealed && exec \"$@\"",
        "sh",
        executable()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return c.folder.run(command);
  };
  const Outcome hash = there({"store", "digest", "sealed/a.store"});
  EXPECT_EQ(hash.out, c.indexed) << hash.err;
  EXPECT_EQ(there({"store", "verify", "sealed/a.store"}).exit_code, 0);
  for (const std::vector<std::string>& arguments : {c.ingest("sealed/a.store", {"clip1.mkv"}),
                                                    c.ingest("sealed/new.store", {"clip1.mkv"}),
                                                    {"index", "sealed/a.store", "--rebuild"},
                                                    {"store", "compact", "sealed/a.store"}}) {
    const Outcome outcome = there(arguments);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_NE(outcome.err.find("sealed/"), std::string::npos) << outcome.err;
  }
  EXPECT_FALSE(fs::exists(c.folder / "sealed/a.store-lock"));
  fs::remove_all(c.folder / "sealed");
}

}  // namespace
}  // namespace freshet::tools
