// What does a hint do to the labels: does the look survive, does the motion go as asked, is one clip everywhere?
//
//   bench_hints STORE CASE.. [--try NAME=VALUE,..].. [--hints maps,direction,guess,none] [--json FILE]
//
// A case is a folder of a clip that the labels may not use: still.png, matte.png, its true mean motion as
// speed.png (white is what the file `white` says, px/s) and way.png, and a file `class`. Each is labelled with each
// hint and each set of options. Columns: pieces; mean likeness of the patches chosen; angle between their mean
// motion and the truth, degrees; signed and absolute log2 of their speed over the truth's, and of the median speed of
// all candidates of all pieces over it; largest share of a clip, of so many, and of a patch; neighbours that
// continue each other; half seconds in which a patch's flow goes against its mean; gap; seconds of search, tables
// and solver.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "bench/harness/machine.h"
#include "bench/harness/median.h"
#include "freshet/error.h"
#include "hints/motion_maps.h"
#include "media/picture/picture.h"
#include "query/labelling/label_map.h"
#include "query/labelling/label_request.h"
#include "vision/flow.h"

namespace {

using namespace freshet;

constexpr double kDegrees = 180 / CV_PI;
constexpr float kMoving = 2.5f;  // px/s

struct Case {
  std::string name, class_name;
  cv::Mat still, matte, motion;  // CV_8UC3, CV_8U, CV_32FC2 px/s
};

std::string first_line(const std::filesystem::path& path) {
  std::string line;
  std::ifstream file(path);
  std::getline(file, line);
  return line;
}

Case read_case(const std::filesystem::path& folder) {
  Case read{folder.filename().string(),
            first_line(folder / "class"),
            media::read_picture(folder / "still.png").bgr,
            {},
            {}};
  const cv::Size size = read.still.size();
  read.matte = media::read_matte(folder / "matte.png", size).alpha;
  const cv::Mat way = hints::read_orientation_map(folder / "way.png", size),
                speed = hints::read_speed_map(folder / "speed.png", size,
                                              std::stod(first_line(folder / "white")));
  read.motion.create(size, CV_32FC2);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      read.motion.at<cv::Vec2f>(y, x) = way.at<cv::Vec2f>(y, x) * std::max(0.f, speed.at<float>(y, x));
  return read;
}

/// A clip's flow by half seconds and blocks of 16 flow samples, px/s of the clip.
class SlowFlow {
 public:
  explicit SlowFlow(const store::Snapshot& snapshot) : snapshot_(snapshot) {}

  const std::vector<cv::Mat>& of(store::ClipId clip) {
    auto& found = flows_[clip];
    if (!found.empty()) return found;
    const store::ClipRecord& record = snapshot_.clip(clip);
    const store::PlaneShape plane = record.flow.planes[0];
    const double fps = static_cast<double>(record.fps_num) / record.fps_den;
    const auto span = static_cast<std::uint32_t>(std::max(1.0, std::round(fps / 2)));
    std::vector<std::int16_t> samples;
    for (std::uint32_t from = 0; from + span <= record.flow.frames; from += span) {
      std::array<cv::Mat, 2> parts;
      for (std::uint32_t p = 0; p < 2; ++p) {
        samples.resize(std::size_t{plane.width} * plane.height * span);
        snapshot_.read(clip, store::Stream::kFlow, p, {0, 0, plane.width, plane.height}, from, span,
                       std::as_writable_bytes(std::span(samples)));
        cv::Mat sum;
        for (std::uint32_t i = 0; i < span; ++i) {
          const cv::Mat frame(static_cast<int>(plane.height), static_cast<int>(plane.width), CV_16S,
                              samples.data() + std::size_t{plane.width} * plane.height * i);
          cv::Mat one;
          frame.convertTo(one, CV_32F, vision::kFlowUnit * fps / span);
          sum = sum.empty() ? one : cv::Mat(sum + one);
        }
        cv::resize(sum, parts[p],
                   {static_cast<int>(plane.width + 15) / 16, static_cast<int>(plane.height + 15) / 16}, 0, 0,
                   cv::INTER_AREA);
      }
      cv::merge(parts.data(), 2, found.emplace_back());
    }
    return found;
  }

