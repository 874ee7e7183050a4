// How well is a picture taken apart: alpha, the colours of what is cut out, what is filled in behind it, in what time?
//
//   bench_layers PICTURE PICTURE... [--write FOLDER] [--json FILE] [--only alpha|fill|time]
//
// Composites whose layers are known: of each picture with the next one's colours in front of it, as a drawn tree, a
// drawn outline and a simulated smoke (900 px wide, 8 bits). It checks first that the layers give the picture. Then, by
// method:
// - alpha: SAD in the trimap's unsure part, 1000 px; root mean square error of the foreground's colour there, times
//   alpha, in levels of 255; the same of the layer laid over plain grey: what an eye sees when it moves. CPU seconds.
// - fill: PSNR and SSIM against what is really behind, in the stripe of 24 px that motion uncovers, and how much of its
//   gradients' energy is there (1: as sharp). CPU seconds.
// - time: wall-clock seconds and peak memory of a scene of 24 layers at 900 x 675.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/choices/known_layers.h"
#include "bench/harness/arguments.h"
#include "bench/harness/machine.h"
#include "bench/quality/quality_measures.h"
#include "media/picture/picture.h"
#include "synth/outline/background.h"
#include "synth/scene/layers/cut_layers.h"

namespace {

using namespace freshet;
using namespace freshet::synth::scene;

constexpr int kStripe = 24;
int wide = 900;

cv::Mat wide_picture(const std::filesystem::path& path) {
  cv::Mat bgr = media::read_picture(path).bgr, out;
  const double scale = static_cast<double>(wide) / bgr.cols;
  cv::resize(bgr, bgr, {wide, cvRound(std::min(0.75 * wide, bgr.rows * scale))}, 0, 0, cv::INTER_AREA);
  bgr.convertTo(out, CV_32F, 1 / 255.0);
  return out;
}

std::vector<bench::KnownLayers> known_cases(const std::vector<std::string>& paths, bool smoke) {
  std::vector<bench::KnownLayers> cases;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const std::string name = std::filesystem::path(paths[i]).stem().string();
    const cv::Mat behind = wide_picture(paths[i]);
    cv::Mat front = wide_picture(paths[(i + 1) % paths.size()]);
    cv::resize(front, front, behind.size());
    const cv::Size size = behind.size();
    const cv::Point2d middle(0.45 * size.width, 0.55 * size.height);
    cases.push_back(bench::laid_over(name + ", tree", front, bench::drawn_tree(size, i + 1), behind, 3));
    cases.push_back(bench::laid_over(name + ", outline", front,
                                     bench::drawn_outline(size, middle, 0.22, i + 1), behind, 7));
    if (!smoke) continue;
    cv::Mat pale;
    cv::GaussianBlur(front, pale, {}, 25);
    cases.push_back(bench::laid_over(name + ", smoke", 0.5 * pale + cv::Scalar::all(0.45),
                                     bench::simulated_smoke(size, i + 1), behind, 3));
  }
  return cases;
}

cv::Mat over_grey(const cv::Mat& colour, const cv::Mat& alpha) {
  std::vector<cv::Mat> channels;
  cv::split(colour, channels);
  for (cv::Mat& channel : channels) channel = channel.mul(alpha) + 0.5 * (1 - alpha);
  cv::Mat out;
  cv::merge(channels, out);
  return out;
}

// Levels of 255 within the mask.
double rms(const cv::Mat& a, const cv::Mat& b, const cv::Mat& mask) {
  return 255 * cv::norm(a, b, cv::NORM_L2, mask) / std::sqrt(3.0 * std::max(1, cv::countNonZero(mask)));
}

std::size_t count_of(const std::vector<bench::KnownLayers>& cases, const std::string& kind) {
  return static_cast<std::size_t>(
      std::count_if(cases.begin(), cases.end(), [&](const auto& each) { return each.name.ends_with(kind); }));
}

struct AlphaRow {
  std::string method;
  std::function<Matting(const bench::KnownLayers&)> run;
};

