// Does appearance transfer keep the exemplar's look for 180 frames, does it hold together, what does it cost?
//
//   bench_transfer EXEMPLAR... [--frames 180] [--width 160] [--design disc] [--write FOLDER] [--curve]
//
// EXEMPLAR is a picture with alpha, a folder of such (a clip), or the name of a scene of synth/simulate
// (fire, smoke, ink). The design is a lobed disc that turns, or such a scene; a frame is three quarters as
// high as wide. An exemplar is made as large as three quarters of the frame's height, so that patches must
// repeat. First it checks what every frame promises: K and K + 1 uses only, no patch of the other segment.
// Then, by exemplar and method (uniform; nearest, which is Kwatra et al. 2005; uniform without coherence),
// over the frames:
//   sharpness  mean squared Laplacian of grey, of the exemplar's
//   colours    L1 distance of colour histograms (8 x 8 x 8) from the exemplar's, 0 to 2
//   change     mean difference between a frame and the previous one carried along the flow, levels of 255
// --curve also makes frames of 0.1 to 4 megapixels, all fluid, from the first exemplar, 360 px high, and
// prints seconds by stage. Wall clock and processor time. Prints tables, and writes transfer.json, with every
// frame's numbers, into the present folder.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/machine.h"
#include "media/picture.h"
#include "media/picture_sequence.h"
#include "synth/simulate/simulate.h"
#include "synth/transfer/forward_warp.h"
#include "synth/transfer/transfer.h"

namespace {

using namespace freshet;
using namespace freshet::synth::transfer;

struct Settings {
  std::vector<std::string> exemplars;
  int frames = 180, width = 160;
  std::string design = "disc";
  std::filesystem::path write;
  bool curve = false;
  cv::Size size() const { return {width, width * 3 / 4}; }
};

struct Look {
  std::string name;
  std::vector<cv::Mat> frames;  // CV_32FC4

