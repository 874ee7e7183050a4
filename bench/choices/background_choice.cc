// Which inpainting should guess what lies behind a fluid?
//
//   bench_background_choice PICTURE... [--method NAME].. [--write FOLDER] [--json FILE]
//
// Mattes of known scenery: an upright flame-like blob of 8, 16 and 32 % of the picture's height as its
// radius, at four fixed places of each picture. What is guessed is compared with what was there: dB of PSNR
// inside the matte, and its seconds. First it checks that nothing outside the matte changes. Prints a table.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "media/picture/picture.h"
#include "platform/stopwatch.h"
#include "synth/outline/background.h"

namespace {

using namespace freshet;

/// A blob twice as high as wide, its edge waved as a flame's.
cv::Mat blob(cv::Size size, cv::Point2d middle, double radius) {
  cv::Mat out = cv::Mat::zeros(size, CV_8U);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double dx = (x - middle.x) / (0.6 * radius), dy = (y - middle.y) / radius;
      const double angle = std::atan2(dy, dx);
      const double reach = 1 + 0.2 * std::sin(5 * angle) + 0.1 * std::sin(9 * angle + 1);
      if (dx * dx + dy * dy < reach * reach) out.at<std::uint8_t>(y, x) = 255;
    }
  return out;
}

double squared_error(const cv::Mat& a, const cv::Mat& b, const cv::Mat& mask) {
  const double distance = cv::norm(a, b, cv::NORM_L2, mask);
  return distance * distance / (3.0 * cv::countNonZero(mask));
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  std::vector<std::string> paths, methods;
  std::filesystem::path write;
  std::string json_file;
  CLI::App app("Which inpainting should guess what lies behind a fluid?");
  app.add_option("PICTURE", paths)->required();
  app.add_option("--method", methods, "May be repeated [all]")->allow_extra_args(false);
  app.add_option("--write", write, "Folder for what was guessed");
  app.add_option("--json", json_file, "Write the figures here");
  CLI11_PARSE(app, argc, argv);
  if (methods.empty()) methods = {"telea", "navier-stokes", "outward", "fsr", "shift-map"};
  const std::vector<double> radii{0.08, 0.16, 0.32};
  const std::vector<cv::Point2d> places{{0.3, 0.4}, {0.7, 0.4}, {0.35, 0.65}, {0.65, 0.6}};
  nlohmann::json json;
  fmt::print(
      "{} pictures at 640 px, {} places; dB (mean of pictures' PSNR inside the matte), s of one thread\n",
      paths.size(), places.size());
  fmt::print("{:<16}", "method");
  for (const double radius : radii) fmt::print("  {:>4.0f} %: dB      s", 100 * radius);
  fmt::print("\n");
  for (const std::string& method : methods) {
    fmt::print("{:<16}", method);
    for (const double radius : radii) {
      double decibels = 0, seconds = 0;
      int count = 0;
      for (std::size_t p = 0; p < paths.size(); ++p) {
        cv::Mat picture = media::read_picture(paths[p]).bgr;
        const double scale = 640.0 / std::max(picture.cols, picture.rows);
        cv::resize(picture, picture, {}, scale, scale, cv::INTER_AREA);
        for (std::size_t i = 0; i < places.size(); ++i) {
          const cv::Mat matte = blob(picture.size(), {places[i].x * picture.cols, places[i].y * picture.rows},
                                     radius * picture.rows);
          cv::Mat spoiled = picture.clone();
          spoiled.setTo(cv::Scalar(40, 160, 255), matte);
          synth::outline::InpaintOptions options;
          options.method = synth::outline::parse_inpaint_method(method);
          options.margin_px = 0;
          const Stopwatch watch;
          const cv::Mat guess = synth::outline::inpaint_background(spoiled, matte, options);
          seconds += watch.seconds();
          if (cv::norm(guess, picture, cv::NORM_INF, ~matte) > 0) {
            fmt::print(stderr, "{} changed the picture outside the matte\n", method);
            return 1;
          }
          decibels += 10 * std::log10(255.0 * 255.0 / std::max(squared_error(guess, picture, matte), 1e-3));
          ++count;
          if (!write.empty() && i == 0)
            media::write_picture(write / fmt::format("{}_{}_{:.0f}.png", p, method, 100 * radius), guess);
        }
      }
      decibels /= count, seconds /= count;
      fmt::print("  {:>10.2f} {:>6.2f}", decibels, seconds);
      std::fflush(stdout);
      json[method].push_back({{"radius", radius}, {"db", decibels}, {"seconds", seconds}});
    }
    fmt::print("\n");
  }
  if (!json_file.empty()) std::ofstream(json_file) << json.dump(2) << "\n";
}
