// Does TV-L1 label better than DIS, for the 4.3 to 5 times that it takes?
//
//   bench_flow_choice CLIP.. [--frames N] [--width PX] [--json FILE]
//   bench_flow_choice $FRESHET_FOOTAGE/clips/{water/brook_mossy_rocks.mp4,fire/flames_wall_black.mp4,...}
//
// First how far either is off where the truth is known: real texture, warped by a smooth flow, with noise.
// Then a store is made with each, of the clips' first frames reduced to one width, and each clip is once held
// out: its middle frame is labelled from the other clips of its class, and the motion that it gets, piece by
// piece, is compared with the motion that it had, as either method measured it; without a hint and with the
// clip's mean direction as one. Last, whether labels chosen by one method's costs are good by the other's.

#include <fmt/format.h>
#include <stdlib.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "bench/harness/machine.h"
#include "freshet/error.h"
#include "ingest/clip_analysis.h"
#include "ingest/ingest.h"
#include "media/video/video_reader.h"
#include "media/video/video_writer.h"
#include "query/costs/stored_features.h"
#include "query/index/index_builder.h"
#include "query/labelling/labelling.h"
#include "store/store.h"
#include "stored/clip_cells.h"
#include "stored/clip_frames.h"
#include "vision/flow.h"
#include "vision/patch_features.h"

