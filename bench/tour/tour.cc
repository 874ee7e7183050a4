// bench/tour/tour.cc — how many frames a second does a camera give that goes through a film?
//
//   bench_tour [--sizes 960x540,1920x1080] [--frames 50] [--runs 3] [--json FILE]
//
// A drawn film of four frames, shown in turn from memory: each is taken apart, brought to its planes and seen from a
// camera that goes ahead, aside and up and turns. No decoder and no encoder runs. Outdoors is a floor and a sky; a room
// has five walls; three things stand upright, each of a fifth of the height, and what lies behind them moves. Before
// that the camera at rest is compared with the film, and one thread with all. Wall clock, the best of the runs,
// and the processor's time a frame, which tells what other programs took.

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/harness/arguments.h"
#include "bench/harness/frame_sizes.h"
#include "bench/harness/machine.h"
#include "synth/tour/path.h"
#include "synth/tour/renderer.h"

namespace {

namespace tour = freshet::synth::tour;
using freshet::bench::parse_sizes;
using freshet::bench::process_seconds;
using freshet::bench::wall_seconds;

std::vector<cv::Mat> draw_film(cv::Size size) {
  std::vector<cv::Mat> frames;
  for (int i = 0; i < 4; ++i) {
    cv::Mat coarse(size / 6 + cv::Size(2, 2), CV_8UC3), frame;
    cv::RNG(7).fill(coarse, cv::RNG::UNIFORM, 40, 200);
    cv::resize(coarse, frame, size, 0, 0, cv::INTER_CUBIC);
    frames.push_back(frame + cv::Scalar::all(5 * i));
  }
  return frames;
}

tour::Mesh mesh_of(cv::Size size, bool room) {
  const double w = size.width, h = size.height;
  tour::Mesh mesh{.picture = size, .vanishing = {0.5 * w, 0.4 * h}};
  mesh.back = room;
  if (room) mesh.left = 0.3 * w, mesh.top = 0.2 * h, mesh.right = 0.7 * w, mesh.bottom = 0.6 * h;
  return mesh;
}

std::vector<tour::Upright> draw_things(cv::Size size) {
  std::vector<tour::Upright> things;
  for (int i = 0; i < 3; ++i) {
    cv::Mat matte(size, CV_8U, cv::Scalar(0));
    const cv::Point middle(cvRound(size.width * (0.25 + 0.25 * i)), cvRound(size.height * (0.5 + 0.05 * i)));
    cv::ellipse(matte, middle, {cvRound(0.04 * size.height), cvRound(0.1 * size.height)}, 0, 0, 360, 255, -1);
    things.push_back({fmt::format("thing {}", i), matte, 8.0 - i});
  }
  return things;
}

struct Measured {
  double frames_per_s = 0, alone = 0;  // with all threads, with one
  double processor_ms = 0;             // a frame, with one
};

Measured measure(cv::Size size, bool room, bool things, int frames, int runs) {
  const std::vector<cv::Mat> film = draw_film(size);
  cv::Mat first;
  film[0].convertTo(first, CV_32F, 1 / 255.0);
  const tour::Room planes(mesh_of(size, room), "bench");
  tour::Scenery scenery(first, things ? draw_things(size) : std::vector<tour::Upright>{});
  const tour::Renderer renderer(planes, scenery, size);
  cv::Mat out(size, CV_8UC3), again(size, CV_8UC3);
  renderer.render(planes.own_camera(size), out);
  if (cv::norm(out, film[0], cv::NORM_INF) > 1)
    throw std::runtime_error("a camera at rest does not show the film");
  const tour::Path path({{0, {}},
                         {1, {.position = {0.2, 0.1, 0.5}, .yaw_deg = 4, .pitch_deg = -1}},
                         {2, {.position = {-0.2, 0.3, 1}, .yaw_deg = -3, .pitch_deg = 1}}},
                        true);
  const auto frame = [&](int i, cv::Mat& into) {
    scenery.show(film[static_cast<std::size_t>(i) % film.size()]);
    renderer.render(planes.camera(path.at(2.0 * i / frames), size), into);
  };
  double processor_s = 1e9;
  const auto best_of = [&] {
    double best = 1e9;
    for (int run = 0; run < runs; ++run) {
      const double begin = wall_seconds(), processor = process_seconds();
      for (int i = 0; i < frames; ++i) frame(i, out);
      best = std::min(best, wall_seconds() - begin);
      processor_s = std::min(processor_s, process_seconds() - processor);
    }
    return frames / best;
  };
  Measured measured;
  measured.frames_per_s = best_of();
  out.copyTo(again);
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  measured.alone = best_of();
  measured.processor_ms = 1e3 * processor_s / frames;
  if (cv::norm(out, again, cv::NORM_INF) != 0)
    throw std::runtime_error("one thread makes another frame than all");
  return measured;
}

}  // namespace

int main(int argc, char** argv) {
  freshet::bench::Arguments app("How many frames a second a camera gives that goes through a film");
  std::vector<std::string> sizes{"960x540", "1920x1080"};
  int frames = 50, runs = 3;
  std::string json_file;
  freshet::bench::add_sizes(app, sizes);
  app.option("--frames", frames, "Frames a run").between(1, 10000);
  app.option("--runs", runs, "Runs; the best counts").between(1, 100);
  app.option("--json", json_file, "Write the figures here too");
  app.parse(argc, argv);
  cv::setNumThreads(1);
  const freshet::bench::Machine machine = freshet::bench::this_machine();
  fmt::print("{}\n", freshet::bench::to_string(machine));
  nlohmann::json all{{"machine", freshet::bench::to_json(machine)},
                     {"frames", frames},
                     {"runs", runs},
                     {"rows", nlohmann::json::array()}};
  fmt::print("{:>11} {:>22} {:>9} {:>11} {:>7} {:>8}\n", "size", "scene", "frames/s", "one thread", "cpu ms",
             "peak MB");
  struct Kind {
    const char* name;
    bool room, things;
  };
  for (const cv::Size size : parse_sizes(sizes))
    for (const Kind& kind : {Kind{"outdoors", false, false}, Kind{"a room", true, false},
                             Kind{"outdoors, three things", false, true}}) {
      const Measured measured = measure(size, kind.room, kind.things, frames, runs);
      fmt::print("{:>11} {:>22} {:>9.1f} {:>11.1f} {:>7.1f} {:>8.0f}\n",
                 fmt::format("{}x{}", size.width, size.height), kind.name, measured.frames_per_s,
                 measured.alone, measured.processor_ms,
                 1e-6 * static_cast<double>(freshet::bench::peak_bytes()));
      std::fflush(stdout);
      all["rows"].push_back({{"width", size.width},
                             {"height", size.height},
                             {"scene", kind.name},
                             {"frames_per_s", measured.frames_per_s},
                             {"one_thread", measured.alone},
                             {"processor_ms", measured.processor_ms},
                             {"peak_bytes", freshet::bench::peak_bytes()}});
    }
  if (!json_file.empty()) std::ofstream(json_file) << all.dump(2) << "\n";
}
