// bench/scene/scene_spectrum.cc — does a still, animated as a tree or as water, move in time as the real clip does?
//
//   bench_scene_spectrum CASE [CASE..] [--frames 90] [--width 480] [--amplitudes .25,.5,1,2,4,8] [--json FILE]
//   CASE   CLIP:tree:LEFT,TOP,RIGHT,BOTTOM:ROOT_X,ROOT_Y,TIP_X,TIP_Y[,ROOT_X..][:KEYS]   several armatures one after
//          the other; the baseline sways on the first
//          CLIP:water:LEFT,TOP,RIGHT,BOTTOM:HORIZON_Y[:KEYS]     places in fractions of the picture
//          KEYS   of the layer, as scene files have them, separated by ';': "frequency = 1.2;mass = 3"
//
// The first half of a clip is the truth, its first frame the still. Of the region: power of each pixel's luma over time,
// and of its flow (DIS), averaged over the pixels; log-spectral distance in dB (root of the mean squared difference of
// decibels over all frequencies above 0), their mean difference (level), the slope of decibels over decades above half a
// hertz, and the peak. Beside it: the clip's other half (no model can be expected to be nearer), a plain sum of three
// sinusoids on the same armature or plane (the baseline), and the still itself. What a person sets by eye, the
// amplitude, is the best of several for the model and for the baseline alike; all else is the scene's.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "media/frame/frame.h"
#include "media/video/video_reader.h"
#include "synth/scene/motion/tree_sway.h"
#include "synth/scene/motion/water_surface.h"
#include "synth/scene/rendering/scene_animation.h"
#include "synth/scene/scene_file.h"
#include "synth/scene/scene_marks.h"
#include "vision/flow.h"

namespace {

namespace scene = freshet::synth::scene;
constexpr double kTurn = 2 * std::numbers::pi;

struct Case {
  std::string clip, motion, keys;
  cv::Rect2d region;
  std::vector<double> line;
};

/// As many as `count`, or several times as many.
std::vector<double> numbers(const std::string& text, std::size_t count, bool several = false) {
  std::vector<double> out;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) out.push_back(std::stod(part));
  if (out.empty() || out.size() % count != 0 || (!several && out.size() != count))
    throw CLI::ValidationError("CASE", fmt::format("{}: {} numbers expected", text, count));
  return out;
}

Case parse_case(const std::string& text) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, ':');) parts.push_back(part);
  if (parts.size() < 4 || (parts[1] != "tree" && parts[1] != "water"))
    throw CLI::ValidationError("CASE", text);
  Case one{.clip = parts[0],
           .motion = parts[1],
           .keys = parts.size() > 4 ? parts[4] : "",
           .region = {},
           .line = {}};
  const std::vector<double> box = numbers(parts[2], 4);
  one.region = {box[0], box[1], box[2] - box[0], box[3] - box[1]};
  one.line = numbers(parts[3], one.motion == "tree" ? 4 : 1, one.motion == "tree");
  std::replace(one.keys.begin(), one.keys.end(), ';', '\n');
  return one;
}

struct Clip {
  std::vector<cv::Mat> bgr;
  double fps = 25;
};
Clip read_clip(const std::string& file, int frames, int width) {
  freshet::media::VideoReader reader(file);
  Clip clip;
  clip.fps = static_cast<double>(reader.info().fps_num) / static_cast<double>(reader.info().fps_den);
  while (static_cast<int>(clip.bgr.size()) < frames) {
    const auto frame = reader.next();
    if (!frame) break;
    cv::Mat bgr = freshet::media::to_bgr(*frame);
    const int height = static_cast<int>(std::lround(1.0 * bgr.rows * width / bgr.cols));
    cv::resize(bgr, bgr, {width, height}, 0, 0, cv::INTER_AREA);
    clip.bgr.push_back(bgr);
  }
  return clip;
}

/// Decibels by frequency, bins 1.. of the frames' length.
struct Spectrum {
  std::vector<double> luma, flow;
};