namespace {

using namespace freshet;
namespace fs = std::filesystem;

constexpr vision::FlowMethod kMethods[] = {vision::FlowMethod::kDis, vision::FlowMethod::kTvL1};
constexpr const char* kNames[] = {"DIS", "TV-L1"};
constexpr double kMinSpeed = 2.5;  // px/s; slower motion has no direction that counts

/// The clip's first frames at one width, lossless, in a folder of its class.
fs::path reduced(const fs::path& clip, const fs::path& folder, int max_frames, int width) {
  media::VideoReader reader(clip);
  const fs::path to = folder / clip.parent_path().filename() / (clip.stem().string() + ".mkv");
  fs::create_directories(to.parent_path());
  std::optional<media::VideoWriter> writer;
  for (int i = 0; i < max_frames; ++i) {
    const auto frame = reader.next();
    if (!frame) break;
    const cv::Mat picture = media::to_bgr(*frame);
    const cv::Size size(width, static_cast<int>(std::lround(1.0 * picture.rows * width / picture.cols)));
    cv::Mat small;
    cv::resize(picture, small, size, 0, 0, cv::INTER_AREA);
    if (!writer)
      writer.emplace(to, size, media::VideoWriterOptions{reader.info().fps_num, reader.info().fps_den});
    writer->write(small);
  }
  if (writer) writer->finish();
  return to;
}

// ---- Known motion -------------------------------------------------------------------------------------

struct KnownMotion {
  cv::Mat from, to, flow;
};

/// Real texture that swirls: a shift of `speed` px, and waves of half of it. What lies at p in `from` lies at
/// p + flow(p) in `to`, so `from` is read out of `to`; then both get noise of their own.
KnownMotion known_motion(const cv::Mat& texture, double speed, double noise, double angle) {
  KnownMotion motion;
  motion.flow.create(texture.size(), CV_32FC2);
  cv::Mat places(texture.size(), CV_32FC2);
  for (int y = 0; y < texture.rows; ++y) {
    for (int x = 0; x < texture.cols; ++x) {
      const cv::Vec2f flow(static_cast<float>(speed * (std::cos(angle) + 0.5 * std::sin(y / 17.0 + angle))),
                           static_cast<float>(speed * (std::sin(angle) + 0.5 * std::cos(x / 23.0))));
      motion.flow.at<cv::Vec2f>(y, x) = flow;
      places.at<cv::Vec2f>(y, x) = cv::Vec2f(static_cast<float>(x), static_cast<float>(y)) + flow;
    }
  }
  cv::Mat moved;
  cv::remap(texture, moved, places, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  cv::RNG random(9);
  const auto noisy = [&](const cv::Mat& picture) {
    cv::Mat grain(picture.size(), CV_32F), sum;
    random.fill(grain, cv::RNG::NORMAL, 0, noise);
    cv::add(picture, grain, sum, cv::noArray(), CV_8U);
    return sum;
  };
  motion.from = noisy(moved);
  motion.to = noisy(texture);
  return motion;
}

/// Mean distance between two flows, px, except in a margin that sees beyond the picture's edge.
double end_point_error(const cv::Mat& flow, const cv::Mat& truth) {
  constexpr int kMargin = 24;
  double sum = 0;
  int count = 0;
  for (int y = kMargin; y < flow.rows - kMargin; ++y) {
    for (int x = kMargin; x < flow.cols - kMargin; ++x, ++count) {
      sum += cv::norm(flow.at<cv::Vec2f>(y, x) - truth.at<cv::Vec2f>(y, x));
    }
  }
  return sum / count;
}

// ---- Two stores of the same clips ---------------------------------------------------------------------

struct Side {
  vision::Settings settings;
  store::Store store;
  std::optional<store::Snapshot> snapshot;
  query::SearchBase base;
  double flow_seconds = 0;
};

Side make_side(vision::FlowMethod method, const std::vector<fs::path>& clips, const fs::path& file) {
  Side side;
  side.settings.flow.method = method;
  side.store = store::Store::create(file, vision::to_json(side.settings));
  for (const fs::path& clip : clips) {  // one by one: clips in the given order, whatever their names
    const std::vector one{clip};
    const auto report = ingest::ingest(side.store, side.settings, one, {.force = true});
    if (report.count(ingest::Outcome::kAdded) != 1) {
      throw Error(ErrorKind::kInput, clip.string(), report.clips.at(0).reasons.at(0));
    }
    side.flow_seconds += report.clips[0].seconds.flow;
  }
  query::build_index(side.store);
  side.snapshot = side.store.snapshot();
  side.base = query::open_search(*side.snapshot);
  return side;
}

/// What of a clip moves, as ingest has it, from the flow that the store keeps.
cv::Mat moving_mask(const Side& side, store::ClipId id) {
  const store::ClipRecord& record = side.snapshot->clip(id);
  const auto& shape = record.flow.planes.at(0);
  const std::size_t pixels = std::size_t{shape.width} * shape.height;
  std::array<std::vector<std::int16_t>, 2> planes;
  for (std::uint32_t p = 0; p < 2; ++p) {
    planes[p].resize(pixels * record.flow.frames);
    side.snapshot->read(id, store::Stream::kFlow, p, {0, 0, shape.width, shape.height}, 0, record.flow.frames,
                        std::as_writable_bytes(std::span(planes[p])));
  }
  cv::Mat speed(static_cast<int>(shape.height), static_cast<int>(shape.width), CV_32F, cv::Scalar(0));
  auto* const sum = speed.ptr<float>();
  for (std::size_t i = 0; i < planes[0].size(); ++i) {
    sum[i % pixels] += std::hypot(static_cast<float>(planes[0][i]), static_cast<float>(planes[1][i]));
  }
  speed *= vision::kFlowUnit / static_cast<float>(record.flow.frames);
  const stored::ClipFrames frames(*side.snapshot, id);
  ingest::LumaStatistics luma(cv::Size(static_cast<int>(record.width), static_cast<int>(record.height)));
  for (const media::Frame& frame : frames.read(0, frames.size())) luma.add(media::to_luma(frame));
  const double fps = static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den);
  return ingest::moving_mask(speed, luma.deviation(), fps, side.settings);
}

// ---- Motion got against motion had --------------------------------------------------------------------

std::vector<cv::Vec2f> motion_had(const Side& side, store::ClipId id, const query::Target& target) {
  const vision::CellMap cells = stored::motion_cells(*side.snapshot, side.settings, id);
  const vision::VariantFrame frame = vision::variant_frame(target.picture, {});
  std::vector<cv::Vec2f> motion;
  for (const cv::Point& corner : target.corners) {
    motion.push_back(vision::patch_mean_motion(cells, frame, corner.x, corner.y, target.side));
  }
  return motion;
}

std::vector<cv::Vec2f> motion_got(const query::CandidateSearch& search, const query::Labels& labels) {
  std::vector<cv::Vec2f> motion;
  for (std::size_t piece = 0; piece < labels.size(); ++piece) {
    const stored::Row row = search.candidates.rows_of(piece)[labels[piece]];
    motion.emplace_back(search.table().mean_u[row], search.table().mean_v[row]);
  }
  return motion;
}

/// Means over pieces, then over clips.
struct Misfit {
  double angle_deg = 0, log2_speed = 0, abs_log2_speed = 0;
  int count = 0;
  void add(const Misfit& other) {
    angle_deg += other.angle_deg;
    log2_speed += other.log2_speed;
    abs_log2_speed += other.abs_log2_speed;
    count += other.count;
  }
  Misfit mean() const {
    const double n = std::max(1, count);
    return {angle_deg / n, log2_speed / n, abs_log2_speed / n, count > 0 ? 1 : 0};
  }
};

Misfit misfit(const std::vector<cv::Vec2f>& got, const std::vector<cv::Vec2f>& had) {
  Misfit sum;
  for (std::size_t i = 0; i < got.size(); ++i) {
    const double speed = cv::norm(had[i]);
    if (speed < kMinSpeed) continue;
    const double turn = std::atan2(got[i][1], got[i][0]) - std::atan2(had[i][1], had[i][0]);
    const double ratio = std::log2(std::max(cv::norm(got[i]), 0.1) / speed);
    sum.add({std::abs(std::remainder(turn, 2 * std::numbers::pi)) * 180 / std::numbers::pi, ratio,
             std::abs(ratio), 1});
  }
  return sum.mean();
}

query::Mrf field_of(const Side& side, const query::CandidateSearch& search) {
  query::StoredFeatures features(*side.snapshot, side.settings, search.table());
  return build_mrf(search.target, search.candidates, query::feature_shape(side.settings), {},
                   features.source());
}

// ---- What is measured, step by step -------------------------------------------------------------------

double seconds_of_flow(const cv::Mat& from, const cv::Mat& to, const vision::FlowOptions& options) {
  const double start = bench::process_seconds();
  vision::optical_flow(from, to, options);
  return bench::process_seconds() - start;
}

/// How far each method is off where motion is known, and what a real frame costs it. By method.
struct KnownErrors {
  std::array<double, 2> seconds{}, vga_seconds{};                     // CPU, per frame
  std::map<std::pair<double, double>, std::array<double, 2>> errors;  // px, by speed and noise
};

KnownErrors known_errors(const std::vector<fs::path>& clips) {
  KnownErrors known;
  const auto count = static_cast<double>(clips.size());
  for (std::size_t c = 0; c < clips.size(); ++c) {
    media::VideoReader reader(clips[c]);
    const cv::Mat first = media::to_luma(*reader.next()), second = media::to_luma(*reader.next());
    const double angle = 1.0 + 2.4 * static_cast<double>(c);
    for (std::size_t m = 0; m < 2; ++m) {
      const vision::FlowOptions options{kMethods[m]};
      known.seconds[m] += seconds_of_flow(first, second, options) / count;
      for (const double speed : {0.5, 2.0, 6.0})
        for (const double noise : {1.0, 4.0}) {
          const KnownMotion motion = known_motion(first, speed, noise, angle);
          const cv::Mat flow = vision::optical_flow(motion.from, motion.to, options);
          known.errors[{speed, noise}][m] += end_point_error(flow, motion.flow) / count;
        }
      if (c > 0) continue;
      cv::Mat from, to;
      cv::resize(first, from, {640, 480}), cv::resize(second, to, {640, 480});
      known.vga_seconds[m] = seconds_of_flow(from, to, options);
    }
  }
  return known;
}

void print(const KnownErrors& known, nlohmann::json& json) {
  fmt::print("\nCPU seconds per frame: DIS {:.4f}, TV-L1 {:.3f}; of 640 x 480: {:.4f}, {:.3f}\n",
             known.seconds[0], known.seconds[1], known.vga_seconds[0], known.vga_seconds[1]);
  json["cpu_seconds_a_frame"] = known.seconds;
  json["cpu_seconds_a_frame_640x480"] = known.vga_seconds;
  fmt::print("\n{:>9}{:>7}{:>12}{:>12}   end-point error, px\n", "speed px", "noise", kNames[0], kNames[1]);
  for (const auto& [of, error] : known.errors) {
    fmt::print("{:>9}{:>7}{:>12.3f}{:>12.3f}\n", of.first, of.second, error[0], error[1]);
    json["known_motion"].push_back(
        {{"speed_px", of.first}, {"noise", of.second}, {"dis_px", error[0]}, {"tvl1_px", error[1]}});
  }
  std::fflush(stdout);
}

std::array<Side, 2> make_sides(const std::vector<fs::path>& clips, const fs::path& folder) {
  std::array<Side, 2> sides;
  for (std::size_t m = 0; m < 2; ++m) {
    sides[m] = make_side(kMethods[m], clips, folder / fmt::format("{}.freshet", m));
    fmt::print("{} store: {:.1f} s of flow, {} patches\n", kNames[m], sides[m].flow_seconds,
               stored::read_patch_table(*sides[m].snapshot).size());
    std::fflush(stdout);
  }
  return sides;
}

/// Each clip once held out, labelled from the others of its class in either store.
class HeldOut {
 public:
  HeldOut(const std::array<Side, 2>& sides, nlohmann::json& json) : sides_(sides), json_(json) {}

