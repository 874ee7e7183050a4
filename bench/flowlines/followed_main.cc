// Does the fluid of an edited film go along the lines that were drawn for it, as fast as along those it comes from?
//
//   bench_followed FILM CLIP --lines lines.svg --edited edited.svg [--correspondence stretched]
//   bench/flowlines/edits.sh $FRESHET_FOOTAGE OUT      makes five edits, and asks this of each
//
// Both are reduced to 640 px. Printed: see bench/flowlines/followed.h; the clip's own angle from its own lines is what
// a person's hand and the flow's error make of it.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/flowlines/followed.h"
#include "freshet/error.h"
#include "synth/flowlines/files/footage_files.h"
#include "synth/flowlines/files/line_files.h"

namespace {

using namespace freshet;
namespace flowlines = synth::flowlines;

constexpr int kSide = 640;  // px

int run(const std::string& film, const std::string& clip, const std::string& lines, const std::string& edited,
        flowlines::Correspondence correspondence) {
  flowlines::Footage made = flowlines::read_footage(film), was = flowlines::read_footage(clip);
  if (made.size() != was.size())
    throw Error(ErrorKind::kInput, film, "it is not of the clip's size", "Give the film made of it");
  const cv::Size size = was.size();
  const double scale = std::min(1.0, static_cast<double>(kSide) / std::max(size.width, size.height));
  const auto read = [&](const std::string& path) {
    std::vector<flowlines::FlowLine> out;
    for (const flowlines::FlowLine& line : flowlines::read_lines(path, size, 4))
      out.push_back(flowlines::scaled(line, static_cast<float>(scale)));
    return out;
  };
  for (std::vector<cv::Mat>* frames : {&made.frames, &was.frames})
    for (cv::Mat& frame : *frames) {
      cv::Mat reduced;
      cv::resize(frame, reduced, cv::Size(), scale, scale, cv::INTER_AREA);
      frame = reduced;
    }
  const bench::Followed led =
      bench::followed(made.frames, was.frames, read(lines), read(edited), correspondence);
  fmt::print(
      "{}: {:.1f} degrees off (the clip from its own lines {:.1f}); log2 of speed {:.2f} by flow, {:.2f} by "
      "ribbons ({:+.2f}); {} places\n",
      film, led.degrees, led.clip_degrees, led.flow_speed, led.ribbon_speed, led.slower, led.places);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("How well an edited film follows its lines");
  std::string film, clip, lines, edited, correspondence = "equal";
  app.add_option("FILM", film, "What was made")->required();
  app.add_option("CLIP", clip, "What it was made of")->required();
  app.add_option("--lines", lines, "The clip's lines")->required()->check(CLI::ExistingFile);
  app.add_option("--edited", edited, "The film's lines")->required()->check(CLI::ExistingFile);
  app.add_option("--correspondence", correspondence)->check(CLI::IsMember({"equal", "stretched"}));
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  try {
    return run(film, clip, lines, edited,
               correspondence == "stretched" ? flowlines::Correspondence::kStretched
                                             : flowlines::Correspondence::kEqual);
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
