// Does the motion that is assigned go as strokes ask, and do maps written by one run bring it back?
//
//   bench_guidance STORE PICTURE:MATTE:STROKES[:CLASS].. [--json FILE]
//
// For each picture: labelled without and with its strokes (default tolerances, narrow search, clips of 96 frames at 25/s).
// Of all pieces and of those whose tolerances did not have to open: the mean angle between the mean motion of
// the patch chosen and what the strokes ask of its piece, and the mean distance of speeds, |log2|. Then the
// assigned motion is written as orientation and speed map, both are read back as the only guide, and the
// picture is labelled again: the fraction of pieces that get the very same patch, or one of the same clip,
// and the angle and distance of speeds between both assignments. The maps themselves are checked first: read
// back they must be within a degree and 1 % of what was written, else the bench ends with 1.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <unistd.h>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "bench/harness/machine.h"
#include "hints/motion_maps.h"
#include "hints/stroke_field.h"
#include "media/picture/picture.h"
#include "query/labelling/labelling.h"
#include "store/store.h"
#include "synth/animate/motion/motion_field.h"
#include "synth/animate/placement/assigned.h"

namespace {

using namespace freshet;

constexpr double kDegrees = 180 / CV_PI;
constexpr double kSeconds = 96 / 25.0;

struct Case {
  std::string name, strokes, class_name;
  cv::Mat picture, matte;
};

Case read_case(const std::string& argument) {
  std::vector<std::string> parts;
  std::istringstream stream(argument);
  for (std::string part; std::getline(stream, part, ':');) parts.push_back(part);
  if (parts.size() < 3 || parts.size() > 4)
    throw std::runtime_error(argument + ": PICTURE:MATTE:STROKES[:CLASS] expected");
  Case read{std::filesystem::path(parts[0]).stem().string(),
            parts[2],
            parts.size() > 3 ? parts[3] : "",
            media::read_picture(parts[0]).bgr,
            {}};
  read.matte = media::read_matte(parts[1], read.picture.size()).alpha;
  return read;
}

/// Means over pieces.
struct Distance {
  double angle = 0, log2_speed = 0;
  int angles = 0, speeds = 0;

  void add_angle(const cv::Vec2f& a, const cv::Vec2f& b) {
    const double lengths = cv::norm(a) * cv::norm(b);
    if (lengths <= 0) return;
    angle += std::acos(std::clamp(a.dot(b) / lengths, -1.0, 1.0)) * kDegrees;
    ++angles;
  }
  void add_speed(double a, double b) {
    log2_speed += std::abs(std::log2(std::max(a, 0.1) / std::max(b, 0.1)));
    ++speeds;
  }
  double mean_angle() const { return angles > 0 ? angle / angles : NAN; }
  double mean_speed() const { return speeds > 0 ? log2_speed / speeds : NAN; }
};

nlohmann::json to_json(const Distance& distance) {
  return {{"pieces", distance.angles},
          {"angle_deg", distance.mean_angle()},
          {"log2_speed", distance.mean_speed()}};
}

std::vector<stored::Row> rows_of(const query::Labelling& labelling) {
  std::vector<stored::Row> rows;
  for (std::size_t piece = 0; piece < labelling.labels.size(); ++piece)
    rows.push_back(labelling.search.candidates.rows_of(piece)[labelling.labels[piece]]);
  return rows;
}

cv::Vec2f motion_of(const stored::PatchTable& table, stored::Row row) {
  return {table.mean_u[row], table.mean_v[row]};
}

struct Honoured {
  Distance all, unopened;
  int opened = 0;
};

Honoured honoured(const stored::PatchTable& table, const query::Labelling& labelling,
                  const std::vector<query::PieceMotion>& asked) {
  Honoured found;
  const std::vector<stored::Row> rows = rows_of(labelling);
  for (std::size_t piece = 0; piece < rows.size(); ++piece) {
    const std::vector<int>& steps = labelling.search.candidates.opened;
    const bool opened = !steps.empty() && steps[piece] > 0;
    found.opened += opened;
    const cv::Vec2f motion = motion_of(table, rows[piece]);
    const auto add = [&](Distance& to) {
      if (asked[piece].direction != cv::Vec2f(0, 0)) to.add_angle(motion, asked[piece].direction);
      if (asked[piece].speed >= 0) to.add_speed(cv::norm(motion), asked[piece].speed);
    };
    add(found.all);
    if (!opened) add(found.unopened);
  }
  return found;
}

/// The guide that maps of this motion are, after they were files; and whether the files kept them.
query::MotionGuide through_files(const cv::Mat& motion, const cv::Mat& matte, bool& right) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path();
  const std::string mark = fmt::format("freshet-guidance-{}", ::getpid());
  const std::filesystem::path way_file = folder / (mark + "-way.png"),
                              speed_file = folder / (mark + "-speed.png");
  const double white = 1000;
  hints::write_orientation_map(way_file, motion, matte);
  hints::write_speed_map(speed_file, motion, matte, white);
  query::MotionGuide guide;
  guide.direction = hints::read_orientation_map(way_file, motion.size());
  guide.speed = hints::read_speed_map(speed_file, motion.size(), white);
  std::filesystem::remove(way_file);
  std::filesystem::remove(speed_file);
  cv::Mat direction, speed;
  hints::split_motion(motion, matte, direction, speed);
  for (int y = 0; y < motion.rows; ++y)
    for (int x = 0; x < motion.cols; ++x) {
      const float written = speed.at<float>(y, x);
      right = right && std::abs(guide.speed.at<float>(y, x) - written) <= 0.01f * std::abs(written) + 0.02f;
      right = right && guide.direction.at<cv::Vec2f>(y, x).dot(direction.at<cv::Vec2f>(y, x)) >=
                           cv::norm(direction.at<cv::Vec2f>(y, x)) * std::cos(1 / kDegrees) - 1e-6;
    }
  return guide;
}

