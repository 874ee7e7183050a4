#include "query/labelling/motion_guess.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"

namespace freshet::query {
namespace {

constexpr int kDirections = 32;
constexpr double kTextureSigma = 2.5;      // px; finer grain is codecs' and sensors'
constexpr double kFaintTexture = 1;        // grey levels a px, squared: gradients of this power count half
constexpr double kUnseenClips = 1;         // of a class, that would move anyhow: few clips prove little
constexpr double kMinPull = 0.2;           // below it a class is said to have no way of its own
constexpr double kMinNamedFraction = 0.1;  // of the candidates: smaller classes are not named
constexpr double kMinTolerance = 45, kMaxTolerance = 90;  // degrees
constexpr double kDegrees = 180 / std::numbers::pi;

using Directions = std::array<double, kDirections>;  // a value each; direction 0 is right, then clockwise

double angle_of(int direction) { return 2 * std::numbers::pi * direction / kDirections; }

// What is known of a class.
struct ClassPull {
  double fraction = 0;  // of the candidates' scores
  double down = 0;      // concentration of its motion about straight down; negative: about up
};

// Concentration of a von Mises distribution whose mean direction has this length (Banerjee et al. 2005,
// Eq. 4.4, in two dimensions: within 7 % of the inverse of I1 / I0).
double concentration(double length) { return length * (2 - length * length) / (1 - length * length); }

std::map<std::string, ClassPull> pulls_of(const store::Snapshot& snapshot, const CandidateSearch& search,
                                          double min_speed) {
  const stored::PatchTable& table = search.table();
  struct Sum {
    double down = 0, count = 0;
    void add(double value, double weight) {
      down += value;
      count += weight;
    }
  };
  std::map<std::string, Sum> clips_down;
  for (std::size_t clip = 0; clip < table.clips.size(); ++clip) {
    Sum patches;
    for (stored::Row row = table.first_row[clip]; row < table.first_row[clip + 1]; ++row) {
      const double speed = std::hypot(table.mean_u[row], table.mean_v[row]);
      if (search.filtered.rows.allows(row) && speed >= min_speed) patches.add(table.mean_v[row] / speed, 1);
    }
    // Each clip counts once: a long shore says no more of water than a brook.
    if (patches.count > 0)
      clips_down[snapshot.clip(table.clips[clip]).class_name].add(patches.down / patches.count, 1);
  }
  std::map<std::string, ClassPull> pulls;
  double total = 0;
  std::vector<double> clip_scores(table.clips.size(), 0);
  for (std::size_t piece = 0; piece < search.candidates.pieces(); ++piece) {
    const auto rows = search.candidates.rows_of(piece);
    const auto scores = search.candidates.scores_of(piece);
    for (std::size_t i = 0; i < rows.size(); ++i) clip_scores[table.clip[rows[i]]] += scores[i];
  }
  for (std::size_t clip = 0; clip < clip_scores.size(); ++clip) {
    if (clip_scores[clip] <= 0) continue;
    pulls[snapshot.clip(table.clips[clip]).class_name].fraction += clip_scores[clip];
    total += clip_scores[clip];
  }
  for (auto& [name, pull] : pulls) {
    pull.fraction /= total;
    if (const auto found = clips_down.find(name); found != clips_down.end())
      pull.down = concentration(found->second.down / (found->second.count + kUnseenClips));
  }
  return pulls;
}

// Axis of texture, piece by piece.
class TextureAxes {
 public:
  TextureAxes(const cv::Mat& picture, const cv::Mat& matte) {
    cv::Mat luma, smooth, x, y, inside;
    cv::cvtColor(picture, luma, cv::COLOR_BGR2GRAY);
    luma.convertTo(smooth, CV_32F);
    cv::GaussianBlur(smooth, smooth, {}, kTextureSigma);
    cv::Scharr(smooth, x, CV_32F, 1, 0, 1 / 32.0);
    cv::Scharr(smooth, y, CV_32F, 0, 1, 1 / 32.0);
    cv::Mat(matte > 127).convertTo(inside, CV_32F, 1 / 255.0);
    cv::integral(x.mul(x).mul(inside), xx_, CV_64F);
    cv::integral(x.mul(y).mul(inside), xy_, CV_64F);
    cv::integral(y.mul(y).mul(inside), yy_, CV_64F);
    cv::integral(inside, area_, CV_64F);
  }
  /// Twice the axis' angle as a vector, as long as its coherence: 0 no axis, 1 one alone.
  cv::Vec2d doubled_axis(cv::Rect box) const {
    const double xx = sum(xx_, box), yy = sum(yy_, box), xy = sum(xy_, box);
    const double power = xx + yy + kFaintTexture * sum(area_, box);
    // Gradients stand across the axis: hence the sign.
    return power > 0 ? cv::Vec2d(yy - xx, -2 * xy) / power : cv::Vec2d(0, 0);
  }

