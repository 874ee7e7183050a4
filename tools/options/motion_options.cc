#include "tools/options/motion_options.h"

#include <cmath>
#include <cstdlib>
#include <initializer_list>
#include <optional>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "hints/field_drawing.h"
#include "hints/motion_maps.h"
#include "hints/stroke_field.h"
#include "media/picture/picture.h"
#include "tools/console/output_names.h"
#include "tools/console/run_context.h"
#include "vision/look/horizon.h"

namespace freshet::tools {
namespace {

constexpr const char* kGroup = "Motion";

/// Does some of a stroke lie on fluid?
bool on_fluid(const hints::Stroke& stroke, const cv::Mat& matte) {
  cv::Mat drawn = cv::Mat::zeros(matte.size(), CV_8U);
  std::vector<cv::Point> points;
  for (const cv::Point2f& point : stroke.points)
    points.emplace_back(static_cast<int>(std::floor(point.x)), static_cast<int>(std::floor(point.y)));
  cv::polylines(drawn, points, false, cv::Scalar(255), 1);
  return cv::countNonZero(drawn & matte) > 0;
}

/// --horizon auto.
std::optional<Horizon> own_horizon(const TargetFiles::Loaded& loaded, const std::string& class_name) {
  const std::optional<Horizon> found = vision::horizon_of_water(loaded.picture, loaded.matte, class_name);
  if (found)
    say(
        fmt::format("--horizon auto: the matte's upper border is straight, row {:.0f} to {:.0f}; towards it "
                    "the water goes "
                    "slower",
                    found->from.y, found->to.y));
  return found;
}

/// --horizon.
std::optional<Horizon> read_horizon(const std::string& text, const TargetFiles::Loaded& loaded,
                                    const std::string& class_name) {
  if (text == "none") return {};
  if (text == "auto") return own_horizon(loaded, class_name);
  const std::string option = "--horizon " + text;
  std::vector<float> numbers;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) {
    char* end = nullptr;
    numbers.push_back(std::strtof(part.c_str(), &end));
    if (part.empty() || *end != 0 || !(std::abs(numbers.back()) < 1e6f))
      numbers.clear(), in.setstate(std::ios::failbit);
  }
  const auto width = static_cast<float>(loaded.matte.cols);
  if (numbers.size() == 1) numbers = {0, numbers[0], width, numbers[0]};
  if (numbers.size() == 4 && numbers[0] > numbers[2])
    std::swap(numbers[0], numbers[2]), std::swap(numbers[1], numbers[3]);
  if (numbers.size() != 4 || numbers[2] - numbers[0] < 1 ||
      std::abs(numbers[3] - numbers[1]) > numbers[2] - numbers[0])
    throw Error(ErrorKind::kUsage, option,
                "auto, none, a row or a line that is level within 45 degrees expected",
                "Give --horizon Y, or --horizon X,Y,X,Y");
  return Horizon{{numbers[0], numbers[1]}, {numbers[2], numbers[3]}};
}

void say_all(const std::string& file, const std::vector<std::string>& notices) {
  for (const std::string& notice : notices) say(file + ": " + notice);
}

}  // namespace

void MotionOptions::add_to(CLI::App& command) {
  speed_white_ = hints::kSpeedWhite;
  add_search_to(command);
  CLI::Option* strokes =
      command
          .add_option(
              "--strokes", strokes_,
              "Lines drawn over the picture in the direction of the flow: SVG (paths, lines, polylines; "
              "attribute data-speed in px/s) or JSON {\"format\": \"freshet-strokes\", \"version\": 1, "
              "\"strokes\": [{\"points\": [[x, y], ...], \"speed\": 80}]}")
          ->group(kGroup);
  command
      .add_option(
          "--orientation-map", orientation_map_,
          "Directions as a picture of the same size: hue 0 (red) right, 90 up, 180 left, 270 down; grey or "
          "transparent: any")
      ->excludes(strokes)
      ->group(kGroup);
  command
      .add_option(
          "--speed-map", speed_map_,
          "Speeds as a grey picture of the same size: black still, white --speed-white; transparent: any")
      ->group(kGroup);
  speed_white_option_ = command
                            .add_option("--speed-white", speed_white_,
                                        "Speed that white stands for, px/s, in maps read and written")
                            ->check(CLI::Range(1.0, 100000.0))
                            ->capture_default_str()
                            ->group(in_detail(kGroup));
  command
      .add_option(
          "--draw", drawing_,
          "Write the picture with arrows of the motion that is asked, or else was assigned (PNG, JPEG)")
      ->group(kGroup);
}

void MotionOptions::add_search_to(CLI::App& command) {
  speed_ratio_ = query::MotionGuide{}.speed_ratio;
  command
      .add_option("--hint", hint_,
                  "Where no direction is asked: auto (guess one from the candidates' classes and the "
                  "picture's texture, and say so) or none")
      ->check(CLI::IsMember({"auto", "none"}))
      ->capture_default_str()
      ->group(in_detail(kGroup));
  command
      .add_option(
          "--hint-search", hint_search_,
          "What a direction or speed that is asked does to the search: wide (looks choose, and the "
          "animation turns and scales what a patch does), narrow (only patches that move so, as in the "
          "paper), or auto: wide, but for --method paper narrow")
      ->check(CLI::IsMember({"auto", "wide", "narrow"}))
      ->capture_default_str()
      ->group(kGroup);
  speed_tolerance_option_ = command
                                .add_option("--speed-tolerance", speed_ratio_,
                                            "Speed tolerance of a narrow search: largest ratio between a "
                                            "patch's speed and the one that strokes or a speed map ask for")
                                ->check(CLI::Range(1.0, 16.0))
                                ->capture_default_str()
                                ->group(in_detail(kGroup));
}