  /// There and back again: a loop without a jump.
  const cv::Mat& at(int t) const {
    const int n = static_cast<int>(frames.size());
    if (n == 1) return frames[0];
    const int k = std::max(t, 0) % (2 * n - 2);
    return frames[static_cast<std::size_t>(k < n ? k : 2 * n - 2 - k)];
  }
};

cv::Mat bgra_of(const synth::simulate::SimulatedFrame& frame) {
  std::vector<cv::Mat> planes;
  cv::split(frame.picture, planes);
  planes.push_back(frame.alpha);
  cv::Mat bgra;
  cv::merge(planes, bgra);
  bgra.convertTo(bgra, CV_32F, 1 / 255.0);
  return bgra;
}

synth::simulate::Simulation simulation(const std::string& name, cv::Size size, int frames) {
  return synth::simulate::Simulation(
      {.preset = synth::simulate::parse_preset(name), .size = size, .frames = frames, .seed = 5});
}

Look read_look(const std::string& name, int height, int frames) {
  Look look{std::filesystem::path(name).stem().string(), {}};
  if (!std::filesystem::exists(name)) {
    auto scene = simulation(name, {height * 4 / 3 / 16 * 16, height / 16 * 16}, frames);
    for (synth::simulate::SimulatedFrame frame; scene.next(frame);) look.frames.push_back(bgra_of(frame));
    return look;
  }
  std::vector<std::filesystem::path> files{name};
  if (std::filesystem::is_directory(name)) files = media::list_folder(name).files;
  for (const std::filesystem::path& file : files) {
    cv::Mat values = media::read_deep_picture(file).values, small;
    values.convertTo(values, CV_32F, 1 / 65535.0);
    const double scale = static_cast<double>(height) / values.rows;
    cv::resize(values, small, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
    look.frames.push_back(small);
  }
  return look;
}

TargetFrame turning_disc(cv::Size size, int frame) {
  constexpr double kTurn = 0.02;  // radians a frame
  TargetFrame made{cv::Mat(size, CV_32F, cv::Scalar(0)), cv::Mat(size, CV_32FC2, cv::Scalar::all(0))};
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double dx = x - 0.5 * size.width, dy = y - 0.5 * size.height,
                   angle = std::atan2(dy, dx) - kTurn * frame;
      const double edge =
          0.4 * size.height * (1 + 0.15 * std::sin(5 * angle) + 0.08 * std::sin(9 * angle + 1));
      const double alpha = std::clamp((edge - std::hypot(dx, dy)) / 3 + 0.5, 0.0, 1.0);
      made.alpha.at<float>(y, x) = static_cast<float>(alpha);
      if (alpha > 0)
        made.flow.at<cv::Vec2f>(y, x) = {static_cast<float>(-dy * kTurn), static_cast<float>(dx * kTurn)};
    }
  return made;
}

std::vector<TargetFrame> design_of(const Settings& settings) {
  std::vector<TargetFrame> all;
  if (settings.design == "disc") {
    for (int t = 0; t < settings.frames; ++t) all.push_back(turning_disc(settings.size(), t));
    return all;
  }
  auto scene = simulation(settings.design, settings.size(), settings.frames);
  for (synth::simulate::SimulatedFrame frame; scene.next(frame);)
    all.push_back({frame.alpha.clone(), frame.motion.clone()});
  return all;
}

cv::Mat opaque_part(const cv::Mat& bgra) {
  std::vector<cv::Mat> planes;
  cv::split(bgra, planes);
  cv::Mat whole = planes[3] > 0.9;
  cv::erode(whole, whole, cv::Mat::ones(3, 3, CV_8U));
  return whole;
}

double sharpness(const cv::Mat& bgra) {
  cv::Mat grey, laplacian;
  cv::cvtColor(bgra, grey, cv::COLOR_BGRA2GRAY);
  cv::Laplacian(grey, laplacian, CV_32F);
  return cv::mean(laplacian.mul(laplacian), opaque_part(bgra))[0];
}

/// 512 shares, of opaque pixels.
std::vector<double> colours(const cv::Mat& bgra) {
  const cv::Mat whole = opaque_part(bgra);
  std::vector<double> shares(512, 0);
  for (int y = 0; y < bgra.rows; ++y)
    for (int x = 0; x < bgra.cols; ++x) {
      if (!whole.at<std::uint8_t>(y, x)) continue;
      const cv::Vec4f& pixel = bgra.at<cv::Vec4f>(y, x);
      std::size_t bin = 0;
      for (int c = 0; c < 3; ++c)
        bin = 8 * bin + static_cast<std::size_t>(std::clamp(static_cast<int>(pixel[c] * 8), 0, 7));
      shares[bin] += 1.0 / std::max(1, cv::countNonZero(whole));
    }
  return shares;
}

double l1(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum;
}

/// Where there is fluid in both. Levels of 255.
double change(const cv::Mat& now, const cv::Mat& before, const TargetFrame& design_before) {
  VectorGrid flow(now.cols, now.rows);
  for (int y = 0; y < now.rows; ++y)
    for (int x = 0; x < now.cols; ++x) {
      const cv::Vec2f by = design_before.flow.at<cv::Vec2f>(y, x);
      flow(x, y) = {by[0], by[1]};
    }
  const WarpedFrame warped = forward_warp(premultiplied(before), grid_of(design_before.alpha), flow);
  const Picture shown = premultiplied(now);
  double sum = 0, pixels = 0;
  for (std::size_t i = 0; i < shown.values.size(); ++i) {
    if (shown.values[i].c[3] < 0.9f || warped.picture.values[i].c[3] < 0.9f) continue;
    for (int c = 0; c < 3; ++c)
      sum += static_cast<double>(std::abs(shown.values[i].c[c] - warped.picture.values[i].c[c])) / 3;
    ++pixels;
  }
  return pixels > 0 ? 255 * sum / pixels : 0;
}

struct Method {
  const char* name;
  TransferOptions options;
};
std::vector<Method> methods() {
  return {{"uniform", {}},
          {"nearest", {.vote_power = 0.6, .retrieval = Retrieval::kNearest}},  // as Kwatra et al. vote
          {"no coherence", {.lambda = 0, .start = Start::kRandom}}};
}

struct Series {
  std::vector<double> sharpness, colours, change;
  int not_uniform = 0;
  std::int64_t violations = 0;
  double cpu_s = 0;
};

double mean(const std::vector<double>& of, std::size_t from, std::size_t to) {
  double sum = 0;
  for (std::size_t i = from; i < to; ++i) sum += of[i];
  return to > from ? sum / static_cast<double>(to - from) : 0;
}

Series run(const Look& look, const std::vector<TargetFrame>& design, const Method& method,
           const Settings& settings) {
  Series series;
  Transfer transfer([&](int t) { return ExemplarFrame{look.at(t), {}}; }, method.options);
  cv::Mat before;
  for (std::size_t t = 0; t < design.size(); ++t) {
    const double start = bench::process_seconds();
    const TransferredFrame made = transfer.next(design[t]);
    series.cpu_s += bench::process_seconds() - start;
    const cv::Mat& of = look.at(static_cast<int>(t));
    series.sharpness.push_back(sharpness(made.bgra) / sharpness(of));
    series.colours.push_back(l1(colours(made.bgra), colours(of)));
    if (t > 0) series.change.push_back(change(made.bgra, before, design[t - 1]));
    series.not_uniform += !(made.boundary.uniform() && made.interior.uniform());
    series.violations += made.violations;
    before = made.bgra;
    if (!settings.write.empty() && (t % 30 == 0 || t + 1 == design.size())) {
      cv::Mat bytes;
      made.bgra.convertTo(bytes, CV_8U, 255);
      media::write_picture(settings.write / fmt::format("{}_{}_{:03}.png", look.name, method.name, t), bytes);
    }
  }
  return series;
}

void curve(const Look& look, nlohmann::json& json) {
  fmt::print(
      "\n| Mpix | wall s | CPU s | prepare | search | assign | vote | CPU s a Mpix |\n"
      "| --: | --: | --: | --: | --: | --: | --: | --: |\n");
  for (const double megapixels : {0.1, 0.25, 0.5, 1.0, 2.0, 4.0}) {
    const int height = static_cast<int>(std::sqrt(megapixels * 1e6 * 3 / 4));
    const cv::Size size(height * 4 / 3, height);
    Transfer transfer([&](int) { return ExemplarFrame{look.at(0), {}}; }, {});
    const TargetFrame target{cv::Mat(size, CV_8U, cv::Scalar(255)),
                             cv::Mat(size, CV_32FC2, cv::Scalar(1, -1))};
    transfer.next(target);
    // The second frame: the first has no past.
    const double start = bench::process_seconds();
    const auto clock = std::chrono::steady_clock::now();
    const TransferredFrame made = transfer.next(target);
    const double cpu = bench::process_seconds() - start;
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
    const StageSeconds& s = made.seconds;
    fmt::print("| {:.2f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} |\n", megapixels,
               wall, cpu, s.prepare, s.search, s.assign, s.vote, cpu / megapixels);
    std::fflush(stdout);
    json.push_back({{"mpix", megapixels},
                    {"wall_s", wall},
                    {"cpu_s", cpu},
                    {"prepare_s", s.prepare},
                    {"search_s", s.search},
                    {"assign_s", s.assign},
                    {"vote_s", s.vote}});
  }
}

Settings parse(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--curve")
      settings.curve = true;
    else if (word == "--frames" && i + 1 < argc)
      settings.frames = std::stoi(argv[++i]);
    else if (word == "--width" && i + 1 < argc)
      settings.width = std::stoi(argv[++i]);
    else if (word == "--design" && i + 1 < argc)
      settings.design = argv[++i];
    else if (word == "--write" && i + 1 < argc)
      settings.write = argv[++i];
    else
      settings.exemplars.push_back(word);
  }
  return settings;
}

}  // namespace