/// Mean power of many series, each a row of `values`.
std::vector<double> decibels(cv::Mat values) {
  const int n = values.cols;
  cv::Mat mean, window(1, n, CV_32F);
  for (int t = 0; t < n; ++t)
    window.at<float>(t) = static_cast<float>(0.5 - 0.5 * std::cos(kTurn * (t + 0.5) / n));
  cv::reduce(values, mean, 1, cv::REDUCE_AVG, CV_32F);
  for (int r = 0; r < values.rows; ++r) {
    cv::Mat row = values.row(r);
    row = (row - mean.at<float>(r)).mul(window);
  }
  cv::Mat spectrum;
  cv::dft(values, spectrum, cv::DFT_ROWS | cv::DFT_COMPLEX_OUTPUT);
  std::vector<double> power(static_cast<std::size_t>(n / 2), 1e-12);
  for (int r = 0; r < values.rows; ++r)
    for (int k = 1; k <= n / 2; ++k) {
      const cv::Vec2f v = spectrum.at<cv::Vec2f>(r, k);
      power[static_cast<std::size_t>(k - 1)] += v.dot(v) / values.rows / n;
    }
  for (double& p : power) p = 10 * std::log10(p);
  return power;
}

Spectrum spectrum_of(const std::vector<cv::Mat>& frames, const cv::Rect& region) {
  const int n = static_cast<int>(frames.size());
  std::vector<cv::Mat> grey;
  for (const cv::Mat& bgr : frames) {
    cv::Mat one;
    cv::cvtColor(bgr, one, cv::COLOR_BGR2GRAY);
    grey.push_back(one);
  }
  cv::Mat luma(region.area(), n, CV_32F), flow(2 * region.area(), n - 1, CV_32F);
  for (int t = 0; t < n; ++t) {
    cv::Mat column;
    grey[static_cast<std::size_t>(t)](region).clone().reshape(1, region.area()).convertTo(column, CV_32F);
    column.copyTo(luma.col(t));
    if (t + 1 == n) break;
    const cv::Mat motion = freshet::vision::optical_flow(grey[static_cast<std::size_t>(t)],
                                                         grey[static_cast<std::size_t>(t) + 1]);
    motion(region).clone().reshape(1, 2 * region.area()).copyTo(flow.col(t));
  }
  return {decibels(luma), decibels(flow)};
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

/// By how much a is above b on average, dB: what moves too much is above 0.
double level(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] - b[k];
  return sum / static_cast<double>(a.size());
}

/// dB a decade above half a hertz.
double slope(const std::vector<double>& power, double step_hz) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t k = 0; k < power.size(); ++k) {
    const double f = step_hz * static_cast<double>(k + 1), x = std::log10(f);
    if (f < 0.5) continue;
    n += 1, sx += x, sy += power[k], sxx += x * x, sxy += x * power[k];
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}
double peak(const std::vector<double>& power, double step_hz) {
  return step_hz * static_cast<double>(std::max_element(power.begin(), power.end()) - power.begin() + 1);
}

/// Three sinusoids, as one would set them by hand: the armature sways, or the plane's rows go up and down in waves.
class Sinusoids : public scene::Motion {
 public:
  Sinusoids(const Case& of, cv::Size size, double fps, double amplitude)
      : of_(of), size_(size), fps_(fps), amplitude_(amplitude) {}
  void go_to(int frame) override { seconds_ = frame / fps_; }
  float reach() const override { return 200; }
  void row(int, int x, int y, int n, float* dx, float* dy) const override {
    constexpr std::array kHz{0.5, 1.1, 1.9}, kPart{1.0, 0.6, 0.3};
    for (int i = 0; i < n; ++i) {
      dx[i] = dy[i] = 0;
      const double px = x + i + 0.5, py = y + 0.5;
      if (of_.motion == "tree") {
        const cv::Point2d root(of_.line[0] * size_.width, of_.line[1] * size_.height),
            tip(of_.line[2] * size_.width, of_.line[3] * size_.height);
        double sway = 0;
        for (std::size_t j = 0; j < 3; ++j)
          sway += kPart[j] * std::sin(kTurn * kHz[j] * seconds_ + 2.0 * static_cast<double>(j));
        const double length = std::hypot(tip.x - root.x, tip.y - root.y);
        const double turn =
            0.03 * amplitude_ * sway *
            scene::bend_by_distance(static_cast<float>(std::hypot(px - root.x, py - root.y) / length));
        dx[i] = static_cast<float>((px - root.x) * (std::cos(turn) - 1) + (py - root.y) * std::sin(turn));
        dy[i] = static_cast<float>((py - root.y) * (std::cos(turn) - 1) - (px - root.x) * std::sin(turn));
        continue;
      }
      const double below = std::max(0.0, py - of_.line[0] * size_.height);
      for (std::size_t j = 0; j < 3; ++j)
        dy[i] += static_cast<float>(
            0.01 * amplitude_ * kPart[j] * below *
            std::sin(kTurn * (kHz[j] * seconds_ + 60 * (1.0 + static_cast<double>(j)) / (below + 10)) +
                     0.02 * px * static_cast<double>(j)));
    }
  }

