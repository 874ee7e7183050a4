#include "synth/stills/between/pinned_flow.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include <opencv2/imgproc.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>

#include "synth/sampling/bilinear.h"
#include "synth/sampling/pull_push.h"

namespace freshet::synth::stills {
namespace {

constexpr double kWindow = 2,
                 kNarrow = 1;        // px, sigmas of windows: to find where a place went, and whose it is
constexpr float kStay = 2;           // grey levels squared that a px squared beside the pins' motion costs
constexpr double kSpread = 4;        // px, sigma over which places take from their neighbours
constexpr float kSure = 100;         // grey levels squared of advantage that are half sure
constexpr float kTextured = 900;     // variance, grey levels squared, that counts at most
constexpr float kPinsSay = .5f;      // of the variance: what pins say where both explain a place equally
constexpr float kEqual = 8;          // grey levels squared that are no difference
constexpr float kUnexplained = .5f;  // of what neither explains: what pins say there
constexpr float kCore = 2.5f;        // px about a pin that are its, whatever the pictures show
constexpr float kCoreGrant = 900;    // grey levels squared that pins are granted at them, falling to 0 ...
constexpr float kCoreReach = 6;      // ... over so many px
constexpr float kEnclosed =
    900;  // grey levels squared that pins are granted in what they enclose: all there are
constexpr double kMostSaid = 400;    // grey levels squared that one place says for or against
constexpr double kBorder = 600;      // the same, that a px of border costs where the still is even ...
constexpr double kAnyBorder = .05;   // ... and the part of it that any costs
constexpr double kEdge = 10;         // grey levels from px to px that are an edge
constexpr float kExactOver = 6;      // px over which what is left at a pin is spread
constexpr float kSoftReach = .15f;   // of the reach: over it, at its end, a thing grows transparent
constexpr double kLeast = .02;       // opacity that hides
constexpr int kHalo = 4;             // px about a thing in which the flow that was found is not believed
constexpr float kUnbelieved = 1.5f;  // px by which forth and back may miss each other behind a thing
constexpr int kTurns = 16;

struct Round {
  int radius;  // steps
  float step;  // px
};
constexpr Round kRounds[] = {{4, 1}, {3, 1}, {2, .25f}};

cv::Point2f as_point(const cv::Vec2f& vector) { return {vector[0], vector[1]}; }

template <class T>
T value_at(const cv::Mat& plane, cv::Point2f at) {
  return sampling::bilinear<T>(plane, at.x, at.y);
}

/// A picture where `move` leads from each place of a box whose corner is given.
cv::Mat led_to(const cv::Mat& picture, const cv::Mat& move, cv::Point corner, cv::Point2f aside = {}) {
  cv::Mat places(move.size(), CV_32FC2), out;
  for (int y = 0; y < move.rows; ++y)
    for (int x = 0; x < move.cols; ++x)
      places.at<cv::Vec2f>(y, x) =
          move.at<cv::Vec2f>(y, x) +
          cv::Vec2f(static_cast<float>(corner.x + x) + aside.x, static_cast<float>(corner.y + y) + aside.y);
  cv::remap(picture, out, places, {}, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return out;
}

cv::Mat as_pixels(const cv::Mat& flow) {
  cv::Mat out;
  flow.convertTo(out, CV_32F, FlowPair::kUnit);
  return out;
}

cv::Mat variance(const cv::Mat& picture) {
  cv::Mat mean;
  cv::GaussianBlur(picture, mean, {}, kWindow, 0, cv::BORDER_REFLECT_101);
  return mismatch(picture, mean, kNarrow);
}

/// How unlike each place of either still is to where a flow leads from it in the other: CV_32F.
struct Missed {
  cv::Mat forth, back;
};

/// Both stills in floats, and how well what was found without pins explains them.
struct Stills {
  cv::Mat from, to;  // CV_32FC3
  Missed wide, narrow;

  Stills(const cv::Mat& one, const cv::Mat& other, const FlowPair& flow) {
    one.convertTo(from, CV_32F);
    other.convertTo(to, CV_32F);
    wide = missed(flow, kWindow);
    narrow = missed(flow, kNarrow);
  }
  Missed missed(const FlowPair& flow, double window) const {
    return {mismatch(from, led_to(to, as_pixels(flow.forth), {}), window),
            mismatch(to, led_to(from, as_pixels(flow.back), {}), window)};
  }
  /// What lies behind things may explain a place too.
  void add(const FlowPair& behind) {
    const Missed other = missed(behind, kNarrow);
    narrow = {cv::min(narrow.forth, other.forth), cv::min(narrow.back, other.back)};
  }
};

/// One thing while it is being found.
class Carrying {
 public:
  Carrying(const Stills& stills, PinnedMotion motion)
      : stills_(stills), motion_(motion), box_(motion.box(stills.from.size())), from_(stills.from(box_)) {
    move_.create(box_.size(), CV_32FC2);
    granted_.create(box_.size(), CV_32F);
    textured_.create(box_.size(), CV_32F);
    near_.create(box_.size(), CV_32F);
    const cv::Mat texture = variance(stills.from)(box_);
    for (int y = 0; y < box_.height; ++y)
      for (int x = 0; x < box_.width; ++x) {
        const cv::Point2f at = place(x, y), way = motion_.move(at);
        move_.at<cv::Vec2f>(y, x) = {way.x, way.y};
        near_.at<float>(y, x) = std::max(0.0f, motion_.nearness(at));
        textured_.at<float>(y, x) =
            kPinsSay * near_.at<float>(y, x) * std::min(kTextured, texture.at<float>(y, x));
        granted_.at<float>(y, x) = kCoreGrant * std::max(0.0f, 1 - motion_.distance(at) / kCoreReach) +
                                   (motion_.encloses(at) ? kEnclosed : 0);
      }
  }

  /// The motion that its pins ask for, as the pictures refine it.
  void find_motion(const std::stop_token& stop) {
    for (const Round& round : kRounds) look_about(round, stop);
    for (int turn = 0; turn < 3; ++turn) hold_pins();
  }
  CarriedThing thing() const { return {box_, move_, opacity()}; }

 private:
  cv::Point2f place(int x, int y) const {
    return {static_cast<float>(box_.x + x), static_cast<float>(box_.y + y)};
  }

  /// Grey levels squared by which the pins' motion, which misses a place by `missed`, explains it better than what was
  /// found does, in that still which it explains better: where something hides the ground in one of them, the other
  /// shows it.
  cv::Mat advantage(const cv::Mat& missed, const Missed& found) const {
    cv::Mat out(box_.size(), CV_32F);
    const cv::Mat there = led_to(found.back, move_, box_.tl());
    for (int y = 0; y < box_.height; ++y)
      for (int x = 0; x < box_.width; ++x) {
        const float without = std::min(found.forth.at<float>(box_.y + y, box_.x + x), there.at<float>(y, x));
        const float worse = missed.at<float>(y, x) - without;
        const float equal = std::clamp(1 - worse / (kEqual + .5f * without), 0.0f, 1.0f);
        out.at<float>(y, x) = equal * textured_.at<float>(y, x) + granted_.at<float>(y, x) - worse +
                              kUnexplained * near_.at<float>(y, x) * without;
      }
    return out;
  }

  void look_about(const Round& round, const std::stop_token& stop) {
    cv::Mat least(box_.size(), CV_32F, cv::Scalar(std::numeric_limits<float>::max())),
        missed(box_.size(), CV_32F), way(box_.size(), CV_32FC2, cv::Scalar::all(0));
    for (int v = -round.radius; v <= round.radius; ++v)
      for (int u = -round.radius; u <= round.radius; ++u) {
        if (stop.stop_requested()) return;
        const cv::Point2f aside(round.step * static_cast<float>(u), round.step * static_cast<float>(v));
        const cv::Mat here = mismatch(from_, led_to(stills_.to, move_, box_.tl(), aside), kWindow);
        const float stay = kStay * aside.dot(aside);
        for (int y = 0; y < box_.height; ++y)
          for (int x = 0; x < box_.width; ++x) {
            const float cost = here.at<float>(y, x) + stay;
            if (cost >= least.at<float>(y, x)) continue;
            least.at<float>(y, x) = cost;
            missed.at<float>(y, x) = here.at<float>(y, x);
            way.at<cv::Vec2f>(y, x) = {aside.x, aside.y};
          }
      }
    // Each takes from its neighbours what they are sure of.
    constexpr float kUnsure = .05f;  // weight of staying
    cv::Mat sure = cv::max(advantage(missed, stills_.wide), 0), planes[2], sum;
    cv::divide(sure, sure + kSure, sure);
    cv::GaussianBlur(sure, sum, {}, kSpread, 0, cv::BORDER_REFLECT_101);
    cv::split(way, planes);
    for (cv::Mat& plane : planes) {
      plane = plane.mul(sure);
      cv::GaussianBlur(plane, plane, {}, kSpread, 0, cv::BORDER_REFLECT_101);
      plane /= sum + kUnsure;
    }
    cv::merge(planes, 2, way);
    move_ += way;
  }

  /// What the motion lacks at a pin, spread about it.
  void hold_pins() {
    std::vector<FlowPin> lacks = motion_.pins();
    for (FlowPin& pin : lacks)
      pin.goes -= as_point(value_at<cv::Vec2f>(move_, pin.at - cv::Point2f(box_.tl())));
    const PinnedMotion lacking(lacks);
    for (int y = 0; y < box_.height; ++y)
      for (int x = 0; x < box_.width; ++x) {
        const float far = lacking.distance(place(x, y)) / kExactOver;
        const cv::Point2f way = std::exp(-.5f * far * far) * lacking.move(place(x, y));
        move_.at<cv::Vec2f>(y, x) += cv::Vec2f(way.x, way.y);
      }
  }

  cv::Mat opacity() const {
    const cv::Mat score =
        advantage(mismatch(from_, led_to(stills_.to, move_, box_.tl()), kNarrow), stills_.narrow);
    cv::Mat core(box_.size(), CV_8U, cv::Scalar(0));
    for (int y = 0; y < box_.height; ++y)
      for (int x = 0; x < box_.width; ++x)
        if (motion_.distance(place(x, y)) <= kCore) core.at<std::uint8_t>(y, x) = 255;
    cv::Mat is = cut_out(score, core);
    keep_joined(is, core);
    // What it encloses goes along.
    std::vector<std::vector<cv::Point>> outlines;
    cv::findContours(is, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    cv::drawContours(is, outlines, -1, cv::Scalar(255), cv::FILLED);
    cv::dilate(is, is, {});
    cv::Mat out;
    is.convertTo(out, CV_32F, 1.0 / 255);
    cv::GaussianBlur(out, out, {}, 1, 0, cv::BORDER_REPLICATE);
    return out.mul(cv::min(near_ / kSoftReach, 1));
  }

  /// The smallest cut between what the pins' motion explains better and the rest: 255 or 0. Its border costs less where
  /// the still has an edge.
  cv::Mat cut_out(const cv::Mat& score, const cv::Mat& core) const {
    constexpr double kSurely = 1e9;
    const int width = box_.width, height = box_.height;
    cv::detail::GCGraph<double> graph(static_cast<unsigned>(width * height),
                                      static_cast<unsigned>(4 * width * height));
    for (int i = 0; i < width * height; ++i) graph.addVtx();
    const auto join = [&](cv::Point a, cv::Point b) {
      const cv::Vec3f apart = from_.at<cv::Vec3f>(a) - from_.at<cv::Vec3f>(b);
      const double cost =
          kBorder * (kAnyBorder + (1 - kAnyBorder) * std::exp(-apart.dot(apart) / (6 * kEdge * kEdge)));
      graph.addEdges(a.y * width + a.x, b.y * width + b.x, cost, cost);
    };
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double side = std::clamp<double>(score.at<float>(y, x), -kMostSaid, kMostSaid);
        const bool is = core.at<std::uint8_t>(y, x) != 0, is_not = near_.at<float>(y, x) <= 0;
        graph.addTermWeights(y * width + x, is ? kSurely : std::max(0.0, side),
                             is       ? 0
                             : is_not ? kSurely
                                      : std::max(0.0, -side));
        if (x > 0) join({x, y}, {x - 1, y});
        if (y > 0) join({x, y}, {x, y - 1});
      }
    graph.maxFlow();
    cv::Mat out(box_.size(), CV_8U);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        out.at<std::uint8_t>(y, x) = graph.inSourceSegment(y * width + x) ? 255 : 0;
    return out;
  }

  /// Of what is, that which touches a core.
  static void keep_joined(cv::Mat& is, const cv::Mat& core) {
    cv::Mat numbers;
    const int count = cv::connectedComponents(is, numbers, 4, CV_32S);
    std::vector<char> touches(static_cast<std::size_t>(count), 0);
    for (int y = 0; y < is.rows; ++y)
      for (int x = 0; x < is.cols; ++x)
        if (core.at<std::uint8_t>(y, x) != 0) touches[numbers.at<int>(y, x)] = 1;
    for (int y = 0; y < is.rows; ++y)
      for (int x = 0; x < is.cols; ++x)
        if (touches[numbers.at<int>(y, x)] == 0) is.at<std::uint8_t>(y, x) = 0;
  }

  const Stills& stills_;
  PinnedMotion motion_;
  cv::Rect box_;
  cv::Mat from_, move_;
  cv::Mat near_;      // CV_32F, 0..1: nearness
  cv::Mat textured_;  // CV_32F: what pins say where both explain a place equally
  cv::Mat granted_;   // CV_32F: what they say anyway
};

cv::Rect grown(const cv::Rect& rect, int by, cv::Size size) {
  return cv::Rect(rect.x - by, rect.y - by, rect.width + 2 * by, rect.height + 2 * by) & cv::Rect({}, size);
}

/// Flow behind the things: what was found where nothing hides it in either still and both ways agree.
cv::Mat behind(const cv::Mat& along, const cv::Mat& other, const cv::Mat& hidden, const cv::Rect& changed) {
  cv::Mat believed(along.size(), CV_32F, cv::Scalar(1)), halo;
  cv::dilate(hidden, halo, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * kHalo + 1, 2 * kHalo + 1}));
  for (int y = changed.y; y < changed.br().y; ++y)
    for (int x = changed.x; x < changed.br().x; ++x) {
      const auto px = static_cast<float>(x), py = static_cast<float>(y);
      const cv::Vec2f move = flow_at(along, px, py),
                      missed = flow_at(other, px + move[0], py + move[1]) + move;
      if (halo.at<float>(y, x) > kLeast || std::hypot(missed[0], missed[1]) > kUnbelieved)
        believed.at<float>(y, x) = 0;
    }
  cv::Mat out = along.clone();
  as_flow_integers(sampling::pull_push(as_pixels(along), believed))(changed).copyTo(out(changed));
  return out;
}

PinnedFlow with_things(const FlowPair& flow, std::vector<CarriedThing> things) {
  const cv::Size size = flow.forth.size();
  PinnedFlow out;
  out.hidden_a = cv::Mat(size, CV_32F, cv::Scalar(0));
  out.hidden_b = out.hidden_a.clone();
  cv::Mat forth(size, CV_32FC2, cv::Scalar::all(0)), back = forth.clone();
  const auto take = [](cv::Mat& hidden, cv::Mat& along, int x, int y, float opacity, cv::Point2f move) {
    if (opacity <= hidden.at<float>(y, x)) return;
    hidden.at<float>(y, x) = opacity;
    along.at<cv::Vec2f>(y, x) = {move.x, move.y};
  };
  for (const CarriedThing& thing : things) {
    const cv::Rect way = thing.way(size);
    out.changed |= way;
    for (int y = way.y; y < way.br().y; ++y)
      for (int x = way.x; x < way.br().x; ++x) {
        const cv::Point2f at(static_cast<float>(x), static_cast<float>(y));
        const CarriedThing::Origin here = thing.origin(at, 0), there = thing.origin(at, 1);
        take(out.hidden_a, forth, x, y, here.opacity, here.move);
        take(out.hidden_b, back, x, y, there.opacity, there.at - at);
      }
  }
  out.things = std::move(things);
  out.changed = grown(out.changed, 2 * kHalo, size);
  const cv::Mat hidden = cv::max(out.hidden_a, out.hidden_b);
  out.behind = {behind(flow.forth, flow.back, hidden, out.changed),
                behind(flow.back, flow.forth, hidden, out.changed)};
  out.flow = {out.behind.forth.clone(), out.behind.back.clone()};
  as_flow_integers(forth).copyTo(out.flow.forth, out.hidden_a > .5);
  as_flow_integers(back).copyTo(out.flow.back, out.hidden_b > .5);
  return out;
}

}  // namespace