  void label(store::ClipId id);
  void print() const;

 private:
  struct Still {  // of the clip held out
    store::ClipId id;
    const store::ClipRecord& record;
    cv::Mat picture, matte;
    std::optional<double> direction_deg;  // its mean motion's, once it is known
  };
  std::optional<query::CandidateSearch> search(const Still& still, std::size_t method, bool hinted) const;
  void judge(Still& still, std::size_t method, bool hinted, const query::CandidateSearch& search);
  void note(const Still& still, const std::array<std::string, 3>& row, const std::vector<cv::Vec2f>& got,
            const std::vector<cv::Vec2f>& had);

  const std::array<Side, 2>& sides_;
  nlohmann::json& json_;
  std::map<std::array<std::string, 3>, Misfit>
      misfits_;                                  // by how labelled, with which store, measured by which
  std::array<double, 2> loss_{}, worst_loss_{};  // labels of DIS under TV-L1's costs; the reverse
  int clips_ = 0;
};

void HeldOut::label(store::ClipId id) {
  const store::ClipRecord& record = sides_[0].snapshot->clip(id);
  const stored::ClipFrames frames(*sides_[0].snapshot, id);
  Still still{id, record, media::to_bgr(frames.read(frames.size() / 2)),
              moving_mask(sides_[0], id) & moving_mask(sides_[1], id), std::nullopt};
  if (cv::countNonZero(still.matte) == 0) {
    fmt::print("{}: nothing moves\n", record.name);
    return;
  }
  ++clips_;
  for (const bool hinted : {false, true})
    for (std::size_t m = 0; m < 2; ++m)
      if (const auto found = search(still, m, hinted)) judge(still, m, hinted, *found);
}

std::optional<query::CandidateSearch> HeldOut::search(const Still& still, std::size_t method,
                                                      bool hinted) const {
  const Side& side = sides_[method];
  query::LabelOptions options;
  options.candidates.class_name = still.record.class_name;
  options.candidates.excluded_clips = {still.record.name};
  if (hinted) options.candidates.direction_deg = still.direction_deg;
  try {
    return query::search_candidates(*side.snapshot, side.base, still.picture, still.matte, options);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kNotFound) throw;
    fmt::print("{}, {}: {}\n", still.record.name, kNames[method], error.what());
    return std::nullopt;
  }
}