Matting by(AlphaMethod method, const bench::KnownLayers& known, bool copied) {
  CutOptions options{.alpha = method};
  options.uncover_px = 0;
  const std::vector<LayerMatte> mattes{{.name = "front", .matte = known.trimap, .kind = MatteKind::kTrimap},
                                       {.name = "rest", .matte = {}, .kind = MatteKind::kRest}};
  std::vector<CutLayer> layers = cut_layers(known.picture, mattes, options);
  return {layers[0].alpha, copied ? known.picture : layers[0].colour, {}};
}

void measure_alpha(const std::vector<bench::KnownLayers>& cases, const std::filesystem::path& write,
                   nlohmann::json& json) {
  std::vector<AlphaRow> rows{
      {"hard, colours copied", [](const auto& k) { return by(AlphaMethod::kHard, k, true); }},
      {"guided, colours copied", [](const auto& k) { return by(AlphaMethod::kGuided, k, true); }},
      {"information flow, colours copied",
       [](const auto& k) { return by(AlphaMethod::kInformationFlow, k, true); }},
      {"guided", [](const auto& k) { return by(AlphaMethod::kGuided, k, false); }},
      {"information flow", [](const auto& k) { return by(AlphaMethod::kInformationFlow, k, false); }},
      {"Bayesian", [](const auto& k) { return by(AlphaMethod::kBayesian, k, false); }},
  };
  fmt::print(
      "| picture | method | SAD, 1000 px | of the unsure | colour x alpha | over grey | s |\n"
      "| --- | --- | --: | --: | --: | --: | --: |\n");
  for (const AlphaRow& row : rows) {
    std::map<std::string, std::array<double, 5>> sums;
    for (std::size_t i = 0; i < cases.size(); ++i) {
      const bench::KnownLayers& known = cases[i];
      const double start = bench::process_seconds();
      const Matting found = row.run(known);
      const double seconds = bench::process_seconds() - start;
      const cv::Mat unsure = known.trimap == 128;
      const double sad = cv::norm(found.alpha, known.alpha, cv::NORM_L1, unsure);
      const cv::Mat truth = over_grey(known.front, known.alpha),
                    seen = over_grey(found.foreground, found.alpha);
      std::vector<cv::Mat> weight(3, known.alpha);
      cv::Mat weights;
      cv::merge(weight, weights);
      const std::array<double, 5> figures{
          sad / 1000, 100 * sad / cv::countNonZero(unsure),
          rms(found.foreground, known.front, unsure & (known.alpha > 0.2) & (found.alpha > 0.2)),
          rms(seen, truth, unsure), seconds};
      const std::string kind = known.name.substr(known.name.rfind(' ') + 1);
      for (const std::string& key : {kind, std::string("mean")})
        for (std::size_t f = 0; f < figures.size(); ++f)
          sums[key][f] +=
              figures[f] / static_cast<double>(key == "mean" ? cases.size() : count_of(cases, kind));
      json["alpha"].push_back({{"picture", known.name},
                               {"method", row.method},
                               {"sad_1000_px", figures[0]},
                               {"colour", figures[2]},
                               {"over_grey", figures[3]},
                               {"cpu_s", seconds}});
      if (!write.empty()) {
        cv::Mat bytes, alpha;
        seen.convertTo(bytes, CV_8U, 255);
        found.alpha.convertTo(alpha, CV_8U, 255);
        media::write_picture(write / fmt::format("{}_{}_grey.png", i, row.method), bytes);
        media::write_picture(write / fmt::format("{}_{}_alpha.png", i, row.method), alpha);
      }
    }
    for (const auto& [kind, f] : sums)
      fmt::print("| {} | {} | {:.2f} | {:.1f} % | {:.1f} | {:.2f} | {:.2f} |\n", kind, row.method, f[0], f[1],
                 f[2], f[3], f[4]);
    std::fflush(stdout);
  }
  if (!write.empty())
    for (std::size_t i = 0; i < cases.size(); ++i) {
      cv::Mat bytes;
      over_grey(cases[i].front, cases[i].alpha).convertTo(bytes, CV_8U, 255);
      media::write_picture(write / fmt::format("{}_truth_grey.png", i), bytes);
      cases[i].picture.convertTo(bytes, CV_8U, 255);
      media::write_picture(write / fmt::format("{}_picture.png", i), bytes);
    }
}