 private:
  const store::Snapshot& snapshot_;
  std::map<store::ClipId, std::vector<cv::Mat>> flows_;
};

struct Figures {
  double pieces = 0, score = 0, angle = 0, log2 = 0, abs_log2 = 0, clip = 0, patch = 0, coherent = 0,
         back = 0, gap = 0, clips = 0, seconds = 0;
  double looks_log2 = 0, looks_abs_log2 = 0;  // of the median speed of all candidates
};

void set(query::LabelRequest& request, const std::string& name, const std::string& value) {
  query::LabelOptions& options = request.options;
  const auto number = [&] { return std::stod(value); };
  if (name == "search")
    options.hint_search = query::parse_hint_search(value);
  else if (name == "direction")
    options.guide_costs.direction = number();
  else if (name == "speed")
    options.guide_costs.speed = number();
  else if (name == "unsteady")
    options.guide_costs.unsteady = number();
  else if (name == "reuse")
    options.reuse.overlap = number();
  else if (name == "crowd")
    options.reuse.crowd = number();
  else if (name == "vote")
    options.costs.vote = number();
  else if (name == "lambda")
    options.costs.lambda = number();
  else if (name == "considered")
    options.candidates.considered = std::stoi(value);
  else
    throw Error(ErrorKind::kUsage, name, "no such option");
}

Figures measure(const store::Snapshot& snapshot, const query::SearchBase& base, SlowFlow& flow,
                const Case& given, const query::LabelRequest& request, const std::string& map) {
  const query::PreparedLabelling prepared = query::prepare(snapshot, base, given.still, given.matte, request);
  const query::Labelling labelling = query::label(snapshot, base, given.still, given.matte, prepared.options);
  const query::Assignment& assignment = labelling.assignment;
  const query::Target& target = labelling.search.target;
  const std::vector<vision::Variant> variants = base.settings.variants();
  Figures figures;
  figures.pieces = static_cast<double>(assignment.pieces.size());
  figures.clips = static_cast<double>(assignment.clips.size());
  figures.gap = assignment.gap();
  const auto& s = labelling.seconds;
  figures.seconds = s.search + s.costs + s.minimize;
  std::map<std::uint32_t, double> clips;
  std::map<stored::Row, double> rows;
  std::vector<stored::Row> chosen;
  double moving = 0, blocks = 0, back = 0, angle = 0, log2 = 0, abs_log2 = 0;
  std::vector<double> truths, speeds;  // log2: of moving pieces, of all their candidates
  for (std::size_t i = 0; i < target.size(); ++i) {
    const stored::Row row = labelling.search.candidates.rows_of(i)[labelling.labels[i]];
    chosen.push_back(row);
    figures.score += assignment.pieces[i].score / figures.pieces;
    clips[base.table.clip[row]] += 1 / figures.pieces;
    rows[row] += 1 / figures.pieces;
    const cv::Rect box =
        cv::Rect(target.corners[i], cv::Size(target.side, target.side)) & cv::Rect({}, given.still.size());
    const cv::Scalar mean = cv::mean(given.motion(box), given.matte(box) > 127);
    const cv::Vec2f truth(static_cast<float>(mean[0]), static_cast<float>(mean[1]));
    const cv::Vec2f own(base.table.mean_u[row], base.table.mean_v[row]);
    if (cv::norm(truth) < kMoving) continue;
    ++moving;
    truths.push_back(std::log2(cv::norm(truth)));
    for (const stored::Row candidate : labelling.search.candidates.rows_of(i))
      speeds.push_back(
          std::log2(std::max(0.1, std::hypot(static_cast<double>(base.table.mean_u[candidate]),
                                             static_cast<double>(base.table.mean_v[candidate])))));
    angle +=
        cv::norm(own) > 0
            ? std::acos(std::clamp(own.dot(truth) / (cv::norm(own) * cv::norm(truth)), -1.0, 1.0)) * kDegrees
            : 90;
    const double ratio = std::log2(std::max(cv::norm(own), 0.1) / cv::norm(truth));
    log2 += ratio;
    abs_log2 += std::abs(ratio);
    // Half seconds in which the patch, turned to the truth, goes back.
    const store::ClipId clip = base.table.clips[base.table.clip[row]];
    const store::ClipRecord& record = snapshot.clip(clip);
    const vision::VariantFrame frame = vision::variant_frame(
        {static_cast<int>(record.width), static_cast<int>(record.height)}, variants[base.table.variant[row]]);
    const double half = base.settings.grid.patch / 2.0;
    const cv::Vec2d at =
        frame.source_from_variant * cv::Vec3d(base.table.x[row] + half, base.table.y[row] + half, 1);
    for (const cv::Mat& field : flow.of(clip)) {
      const cv::Vec2f v = field.at<cv::Vec2f>(
          std::clamp(static_cast<int>(at[1] / (16 * base.settings.flow_step)), 0, field.rows - 1),
          std::clamp(static_cast<int>(at[0] / (16 * base.settings.flow_step)), 0, field.cols - 1));
      const cv::Vec2d turned = frame.variant_from_source_velocity * cv::Vec2d(v[0], v[1]);
      ++blocks;
      back += turned[0] * own[0] + turned[1] * own[1] < 0;
    }
  }
  for (const auto& [clip, share] : clips) figures.clip = std::max(figures.clip, share);
  for (const auto& [row, share] : rows) figures.patch = std::max(figures.patch, share);
  for (const auto& [p, q] : target.edges) {
    const cv::Point step = (target.places[q] - target.places[p]) * target.stride;
    const stored::Row a = chosen[p], b = chosen[q];
    figures.coherent +=
        base.table.clip[a] == base.table.clip[b] && base.table.variant[a] == base.table.variant[b] &&
        base.table.x[b] - base.table.x[a] == step.x && base.table.y[b] - base.table.y[a] == step.y;
  }
  figures.coherent /= std::max<double>(1, static_cast<double>(target.edges.size()));
  if (moving > 0) {
    figures.angle = angle / moving;
    figures.log2 = log2 / moving;
    figures.abs_log2 = abs_log2 / moving;
    figures.back = back / std::max(1.0, blocks);
    const double looks = bench::median(speeds);
    for (const double truth : truths) {
      figures.looks_log2 += (looks - truth) / moving;
      figures.looks_abs_log2 += std::abs(looks - truth) / moving;
    }
  }
  if (!map.empty()) media::write_picture(map, query::label_map(given.still, &given.matte, assignment));
  return figures;
}

std::string row_of(const std::string& name, const Figures& f) {
  return fmt::format(
      "| {} | {:.0f} | {:.3f} | {:.0f} | {:+.2f}, {:.2f} | {:+.2f}, {:.2f} | {:.0f} of {:.1f} | {:.1f} | "
      "{:.2f} | "
      "{:.1f} | {:.2f} | {:.1f} |",
      name, f.pieces, f.score, f.angle, f.log2, f.abs_log2, f.looks_log2, f.looks_abs_log2, 100 * f.clip,
      f.clips, 100 * f.patch, f.coherent, 100 * f.back, 100 * f.gap, f.seconds);
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("What does a hint do to the labels?");
  std::string store_path, json_path, maps;
  std::vector<std::string> folders, tries, hints{"maps"};
  bool totals = false;
  app.add_option("STORE", store_path)->required();
  app.add_option("CASES", folders)->required();
  app.add_option("--try", tries, "NAME=VALUE,..: one more set of options");
  app.add_option("--hints", hints, "maps, direction, guess, none")->delimiter(',');
  app.add_option("--maps", maps, "Write label maps to this folder");
  app.add_flag("--totals", totals, "Means alone");
  app.add_option("--json", json_path);
  CLI11_PARSE(app, argc, argv);

  const store::Snapshot snapshot = store::Store::open_read(store_path).snapshot();
  const query::SearchBase base = query::open_search(snapshot);
  SlowFlow flow(snapshot);
  if (tries.empty()) tries.push_back("");
  fmt::print(
      "{}\n\n| case, hint, options | pieces | likeness | angle | speed | by looks | clip % | patch % | "
      "coherent | back % | gap % | s |\n",
      bench::to_string(bench::this_machine()));
  nlohmann::json json{{"machine", bench::to_json(bench::this_machine())}};
  std::map<std::string, std::vector<Figures>> all;
  for (const std::string& folder : folders) {
    const Case given = read_case(folder);
    for (const std::string& hint : hints)
      for (const std::string& text : tries) {
        query::LabelRequest request;
        request.duration_s = 96 / 25.0;
        request.options.candidates.class_name = given.class_name;
        for (const store::ClipId clip : snapshot.clips())
          if (snapshot.clip(clip).name.find(given.name) != std::string::npos)
            request.options.candidates.excluded_clips = {snapshot.clip(clip).name};
        std::istringstream stream(text);
        for (std::string part; std::getline(stream, part, ',');)
          set(request, part.substr(0, part.find('=')), part.substr(part.find('=') + 1));
        cv::Mat direction, speed;
        hints::split_motion(given.motion, given.matte, direction, speed);
        if (hint == "maps") {
          request.options.guide.direction = direction;
          request.options.guide.speed = speed;
        } else if (hint == "direction") {
          const cv::Scalar mean = cv::mean(given.motion, given.matte > 127);
          const double length = std::hypot(mean[0], mean[1]);
          request.options.guide.direction =
              cv::Mat(given.still.size(), CV_32FC2, cv::Scalar(mean[0] / length, mean[1] / length));
        }
        request.guesses = hint == "guess";
        const std::string name = hint + " " + text;
        const std::string map =
            maps.empty() ? "" : maps + "/" + given.name + "_" + hint + "_" + text + ".png";
        const Figures figures = measure(snapshot, base, flow, given, request, map);
        if (!totals) fmt::print("{}\n", row_of(given.class_name + " " + given.name + ", " + name, figures));
        std::fflush(stdout);
        for (const std::string& group : {given.class_name, std::string("all")}) {
          auto& list = all[name + " | " + group];
          list.push_back(figures);
        }
      }
  }
  for (const auto& [name, list] : all) {
    Figures mean;
    for (const Figures& f : list) {
      const double n = static_cast<double>(list.size());
      for (double Figures::*const of :
           {&Figures::pieces, &Figures::score, &Figures::angle, &Figures::log2, &Figures::abs_log2,
            &Figures::clip, &Figures::patch, &Figures::coherent, &Figures::back, &Figures::gap,
            &Figures::clips, &Figures::seconds, &Figures::looks_log2, &Figures::looks_abs_log2})
        mean.*of += f.*of / n;
    }
    fmt::print("{}\n", row_of(name, mean));
    json["means"][name] = {{"clips", list.size()},
                           {"likeness", mean.score},
                           {"angle_deg", mean.angle},
                           {"log2_speed", mean.log2},
                           {"abs_log2_speed", mean.abs_log2},
                           {"looks_log2_speed", mean.looks_log2},
                           {"looks_abs_log2_speed", mean.looks_abs_log2},
                           {"clip_share", mean.clip},
                           {"patch_share", mean.patch},
                           {"coherent", mean.coherent},
                           {"back", mean.back},
                           {"gap", mean.gap},
                           {"seconds", mean.seconds}};
  }
  if (!json_path.empty()) std::ofstream(json_path) << json.dump(2) << '\n';
} catch (const freshet::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
