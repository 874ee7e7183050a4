#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "platform/stopwatch.h"
#include "query/labelling/labelling.h"
#include "synth/matte/matte.h"
#include "synth/matte/proposal.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/options/search_options.h"
#include "tools/query/label_run.h"

namespace freshet::tools {
namespace {

namespace matte = synth::matte;

constexpr int kProposalSide = 640;  // px: more pieces cost time and say no more about where fluid is

struct MatteCommand {
  std::filesystem::path picture, scribbles, marks;
  std::vector<std::string> boxes;
  std::string store;  // to propose marks from; empty: none
  query::CandidateOptions candidates;
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

/// Where the person's own marks say enough they are used alone; else throws, and advises what was not done yet.
void say_nothing_stands_out(const MatteCommand& command, const matte::Proposal& proposal) {
  const std::string fault = fmt::format(
      "it cannot tell the fluid in this picture from the rest: by their texture both are as like its clips "
      "(mean "
      "scores {:.2f} and {:.2f})",
      proposal.fluid_score, proposal.background_score);
  if (!command.scribbles.empty() || !command.marks.empty() || !command.boxes.empty()) {
    say(command.store + ": " + fault + ". Your own marks are used alone");
    return;
  }
  throw Error(
      ErrorKind::kNotFound, command.store, fault,
      std::string(command.candidates.class_name.empty() ? "Try --class with the fluid's class, or mark"
                                                        : "Mark") +
          " the fluid with a few --scribbles or a --box, which need no store");
}

/// What the store proposes, for a copy of the picture of at most kProposalSide px: 3 s with 350,000 patches.
matte::Marks propose(const MatteCommand& command, const cv::Mat& picture, const RunContext& context) {
  const store::Snapshot snapshot = store::Store::open_read(command.store).snapshot();
  const auto base = open_with_progress(snapshot, SearchOptions());
  const double scale =
      std::min(1.0, static_cast<double>(kProposalSide) / std::max(picture.cols, picture.rows));
  cv::Mat small;
  cv::resize(picture, small,
             {std::max(1, cvRound(picture.cols * scale)), std::max(1, cvRound(picture.rows * scale))}, 0, 0,
             cv::INTER_AREA);
  query::LabelOptions options;
  options.candidates = command.candidates;
  options.candidates.k = matte::ProposalOptions{}.best;
  options.candidates.coherent = 0;
  Progress progress;
  const query::CandidateSearch search =
      query::search_candidates(snapshot, *base, small, cv::Mat(small.size(), CV_8U, cv::Scalar(255)), options,
                               progress.callback(), context.stop);
  progress.finish();
  const matte::Proposal proposal = matte::propose_marks(search.target, search.candidates, {});
  if (!proposal.stands_out) {
    say_nothing_stands_out(command, proposal);
    return matte::Marks(picture.size(), CV_8U, cv::Scalar(matte::kUnknown));
  }
  say(fmt::format(
      "{}: of {} pieces {} look like fluid (mean score {:.2f}), {} do not ({:.2f}). This is a guess: "
      "look at the matte",
      command.store, search.target.size(), proposal.fluid_pieces, proposal.fluid_score,
      proposal.background_pieces, proposal.background_score));
  matte::Marks marks;
  cv::resize(proposal.marks, marks, picture.size(), 0, 0, cv::INTER_NEAREST);
  return marks;
}

/// Scribbles lie over marks, both over the store's proposal, and all over the boxes.
matte::Marks read_all_marks(const MatteCommand& command, const cv::Mat& picture, const RunContext& context) {
  matte::Marks marks(picture.size(), CV_8U, cv::Scalar(matte::kUnknown));
  std::vector<cv::Rect2d> boxes;
  for (const std::string& box : command.boxes) boxes.push_back(parse_box(box));
  if (!command.store.empty()) {
    // What the box rules out is no fluid, whatever the store says.
    marks = propose(command, picture, context);
    if (!boxes.empty()) {
      matte::Marks outside(picture.size(), CV_8U, cv::Scalar(matte::kUnknown));
      matte::keep_within(outside, boxes, "--box");
      matte::lay_over(marks, outside);
    }
  }
  if (!command.marks.empty()) matte::lay_over(marks, matte::read_marks(command.marks, picture.size()));
  if (!command.scribbles.empty()) {
    std::vector<std::string> notices;
    matte::lay_over(marks, matte::read_scribbles(command.scribbles, picture, &notices));
    for (const std::string& notice : notices) say(command.scribbles.string() + ": " + notice);
  }
  if (!boxes.empty()) matte::keep_within(marks, boxes, "--box");
  return marks;
}

void run_matte(MatteCommand command, const RunContext& context) {
  if (command.scribbles.empty() && command.marks.empty() && command.boxes.empty() && command.store.empty())
    throw Error(ErrorKind::kUsage, "synth matte", "nothing says where the fluid is",
                "Give --scribbles, --marks, --box or --auto");
  check_picture_output(command.out);
  check_picture_output(command.sheet);
  command.options.edge.edge = matte::parse_edge(command.edge);
  const Stopwatch watch;
  const media::Picture picture = media::read_picture(command.picture);
  for (const std::string& notice : picture.notices) say(command.picture.string() + ": " + notice);
  const matte::Marks marks = read_all_marks(command, picture.bgr, context);
  const double marks_s = watch.seconds();
  const std::string where = !command.scribbles.empty() ? command.scribbles.string()
                            : !command.marks.empty()   ? command.marks.string()
                            : !command.boxes.empty()   ? "--box"
                                                       : command.store;
  const matte::MadeMatte made = matte::make_matte(picture.bgr, marks, command.options, where, context.stop);
  for (const std::string& notice : made.notices) say(where + ": " + notice);
  media::write_picture(command.out, made.alpha);
  if (!command.sheet.empty())
    media::write_picture(command.sheet, matte::matte_sheet(picture.bgr, marks, made.alpha));
  say(fmt::format("{:.1f} % of {} x {} px is fluid; marks {:.2f} s, region {:.2f} s, edge {:.2f} s",
                  100 * made.fraction, made.alpha.cols, made.alpha.rows, marks_s, made.region_s,
                  made.edge_s));
  if (command.json) {
    fmt::print(
        "{}\n",
        nlohmann::json{{"matte", command.out},
                       {"width", made.alpha.cols},
                       {"height", made.alpha.rows},
                       {"share", made.fraction},
                       {"edge", command.edge},
                       {"notices", made.notices},
                       {"seconds", {{"marks", marks_s}, {"region", made.region_s}, {"edge", made.edge_s}}}}
            .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
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
                  "Write picture, scribbles, matte and cut-out side by side (PNG, JPEG)");
  const std::string marking = "Where the fluid is";
  sub->add_option("--scribbles", command->scribbles,
                  "Picture of scribbles, of the same size: white or green on fluid, black or red on "
                  "background. Transparent or grey pixels are unknown; so are pixels that equal the picture, "
                  "if you scribble over a copy of it. Without background scribbles the picture's border is "
                  "background; without fluid scribbles the rest may be fluid")
      ->group(marking);
  sub->add_option("--marks", command->marks,
                  R"(Lines, dots and boxes as JSON, px: {"format": "freshet-marks", "version": 1, "marks": )"
                  R"([{"is": "fluid", "points": [[x, y], ...], "width": 7}, {"is": "background", "box": )"
                  R"([x, y, width, height]}, {"is": "within", "box": [...]}]})")
      ->group(marking);
  sub->add_option("--box", command->boxes,
                  "Box that holds all fluid, px; may be given several times. Scribbles override it")
      ->type_name("X,Y,W,H")
      ->delimiter(' ')
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->group(marking);
  sub->add_option(
         "--auto", command->store,
         "Store that proposes fluid: places whose best candidates score high. A guess, blind to colour, best "
         "on water: check the --sheet and correct it with scribbles and boxes, which override it")
      ->type_name("STORE")
      ->group(marking);
  sub->add_option("--class", command->candidates.class_name, "With --auto: only clips of this class [all]")
      ->group(marking);
  sub->add_option("--exclude", command->candidates.excluded_clips,
                  "With --auto: clip to exclude; may be given several times")
      ->group(marking);
  const std::string edges = "Edge";
  sub->add_option("--edge", command->edge,
                  "Soft edge: guided (fast), information-flow (fine detail, some seconds) or none")
      ->check(CLI::IsMember({"guided", "information-flow", "none"}))
      ->capture_default_str()
      ->group(edges);
  sub->add_option("--edge-width", command->options.edge.width_px,
                  "Width of the band along the edge in which alpha is estimated, px [8 % of the picture's "
                  "longer side; guided 2 %]")
      ->check(CLI::Range(1.0, 10000.0))
      ->group(edges);
  sub->add_option("--iterations", command->options.region.iterations,
                  "GrabCut iterations; at least 3 where no fluid is marked, as with --box alone")
      ->check(CLI::Range(0, 100))
      ->capture_default_str()
      ->group(edges);
  sub->add_flag("--json", command->json, "Print the share of fluid (0 to 1) and seconds by stage as JSON");
  add_overwrite(*sub);
  add_threads(*sub);
  sub->callback([command, &context] { run_matte(*command, context); });
}

}  // namespace freshet::tools
