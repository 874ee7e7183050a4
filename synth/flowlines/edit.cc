#include "synth/flowlines/edit.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "synth/flowlines/lines/moving_lines.h"
#include "synth/flowlines/pairing.h"

namespace freshet::synth::flowlines {
namespace {

constexpr int kStride = 3;         // px between points that are compared
constexpr double kReach = 4;       // patches within which lines are joined
constexpr double kSameWay = 0.5;   // cosine: others cross
constexpr double kDrawnOut = 2;    // times as far apart as the input lines
constexpr double kMirrored = 1.2;  // times as far or as near, where they lie the other way round

cv::Point2f at_share(const FlowLine& line, float share) { return at(line, share * line.length()); }

double mean_distance(const FlowLine& a, const FlowLine& b, double* most = nullptr) {
  constexpr int kPoints = 16;
  double sum = 0;
  for (int i = 0; i <= kPoints; ++i) {
    const auto share = static_cast<float>(i) / kPoints;
    const double apart = cv::norm(at_share(a, share) - at_share(b, share));
    sum += apart;
    if (most != nullptr) *most = std::max(*most, apart);
  }
  return sum / (kPoints + 1);
}

/// Distance from a point to the nearest sample of a line.
double distance_to(const FlowLine& line, cv::Point2f point) {
  double least = 1e18;
  for (const cv::Point2f& sample : line.points) least = std::min(least, cv::norm(sample - point));
  return least;
}

/// Whether another drawn line already lies where an interpolated one would.
bool is_taken(const FlowLine& line, const std::vector<FlowLine>& drawn, std::size_t a, std::size_t b,
              double within) {
  const cv::Point2f middle = at_share(line, 0.5f);
  for (std::size_t i = 0; i < drawn.size(); ++i)
    if (i != a && i != b && distance_to(drawn[i], middle) < within) return true;
  return false;
}

/// A place that two neighbouring edited lines both cover: arc length along and distance across each.
struct Overlap {
  float arc_a, across_a, arc_b, across_b;
};

std::vector<Overlap> overlaps(const FlowLine& a, const FlowLine& b, double patch) {
  std::vector<Overlap> out;
  for (int s = 0; s < a.samples(); s += kStride) {
    // Halfway between the two lines, and from there along the way to the other.
    const cv::Point2f here = a.points[static_cast<std::size_t>(s)];
    int nearest = 0;
    double least = 1e18;
    for (int t = 0; t < b.samples(); ++t)
      if (const double d = cv::norm(b.points[static_cast<std::size_t>(t)] - here); d < least) {
        least = d;
        nearest = t;
      }
    if (least > patch) continue;
    const cv::Point2f there = b.points[static_cast<std::size_t>(nearest)];
    const cv::Point2f along_a = tangent(a, s), along_b = tangent(b, nearest);
    for (const float share : {0.25f, 0.5f, 0.75f}) {
      const cv::Point2f p = here * (1 - share) + there * share, from_a = p - here, from_b = p - there;
      out.push_back({static_cast<float>(s) + from_a.dot(along_a), from_a.dot({-along_a.y, along_a.x}),
                     static_cast<float>(nearest) + from_b.dot(along_b), from_b.dot({-along_b.y, along_b.x})});
    }
  }
  return out;
}

cv::Point2f place(const FlowLine& line, float arc, float across) {
  const cv::Point2f along = tangent(line, cvRound(arc));
  return at(line, arc) + cv::Point2f(-along.y, along.x) * across;
}

/// What each input line would show at one side of the overlaps, in some frames: a row an input.
class Shown {
 public:
  Shown(const std::vector<cv::Mat>& frames, int wanted) {
    const int count = std::min(wanted, static_cast<int>(frames.size()));
    for (int i = 0; i < count; ++i)
      frames_.push_back(
          frames[static_cast<std::size_t>(i) * frames.size() / static_cast<std::size_t>(count)]);
  }
  cv::Mat rows(const std::vector<FlowLine>& inputs, const EditedLine& edited,
               const std::vector<Overlap>& at_places, bool first, Correspondence correspondence) const {
    const int width = static_cast<int>(at_places.size());
    cv::Mat out(static_cast<int>(inputs.size()), width * static_cast<int>(frames_.size()), CV_8UC3);
    if (width == 0) return out;  // the two lines lie apart
    tbb::parallel_for(0, out.rows, [&](int y) {
      const FlowLine& input = inputs[static_cast<std::size_t>(y)];
      const ArcMap arc_of(edited.line, input, correspondence);
      cv::Mat map(1, width, CV_32FC2), shown;
      for (int i = 0; i < width; ++i) {
        const Overlap& overlap = at_places[static_cast<std::size_t>(i)];
        const float arc = arc_of(first ? overlap.arc_a : overlap.arc_b);
        const cv::Point2f p = place(input, arc, first ? overlap.across_a : overlap.across_b);
        map.at<cv::Vec2f>(i) = cv::Vec2f(p.x, p.y);
      }
      for (std::size_t f = 0; f < frames_.size(); ++f) {
        cv::remap(frames_[f], shown, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
        shown.copyTo(out(cv::Rect(static_cast<int>(f) * width, y, width, 1)));
      }
    });
    return out;
  }

 private:
  std::vector<cv::Mat> frames_;
};

/// E(x - 1, y', x, y) of all pairs of inputs: every row of one side with every row of the other.
cv::Mat errors(const cv::Mat& of_a, const cv::Mat& of_b) {
  cv::Mat out(of_a.rows, of_b.rows, CV_64F, cv::Scalar(0));
  if (of_a.cols == 0) return out;
  tbb::parallel_for(0, of_a.rows, [&](int i) {
    for (int j = 0; j < of_b.rows; ++j)
      out.at<double>(i, j) = cv::norm(of_a.row(i), of_b.row(j), cv::NORM_L2SQR) / of_a.cols;
  });
  return out;
}

/// The mean cosine of their ways, share by share.
double same_way(const FlowLine& a, const FlowLine& b) {
  constexpr int kPoints = 8;
  double sum = 0;
  for (int i = 0; i <= kPoints; ++i) {
    const auto share = static_cast<float>(i) / kPoints;
    sum += static_cast<double>(
        tangent(a, cvRound(share * a.length())).dot(tangent(b, cvRound(share * b.length()))));
  }
  return sum / (kPoints + 1);
}

/// On which side of a line another's middle lies: the sign says it.
float side_of(const FlowLine& other, const FlowLine& line) {
  const cv::Point2f along = tangent(line, line.samples() / 2);
  const cv::Point2f way = at_share(other, 0.5f) - at_share(line, 0.5f);
  return along.x * way.y - along.y * way.x;
}

/// Whether two lines, one given after the other, are of one sheet of fluid.
bool are_near(const FlowLine& a, const FlowLine& b, const EditOptions& options) {
  double most = 0;
  mean_distance(a, b, &most);
  if (options.join_px > 0) return most <= options.join_px;
  return most <= kReach * options.patch_px && same_way(a, b) >= kSameWay;
}

/// Whether two edited lines are, by the input lines whose copies they are: a sheet may be drawn out across the flow,
/// within limits, or mirrored; two copies of one line, or the last of one copy of a fall and the first of the next,
/// are two.
bool are_sheet(const FlowLine& a, const FlowLine& b, const FlowLine& of_a, const FlowLine& of_b,
               const EditOptions& options) {
  if (!are_near(a, b, options)) return false;
  if (options.join_px > 0) return true;
  const double stretch = mean_distance(a, b) / std::max(1e-6, mean_distance(of_a, of_b));
  const bool mirrored = side_of(b, a) * side_of(of_b, of_a) < 0;
  return &of_a != &of_b && stretch <= (mirrored ? kMirrored : kDrawnOut) &&
         (!mirrored || stretch >= 1 / kMirrored);
}

/// By drawn line, from its name.
std::vector<int> times_of(const std::vector<FlowLine>& inputs, const std::vector<FlowLine>& drawn,
                          const std::vector<int>& partner) {
  std::vector<std::string> copies{""};
  std::vector<int> out;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const std::string& of = inputs[static_cast<std::size_t>(partner[i])].name;
    const std::string copy = drawn[i].name.substr(of.size());
    auto found = std::ranges::find(copies, copy);
    if (found == copies.end()) found = copies.insert(copies.end(), copy);
    const auto number = static_cast<int>(found - copies.begin());
    out.push_back(number == 0 ? 0 : 1 + (number - 1) % (kTimes - 1));
  }
  return out;
}

/// Lines with those that join consecutive ones, in their order.
/// joins    whether line i is joined with the one before it.
std::vector<EditedLine> joined(const std::vector<FlowLine>& drawn, const EditOptions& options,
                               const std::function<bool(std::size_t i)>& joins,
                               std::vector<std::size_t>* chain_begins) {
  std::vector<EditedLine> dense;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (i == 0 || !joins(i)) {
      if (chain_begins != nullptr) chain_begins->push_back(dense.size());
    } else {
      const double apart = mean_distance(drawn[i - 1], drawn[i]);
      const int missing = std::max(0, cvRound(apart / options.spacing_px) - 1);
      for (int k = 1; k <= missing; ++k) {
        const float share = static_cast<float>(k) / static_cast<float>(missing + 1);
        FlowLine line = between(drawn[i - 1], drawn[i], share);
        line.name = fmt::format("{}~{}", drawn[i - 1].name, drawn[i].name);
        if (line.points.empty() || is_taken(line, drawn, i - 1, i, 0.6 * options.spacing_px)) continue;
        dense.push_back({std::move(line), -1, false, i - 1, i, share});
      }
    }
    dense.push_back({drawn[i], -1, true, i, i, 0});
  }
  return dense;
}

}  // namespace