 private:
  static double sum(const cv::Mat& integral, cv::Rect box) {
    return integral.at<double>(box.y, box.x) + integral.at<double>(box.br().y, box.br().x) -
           integral.at<double>(box.y, box.br().x) - integral.at<double>(box.br().y, box.x);
  }
  cv::Mat xx_, xy_, yy_, area_;
};

// What each piece says by itself, and then with its neighbours: the mean, by a Gaussian of their distance.
std::vector<Directions> spread(const std::vector<Directions>& own, const Target& target, double sigma) {
  std::vector<int> piece_at(static_cast<std::size_t>(target.columns) * target.rows, -1);
  const auto at = [&](int column, int row) -> int& {
    return piece_at[static_cast<std::size_t>(row) * target.columns + column];
  };
  for (std::size_t piece = 0; piece < own.size(); ++piece)
    at(target.places[piece].x, target.places[piece].y) = static_cast<int>(piece);
  const double steps = sigma / target.stride;
  const int reach = static_cast<int>(std::ceil(2.5 * steps));
  std::vector<Directions> all(own.size());
  for (std::size_t piece = 0; piece < own.size(); ++piece) {
    const cv::Point centre = target.places[piece];
    double weights = 0;
    Directions& sum = all[piece];
    sum.fill(0);
    for (int y = std::max(0, centre.y - reach); y <= std::min(target.rows - 1, centre.y + reach); ++y)
      for (int x = std::max(0, centre.x - reach); x <= std::min(target.columns - 1, centre.x + reach); ++x) {
        if (at(x, y) < 0) continue;
        const cv::Point d = cv::Point(x, y) - centre;
        const double weight = steps > 0 ? std::exp(-d.dot(d) / (2 * steps * steps)) : 1;
        weights += weight;
        for (int i = 0; i < kDirections; ++i) sum[i] += weight * own[at(x, y)][i];
      }
    for (double& value : sum) value /= weights;
  }
  return all;
}

PieceGuess mean_direction(const Directions& evidence, double min_certainty) {
  const double maximum = *std::max_element(evidence.begin(), evidence.end());
  double u = 0, v = 0, total = 0;
  for (int d = 0; d < kDirections; ++d) {
    const double likelihood = std::exp(evidence[d] - maximum);
    total += likelihood;
    u += likelihood * std::cos(angle_of(d));
    v += likelihood * std::sin(angle_of(d));
  }
  const double length = std::hypot(u, v);
  PieceGuess guess{{0, 0}, static_cast<float>(length / total)};
  if (guess.certainty >= min_certainty && length > 0)
    guess.direction = {static_cast<float>(u / length), static_cast<float>(v / length)};
  return guess;
}

// Each pixel takes the mean of the pieces that lie on it, most of the nearest, if more of them dare than not.
cv::Mat direction_map(const Target& target, const std::vector<PieceGuess>& pieces) {
  cv::Mat sum(target.picture, CV_32FC3, cv::Scalar::all(0));  // direction, and what dares less what does not
  const auto tent = [&](int i) { return std::min(i + 1, target.side - i) / (0.5f * target.side); };
  for (std::size_t piece = 0; piece < pieces.size(); ++piece) {
    const cv::Point corner = target.corners[piece];
    const cv::Rect box = cv::Rect(corner, cv::Size(target.side, target.side)) & cv::Rect({}, target.picture);
    const cv::Vec2f& way = pieces[piece].direction;
    const float dares = way == cv::Vec2f(0, 0) ? -1 : 1;
    for (int y = box.y; y < box.br().y; ++y)
      for (int x = box.x; x < box.br().x; ++x)
        sum.at<cv::Vec3f>(y, x) += tent(y - corner.y) * tent(x - corner.x) * cv::Vec3f(way[0], way[1], dares);
  }
  cv::Mat map(target.picture, CV_32FC2, cv::Scalar::all(0));
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x) {
      const cv::Vec3f& s = sum.at<cv::Vec3f>(y, x);
      const float length = std::hypot(s[0], s[1]);
      if (s[2] > 0 && length > 1e-3f) map.at<cv::Vec2f>(y, x) = {s[0] / length, s[1] / length};
    }
  return map;
}

// "candidates are 72 % fire (goes up in this store), 28 % clouds (neither up nor down)"
std::string describe(const std::map<std::string, ClassPull>& pulls) {
  std::vector<std::pair<std::string, ClassPull>> order(pulls.begin(), pulls.end());
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.second.fraction > b.second.fraction; });
  std::string text = "candidates are";
  for (std::size_t i = 0; i < order.size() && (i == 0 || order[i].second.fraction >= kMinNamedFraction);
       ++i) {
    const auto& [name, pull] = order[i];
    text += fmt::format("{} {:.0f} % {} ({}{})", i > 0 ? "," : "", 100 * pull.fraction,
                        name.empty() ? "of no class" : name,
                        pull.down > kMinPull    ? "goes down"
                        : pull.down < -kMinPull ? "goes up"
                                                : "neither up nor down",
                        i == 0 ? " in this store" : "");
  }
  return text;
}

