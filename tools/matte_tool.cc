#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet_error.h"
#include "media/picture.h"
#include "synth/matte/matte.h"
#include "tools/commands.h"
#include "tools/output_names.h"

namespace freshet::tools {
namespace {

namespace matte = synth::matte;

struct MatteCommand {
  std::filesystem::path picture, scribbles, marks;
  std::vector<std::string> boxes;
  std::string edge = matte::to_string(matte::EdgeOptions{}.edge);
  std::string out, sheet;
  matte::MatteOptions options;
  bool json = false;
};

cv::Rect2d parse_box(const std::string& text) {
  double x = 0, y = 0, width = 0, height = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf%c", &x, &y, &width, &height, &rest) != 4)
    throw Error(ErrorKind::kUsage, "--box " + text, "it is not LEFT,TOP,WIDTH,HEIGHT in px",
                "For example --box 120,40,300,200");
  return {x, y, width, height};
}

/// Scribbles lie over marks, and both over the boxes.
matte::Marks read_all_marks(const MatteCommand& command, const cv::Mat& picture) {
  matte::Marks marks(picture.size(), CV_8U, cv::Scalar(matte::kUnknown));
  if (!command.marks.empty()) matte::lay_over(marks, matte::read_marks(command.marks, picture.size()));
  if (!command.scribbles.empty()) {
    std::vector<std::string> notices;
    matte::lay_over(marks, matte::read_scribbles(command.scribbles, picture, &notices));
    for (const std::string& notice : notices) say(command.scribbles.string() + ": " + notice);
  }
  if (!command.boxes.empty()) {
    std::vector<cv::Rect2d> boxes;
    for (const std::string& box : command.boxes) boxes.push_back(parse_box(box));
    matte::keep_within(marks, boxes, "--box");
  }
  return marks;
}

void run_matte(MatteCommand command, const RunContext& context) {
  if (command.scribbles.empty() && command.marks.empty() && command.boxes.empty())
    throw Error(ErrorKind::kUsage, "synth matte", "nothing says where the fluid is",
                "Give --scribbles, --marks or --box");
  check_picture_output(command.out);
  check_picture_output(command.sheet);
  command.options.edge.edge = matte::parse_edge(command.edge);
  const auto start = std::chrono::steady_clock::now();
  const media::Picture picture = media::read_picture(command.picture);
  for (const std::string& notice : picture.notices) say(command.picture.string() + ": " + notice);
  const matte::Marks marks = read_all_marks(command, picture.bgr);
  const double read_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::string where = !command.scribbles.empty() ? command.scribbles.string()
                            : !command.marks.empty()   ? command.marks.string()
                                                       : "--box";
  const matte::Matte made = matte::make_matte(picture.bgr, marks, command.options, where, context.stop);
  for (const std::string& notice : made.notices) say(where + ": " + notice);
  media::write_picture(command.out, made.alpha);
  if (!command.sheet.empty())
    media::write_picture(command.sheet, matte::matte_sheet(picture.bgr, marks, made.alpha));
  say(fmt::format("{:.1f} % of {} x {} px is fluid; read {:.2f} s, region {:.2f} s, edge {:.2f} s",
                  100 * made.share, made.alpha.cols, made.alpha.rows, read_s, made.region_s, made.edge_s));
  if (command.json) {
    fmt::print("{}\n", nlohmann::json{{"matte", command.out},
                                      {"width", made.alpha.cols},
                                      {"height", made.alpha.rows},
                                      {"share", made.share},
                                      {"edge", command.edge},
                                      {"notices", made.notices},
                                      {"seconds",
                                       {{"read", read_s}, {"region", made.region_s}, {"edge", made.edge_s}}}}
                           .dump());
    return;
  }
  fmt::print("{}\n", command.out);
  if (!command.sheet.empty()) fmt::print("{}\n", command.sheet);
}

}  // namespace

void add_matte(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<MatteCommand>();
  CLI::App* sub = synth_command.add_subcommand("matte", "Make a picture's matte from scribbles or boxes");
  sub->add_option("PICTURE", command->picture, "The still picture (PNG, JPEG, TIFF, ...)")->required();
  sub->add_option("-o,--output", command->out, "The matte: 8-bit grey, white where the fluid is (.png)")
      ->required();
  sub->add_option("--sheet", command->sheet,
                  "Write picture, marks, matte and cut-out side by side (PNG, JPEG)");
  const std::string marking = "Where the fluid is";
  sub->add_option(
         "--scribbles", command->scribbles,
         "A picture of the same size with strokes: white or green on fluid, black or red on "
         "background. All else is unknown: what is transparent; or grey; or, where the strokes are "
         "painted over the picture itself, whatever equals it. Strokes of fluid alone: the picture's "
         "border is background. Of background alone: the rest may be fluid")
      ->group(marking);
  sub->add_option("--marks", command->marks,
                  R"(Lines, dots and boxes as JSON, px: {"format": "freshet-marks", "version": 1, "marks": )"
                  R"([{"is": "fluid", "points": [[x, y], ...], "width": 7}, {"is": "background", "box": )"
                  R"([x, y, width, height]}, {"is": "within", "box": [...]}]})")
      ->group(marking);
  sub->add_option("--box", command->boxes,
                  "All fluid lies inside this box, px; several: inside any of them. Strokes go first")
      ->type_name("X,Y,W,H")
      ->delimiter(' ')
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->group(marking);
  const std::string edges = "Edge";
  sub->add_option("--edge", command->edge,
                  "guided (light), information-flow (fine detail; some seconds), or none (hard)")
      ->check(CLI::IsMember({"guided", "information-flow", "none"}))
      ->capture_default_str()
      ->group(edges);
  sub->add_option("--edge-width", command->options.edge.width_px,
                  "Width, px, of the band along the region's edge in which alpha is found "
                  "[8 % of the picture's longer side; guided 2 %]")
      ->check(CLI::Range(1.0, 10000.0))
      ->group(edges);
  sub->add_option("--iterations", command->options.region.iterations,
                  "Times that GrabCut adapts the marks' colours to what it found")
      ->check(CLI::Range(0, 100))
      ->capture_default_str()
      ->group(edges);
  sub->add_flag("--json", command->json, "Print share of fluid (0..1) and seconds by stage as JSON");
  add_threads(*sub);
  sub->callback([command, &context] { run_matte(*command, context); });
}

}  // namespace freshet::tools