double gradient_energy(const cv::Mat& bgr, const cv::Mat& mask) {
  cv::Mat grey, dx, dy;
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  cv::Sobel(grey, dx, CV_32F, 1, 0);
  cv::Sobel(grey, dy, CV_32F, 0, 1);
  return cv::mean(dx.mul(dx) + dy.mul(dy), mask)[0];
}

void measure_fill(const std::vector<bench::KnownLayers>& cases, bool shift_map,
                  const std::filesystem::path& write, nlohmann::json& json) {
  fmt::print(
      "| method | PSNR, dB | SSIM | gradients | s |\n"
      "| --- | --: | --: | --: | --: |\n");
  std::vector<std::pair<std::string, std::function<cv::Mat(const cv::Mat&, const cv::Mat&, const cv::Mat&)>>>
      rows;
  std::vector<std::string> others{"telea", "navier-stokes", "outward"};
  if (shift_map) others.emplace_back("shift-map");
  for (const std::string& name : others)
    rows.emplace_back(name, [name](const cv::Mat& bgr, const cv::Mat& hole, const cv::Mat&) {
      synth::outline::InpaintOptions options;
      options.method = synth::outline::parse_inpaint_method(name);
      options.margin_px = 0;
      options.max_side_px = wide;
      return synth::outline::inpaint_background(bgr, hole, options);
    });
  for (const auto& [patch, search] : {std::pair(9, 24), std::pair(9, 48), std::pair(9, 96), std::pair(7, 48),
                                      std::pair(13, 48), std::pair(9, 192)})
    rows.emplace_back(
        fmt::format("patches of {} px within {}", patch, search),
        [patch = patch, search = search](const cv::Mat& bgr, const cv::Mat& hole, const cv::Mat& stripe) {
          cv::Mat picture, out;
          bgr.convertTo(picture, CV_32F, 1 / 255.0);
          const cv::Mat known = hole == 0;
          const Filled filled =
              exemplar_fill(picture, {known, stripe, known}, {.patch_px = patch, .search_px = search});
          filled.picture.convertTo(out, CV_8U, 255);
          return out;
        });
  for (const auto& [name, run] : rows) {
    double decibels = 0, ssim = 0, gradients = 0, seconds = 0;
    int count = 0;
    for (std::size_t i = 0; i < cases.size(); ++i) {
      const bench::KnownLayers& known = cases[i];
      if (known.name.ends_with("smoke")) continue;  // it covers most of a picture
      cv::Mat hole, near, spoiled, truth;
      cv::dilate(known.alpha > 0, hole, cv::Mat::ones(5, 5, CV_8U));
      const int side = 2 * kStripe + 1;
      cv::dilate(hole == 0, near, cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side}));
      const cv::Mat stripe = hole & near;
      known.picture.convertTo(spoiled, CV_8U, 255);
      known.behind.convertTo(truth, CV_8U, 255);
      const double start = bench::process_seconds();
      const cv::Mat guess = run(spoiled, hole, stripe);
      seconds += bench::process_seconds() - start;
      const double error = rms(guess, truth, stripe) / 255;
      decibels += 20 * std::log10(255 / std::max(error, 1e-3));
      cv::Mat a, b;
      cv::cvtColor(guess, a, cv::COLOR_BGR2GRAY);
      cv::cvtColor(truth, b, cv::COLOR_BGR2GRAY);
      a.convertTo(a, CV_32F);
      b.convertTo(b, CV_32F);
      ssim += cv::mean(bench::ssim_map(a, b), stripe)[0];
      gradients += gradient_energy(guess, stripe) / gradient_energy(truth, stripe);
      ++count;
      if (!write.empty()) media::write_picture(write / fmt::format("{}_fill_{}.png", i, name), guess);
    }
    fmt::print("| {} | {:.2f} | {:.3f} | {:.2f} | {:.2f} |\n", name, decibels / count, ssim / count,
               gradients / count, seconds / count);
    std::fflush(stdout);
    json["fill"].push_back({{"method", name},
                            {"db", decibels / count},
                            {"ssim", ssim / count},
                            {"gradients", gradients / count},
                            {"cpu_s", seconds / count}});
  }
}