std::string report_of(const MotionGuess& guess, const std::map<std::string, ClassPull>& pulls) {
  if (guess.guide.empty()) return "no direction guessed: " + describe(pulls);
  double u = 0, v = 0;
  std::size_t daring = 0;
  for (const PieceGuess& piece : guess.pieces) {
    u += piece.direction[0];
    v += piece.direction[1];
    daring += piece.direction != cv::Vec2f(0, 0);
  }
  const double angle = std::round(std::atan2(-v, u) * kDegrees);
  return fmt::format(
      "direction guessed for {:.0f} % of the pieces, on average {:.0f} degrees (0 right, 90 up), "
      "tolerance {:.0f}: {}; texture's axis turns it",
      100.0 * static_cast<double>(daring) / static_cast<double>(guess.pieces.size()),
      angle < 0 ? angle + 360 : angle, guess.guide.tolerance_deg, describe(pulls));
}

}  // namespace

MotionGuess guess_motion(const store::Snapshot& snapshot, const CandidateSearch& search,
                         const cv::Mat& picture, const cv::Mat& matte, const GuessOptions& options) {
  const Target& target = search.target;
  if (picture.type() != CV_8UC3 || matte.type() != CV_8U || picture.size() != matte.size() || picture.empty())
    throw Error(ErrorKind::kUsage, "picture and matte", "8-bit BGR and 8-bit grey of the same size expected");
  cv::Mat searched = picture, fluid = matte;
  if (picture.size() != target.picture) {
    cv::resize(picture, searched, target.picture, 0, 0, cv::INTER_AREA);
    cv::resize(matte, fluid, target.picture, 0, 0, cv::INTER_AREA);
  }
  const std::map<std::string, ClassPull> pulls = pulls_of(snapshot, search, options.min_speed_px_per_s);
  double down = 0;
  for (const auto& [name, pull] : pulls) down += pull.fraction * pull.down;

  const TextureAxes axes(searched, fluid);
  std::vector<Directions> own(target.size());
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    const cv::Vec2d axis = axes.doubled_axis(
        cv::Rect(target.corners[piece], cv::Size(target.side, target.side)) & cv::Rect({}, target.picture));
    own[piece].fill(0);
    for (int d = 0; d < kDirections; ++d)
      own[piece][d] +=
          options.edges * (axis[0] * std::cos(2 * angle_of(d)) + axis[1] * std::sin(2 * angle_of(d))) +
          options.gravity * down * std::sin(angle_of(d));
  }

  MotionGuess guess;
  double certainty = 0;
  std::size_t daring = 0;
  for (const Directions& evidence : spread(own, target, options.reach_px)) {
    guess.pieces.push_back(mean_direction(evidence, options.min_certainty));
    if (guess.pieces.back().direction == cv::Vec2f(0, 0)) continue;
    certainty += guess.pieces.back().certainty;
    ++daring;
  }
  if (daring > 0) {
    guess.guide.direction = direction_map(target, guess.pieces);
    if (picture.size() != target.picture)
      cv::resize(guess.guide.direction, guess.guide.direction, picture.size(), 0, 0, cv::INTER_NEAREST);
    guess.guide.min_speed_px_per_s = options.min_speed_px_per_s;
    // Deviation of a wrapped normal distribution whose mean direction has this length.
    const double deviation =
        std::sqrt(-2 * std::log(std::min(certainty / static_cast<double>(daring), 1.0))) * kDegrees;
    guess.guide.tolerance_deg = std::clamp(deviation, kMinTolerance, kMaxTolerance);
  }
  guess.report = report_of(guess, pulls);
  return guess;
}

}  // namespace freshet::query