void follow_drawn(const std::vector<FlowLine>& drawn, std::vector<EditedLine>& dense) {
  for (EditedLine& line : dense)
    line.line = line.drawn ? drawn[line.to] : between(drawn[line.from], drawn[line.to], line.share);
}

std::vector<FlowLine> dense_inputs(const std::vector<FlowLine>& inputs, const EditOptions& options) {
  std::vector<FlowLine> out = inputs;
  const auto near = [&](std::size_t i) { return are_near(inputs[i - 1], inputs[i], options); };
  for (EditedLine& line : joined(inputs, options, near, nullptr))
    if (!line.drawn) out.push_back(std::move(line.line));
  return out;
}

std::vector<int> partners(const std::vector<FlowLine>& inputs, const std::vector<FlowLine>& edited,
                          const std::string& where) {
  std::vector<int> out;
  for (const FlowLine& line : edited) {
    int found = -1;
    std::size_t longest = 0;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      const std::string& name = inputs[i].name;
      const bool same = line.name == name || line.name.starts_with(name + "-");
      if (same && name.size() >= longest) {
        longest = name.size();
        found = static_cast<int>(i);
      }
    }
    if (found < 0) {
      std::string names;
      for (std::size_t i = 0; i < inputs.size() && i < 8; ++i)
        names += (i == 0 ? "\"" : ", \"") + inputs[i].name + "\"";
      throw Error(ErrorKind::kInput, fmt::format("{}: \"{}\"", where, line.name),
                  "no input line has this id, or the part of it before a \"-\"; there are " + names +
                      (inputs.size() > 8 ? ", ..." : ""),
                  "Give it the id of the line whose texture it shall show (--lines-out writes the ids)");
    }
    out.push_back(found);
  }
  return out;
}