// Twenty-four layers: trees and outlines before the rest, as in the paper's Argenteuil.
void measure_time(const std::filesystem::path& path, nlohmann::json& json) {
  cv::Mat picture = wide_picture(path);
  cv::resize(picture, picture, {900, 675});
  std::vector<LayerMatte> mattes;
  for (int i = 0; i < 23; ++i) {
    cv::Mat alpha = cv::Mat::zeros(picture.size(), CV_32F);
    if (i % 2 == 0) {
      const cv::Mat tree = bench::drawn_tree({225, 260}, static_cast<std::uint64_t>(i) + 1);
      tree.copyTo(alpha(cv::Rect(28 * i + 10, 20 + 130 * (i % 3), 225, 260)));
    } else {
      alpha = bench::drawn_outline(picture.size(), {38.0 * i, 560.0 - 60 * (i % 5)}, 0.08,
                                   static_cast<std::uint64_t>(i));
    }
    mattes.push_back({.name = fmt::format("layer {}", i), .matte = alpha >= 0.5, .kind = MatteKind::kRegion});
  }
  mattes.push_back({.name = "rest", .matte = {}, .kind = MatteKind::kRest});
  const double start = bench::wall_seconds();
  const std::vector<CutLayer> layers = cut_layers(picture, mattes);
  const double seconds = bench::wall_seconds() - start;
  double matting = 0, filling = 0;
  for (const CutLayer& layer : layers) matting += layer.matting_s, filling += layer.filling_s;
  const double peak = static_cast<double>(bench::peak_bytes()) / (1 << 20);
  fmt::print("24 layers at 900 x 675: {:.1f} s (matting {:.1f}, filling {:.1f}), at most {:.0f} MB\n",
             seconds, matting, filling, peak);
  json["time"] = {{"wall_s", seconds}, {"matting_s", matting}, {"filling_s", filling}, {"peak_mb", peak}};
}

bool gives_the_picture(const bench::KnownLayers& known) {
  const std::vector<LayerMatte> mattes{{.name = "front", .matte = known.trimap, .kind = MatteKind::kTrimap},
                                       {.name = "rest", .matte = {}, .kind = MatteKind::kRest}};
  return cv::norm(composited(cut_layers(known.picture, mattes)), known.picture, cv::NORM_INF) < 1e-4;
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<std::string> paths;
  std::filesystem::path write;
  std::string json_file, only;
  bool smoke = true, shift_map = false;
  bench::Arguments app("How well is a picture taken apart?");
  app.option("PICTURE", paths).required();
  app.option("--write", write, "Folder for what was cut out and filled in");
  app.option("--json", json_file, "Write the figures here");
  app.option("--width", wide, "Of the pictures, px").between(100, 4000);
  app.flag("!--no-smoke", smoke, "Without the simulated smoke");
  app.flag("--shift-map", shift_map, "Also fill by shift-map, in minutes");
  app.option("--only", only, "alpha, fill or time [all]").one_of({"alpha", "fill", "time"});
  app.parse(argc, argv);
  const bench::Machine machine = bench::this_machine();
  fmt::print("{}\n", to_string(machine));
  nlohmann::json json{{"machine", to_json(machine)}};
  if (only != "time") {
    const std::vector<bench::KnownLayers> cases = known_cases(paths, smoke);
    if (!gives_the_picture(cases.front())) {
      fmt::print(stderr, "the layers do not give the picture\n");
      return 1;
    }
    if (only != "fill") measure_alpha(cases, write, json);
    if (only != "alpha") measure_fill(cases, shift_map, write, json);
  }
  if (only.empty() || only == "time") measure_time(paths.front(), json);
  if (!json_file.empty()) std::ofstream(json_file) << json.dump(2) << '\n';
  return 0;
} catch (const std::exception& fault) {
  fmt::print(stderr, "bench_layers: {}\n", fault.what());
  return 1;
}