void HeldOut::judge(Still& still, std::size_t method, bool hinted, const query::CandidateSearch& search) {
  const std::array had{motion_had(sides_[0], still.id, search.target),
                       motion_had(sides_[1], still.id, search.target)};
  if (!still.direction_deg) {
    cv::Vec2f sum;
    for (const auto& motion : had)
      for (const cv::Vec2f& each : motion) sum += each;
    still.direction_deg = std::atan2(-sum[1], sum[0]) * 180 / std::numbers::pi;
    if (*still.direction_deg < 0) *still.direction_deg += 360;
    note(still, {"the clip itself", kNames[0], kNames[1]}, had[0], had[1]);
    note(still, {"the clip itself", kNames[1], kNames[0]}, had[1], had[0]);
  }

  // The labels' motion against what either method measured.
  const std::string how = hinted ? "direction given" : "no hint";
  const query::Mrf own = field_of(sides_[method], search), other = field_of(sides_[1 - method], search);
  const query::Solution solution = minimize(own, query::Minimizer::kTrwS);
  for (std::size_t truth = 0; truth < 2; ++truth) {
    note(still, {how, kNames[method], kNames[truth]}, motion_got(search, solution.labels), had[truth]);
    note(still, {how + ", best likeness alone", kNames[method], kNames[truth]},
         motion_got(search, unary_minimum(own)), had[truth]);
  }
  if (hinted) return;

  // The labels by the other method's costs.
  const double best = minimize(other, query::Minimizer::kTrwS).energy;
  const double above = energy(other, solution.labels) / best - 1;
  loss_[method] += above;
  worst_loss_[method] = std::max(worst_loss_[method], above);
  json_["cross_energy"].push_back(
      {{"clip", still.record.name}, {"labels_of", kNames[method]}, {"loss", above}});
}