std::vector<EditedLine> densify(const std::vector<FlowLine>& inputs, const std::vector<FlowLine>& drawn,
                                const std::vector<int>& partner, const std::vector<cv::Mat>& frames,
                                const EditOptions& options) {
  std::vector<std::size_t> chain_begins;  // lines of a chain lie beside each other
  const auto of = [&](std::size_t i) -> const FlowLine& {
    return inputs[static_cast<std::size_t>(partner[i])];
  };
  // No sheet has a line twice: with it another copy begins.
  std::vector<int> sheet(partner.begin(), partner.begin() + std::min<std::ptrdiff_t>(1, std::ssize(partner)));
  const auto joins = [&](std::size_t i) {
    const bool again = options.join_px <= 0 && std::ranges::find(sheet, partner[i]) != sheet.end();
    const bool joined = !again && are_sheet(drawn[i - 1], drawn[i], of(i - 1), of(i), options);
    if (!joined) sheet.clear();
    sheet.push_back(partner[i]);
    return joined;
  };
  std::vector<EditedLine> dense = joined(drawn, options, joins, &chain_begins);
  for (std::size_t i = 0, given = 0; i < dense.size(); ++i)
    if (dense[i].drawn) dense[i].input = partner[given++];
  chain_begins.push_back(dense.size());
  const std::vector<int> times = times_of(inputs, drawn, partner);
  for (std::size_t c = 0; c + 1 < chain_begins.size(); ++c)
    for (std::size_t i = chain_begins[c]; i < chain_begins[c + 1]; ++i)
      dense[i].time = times[dense[chain_begins[c]].from];
  const Shown shown(frames, options.frames);
  for (std::size_t c = 0; c + 1 < chain_begins.size(); ++c) {
    const std::size_t first = chain_begins[c], count = chain_begins[c + 1] - first;
    std::vector<int> given;
    for (std::size_t i = 0; i < count; ++i) given.push_back(dense[first + i].input);
    if (std::find(given.begin(), given.end(), -1) == given.end()) continue;
    std::vector<cv::Mat> tables(count);
    for (std::size_t i = 1; i < count; ++i) {
      const EditedLine &a = dense[first + i - 1], &b = dense[first + i];
      if (a.drawn && b.drawn) continue;
      const std::vector<Overlap> both = overlaps(a.line, b.line, options.patch_px);
      tables[i] = errors(shown.rows(inputs, a, both, true, options.correspondence),
                         shown.rows(inputs, b, both, false, options.correspondence));
    }
    const std::vector<int> chosen = pair_lines(
        static_cast<int>(count), static_cast<int>(inputs.size()),
        [&](int x, int before, int y) {
          const cv::Mat& table = tables[static_cast<std::size_t>(x)];
          return table.empty() ? 0.0 : table.at<double>(before, y);
        },
        given);
    for (std::size_t i = 0; i < count; ++i) dense[first + i].input = chosen[i];
  }
  return dense;
}

}  // namespace freshet::synth::flowlines