 private:
  Case of_;
  cv::Size size_;
  double fps_, amplitude_, seconds_ = 0;
};

std::vector<cv::Mat> baseline(const Case& of, const cv::Mat& still, int frames, double fps,
                              double amplitude) {
  cv::Mat coded;
  still.convertTo(coded, CV_32F, 1 / 255.0);
  const scene::Sprite sprite =
      scene::make_sprite(coded, cv::Mat(still.size(), CV_32F, cv::Scalar(1)), scene::Outline::kMoves);
  Sinusoids motion(of, still.size(), fps, amplitude);
  std::vector<cv::Mat> out;
  for (int t = 0; t < frames; ++t) {
    motion.go_to(t);
    const scene::MovedSprite moved{&sprite, &motion};
    cv::Mat frame(still.size(), CV_8UC3);
    scene::composite(std::span(&moved, 1), frame);
    out.push_back(frame);
  }
  return out;
}

std::string armatures(const Case& of, cv::Size size) {
  std::string rows;
  for (std::size_t i = 0; i < of.line.size(); i += 2)
    rows += fmt::format("{}{}, {}{}", i % 4 == 0 ? "[" : ", ", of.line[i] * size.width,
                        of.line[i + 1] * size.height, i % 4 == 0 ? "" : "], ");
  return fmt::format("armature = [{}]\n", rows);
}

std::vector<cv::Mat> model(const Case& of, const cv::Mat& still, int frames, double fps, double amplitude) {
  const double w = still.cols, h = still.rows;
  std::string text = fmt::format(
      "picture = \"p\"\nframes = {}\nfps = {}\n[[layer]]\nname = \"all\"\nmatte = \"rest\"\nmotion = "
      "\"{}\"\n{}\n",
      frames, fps, of.motion, of.keys);
  text += of.motion == "tree" ? armatures(of, still.size())
                              : fmt::format("horizon = [0, {}, {}, {}]\nedge = \"held\"\n", of.line[0] * h, w,
                                            of.line[0] * h);
  scene::Scene asked = scene::parse_scene(text, "case.toml");
  if (auto* const tree = asked.layers[0].as<scene::TreeMotion>()) tree->mass /= amplitude;
  cv::Mat coded, alpha(still.size(), CV_32F, cv::Scalar(1));
  still.convertTo(coded, CV_32F, 1 / 255.0);
  if (of.motion == "water") alpha.rowRange(0, std::max(0, static_cast<int>(of.line[0] * h))).setTo(0);
  scene::read_marks(asked, still.size());
  if (auto* const water = asked.layers[0].as<scene::WaterMotion>()) {
    // As the scene does, for the usual amplitude follows from it.
    water->focal_px = water->focal_or_usual(still.size());
    if (!water->mapping)
      water->mapping = scene::mapping_seen(*water, {0, 0, still.cols, still.rows}, still.size());
    water->amplitude = amplitude * water->amplitude_or_usual();
  }
  const std::vector<scene::LayerPixels> pixels{{coded, alpha}};
  scene::SceneAnimation animation(asked, pixels, still.size());
  std::vector<cv::Mat> out;
  for (int t = 0; t < frames; ++t) {
    cv::Mat frame(still.size(), CV_8UC3);
    animation.render(t, frame);
    out.push_back(frame.clone());
  }
  return out;
}

struct Judged {
  std::string name;
  Spectrum spectrum;
  double amplitude = 1;
};

