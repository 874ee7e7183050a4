#include "synth/tour/tour.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"

namespace freshet::synth::tour {
namespace {

constexpr double kUsualSeconds = 4, kUsualFps = 25;
constexpr int kMostFrames = 1'000'000, kMaxSide = 16384;
constexpr double kLeastNarrowed = 0.4;  // a view narrower than that is another picture
constexpr double kAhead = 0.05;         // least part straight ahead of a ray whose length along the axis is 1
constexpr int kMoments = 33;            // at which a path is tried

std::string where_of(const TourPlan& plan) { return plan.file.empty() ? "synth tour" : plan.file.string(); }

double fps_of(const Film& film, const TourOptions& options) {
  return options.fps > 0 ? options.fps : film.fps() > 0 ? film.fps() : kUsualFps;
}

int frames_of(Film& film, const TourPlan& plan, const TourOptions& options) {
  const double fps = fps_of(film, options);
  double frames = options.frames;
  if (options.frames == 0) {
    if (plan.seconds)
      frames = std::round(*plan.seconds * fps);
    else if (plan.keys.size() > 1)
      frames = std::round(plan.keys.back().time_s * fps) + 1;
    else if (film.frames() > 1)
      frames = std::round(film.frames() * fps / film.fps());
    else
      frames = std::round(kUsualSeconds * fps);
  }
  if (frames > kMostFrames)
    throw Error(ErrorKind::kInput, where_of(plan), fmt::format("a tour of {:.0f} frames", frames),
                fmt::format("At most {} go into one", kMostFrames));
  return std::max(1, static_cast<int>(frames));
}

cv::Size size_of(const Film& film, const TourOptions& options) {
  cv::Size size = options.size;
  if (size.width == 0 && size.height == 0) size = film.size();
  if (size.width == 0) size.width = cvRound(1.0 * size.height * film.size().width / film.size().height);
  if (size.height == 0) size.height = cvRound(1.0 * size.width * film.size().height / film.size().width);
  if (size.width < 1 || size.height < 1 || std::max(size.width, size.height) > kMaxSide)
    throw Error(ErrorKind::kUsage, fmt::format("--size {}x{}", size.width, size.height),
                "no frame has that size", fmt::format("Give 1 to {} px each way", kMaxSide));
  return size;
}

/// A matte that goes on so many px around it, the outer third softly: what ends at once is seen to be cut out.
cv::Mat widened(const cv::Mat& matte, int by_px) {
  cv::Mat away, out;
  cv::distanceTransform(matte < 128, away, cv::DIST_L2, 5);
  away = 255 * 3 * (1 - away / (by_px + 1));
  away.convertTo(out, CV_8U);
  return cv::max(out, matte);
}

std::vector<Upright> uprights(const TourPlan& plan, const Film& film, const Room& room,
                              std::vector<std::string>& notices) {
  std::vector<Upright> things;
  for (const TourThing& thing : plan.things) {
    const media::Matte matte = media::read_matte(thing.matte, film.size());
    for (const std::string& notice : matte.notices) notices.push_back(thing.matte.string() + ": " + notice);
    const cv::Mat grown = thing.grow_px > 0 ? widened(matte.alpha, thing.grow_px) : matte.alpha;
    things.push_back({thing.name, grown, depth_of(thing, plan, matte.alpha, room)});
  }
  return things;
}

Path path_of(const TourPlan& plan, const Room& room, const Scenery& scenery, int frames, double fps) {
  if (!plan.keys.empty()) return Path(plan.keys, plan.ease);
  const Move move = plan.move.value_or(Move::kIn);
  // Not through what stands there: it would fill the view.
  double ahead = room.nearest_floor(), pivot = 2 * ahead;
  if (std::isfinite(room.back_depth())) {
    ahead = std::min(ahead, 0.6 * room.back_depth());
    pivot = room.back_depth();
  }
  for (const Scenery::Board& board : scenery.furthest_first()) {
    ahead = std::min(ahead, 0.5 * board.depth);
    pivot = board.depth;
  }
  const double nearest = room.nearest_floor();
  const Reach reach{ahead, 0.5 * room.picture().width / room.focal_px() * nearest, pivot};
  const double seconds = (move == Move::kOrbit ? frames : frames - 1) / fps;
  if (frames == 1) return Path({{0, made_path(move, plan.amount, 1, reach, plan.ease).at(1)}}, false);
  return made_path(move, plan.amount, seconds, reach, plan.ease);
}

/// Throws where the camera is outside the box, or looks where nothing is.
void check_path(const Path& path, const Room& room, cv::Size frame, int frames, double fps,
                const TourPlan& plan) {
  for (int i = 0; i < frames; ++i) {
    const CameraPlace place = path.at(i / fps);
    const std::string moment = fmt::format("{}: {:.4g} s", where_of(plan), i / fps);
    if (const std::string fault = room.fault_of(place.position); !fault.empty())
      throw Error(
          ErrorKind::kInput, moment, fault,
          plan.keys.empty() ? "Give a smaller amount" : "Move the keys before and after it into the box");
    const Pinhole camera = room.camera(place, frame);
    for (const cv::Point2d corner :
         {cv::Point2d(-0.5, -0.5), cv::Point2d(frame.width - 0.5, -0.5),
          cv::Point2d(-0.5, frame.height - 0.5), cv::Point2d(frame.width - 0.5, frame.height - 0.5)})
      if (const cv::Vec3d ray = camera.ray_of_pixel * cv::Vec3d(corner.x, corner.y, 1);
          !(ray[2] > kAhead * cv::norm(ray)))
        throw Error(
            ErrorKind::kInput, moment,
            fmt::format(
                "the camera looks [{:.4g}, {:.4g}] degrees aside with a view of {:.4g}: beyond what lies "
                "ahead, of which the picture knows nothing",
                place.yaw_deg, place.pitch_deg, place.view_deg),
            "Turn it less, or give a narrower view");
  }
}

/// How far outside the picture it lies, px.
double outside_of(const Room::Hit& hit, cv::Size picture) {
  if (!hit.shown) return std::max(picture.width, picture.height);
  return std::max({-0.5 - hit.sample.x, -0.5 - hit.sample.y, hit.sample.x - (picture.width - 0.5),
                   hit.sample.y - (picture.height - 0.5)});
}

std::vector<cv::Point2d> rim_of(cv::Size frame) {
  constexpr int kAlong = 24;
  std::vector<cv::Point2d> rim;
  for (int i = 0; i <= kAlong; ++i) {
    const double x = frame.width * (1.0 * i / kAlong) - 0.5, y = frame.height * (1.0 * i / kAlong) - 0.5;
    for (const cv::Point2d p : {cv::Point2d(x, -0.5), cv::Point2d(x, frame.height - 0.5),
                                cv::Point2d(-0.5, y), cv::Point2d(frame.width - 0.5, y)})
      rim.push_back(p);
  }
  return rim;
}

/// Whether all that a camera sees is shown by the picture. What its rim sees decides: the picture is whole.
bool sees_picture_only(const Room& room, const Scenery& scenery, const Pinhole& camera,
                       const std::vector<cv::Point2d>& rim) {
  const double slack = 1e-6 * room.picture().width;
  for (const cv::Point2d p : rim)
    if (outside_of(room.hit(camera, p), room.picture()) > slack) return false;
  // Where the picture cuts a thing, no more of it is known.
  for (const Scenery::Board& board : scenery.furthest_first()) {
    if (!(board.left || board.right || board.bottom) || board.depth <= camera.centre[2] * 1.01) continue;
    const cv::Matx33d h = room.board_seen_by(camera, board.depth).picture_from_frame;
    for (const cv::Point2d p : rim) {
      const cv::Vec3d at = h * cv::Vec3d(p.x, p.y, 1);
      const double x = at[0] / at[2], y = at[1] / at[2];
      const bool beside =
          y > board.box.y && y<board.box.br().y, below = x> board.box.x && x < board.box.br().x;
      if ((board.left && beside && x < -0.5 - slack) ||
          (board.right && beside && x > room.picture().width - 0.5 + slack) ||
          (board.bottom && below && y > room.picture().height - 0.5 + slack))
        return false;
    }
  }
  return true;
}

}  // namespace

Tour::Tour(const std::filesystem::path& film, const TourPlan& plan, const TourOptions& options,
           std::stop_token stop)
    : film_(film),
      room_(mesh_of(plan, film_.size()), where_of(plan)),
      frames_(frames_of(film_, plan, options)),
      fps_(fps_of(film_, options)),
      size_(size_of(film_, options)),
      scenery_(film_.first(), uprights(plan, film_, room_, notices_), stop),
      path_(path_of(plan, room_, scenery_, frames_, fps_)),
      renderer_(room_, scenery_, size_) {
  if (!plan.horizon && !plan.vanishing && !plan.rectangle)
    notices_.push_back(fmt::format("no horizon is given: it is taken to be row {:.6g}, the middle",
                                   0.5 * film_.size().height));
  check_path(path_, room_, size_, frames_, fps_, plan);
  narrow(plan.beyond);
  film_.play(frames_, fps_, options.film_end, options.memory_bytes, stop);
  notices_.insert(notices_.end(), film_.notices().begin(), film_.notices().end());
}

void Tour::narrow(Beyond beyond) {
  const std::vector<cv::Point2d> rim = rim_of(size_);
  const auto moment = [&](int i) { return (frames_ - 1) / fps_ * i / (kMoments - 1); };
  const auto fits = [&](const Narrowing& narrowed) {
    for (int i = 0; i < kMoments; ++i)
      if (!sees_picture_only(room_, scenery_, room_.camera(path_.at(moment(i)), size_, narrowed), rim))
        return false;
    return true;
  };
  if (fits({})) return;
  const bool cut_below = std::ranges::any_of(scenery_.furthest_first(), &Scenery::Board::bottom);
  for (const double anchor : {cut_below ? 1.0 : 0.5, 0.5}) {
    if (beyond == Beyond::kMirror || !fits({kLeastNarrowed, anchor})) continue;
    double low = kLeastNarrowed, high = 1;
    for (int i = 0; i < 16; ++i) {
      const double middle = 0.5 * (low + high);
      (fits({middle, anchor}) ? low : high) = middle;
    }
    narrowed_ = {low, anchor};
    notices_.push_back(
        fmt::format("the view is narrowed to {:.0f} %, so that nothing beyond the picture shows", 100 * low));
    return;
  }
  constexpr int kAcross = 48, kDown = 27;
  int most = 0, at = 0;
  for (int i = 0; i < kMoments; ++i) {
    const Pinhole camera = room_.camera(path_.at(moment(i)), size_);
    int outside = 0;
    for (int y = 0; y < kDown; ++y)
      for (int x = 0; x < kAcross; ++x)
        outside += outside_of(room_.hit(camera, {(x + 0.5) / kAcross * size_.width - 0.5,
                                                 (y + 0.5) / kDown * size_.height - 0.5}),
                              room_.picture()) > 0;
    if (outside > most) most = outside, at = i;
  }
  beyond_share_ = 1.0 * most / (kAcross * kDown);
  notices_.push_back(fmt::format(
      "up to {:.0f} % of a frame, at {:.2f} s, is beyond the picture: the planes go on mirrored there{}",
      100 * beyond_share_, moment(at),
      beyond == Beyond::kNarrow
          ? fmt::format(", for no view of {:.0f} % keeps within it", 100 * kLeastNarrowed)
          : ""));
}

void Tour::skip() {
  film_.next();
  ++at_;
}

void Tour::render(cv::Mat& out, cv::Mat* depth) {
  if (const cv::Mat* frame = film_.next()) scenery_.show(*frame);
  renderer_.render(room_.camera(path_.at(at_++ / fps_), size_, narrowed_), out, depth);
}

cv::Mat Tour::drawn() const {
  cv::Mat out;
  film_.first().convertTo(out, CV_8U, 255);
  const cv::Scalar white(255, 255, 255), red(60, 60, 255), green(80, 220, 80);
  const int thick = std::max(1, out.cols / 500);
  const auto line = [&](cv::Point2d from, cv::Point2d to, const cv::Scalar& colour) {
    constexpr int kShift = 4;
    const auto fixed = [](cv::Point2d p) {
      return cv::Point(cvRound(std::clamp(p.x, -1e5, 1e5) * (1 << kShift)),
                       cvRound(std::clamp(p.y, -1e5, 1e5) * (1 << kShift)));
    };
    cv::line(out, fixed(from), fixed(to), colour, thick, cv::LINE_AA, kShift);
  };
  // Seen by its own camera, each side has an outline where it meets the others: points of space, projected.
  const Mesh& mesh = room_.mesh();
  const cv::Point2d v = mesh.vanishing - cv::Point2d(0.5, 0.5);
  const double width = out.cols, height = out.rows;
  line({0, v.y}, {width, v.y}, green);
  if (mesh.back) {
    const double l = mesh.left > 0 ? mesh.left - 0.5 : 0, r = mesh.right < width ? mesh.right - 0.5 : width,
                 t = mesh.top > 0 ? mesh.top - 0.5 : 0, b = mesh.bottom - 0.5;
    line({l, b}, {r, b}, white);
    if (mesh.top > 0) line({l, t}, {r, t}, white);
    if (mesh.left > 0) line({l, t}, {l, b}, white);
    if (mesh.right < width) line({r, t}, {r, b}, white);
    const auto outwards = [&](cv::Point2d corner) { line(corner, v + (corner - v) * 1e3, white); };
    if (mesh.left > 0) outwards({l, b});
    if (mesh.right < width) outwards({r, b});
    if (mesh.left > 0 && mesh.top > 0) outwards({l, t});
    if (mesh.right < width && mesh.top > 0) outwards({r, t});
  }
  // The floor, in squares as wide as the camera is high.
  const double far = std::min(room_.back_depth(), 12 * room_.nearest_floor());
  for (double z = std::ceil(room_.nearest_floor()); z < far; z += 1) {
    const double row = v.y + room_.focal_px() / z;
    if (room_.focal_px() / z - room_.focal_px() / (z + 1) < 3) break;
    line({0, row}, {width, row}, green);
  }
  for (int i = -12; i <= 12; ++i) {
    const double x = i;  // at the lower edge and at the far one
    const double near_px = height - v.y, far_px = room_.focal_px() / far;
    line({v.x + x * near_px, v.y + near_px}, {v.x + x * far_px, v.y + far_px}, green);
  }
  for (const Scenery::Board& board : scenery_.furthest_first()) {
    const double foot = v.y + room_.focal_px() / board.depth;
    line({static_cast<double>(board.box.x), foot}, {static_cast<double>(board.box.br().x), foot}, red);
    cv::rectangle(out, board.box, red, thick);
  }
  return out;
}

}  // namespace freshet::synth::tour
