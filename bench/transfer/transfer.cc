// Does appearance transfer keep the exemplar's look for 180 frames, does it hold together, what does it cost?
//
//   bench_transfer EXEMPLAR... [--frames 180] [--width 160] [--store STORE] [--write FOLDER]
//                  [--curve MPIX,...] [--json FILE] [--method NAME]... [--sheet PICTURE]
//
// EXEMPLAR is NAME[:GROUND][@DESIGN][*SPEED]. NAME: a picture, a folder of pictures, a video, a clip of the store, or
// a ready-made clip of synth/simulate (fire, waterfall, ...). GROUND: black or white, on which it stands.
// DESIGN: a preset of freshet synth simulate (plume, firepit, ...), or disc, which is lobed and turns.
// SPEED: every so many frames of a film; below 0 backwards; 0: its first frame alone, a still. A frame is three
// quarters as high as wide, an exemplar half as high as the frame: patches must repeat. First it checks what every
// frame promises: K and K + 1 uses only, no patch of the other segment. Then, by exemplar and method (uniform; nearest,
// which is Kwatra et al. 2005; stabilised, which is uniform of a video without its own motion; curved and diverging,
// which are uniform with a guide of weight 1; uniform without coherence; and the other papers' of Fig. 2 and 13, as
// rivals/rivals.h has them: discrete, bidirectional, occurrences, benard, browning), over the frames:
//   sharpness  mean squared Laplacian of grey, of the exemplar's
//   structure  mean square of what is 4 to 8 px in size, of the exemplar's
//   colours    L1 distance of colour histograms (8 x 8 x 8) from the exemplar's, 0 to 2
//   change     mean difference between a frame and the previous one carried along the flow, levels of 255
//   slip       motion of the film less the design's, by optical flow where there is fluid: mean length, and mean, px
//   curvature, divergence  of the design at a patch and of the exemplar at its source: correlation
// --method makes these methods alone. --sheet draws a row for each exemplar: itself, frames of its first method after
// each quarter of the time, and the film's middle column over time. Fig. 10 of Jamriska et al. 2015 has ten exemplars
// on one design; CLIP@fireball and CLIP@fireball*0 are their Fig. 11, a video beside a still of it.
// --curve 0.1,0.5,1 also makes frames of so many megapixels, all fluid, from the first exemplar, 360 px high,
// and prints seconds by stage, wall clock and processor time; of the second frame, which has a past, and
// above 1 megapixel of the first. Prints tables; --json has every frame's numbers.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/harness/arguments.h"
#include "bench/harness/machine.h"
#include "bench/transfer/rivals/rivals.h"
#include "freshet/error.h"
#include "media/frame/filmed_ground.h"
#include "media/picture/picture.h"
#include "report/sheet_words.h"
#include "store/store.h"
#include "synth/simulate/design/scene_file.h"
#include "synth/simulate/simulate.h"
#include "synth/transfer/features.h"
#include "synth/transfer/files/exemplar_files.h"
#include "synth/transfer/files/exemplar_motion.h"
#include "synth/transfer/files/extent.h"
#include "synth/transfer/forward_warp.h"
#include "synth/transfer/transfer.h"

namespace {

using namespace freshet;
using namespace freshet::synth::transfer;

struct Settings {
  std::vector<std::string> exemplars;
  int frames = 180, width = 160;
  std::filesystem::path store, write, json_file;
  std::vector<double> curve;  // megapixels
  std::set<std::string> methods;
  std::filesystem::path sheet;
  cv::Size size() const { return {width, width * 3 / 4}; }
};

struct Look {
  std::string name;
  std::vector<cv::Mat> frames;     // CV_32FC4
  std::vector<cv::Mat> back = {};  // ExemplarFrame::back
  bool is_light = false;           // filmed on black

  const cv::Mat& at(int t) const { return frames[index(t)]; }
  ExemplarFrame moment(int t) const { return {frames[index(t)], back[index(t)]}; }