void judge(const Case& of, int frames, int width, const std::vector<double>& amplitudes,
           nlohmann::json& rows) {
  const Clip clip = read_clip(of.clip, 2 * frames, width);
  const int half = static_cast<int>(clip.bgr.size()) / 2;
  if (half < 16) throw std::runtime_error(of.clip + ": too short");
  const cv::Mat still = clip.bgr[0];
  const cv::Rect region =
      cv::Rect(cvRound(of.region.x * still.cols), cvRound(of.region.y * still.rows),
               cvRound(of.region.width * still.cols), cvRound(of.region.height * still.rows)) &
      cv::Rect({0, 0}, still.size());
  const Spectrum truth = spectrum_of({clip.bgr.begin(), clip.bgr.begin() + half}, region);
  std::vector<Judged> all{
      {"clip", truth},
      {"other half", spectrum_of({clip.bgr.begin() + half, clip.bgr.begin() + 2 * half}, region)}};
  for (const bool ours : {true, false}) {
    Judged best{ours ? "scene" : "3 sinusoids", {}, 0};
    double nearest = 1e9;
    for (const double amplitude : amplitudes) {
      const Spectrum found = spectrum_of(
          ours ? model(of, still, half, clip.fps, amplitude) : baseline(of, still, half, clip.fps, amplitude),
          region);
      const double far = distance(found.luma, truth.luma) + distance(found.flow, truth.flow);
      if (far >= nearest) continue;
      nearest = far;
      best.spectrum = found, best.amplitude = amplitude;
    }
    all.push_back(best);
  }
  all.push_back({"still", spectrum_of(std::vector<cv::Mat>(static_cast<std::size_t>(half), still), region)});
  fmt::print("{} as {}, {} frames at {:.4g}/s, {} x {} px of {} x {}\n", of.clip, of.motion, half, clip.fps,
             region.width, region.height, still.cols, still.rows);
  fmt::print("  {:<12} {:>9} {:>9} {:>7} {:>7} {:>11} {:>11} {:>9} {:>9} {:>6}\n", "", "luma dB", "flow dB",
             "level", "level", "luma slope", "flow slope", "peak Hz", "flow Hz", "x");
  const double step = clip.fps / half, flow_step = clip.fps / (half - 1);
  for (const Judged& one : all) {
    const double luma = distance(one.spectrum.luma, truth.luma),
                 flow = distance(one.spectrum.flow, truth.flow);
    fmt::print("  {:<12} {:>9.2f} {:>9.2f} {:>7.1f} {:>7.1f} {:>11.1f} {:>11.1f} {:>9.2f} {:>9.2f} {:>6}\n",
               one.name, luma, flow, level(one.spectrum.luma, truth.luma),
               level(one.spectrum.flow, truth.flow), slope(one.spectrum.luma, step),
               slope(one.spectrum.flow, flow_step), peak(one.spectrum.luma, step),
               peak(one.spectrum.flow, flow_step), one.amplitude);
    rows.push_back({{"clip", of.clip},
                    {"what", one.name},
                    {"luma_db", luma},
                    {"flow_db", flow},
                    {"luma_spectrum", one.spectrum.luma},
                    {"flow_spectrum", one.spectrum.flow}});
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Whether animated stills move in time as real clips do");
  std::vector<std::string> cases;
  int frames = 90, width = 480;
  std::vector<double> amplitudes{0.25, 0.5, 1, 2, 4, 8};
  std::string json_file;
  app.add_option("CASE", cases, "CLIP:MOTION:REGION:LINE[:KEYS]")->required();
  app.add_option("--frames", frames, "Frames of each half, at most")
      ->check(CLI::Range(16, 1000))
      ->capture_default_str();
  app.add_option("--width", width, "Clips are reduced to it, px")
      ->check(CLI::Range(64, 4096))
      ->capture_default_str();
  app.add_option("--amplitudes", amplitudes,
                 "Factors of the amplitude; the best counts, of 1 alone the default")
      ->delimiter(',')
      ->check(CLI::Range(1e-3, 1e3))
      ->capture_default_str();
  app.add_option("--json", json_file, "Write figures and spectra here too");
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  nlohmann::json rows = nlohmann::json::array();
  for (const std::string& text : cases) judge(parse_case(text), frames, width, amplitudes, rows);
  if (!json_file.empty()) std::ofstream(json_file) << rows.dump(1) << "\n";
}