void HeldOut::note(const Still& still, const std::array<std::string, 3>& row,
                   const std::vector<cv::Vec2f>& got, const std::vector<cv::Vec2f>& had) {
  const Misfit of = misfit(got, had);
  misfits_[row].add(of);
  json_["held_out"].push_back({{"clip", still.record.name},
                               {"how", row[0]},
                               {"store", row[1]},
                               {"measured_by", row[2]},
                               {"pieces", got.size()},
                               {"angle_deg", of.angle_deg},
                               {"log2_speed", of.log2_speed},
                               {"abs_log2_speed", of.abs_log2_speed}});
}

void HeldOut::print() const {
  fmt::print("\n{:<34}{:<8}{:<12}{:>10}{:>12}{:>14}{:>7}\n", "labelled", "store", "measured by", "angle deg",
             "log2 speed", "|log2 speed|", "clips");
  for (const auto& [row, sum] : misfits_) {
    const Misfit mean = sum.mean();
    fmt::print("{:<34}{:<8}{:<12}{:>10.1f}{:>12.2f}{:>14.2f}{:>7}\n", row[0], row[1], row[2], mean.angle_deg,
               mean.log2_speed, mean.abs_log2_speed, sum.count);
  }
  fmt::print(
      "\nenergy above the other method's optimum: DIS's labels {:.2f} % (worst {:.2f}), TV-L1's {:.2f} % "
      "(worst {:.2f})\n",
      100 * loss_[0] / clips_, 100 * worst_loss_[0], 100 * loss_[1] / clips_, 100 * worst_loss_[1]);
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<fs::path> clips;
  int max_frames = 60, width = 352;
  std::string json_file;
  CLI::App app("Does TV-L1 label better than DIS, for the time that it takes?");
  app.add_option("CLIP", clips, "At least two")->required()->expected(2, -1);
  app.add_option("--frames", max_frames, "The first frames of each clip")->capture_default_str();
  app.add_option("--width", width, "That each clip is reduced to, px")->capture_default_str();
  app.add_option("--json", json_file, "Write the figures here");
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  std::string name = (fs::temp_directory_path() / "flow_choice_XXXXXX").string();
  const fs::path folder = mkdtemp(name.data());
  for (fs::path& clip : clips) clip = reduced(fs::absolute(clip), folder, max_frames, width);
  nlohmann::json json{
      {"bench", "flow_choice"}, {"compiler", __VERSION__}, {"frames", max_frames}, {"width", width}};
  fmt::print("{} clips of {} frames, {} px wide; compiler {}\n", clips.size(), max_frames, width,
             __VERSION__);

  print(known_errors(clips), json);
  {
    const std::array<Side, 2> sides = make_sides(clips, folder);
    HeldOut held_out(sides, json);
    for (const store::ClipId id : sides[0].snapshot->clips()) held_out.label(id);
    held_out.print();
  }
  if (!json_file.empty()) std::ofstream(json_file) << json.dump(1) << '\n';
  fs::remove_all(folder);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
