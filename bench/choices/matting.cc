// How near to a drawn or thresholded truth do mattes from scribbles come, by which edge, in what time?
//
//   bench_matting PICTURE:MARKS:TRUTH... [--write FOLDER] [--json FILE]
//
// MARKS are scribbles (a picture) or marks (.json), TRUTH a grey picture. First it checks what a matte
// promises: the marks hold, and outside of the band alpha is the region's. Then, by edge, width of the band
// and iterations of GrabCut: SAD (sum of absolute differences, alpha 0..1) in thousands of px, as a fraction
// of the truth's own area, and CPU seconds of all threads. --write leaves a sheet of each picture's default
// matte and the matte of each edge. Prints a table.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "bench/harness/arguments.h"
#include "bench/harness/machine.h"
#include "media/picture/picture.h"
#include "synth/matte/matte.h"

namespace {

using namespace freshet;
using namespace freshet::synth::matte;

struct Case {
  std::string name;
  cv::Mat picture, truth;
  Marks marks;
};

Case read_case(const std::string& argument) {
  const std::size_t first = argument.find(':'), second = argument.find(':', first + 1);
  if (second == std::string::npos) throw std::runtime_error(argument + ": PICTURE:MARKS:TRUTH expected");
  const std::filesystem::path path = argument.substr(0, first);
  const std::filesystem::path marks = argument.substr(first + 1, second - first - 1);
  Case read{path.stem().string(), media::read_picture(path).bgr, {}, {}};
  read.truth = media::read_matte(argument.substr(second + 1), read.picture.size()).alpha;
  read.marks = marks.extension() == ".json" ? read_marks(marks, read.picture.size())
                                            : read_scribbles(marks, read.picture);
  return read;
}

/// Pixels, alpha 0..1.
double sad(const cv::Mat& alpha, const cv::Mat& truth) { return cv::norm(alpha, truth, cv::NORM_L1) / 255; }

bool keeps_promises(const Case& one) {
  const MatteOptions options;
  const cv::Mat region = hard_region(one.picture, one.marks, options.region, one.name);
  const cv::Mat alpha = soft_edge(one.picture, region, one.marks, options.edge);
  const cv::Mat trimap = trimap_of(region, one.marks, band_width(options.edge, alpha.size()));
  return cv::countNonZero((one.marks == kFluid) & (alpha != 255)) == 0 &&
         cv::countNonZero((one.marks == kBackground) & (alpha != 0)) == 0 &&
         cv::countNonZero((trimap != 128) & (alpha != trimap)) == 0;
}

struct Row {
  std::string what;
  MatteOptions options;
};

std::vector<Row> rows() {
  std::vector<Row> all;
  const auto add = [&](std::string what) -> MatteOptions& {
    all.push_back({std::move(what), {}});
    return all.back().options;
  };
  add("GrabCut alone").edge.edge = Edge::kNone;
  for (const Edge edge : {Edge::kGuided, Edge::kInformationFlow})
    for (const double width : {0.01, 0.02, 0.04, 0.08}) {
      MatteOptions& options = add(fmt::format("{}, band {:.0f} %", to_string(edge), 100 * width));
      options.edge.edge = edge;
      options.edge.width_px = -width;  // of the picture's longer side, filled in by picture
    }
  const auto add_guided = [&](std::string what) -> RegionOptions& {
    MatteOptions& options = add("guided, " + std::move(what));
    options.edge.edge = Edge::kGuided;
    return options.region;
  };
  for (const int iterations : {0, 1, 2, 5})
    add_guided(fmt::format("{} iterations", iterations)).iterations = iterations;
  for (const double minimum : {0.0, 0.002})
    add_guided(fmt::format("islands from {:.1f} %", 100 * minimum)).min_island = minimum;
  return all;
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<std::string> arguments;
  std::filesystem::path write;
  std::string json_file;
  bench::Arguments app("How near to a drawn or thresholded truth do mattes from scribbles come?");
  app.option("CASE", arguments, "PICTURE:MARKS:TRUTH").required();
  app.option("--write", write, "Folder for mattes and sheets");
  app.option("--json", json_file, "Write the figures here");
  app.parse(argc, argv);
  std::vector<Case> cases;
  for (const std::string& argument : arguments) cases.push_back(read_case(argument));
  const bench::Machine machine = bench::this_machine();
  fmt::print("{}\n", to_string(machine));
  for (const Case& one : cases)
    if (!keeps_promises(one)) {
      fmt::print(stderr, "{}: marks or the region's own values were changed\n", one.name);
      return 1;
    }
  nlohmann::json json{{"machine", to_json(machine)}, {"rows", nlohmann::json::array()}};
  fmt::print(
      "| picture | method | SAD, 1000 px | of truth's area | region s | edge s |\n"
      "| --- | --- | --: | --: | --: | --: |\n");
  std::vector<double> sums(rows().size(), 0);
  for (const Case& one : cases) {
    const double area = cv::sum(one.truth)[0] / 255;
    std::size_t index = 0;
    for (Row& row : rows()) {
      EdgeOptions& edge = row.options.edge;
      if (edge.width_px < 0) edge.width_px *= -std::max(one.picture.cols, one.picture.rows);
      const double start = bench::process_seconds();
      const cv::Mat region = hard_region(one.picture, one.marks, row.options.region, one.name);
      const double cut = bench::process_seconds();
      const cv::Mat alpha = soft_edge(one.picture, region, one.marks, edge);
      const double end = bench::process_seconds();
      const double error = sad(alpha, one.truth);
      sums[index++] += error / area;
      fmt::print("| {} | {} | {:.1f} | {:.1f} % | {:.2f} | {:.2f} |\n", one.name, row.what, error / 1000,
                 100 * error / area, cut - start, end - cut);
      std::fflush(stdout);
      json["rows"].push_back({{"picture", one.name},
                              {"method", row.what},
                              {"sad_px", error},
                              {"share_of_truth", error / area},
                              {"region_cpu_s", cut - start},
                              {"edge_cpu_s", end - cut}});
      if (!write.empty() && index <= 9)
        media::write_picture(write / fmt::format("{}_{}.png", one.name, index), alpha);
    }
    if (!write.empty()) {
      const MadeMatte matte = make_matte(one.picture, one.marks, {}, one.name);
      media::write_picture(write / (one.name + "_sheet.png"),
                           matte_sheet(one.picture, one.marks, matte.alpha));
    }
  }
  std::size_t index = 0;
  for (const Row& row : rows())
    fmt::print("| mean of {} | {} | | {:.1f} % | | |\n", cases.size(), row.what,
               100 * sums[index++] / static_cast<double>(cases.size()));
  if (!json_file.empty()) std::ofstream(json_file) << json.dump(2) << '\n';
  return 0;
} catch (const std::exception& fault) {
  fmt::print(stderr, "bench_matting: {}\n", fault.what());
  return 1;
}