void MotionOptions::add_outputs_to(CLI::App& command) {
  command
      .add_option(
          "--orientation-out", orientation_out_,
          "Write the assigned directions, to be edited and given back with --orientation-map (PNG, 16 bits)")
      ->group(kGroup);
  command
      .add_option("--speed-out", speed_out_,
                  "Write the assigned speeds, to edit and pass to --speed-map (PNG, 16 bits)")
      ->group(kGroup);
}

void MotionOptions::add_rendering_to(CLI::App& command) {
  horizon_ = "auto";
  command
      .add_option("--horizon", horizon_,
                  "Where a plane of water ends, towards which it goes slower: auto (the straight, level "
                  "upper border of "
                  "the matte of water, where it has one), none, a row, px from above, or a line X,Y,X,Y")
      ->default_str("auto")
      ->group(kGroup);
}

void MotionOptions::check_outputs() const {
  check_picture_output(drawing_);
  for (const std::string& path : {orientation_out_, speed_out_}) {
    check_output_folder(path);
    if (!path.empty()) hints::check_map_name(path);
  }
}

AskedMotion MotionOptions::read(const TargetFiles::Loaded& loaded, const SearchOptions& search,
                                query::HintSearch automatic) const {
  AskedMotion asked;
  asked.search = hint_search_ == "auto" ? automatic : query::parse_hint_search(hint_search_);
  asked.guesses = hint_ == "auto";
  if (asked.search == query::HintSearch::kWide)
    for (const CLI::Option* narrow :
         std::initializer_list<const CLI::Option*>{&search.tolerance(), speed_tolerance_option_})
      if (narrow->count() > 0)
        throw Error(ErrorKind::kUsage, narrow->get_name(), "it belongs to a narrow search",
                    "Add --hint-search narrow");
  if (speed_white_option_->count() > 0 && speed_map_.empty() && speed_out_.empty())
    throw Error(ErrorKind::kUsage, speed_white_option_->get_name(), "it belongs to a map of speeds",
                "Add --speed-map or --speed-out");
  asked.guide.tolerance_deg = search.options().direction_tolerance_deg;
  asked.guide.speed_ratio = speed_ratio_;
  const cv::Size picture = loaded.picture.size();
  std::vector<std::string> notices;
  if (!horizon_.empty()) asked.guide.horizon = read_horizon(horizon_, loaded, search.options().class_name);
  if (!strokes_.empty()) {
    asked.strokes = hints::read_strokes(strokes_, picture, &notices);
    say_all(strokes_, notices);
    for (const hints::Stroke& stroke : asked.strokes)
      if (!on_fluid(stroke, loaded.matte))
        say(fmt::format("{}: {} lies wholly outside the matte; is it meant for this picture?", strokes_,
                        stroke.name.empty() ? "a stroke" : stroke.name));
    hints::StrokeField field =
        hints::interpolate(asked.strokes, picture, strokes_, {.horizon = asked.guide.horizon});
    if (!field.clash.empty()) say(strokes_ + ": " + field.clash);
    asked.guide.direction = field.direction;
    asked.guide.speed = field.speed;
  }
  notices.clear();
  if (!orientation_map_.empty()) {
    asked.guide.direction = hints::read_orientation_map(orientation_map_, picture, &notices);
    say_all(orientation_map_, notices);
  }
  notices.clear();
  if (!speed_map_.empty()) {
    if (!asked.guide.speed.empty()) say("the speed map is used, and not the strokes' speeds");
    asked.guide.speed = hints::read_speed_map(speed_map_, picture, speed_white_, &notices);
    say_all(speed_map_, notices);
  }
  return asked;
}

void MotionOptions::draw(const TargetFiles::Loaded& loaded, const AskedMotion& asked,
                         const cv::Mat& motion) const {
  if (drawing_.empty()) return;
  cv::Mat direction = asked.guide.direction, speed = asked.guide.speed;
  if (asked.guide.empty()) {
    if (motion.empty())
      throw Error(ErrorKind::kUsage, "--draw " + drawing_, "no motion is asked",
                  "Give --strokes, --orientation-map or --speed-map");
    hints::split_motion(motion, loaded.matte, direction, speed);
  }
  media::write_picture(drawing_,
                       hints::draw_field(loaded.picture, loaded.matte, direction, speed, asked.strokes));
}

void MotionOptions::write_maps(const TargetFiles::Loaded& loaded, const cv::Mat& motion) const {
  if (!orientation_out_.empty()) hints::write_orientation_map(orientation_out_, motion, loaded.matte);
  if (speed_out_.empty()) return;
  const double cut = hints::write_speed_map(speed_out_, motion, loaded.matte, speed_white_);
  if (cut > 0)
    say(fmt::format(
        "{}: {:.1f} % of the moving pixels are faster than white; a greater --speed-white shows them",
        speed_out_, 100 * cut));
}

}  // namespace freshet::tools