cv::Mat mismatch(const cv::Mat& a, const cv::Mat& b, double window) {
  cv::Mat difference, out;
  cv::subtract(a, b, difference);
  cv::multiply(difference, difference, difference);
  cv::transform(difference, out, cv::Matx13f::all(1.0f / 3));
  out = cv::min(out, kMostMissed);
  cv::GaussianBlur(out, out, {}, window, 0, cv::BORDER_REFLECT_101);
  return out;
}

CarriedThing::Origin CarriedThing::origin(cv::Point2f place, float part) const {
  constexpr float kMissed = .5f;  // px
  const cv::Point2f corner = box.tl(), in = place - corner;
  cv::Point2f way = as_point(value_at<cv::Vec2f>(move, in));
  for (int turn = 0; turn < kTurns; ++turn) way = as_point(value_at<cv::Vec2f>(move, in - part * way));
  const cv::Point2f at = in - part * way, missed = at + part * as_point(value_at<cv::Vec2f>(move, at)) - in;
  const bool inside = at.x > -1 && at.y > -1 && at.x < static_cast<float>(box.width) &&
                      at.y < static_cast<float>(box.height) && std::hypot(missed.x, missed.y) < kMissed;
  return {at + corner, way, inside ? value_at<float>(opacity, at) : 0};
}