int main(int argc, char** argv) try {
  const Settings settings = parse(argc, argv);
  if (settings.exemplars.empty()) {
    fmt::print(stderr,
               "usage: bench_transfer EXEMPLAR... [--frames N] [--width PX] [--design NAME] [--write FOLDER] "
               "[--curve]\n");
    return 2;
  }
  const bench::Machine machine = bench::this_machine();
  fmt::print("{}; {} x {} px, {} frames of {}\n\n", to_string(machine), settings.width,
             settings.size().height, settings.frames, settings.design);
  nlohmann::json json{
      {"machine", to_json(machine)}, {"runs", nlohmann::json::array()}, {"curve", nlohmann::json::array()}};
  const std::vector<TargetFrame> design = design_of(settings);
  fmt::print(
      "| exemplar | method | sharpness, frames 1-10 | last 30 | colours, 1-10 | last 30 | change | not "
      "uniform | violations | CPU s a frame |\n"
      "| --- | --- | --: | --: | --: | --: | --: | --: | --: | --: |\n");
  int failed = 0;
  for (const std::string& name : settings.exemplars) {
    const Look look = read_look(name, settings.size().height * 3 / 4, settings.frames);
    for (const Method& method : methods()) {
      const Series series = run(look, design, method, settings);
      const std::size_t n = series.sharpness.size(), early = std::min<std::size_t>(n, 10),
                        late = n - std::min<std::size_t>(n, 30);
      const bool must_be_uniform = method.options.retrieval == Retrieval::kUniform;
      failed += series.violations > 0 || (must_be_uniform && series.not_uniform > 0);
      fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.1f} | {} | {} | {:.2f} |\n", look.name,
                 method.name, mean(series.sharpness, 0, early), mean(series.sharpness, late, n),
                 mean(series.colours, 0, early), mean(series.colours, late, n),
                 mean(series.change, 0, series.change.size()), series.not_uniform, series.violations,
                 series.cpu_s / static_cast<double>(n));
      std::fflush(stdout);
      json["runs"].push_back({{"exemplar", look.name},
                              {"method", method.name},
                              {"sharpness", series.sharpness},
                              {"colours", series.colours},
                              {"change", series.change},
                              {"not_uniform", series.not_uniform},
                              {"violations", series.violations},
                              {"cpu_s", series.cpu_s}});
    }
  }
  if (settings.curve) curve(read_look(settings.exemplars[0], 360, 1), json["curve"]);
  std::ofstream("transfer.json") << json.dump(2) << '\n';
  if (failed > 0) fmt::print(stderr, "{} runs broke the promise of uniform use\n", failed);
  return failed > 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