bool measure(const store::Snapshot& snapshot, const query::SearchBase& base, const Case& given,
             nlohmann::json& report) {
  query::LabelOptions options;
  options.candidates.class_name = given.class_name;
  options.candidates.min_duration_s = kSeconds;
  options.hint_search = query::HintSearch::kNarrow;
  options.guide_costs = query::default_guide_costs(options.hint_search);
  const query::Labelling free = query::label(snapshot, base, given.picture, given.matte, options);

  const hints::StrokeField field = hints::interpolate(
      hints::read_strokes(given.strokes, given.picture.size()), given.picture.size(), given.strokes);
  options.guide.direction = field.direction;
  options.guide.speed = field.speed;
  const query::Labelling guided = query::label(snapshot, base, given.picture, given.matte, options);
  const auto asked = query::asked_motion(options.guide, guided.search.target, given.matte);
  const Honoured without = honoured(base.table, free, asked), with = honoured(base.table, guided, asked);

  const cv::Mat motion = synth::animate::motion_field(
      snapshot, base.settings, synth::animate::placement_from(guided.assignment, snapshot),
      given.picture.size());
  bool right = true;
  options.guide = through_files(motion, given.matte, right);
  const query::Labelling again = query::label(snapshot, base, given.picture, given.matte, options);
  const std::vector<stored::Row> first = rows_of(guided), second = rows_of(again);
  Distance apart;
  int same_patch = 0, same_clip = 0;
  for (std::size_t piece = 0; piece < first.size(); ++piece) {
    same_patch += first[piece] == second[piece];
    same_clip += base.table.clip[first[piece]] == base.table.clip[second[piece]];
    const cv::Vec2f a = motion_of(base.table, first[piece]), b = motion_of(base.table, second[piece]);
    apart.add_angle(a, b);
    apart.add_speed(cv::norm(a), cv::norm(b));
  }
  const auto pieces = static_cast<double>(first.size());
  fmt::print(
      "| {} | {} | {:.0f} / {:.2f} | {:.1f} / {:.2f} | {:.0f} % | {:.1f} / {:.2f} | {:.0f} % | {:.0f} % | "
      "{:.1f} / {:.2f} |\n",
      given.name, first.size(), without.all.mean_angle(), without.all.mean_speed(), with.all.mean_angle(),
      with.all.mean_speed(), 100 * with.opened / pieces, with.unopened.mean_angle(),
      with.unopened.mean_speed(), 100 * same_patch / pieces, 100 * same_clip / pieces, apart.mean_angle(),
      apart.mean_speed());
  std::fflush(stdout);
  report["pictures"].push_back({{"picture", given.name},
                                {"pieces", first.size()},
                                {"without_strokes", to_json(without.all)},
                                {"with_strokes", to_json(with.all)},
                                {"opened", with.opened / pieces},
                                {"with_strokes_unopened", to_json(with.unopened)},
                                {"fed_back",
                                 {{"same_patch", same_patch / pieces},
                                  {"same_clip", same_clip / pieces},
                                  {"apart", to_json(apart)},
                                  {"maps_kept", right}}}});
  return right;
}

}  // namespace

int main(int argc, char** argv) try {
  std::string store, json_file;
  std::vector<std::string> cases;
  CLI::App app("Does the motion that is assigned go as strokes ask?");
  app.add_option("STORE", store)->required();
  app.add_option("CASE", cases, "PICTURE:MATTE:STROKES[:CLASS]")->required();
  app.add_option("--json", json_file, "Write the figures here");
  CLI11_PARSE(app, argc, argv);
  const store::Snapshot snapshot = store::Store::open_read(store).snapshot();
  const query::SearchBase base = query::open_search(snapshot);
  const bench::Machine machine = bench::this_machine();
  fmt::print("{}\n{} clips, {} patches\n\n", bench::to_string(machine), snapshot.clips().size(),
             base.table.size());
  fmt::print(
      "| picture | pieces | no strokes: angle / speed | strokes | opened | strokes, not opened | same patch "
      "| "
      "same clip | fed back |\n| --- | --: | --: | --: | --: | --: | --: | --: | --: |\n");
  nlohmann::json report{
      {"bench", "guidance"}, {"machine", bench::to_json(machine)}, {"patches", base.table.size()}};
  bool right = true;
  for (const std::string& one : cases) right = measure(snapshot, base, read_case(one), report) && right;
  report["right"] = right;
  if (!json_file.empty()) std::ofstream(json_file) << report.dump(1) << '\n';
  if (!right) fmt::print(stderr, "wrong: a map did not come back as it was written\n");
  return right ? 0 : 1;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