cv::Rect CarriedThing::way(cv::Size flow) const {
  cv::Rect out;
  for (int y = 0; y < box.height; ++y)
    for (int x = 0; x < box.width; ++x) {
      if (opacity.at<float>(y, x) <= 0) continue;
      const cv::Vec2f to = move.at<cv::Vec2f>(y, x);
      const cv::Point here = box.tl() + cv::Point(x, y),
                      there = here + cv::Point(cvFloor(to[0]), cvFloor(to[1]));
      out |= cv::Rect(here, cv::Size(1, 1)) | cv::Rect(there, cv::Size(2, 2));
    }
  return grown(out, 1, flow);
}

PinnedFlow pinned_flow(const cv::Mat& from, const cv::Mat& to, const FlowPair& flow,
                       std::span<const FlowPin> pins, const std::stop_token& stop) {
  Stills stills(from, to, flow);
  std::vector<Carrying> carrying;
  for (std::vector<FlowPin>& group : joined_pins(pins)) {
    carrying.emplace_back(stills, PinnedMotion(std::move(group)));
    carrying.back().find_motion(stop);
  }
  const auto composed = [&] {
    std::vector<CarriedThing> things;
    for (const Carrying& each : carrying)
      if (!stop.stop_requested()) things.push_back(each.thing());
    return with_things(flow, std::move(things));
  };
  // About a thing the flow that was found is not to be trusted: what lies behind is known only when the thing is.
  stills.add(composed().behind);
  return composed();
}

}  // namespace freshet::synth::stills