 private:
  std::size_t index(int t) const {
    return static_cast<std::size_t>(std::clamp(t, 0, static_cast<int>(frames.size()) - 1));
  }
};

/// Averages light, not colours of what is not there.
cv::Mat scaled(const cv::Mat& bgra, double scale) {
  cv::Mat values = bgra.clone();
  const auto for_pixels = [](cv::Mat& picture, const auto& body) {
    for (int y = 0; y < picture.rows; ++y)
      for (int x = 0; x < picture.cols; ++x) body(picture.at<cv::Vec4f>(y, x));
  };
  for_pixels(values, [](cv::Vec4f& p) { p = {p[0] * p[3], p[1] * p[3], p[2] * p[3], p[3]}; });
  cv::resize(values, values, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  for_pixels(values, [](cv::Vec4f& p) {
    if (p[3] > 0) p = {p[0] / p[3], p[1] / p[3], p[2] / p[3], p[3]};
  });
  return values;
}

cv::Mat bgra_of(const synth::simulate::SimulatedFrame& frame) {
  std::vector<cv::Mat> planes;
  cv::split(frame.picture, planes);
  planes.push_back(frame.alpha);
  cv::Mat bgra;
  cv::merge(planes, bgra);
  bgra.convertTo(bgra, CV_32F, 1 / 255.0);
  return bgra;
}

void find_motion(Look& look) {
  for (std::size_t t = 0; t < look.frames.size(); ++t)
    if (t > 0)
      look.back.push_back(motion_between(look.frames[t], look.frames[t - 1], look.is_light));
    else if (look.frames.size() == 1)
      look.back.emplace_back(look.frames[t].size(), CV_32FC2, cv::Scalar::all(0));
    else
      look.back.push_back(-motion_between(look.frames[0], look.frames[1], look.is_light));
}

bool is_simulated(const std::string& name) {
  for (const synth::simulate::SceneKind kind : synth::simulate::all_clip_kinds())
    if (name == synth::simulate::scene_kind_name(kind)) return true;
  return false;
}

/// NAME[:GROUND][@DESIGN][*SPEED]
struct Asked {
  std::string name, ground = "none", design = "disc", speed = "1";
};
Asked parse_exemplar(std::string text) {
  Asked asked;
  const auto cut = [&](char mark, std::string& part) {
    const std::size_t at = text.rfind(mark);
    if (at == std::string::npos) return;
    part = text.substr(at + 1);
    text.resize(at);
  };
  cut('*', asked.speed);
  cut('@', asked.design);
  cut(':', asked.ground);
  asked.name = text;
  return asked;
}

/// As freshet synth transfer fits light to its design.
Extent extent_of_all(const std::vector<TargetFrame>& design) {
  constexpr int kSeen = 8;
  return mean_extent(static_cast<int>(design.size()), kSeen, {}, [&](int i) {
    cv::Mat alpha = design[static_cast<std::size_t>(i)].alpha;
    alpha.convertTo(alpha, CV_32F, alpha.depth() == CV_8U ? 1.0 / 255 : 1.0);
    return alpha;
  });
}

Look read_look(const Asked& asked, const std::vector<TargetFrame>& design, int height, int frames,
               const std::filesystem::path& store_path) {
  Look look{std::filesystem::path(asked.name).stem().string(), {}};
  if (is_simulated(asked.name)) {
    if (asked.speed != "1")
      throw Error(ErrorKind::kUsage, asked.name + "*" + asked.speed, "a simulated clip has no other speed",
                  "Leave *" + asked.speed + " out, or give a video");
    const cv::Size size(height * 8, height * 6);
    synth::simulate::Simulation scene(
        {.kind = synth::simulate::parse_scene_kind(asked.name), .size = size, .frames = frames, .seed = 5});
    for (synth::simulate::SimulatedFrame frame; scene.next(frame);)
      look.frames.push_back(scaled(bgra_of(frame), 1.0 / 6));
    find_motion(look);
    return look;
  }
  look.is_light = asked.ground == "black";
  const int speed = std::stoi(asked.speed);
  if (speed == 0) look.name += "_still";
  const ExemplarOptions options{.ground = media::parse_ground(asked.ground),
                                .frames = frames * std::max(1, std::abs(speed))};
  ExemplarFiles files =
      std::filesystem::exists(asked.name)
          ? ExemplarFiles(asked.name, options)
          : ExemplarFiles(store::Store::open_read(store_path).snapshot(), asked.name, options);
  if (!design.empty()) files.fit_body(extent_of_all(design), {});
  files.check();
  const bool moves = files.frames() > 1 && speed != 0;
  for (int t = 0; t < (moves ? frames : 1); ++t) {
    cv::Mat values;
    files.at(speed < 0 ? (frames - 1 - t) * -speed : t * speed).bgra.convertTo(values, CV_32F, 1 / 65535.0);
    look.frames.push_back(scaled(values, static_cast<double>(height) / values.rows));
  }
  find_motion(look);
  return look;
}

TargetFrame turning_disc(cv::Size size, int frame) {
  constexpr double kTurn = 0.02;  // radians per frame
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

std::vector<TargetFrame> design_of(const std::string& name, const Settings& settings) {
  std::vector<TargetFrame> all;
  if (name == "disc") {
    for (int t = 0; t < settings.frames; ++t) all.push_back(turning_disc(settings.size(), t));
    return all;
  }
  synth::simulate::SceneOptions scene =
      synth::simulate::parse_scene(synth::simulate::preset_scene(name), name);
  scene.size = settings.size(), scene.frames = settings.frames;
  synth::simulate::Simulation design(scene);
  for (synth::simulate::SimulatedFrame frame; design.next(frame);)
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

double structure(const cv::Mat& bgra) {
  cv::Mat grey, fine, coarse;
  cv::cvtColor(bgra, grey, cv::COLOR_BGRA2GRAY);
  cv::GaussianBlur(grey, fine, {}, 2);
  cv::GaussianBlur(grey, coarse, {}, 4);
  const cv::Mat band = fine - coarse;
  return cv::mean(band.mul(band), opaque_part(bgra))[0];
}

/// 512 shares, of opaque pixels.
std::vector<double> colours(const cv::Mat& bgra) {
  const cv::Mat whole = opaque_part(bgra);
  std::vector<double> fractions(512, 0);
  for (int y = 0; y < bgra.rows; ++y)
    for (int x = 0; x < bgra.cols; ++x) {
      if (!whole.at<std::uint8_t>(y, x)) continue;
      const cv::Vec4f& pixel = bgra.at<cv::Vec4f>(y, x);
      std::size_t bin = 0;
      for (int c = 0; c < 3; ++c)
        bin = 8 * bin + static_cast<std::size_t>(std::clamp(static_cast<int>(pixel[c] * 8), 0, 7));
      fractions[bin] += 1.0 / std::max(1, cv::countNonZero(whole));
    }
  return fractions;
}

double l1(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum;
}

/// Where there is fluid in both. Levels of 255.
double change(const cv::Mat& now, const cv::Mat& before, const TargetFrame& design_before) {
  synth::VectorGrid flow(now.cols, now.rows);
  for (int y = 0; y < now.rows; ++y)
    for (int x = 0; x < now.cols; ++x) {
      const cv::Vec2f by = design_before.flow.at<cv::Vec2f>(y, x);
      flow(x, y) = {by[0], by[1]};
    }
  const WarpedFrame warped = forward_warp(premultiplied(before), grid_of(design_before.alpha), flow);
  const PixelGrid shown = premultiplied(now);
  double sum = 0, pixels = 0;
  for (std::size_t i = 0; i < shown.values.size(); ++i) {
    if (shown.values[i].c[3] < 0.9f || warped.picture.values[i].c[3] < 0.9f) continue;
    for (int c = 0; c < 3; ++c)
      sum += static_cast<double>(std::abs(shown.values[i].c[c] - warped.picture.values[i].c[c])) / 3;
    ++pixels;
  }
  return pixels > 0 ? 255 * sum / pixels : 0;
}

/// Mean of the motion seen less the design's where there is fluid, and of its length, px a frame.
struct Slip {
  cv::Vec2d mean;
  double length = 0;
};
Slip slip(const cv::Mat& now, const cv::Mat& before, const cv::Mat& design_flow, bool is_light) {
  const cv::Mat off = motion_between(before, now, is_light) - design_flow;
  Slip sum;
  double pixels = 1e-9;
  for (int y = 0; y < now.rows; ++y)
    for (int x = 0; x < now.cols; ++x) {
      if (before.at<cv::Vec4f>(y, x)[3] < 0.9f) continue;
      sum.mean += cv::Vec2d(off.at<cv::Vec2f>(y, x));
      sum.length += cv::norm(off.at<cv::Vec2f>(y, x));
      ++pixels;
    }
  return {sum.mean / pixels, sum.length / pixels};
}

/// How the guides of targets go with those of the sources that they got: correlations, of all patches.
struct Agreement {
  double curvature = 0, divergence = 0;
};
double correlation(const std::vector<cv::Vec2d>& pairs) {
  cv::Vec2d mean;
  for (const cv::Vec2d& each : pairs) mean += each / static_cast<double>(pairs.size());
  double both = 0, first = 1e-12, second = 1e-12;
  for (const cv::Vec2d& each : pairs) {
    const cv::Vec2d off = each - mean;
    both += off[0] * off[1], first += off[0] * off[0], second += off[1] * off[1];
  }
  return both / std::sqrt(first * second);
}
Agreement agreement(const TransferredFrame& made, const TargetFrame& target, const ExemplarFrame& look) {
  const Guides of_target = guides_of(grid_of(target.alpha), vectors_of(target.flow), {}),
               of_look = guides_of(alpha_of(premultiplied(look.bgra)), vectors_of(-look.back), {});
  std::vector<cv::Vec2d> curvatures, divergences;
  for (int y = 0; y < made.nearest.rows; ++y)
    for (int x = 0; x < made.nearest.cols; ++x) {
      const cv::Vec3i of = made.nearest.at<cv::Vec3i>(y, x);
      if (of[0] < 0) continue;
      curvatures.emplace_back(of_target.curvature(x, y), of_look.curvature(of[0], of[1]));
      divergences.emplace_back(of_target.divergence(x, y), of_look.divergence(of[0], of[1]));
    }
  return {correlation(curvatures), correlation(divergences)};
}

struct Method {
  const char* name;
  TransferOptions options;
  std::optional<bench::Rival> rival = {};

  bool uniform() const { return !rival && options.retrieval == Retrieval::kUniform; }
};
std::vector<Method> methods() {
  return {{"uniform", {}},
          {"nearest", {.vote_power = 0.6, .retrieval = Retrieval::kNearest}},  // as Kwatra et al. vote
          {"stabilised", {.stabilised = true}},
          {"curved", {.curvature = 1}},
          {"diverging", {.divergence = 1}},
          {"no coherence", {.lambda = 0, .start = Start::kRandom}},
          {"discrete", {}, bench::Rival::kDiscrete},
          {"bidirectional", {}, bench::Rival::kBidirectional},
          {"occurrences", {}, bench::Rival::kOccurrences},
          {"benard", {}, bench::Rival::kBenard},
          {"browning", {}, bench::Rival::kBrowning}};
}

/// Makes the frames of a design, in order.
using NextFrame = std::function<TransferredFrame(std::size_t t)>;
NextFrame begin(const Method& method, const Look& look, const std::vector<TargetFrame>& design) {
  const Exemplar exemplar = [&](int t) { return look.moment(t); };
  if (method.rival) return bench::rival(*method.rival, exemplar, design);
  return [transfer = std::make_shared<Transfer>(exemplar, method.options), &design](std::size_t t) {
    return transfer->next(design[t]);
  };
}

/// Exemplars and their films, a row each.
class Sheet {
 public:
  void begin_row(const Look& look, cv::Size frame) {
    row_ = cv::Mat(frame.height + report::kSheetLine, (static_cast<int>(kShown) + 2) * frame.width, CV_8UC3,
                   cv::Scalar::all(report::kSheetPaper));
    report::write_caption(row_, look.name, {4, row_.rows - 5}, row_.cols - 8);
    const cv::Mat& first = look.at(0);
    put(scaled(first, std::min(1.0, static_cast<double>(frame.width) / first.cols)), 0, frame);
  }
  /// One of its frames, of so many: those after each quarter are kept.
  void add(const cv::Mat& bgra, std::size_t frame, std::size_t frames) {
    for (std::size_t column = 1; column <= kShown; ++column)
      if (frame + 1 == std::max<std::size_t>(1, column * frames / kShown))
        put(bgra, static_cast<int>(column) * bgra.cols, bgra.size());
    const auto at = [&](std::size_t t) {
      return static_cast<int>(t * static_cast<std::size_t>(bgra.cols) / frames);
    };
    for (int x = at(frame); x < at(frame + 1); ++x)
      put(bgra.col(bgra.cols / 2), (static_cast<int>(kShown) + 1) * bgra.cols + x, {1, bgra.rows});
  }
  void end_row() { sheet_.push_back(row_); }
  const cv::Mat& picture() const { return sheet_; }

 private:
  static constexpr std::size_t kShown = 4;

  void put(const cv::Mat& bgra, int left, cv::Size frame) {
    cv::Mat cell = row_({left, 0, frame.width, frame.height});
    for (int y = 0; y < std::min(bgra.rows, cell.rows); ++y)
      for (int x = 0; x < std::min(bgra.cols, cell.cols); ++x) {
        const cv::Vec4f& pixel = bgra.at<cv::Vec4f>(y, x);
        for (int c = 0; c < 3; ++c)
          cell.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<std::uint8_t>(255 * pixel[c] * pixel[3] +
                                                                        report::kSheetPaper * (1 - pixel[3]));
      }
  }

  cv::Mat row_, sheet_;
};

struct Series {
  std::vector<double> sharpness, structure, colours, change, slip, slip_x, slip_y, curvature, divergence;
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
           const Settings& settings, Sheet* sheet) {
  Series series;
  const NextFrame next = begin(method, look, design);
  cv::Mat before;
  for (std::size_t t = 0; t < design.size(); ++t) {
    const double start = bench::process_seconds();
    const TransferredFrame made = next(t);
    series.cpu_s += bench::process_seconds() - start;
    const cv::Mat& of = look.at(static_cast<int>(t));
    series.sharpness.push_back(sharpness(made.bgra) / sharpness(of));
    series.structure.push_back(structure(made.bgra) / structure(of));
    series.colours.push_back(l1(colours(made.bgra), colours(of)));
    const Agreement agreed = agreement(made, design[t], look.moment(static_cast<int>(t)));
    series.curvature.push_back(agreed.curvature);
    series.divergence.push_back(agreed.divergence);
    if (t > 0) {
      series.change.push_back(change(made.bgra, before, design[t - 1]));
      const Slip slipped = slip(made.bgra, before, design[t - 1].flow, look.is_light);
      series.slip.push_back(slipped.length);
      series.slip_x.push_back(slipped.mean[0]);
      series.slip_y.push_back(slipped.mean[1]);
    }
    series.not_uniform += !(made.boundary.uniform() && made.interior.uniform());
    series.violations += made.violations;
    before = made.bgra;
    if (sheet != nullptr) sheet->add(made.bgra, t, design.size());
    if (!settings.write.empty() && (t % 30 == 0 || t + 1 == design.size())) {
      cv::Mat bytes;
      made.bgra.convertTo(bytes, CV_8U, 255);
      media::write_picture(settings.write / fmt::format("{}_{}_{:03}.png", look.name, method.name, t), bytes);
    }
  }
  return series;
}

void curve(const Look& look, const std::vector<double>& sizes, nlohmann::json& json) {
  fmt::print(
      "\n| Mpix | wall s | CPU s | prepare | search | assign | vote | CPU s a Mpix |\n"
      "| --: | --: | --: | --: | --: | --: | --: | --: |\n");
  for (const double megapixels : sizes) {
    const int height = static_cast<int>(std::sqrt(megapixels * 1e6 * 3 / 4));
    const cv::Size size(height * 4 / 3, height);
    Transfer transfer([&](int) { return ExemplarFrame{look.at(0)}; }, {});
    const TargetFrame target{cv::Mat(size, CV_8U, cv::Scalar(255)),
                             cv::Mat(size, CV_32FC2, cv::Scalar(1, -1))};
    if (megapixels <= 1) transfer.next(target);
    const double start = bench::process_seconds();
    const double clock = bench::wall_seconds();
    const TransferredFrame made = transfer.next(target);
    const double cpu = bench::process_seconds() - start;
    const double wall = bench::wall_seconds() - clock;
    const TransferSeconds& s = made.seconds;
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

/// Four places are enough, and a quarter of the bytes.
void shorten(nlohmann::json& json) {
  if (json.is_number_float()) json = std::round(json.get<double>() * 1e4) / 1e4;
  if (json.is_structured())
    for (nlohmann::json& each : json) shorten(each);
}

void write_result(const Settings& settings, nlohmann::json json) {
  shorten(json);
  if (!settings.json_file.empty()) std::ofstream(settings.json_file) << json.dump() << '\n';
}

}  // namespace

int main(int argc, char** argv) try {
  Settings settings;
  bench::Arguments app("Does appearance transfer keep the exemplar's look, hold together, and at what cost?");
  app.option("EXEMPLAR", settings.exemplars, "NAME[:GROUND][@DESIGN][*SPEED]").required();
  app.option("--frames", settings.frames, "Of each run; 0: only the curve");
  app.option("--width", settings.width, "Of a frame, px");
  app.option("--store", settings.store, "Store of the clips that are named");
  app.option("--write", settings.write, "Folder for frames");
  app.option("--curve", settings.curve, "Sizes of one frame that are timed, Mpx").split_at(',').one_each();
  app.option("--json", settings.json_file, "Write the figures here");
  app.option("--method", settings.methods, "Only this one; all").one_each();
  app.option("--sheet", settings.sheet, "Draw the exemplars and their films here");
  app.parse(argc, argv);
  const bench::Machine machine = bench::this_machine();
  fmt::print("{}; {} x {} px, {} frames\n\n", to_string(machine), settings.width, settings.size().height,
             settings.frames);
  nlohmann::json json{
      {"machine", to_json(machine)}, {"runs", nlohmann::json::array()}, {"curve", nlohmann::json::array()}};
  fmt::print(
      "| exemplar | method | sharpness, frames 1-10 | last 30 | structure, 1-10 | last 30 | colours, 1-10 | "
      "last 30 | change | slip | slip x, y | curvature | divergence | not uniform | violations | CPU s per "
      "frame |\n"
      "| --- | --- | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |\n");
  int failed = 0;
  Sheet sheet;
  for (const std::string& name : settings.exemplars) {
    if (settings.frames < 1) break;
    const Asked asked = parse_exemplar(name);
    const std::vector<TargetFrame> design = design_of(asked.design, settings);
    const Look look = read_look(asked, design, settings.size().height / 2, settings.frames, settings.store);
    sheet.begin_row(look, settings.size());
    bool drawn = false;
    for (const Method& method : methods()) {
      if (!settings.methods.empty() && !settings.methods.contains(method.name)) continue;
      if (needs_motion(method.options) && look.frames.size() == 1) continue;
      const Series series = run(look, design, method, settings, drawn ? nullptr : &sheet);
      drawn = true;
      const std::size_t n = series.sharpness.size(), early = std::min<std::size_t>(n, 10),
                        late = n - std::min<std::size_t>(n, 30);
      failed += series.violations > 0 || (method.uniform() && series.not_uniform > 0);
      fmt::print(
          "| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.1f} | {:.2f} | {:.2f}, "
          "{:.2f} | {:.2f} | {:.2f} | {} | {} | {:.2f} |\n",
          look.name, method.name, mean(series.sharpness, 0, early), mean(series.sharpness, late, n),
          mean(series.structure, 0, early), mean(series.structure, late, n), mean(series.colours, 0, early),
          mean(series.colours, late, n), mean(series.change, 0, series.change.size()),
          mean(series.slip, 0, series.slip.size()), mean(series.slip_x, 0, series.slip_x.size()),
          mean(series.slip_y, 0, series.slip_y.size()), mean(series.curvature, 0, n),
          mean(series.divergence, 0, n), series.not_uniform, series.violations,
          series.cpu_s / static_cast<double>(n));
      std::fflush(stdout);
      json["runs"].push_back({{"exemplar", look.name},
                              {"design", asked.design},
                              {"size", {settings.width, settings.size().height}},
                              {"method", method.name},
                              {"sharpness", series.sharpness},
                              {"structure", series.structure},
                              {"colours", series.colours},
                              {"change", series.change},
                              {"slip", series.slip},
                              {"slip_x", series.slip_x},
                              {"slip_y", series.slip_y},
                              {"curvature", series.curvature},
                              {"divergence", series.divergence},
                              {"not_uniform", series.not_uniform},
                              {"violations", series.violations},
                              {"cpu_s", series.cpu_s}});
    }
    sheet.end_row();
  }
  if (!settings.sheet.empty()) media::write_picture(settings.sheet, sheet.picture());
  if (!settings.curve.empty())
    curve(read_look(parse_exemplar(settings.exemplars[0]), {}, 360, 1, settings.store), settings.curve,
          json["curve"]);
  write_result(settings, json);
  if (failed > 0) fmt::print(stderr, "{} runs broke the promise of uniform use\n", failed);
  return failed > 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
