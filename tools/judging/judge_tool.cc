// freshet synth judge: a film of a still, whoever made it, judged without its truth.

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "hints/stroke_field.h"
#include "media/frame/frame.h"
#include "media/picture/picture.h"
#include "media/video/video_reader.h"
#include "synth/judging/critic.h"
#include "synth/judging/verdict_sheet.h"
#include "tools/console/output_names.h"
#include "tools/console/table.h"
#include "tools/judging/judge_tool.h"
#include "tools/judging/verdict_report.h"
#include "vision/look/bars.h"

namespace freshet::tools {
namespace {

namespace judging = synth::judging;

constexpr double kSameShape = 0.03;  // of the ratio of sides: encoders pad to even sides

struct JudgeCommand {
  std::filesystem::path film, picture, matte, sheet;
  std::string strokes, kind;
  bool whole = false, json = false;
};

/// The still and its matte at the film's size.
struct Target {
  cv::Mat picture, matte;
  judging::Asked asked;
};

Target read_target(const JudgeCommand& command, cv::Size film) {
  const media::Picture picture = media::read_picture(command.picture);
  for (const std::string& notice : picture.notices) say(command.picture.string() + ": " + notice);
  const cv::Size size = picture.bgr.size();
  const double shape =
      static_cast<double>(film.width) * size.height / (static_cast<double>(film.height) * size.width);
  if (std::abs(shape - 1) > kSameShape)
    throw Error(ErrorKind::kInput, command.film.string(),
                fmt::format("it has {} x {} px, and {} {} x {}: another shape", film.width, film.height,
                            command.picture.string(), size.width, size.height),
                "Give the still that the film was made of");
  Target target;
  cv::Mat matte;
  if (!command.matte.empty()) {
    const media::Matte read = media::read_matte(command.matte, size);
    for (const std::string& notice : read.notices) say(command.matte.string() + ": " + notice);
    matte = read.alpha;
  } else if (command.whole) {
    matte = vision::matte_within_bars(picture.bgr);
  } else {
    throw Error(ErrorKind::kUsage, command.film.string(), "nothing says where its fluid is",
                "Give --matte, or --whole where all of it moves");
  }
  const bool reduces = film.area() < size.area();
  cv::resize(picture.bgr, target.picture, film, 0, 0, reduces ? cv::INTER_AREA : cv::INTER_CUBIC);
  cv::resize(matte, target.matte, film, 0, 0, reduces ? cv::INTER_AREA : cv::INTER_LINEAR);
  if (!command.strokes.empty()) {
    const hints::StrokeField field =
        hints::interpolate(hints::read_strokes(command.strokes, size), size, command.strokes);
    target.asked.direction = field.direction;
  }
  return target;
}

void print_findings(const judging::Verdict& verdict, const judging::Evidence& film) {
  Table table({"measure", "value", "unit", "usual", "fault", "most at"});
  for (const judging::Finding& finding : verdict.findings) {
    const judging::MeasureWords& words = judging::words_of(finding.measure);
    const bool measured = std::isfinite(finding.reading.value);
    table.row({words.name, measured ? fmt::format("{:.2f}", finding.reading.value) : "-", words.unit,
               fmt::format("{:.2f}", finding.usual), measured ? fmt::format("{:.1f}", finding.fault) : "-",
               finding.fault > 0 ? judging::place_words(finding, film) : ""});
  }
  fmt::print("{}", table.text());
}

void run_judge(const JudgeCommand& command, const RunContext& context) {
  check_picture_output(command.sheet);
  media::VideoReader reader(command.film, 0,
                            media::Repairs{.upright = std::filesystem::is_regular_file(command.film)});
  const double fps = static_cast<double>(reader.info().fps_num) /
                     static_cast<double>(std::max<std::int64_t>(1, reader.info().fps_den));
  std::unique_ptr<judging::Evidence> film;
  Target target;
  for (int count = 0; count < judging::kJudgedFrames; ++count) {
    const auto frame = reader.next();
    if (!frame) break;
    if (context.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "synth judge", "stopped");
    const cv::Mat bgr = media::to_bgr(*frame);
    if (film == nullptr) {
      target = read_target(command, bgr.size());
      film = std::make_unique<judging::Evidence>(target.picture, target.matte, fps > 0 ? fps : 25);
    }
    film->add(bgr);
  }
  if (!reader.complaint().empty()) say(reader.complaint());
  if (film == nullptr)
    throw Error(ErrorKind::kInput, command.film.string(), "it has no frame", "Give a film");
  const judging::Verdict verdict = judging::judge(*film, command.kind, target.asked);
  if (!command.sheet.empty()) media::write_picture(command.sheet, judging::verdict_sheet(verdict, *film));
  say(fmt::format("{} frames judged at {} x {} px in {:.1f} s", film->count(), film->size().width,
                  film->size().height, verdict.seconds));
  if (command.json) {
    nlohmann::json json = verdict_json(verdict, *film, command.kind);
    json["film"] = command.film.string();
    json["frames"] = film->count();
    fmt::print("{}\n", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    return;
  }
  print_findings(verdict, *film);
  fmt::print("faults {:.1f}: {}\n", verdict.faults, judging::verdict_words(verdict, *film));
  if (!command.sheet.empty()) fmt::print("{}\n", command.sheet.string());
}

}  // namespace

void add_judge(CLI::App& synth_command, RunContext& context) {
  auto command = std::make_shared<JudgeCommand>();
  CLI::App* sub = synth_command.add_subcommand(
      "judge",
      "Judge a film of a still, ours or not, without its truth: faults, where, and what changes them");
  sub->add_option("FILM", command->film,
                  "A video, an animated picture, or a numbered sequence (f%05d.png, a folder)")
      ->required();
  sub->add_option("PICTURE", command->picture, "The still that it was made of")->required();
  CLI::Option* const matte =
      sub->add_option("--matte", command->matte, "Grey picture, white where the fluid is");
  sub->add_flag("--whole", command->whole,
                "All of the picture is fluid, but for black bars at its sides [off]")
      ->excludes(matte);
  sub->add_option(
      "--class", command->kind,
      "What kind of fluid it shows: water, fire, smoke or clouds, for what is usual [the mean of all]");
  sub->add_option("--strokes", command->strokes,
                  "What was asked of its motion, as freshet synth animate takes it");
  sub->add_option("-o,--output", command->sheet, "Sheet of where and when it is worst (PNG, JPEG)");
  sub->add_flag("--json", command->json, "Print all readings with their maps as JSON");
  add_overwrite(*sub);
  add_threads(*sub);
  sub->callback([command, &context] { run_judge(*command, context); });
}

}  // namespace freshet::tools
