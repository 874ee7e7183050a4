#include "synth/stills/region_proposal.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "synth/stills/still_graph.h"
#include "synth/stills/still_set.h"

namespace freshet::synth::stills {
namespace {

constexpr double kStill = 2;          // of 255: a scene whose strongest variation is below it does not move
constexpr double kLeastArea = .0004;  // of the picture, of a piece
constexpr double kLeastEnergy = .02;  // of the strongest piece's
constexpr double kWhole = .85;        // of the picture: what moves more than that is all of it
constexpr double kSlowArea = .01;     // of the picture: less is left standing

float percentile(const cv::Mat& plane, double part) {
  std::vector<float> values(plane.begin<float>(), plane.end<float>());
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

cv::Mat disc(double radius) {
  const int side = 2 * std::max(1, cvRound(radius)) + 1;
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side});
}

// Of the upper halves of two tables, -1..1.
double agreement(const Square<double>& a, const Square<double>& b) {
  double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  int count = 0;
  for (int i = 0; i < a.n; ++i)
    for (int j = 0; j < i; ++j, ++count) {
      sa += a(i, j), sb += b(i, j);
      saa += a(i, j) * a(i, j), sbb += b(i, j) * b(i, j), sab += a(i, j) * b(i, j);
    }
  const double va = saa - sa * sa / count, vb = sbb - sb * sb / count;
  return va > 0 && vb > 0 ? (sab - sa * sb / count) / std::sqrt(va * vb) : 0;
}

// What a thing surrounds is its own: the middle of a flame is white in every still.
cv::Mat without_holes(const cv::Mat& mask) {
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(mask, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  cv::Mat filled(mask.size(), CV_8U, cv::Scalar(0));
  cv::drawContours(filled, outlines, -1, cv::Scalar(255), cv::FILLED);
  return filled;
}

struct Piece {
  cv::Mat mask;  // CV_8U
  double energy = 0;
};

/// The connected parts of a mask that matter, the strongest first.
std::vector<Piece> pieces_of(const cv::Mat& mask, const cv::Mat& variation, double least_energy_share) {
  cv::Mat labels;
  const int count = cv::connectedComponents(mask, labels, 8, CV_32S);
  std::vector<Piece> pieces;
  for (int label = 1; label < count; ++label) {
    Piece piece{.mask = labels == label};
    if (cv::countNonZero(piece.mask) < kLeastArea * static_cast<double>(mask.total())) continue;
    cv::Mat inside;
    variation.copyTo(inside, piece.mask);
    piece.energy = cv::norm(inside, cv::NORM_L2SQR);
    pieces.push_back(std::move(piece));
  }
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const Piece& a, const Piece& b) { return a.energy > b.energy; });
  if (!pieces.empty()) {
    const double least = least_energy_share * pieces.front().energy;
    std::erase_if(pieces, [&](const Piece& piece) { return piece.energy < least; });
  }
  return pieces;
}

/// Cuts pieces where two peaks of variation that go their own ways have a valley between them.
class Splitter {
 public:
  Splitter(const std::vector<cv::Mat>& stills, const cv::Mat& variation, const RegionProposalOptions& options)
      : stills_(stills), variation_(variation), options_(options) {}

  void split(const Piece& piece, std::vector<Piece>& out) const {
    constexpr double kStep = 1.2, kPart = .1;
    double low = 0, high = 0;
    cv::minMaxLoc(variation_, &low, &high, nullptr, nullptr, piece.mask);
    for (double level = std::max(low, 1.0) * kStep; level < high; level *= kStep) {
      const std::vector<Piece> parts = pieces_of(piece.mask & (variation_ > level), variation_, kPart);
      if (parts.size() < 2 || !have_valleys(parts, level) || !go_apart(parts)) continue;
      for (const Piece& each : grown(piece, parts)) split(each, out);
      return;
    }
    out.push_back(piece);
  }

 private:
  bool have_valleys(const std::vector<Piece>& parts, double level) const {
    return std::all_of(parts.begin(), parts.end(), [&](const Piece& part) {
      double peak = 0;
      cv::minMaxLoc(variation_, nullptr, &peak, nullptr, nullptr, part.mask);
      return level <= options_.valley * peak;
    });
  }
  bool go_apart(const std::vector<Piece>& parts) const {
    std::vector<Square<double>> tables;
    for (const Piece& part : parts) tables.push_back(still_distances(stills_, part.mask));
    for (std::size_t i = 0; i < parts.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (agreement(tables[i], tables[j]) < options_.apart) return true;
    return false;
  }
  /// The whole piece shared out among its parts, along the valleys.
  std::vector<Piece> grown(const Piece& piece, const std::vector<Piece>& parts) const {
    cv::Mat markers(piece.mask.size(), CV_32S, cv::Scalar(0)), relief, relief3;
    markers.setTo(1, piece.mask == 0);
    for (std::size_t i = 0; i < parts.size(); ++i) markers.setTo(static_cast<int>(i) + 2, parts[i].mask);
    double high = 0;
    cv::minMaxLoc(variation_, nullptr, &high, nullptr, nullptr, piece.mask);
    variation_.convertTo(relief, CV_8U, -255 / high, 255);
    cv::merge(std::vector<cv::Mat>(3, relief), relief3);
    cv::watershed(relief3, markers);
    std::vector<Piece> out;
    for (std::size_t i = 0; i < parts.size(); ++i)
      out.push_back({.mask = piece.mask & (markers == static_cast<int>(i) + 2), .energy = parts[i].energy});
    return out;
  }

  const std::vector<cv::Mat>& stills_;
  const cv::Mat& variation_;
  const RegionProposalOptions& options_;
};

/// Pieces that one order serves, as one.
std::vector<Piece> joined(const std::vector<Piece>& pieces, const std::vector<cv::Mat>& stills,
                          const RegionProposalOptions& options) {
  std::vector<Square<double>> tables;
  for (const Piece& piece : pieces) tables.push_back(still_distances(stills, piece.mask));
  std::vector<Piece> out;
  std::vector<std::size_t> leader;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    std::size_t best = out.size();
    double most = options.together;
    for (std::size_t k = 0; k < out.size(); ++k)
      if (const double found = agreement(tables[i], tables[leader[k]]); found > most) best = k, most = found;
    if (best == out.size() && static_cast<int>(out.size()) < options.most) {
      out.push_back({.mask = pieces[i].mask.clone(), .energy = pieces[i].energy});
      leader.push_back(i);
    } else if (best < out.size()) {
      out[best].mask |= pieces[i].mask;
    }
  }
  return out;
}

/// Where pieces crowd, the surface shimmers: rain on water has as many clocks as one cares to cut pieces, and
/// none to be seen. Crowds of pieces that touch become one piece each.
std::vector<Piece> without_crowds(const std::vector<Piece>& pieces, double longer) {
  constexpr std::size_t kCrowd = 3;
  constexpr double kTouch = .02, kGap = .03;  // of the longer side; each of two pieces grows by kTouch
  if (pieces.size() < kCrowd) return pieces;
  cv::Mat all(pieces[0].mask.size(), CV_8U, cv::Scalar(0)), labels;
  for (const Piece& piece : pieces) all |= piece.mask;
  cv::dilate(all, all, disc(kTouch * longer));
  const int count = cv::connectedComponents(all, labels, 8, CV_32S);
  std::vector<char> taken(pieces.size(), 0);
  std::vector<Piece> out;
  for (int label = 1; label < count; ++label) {
    std::vector<std::size_t> crowd;
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (taken[i] == 0 && cv::countNonZero(pieces[i].mask & (labels == label)) > 0) crowd.push_back(i);
    if (crowd.size() < kCrowd) continue;
    Piece one{.mask = cv::Mat(all.size(), CV_8U, cv::Scalar(0))};
    for (const std::size_t i : crowd)
      one.mask |= pieces[i].mask, one.energy += pieces[i].energy, taken[i] = 1;
    cv::morphologyEx(one.mask, one.mask, cv::MORPH_CLOSE, disc(kGap * longer));
    out.push_back(std::move(one));
  }
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (taken[i] == 0) out.push_back(pieces[i]);
  return out;
}

cv::Scalar tint(std::size_t number) {
  static const cv::Scalar kTints[] = {{60, 200, 255}, {255, 160, 60}, {120, 255, 120}, {255, 100, 220},
                                      {90, 90, 255},  {255, 255, 90}, {180, 255, 255}, {200, 140, 255}};
  return kTints[number % std::size(kTints)];
}

// width   px that the text may take: it is written smaller where it would be longer.
void write(cv::Mat& sheet, const std::string& text, cv::Point at, int width) {
  constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
  constexpr double kScale = .5;
  int baseline = 0;
  const int needed = cv::getTextSize(text, kFont, kScale, 1, &baseline).width;
  const double scale = kScale * std::min(1.0, static_cast<double>(width) / std::max(1, needed));
  cv::putText(sheet, text, at, kFont, scale, cv::Scalar::all(0), 3, cv::LINE_AA);
  cv::putText(sheet, text, at, kFont, scale, cv::Scalar::all(255), 1, cv::LINE_AA);
}

cv::Mat enlarged(const cv::Mat& mask, cv::Size size) {
  cv::Mat smooth, out;
  cv::resize(mask, smooth, size, 0, 0, cv::INTER_LINEAR);
  out = smooth >= 128;
  return out;
}

}  // namespace

cv::Mat variation_of(const std::vector<cv::Mat>& stills) {
  cv::Mat sum(stills[0].size(), CV_32FC3, cv::Scalar::all(0)), squares = sum.clone(), blurred;
  for (const cv::Mat& still : stills) {
    still.convertTo(blurred, CV_32F);
    cv::GaussianBlur(blurred, blurred, {}, 1);
    cv::accumulate(blurred, sum);
    cv::accumulateSquare(blurred, squares);
  }
  const auto n = static_cast<double>(stills.size());
  sum /= n;
  cv::Mat variance = squares / n - sum.mul(sum), mean;
  cv::transform(variance, mean, cv::Matx13f(1.f / 3, 1.f / 3, 1.f / 3));
  cv::sqrt(cv::max(mean, 0), mean);
  return mean;
}

RegionProposal propose_regions(const std::vector<cv::Mat>& small, const RegionProposalOptions& options) {
  const std::vector<cv::Mat> stills = reduced(small, options.side);
  RegionProposal proposal{.regions = {}, .variation = variation_of(stills), .notices = {}};
  const cv::Mat& variation = proposal.variation;
  const cv::Size size = variation.size();
  const double strongest = percentile(variation, .999);
  if (strongest < kStill)
    throw Error(
        ErrorKind::kInput, "stills",
        fmt::format("nothing moves in them: no place varies by more than {:.1f} of 255 from still to still",
                    strongest),
        "Give stills between which something has moved, or mark a region with --regions");
  const double noise = std::min<double>(percentile(variation, .2), 3);
  const double moves = std::max(2.5 * noise + 1, options.moves * percentile(variation, .99));
  const double longer = std::max(size.width, size.height);
  cv::Mat moving = variation > std::min(moves, .5 * strongest);
  cv::morphologyEx(moving, moving, cv::MORPH_CLOSE, disc(.012 * longer));
  std::vector<Piece> pieces;
  const Splitter splitter(stills, variation, options);
  for (const Piece& piece : pieces_of(moving, variation, kLeastEnergy)) splitter.split(piece, pieces);
  pieces = without_crowds(joined(pieces, stills, options), longer);

  std::stable_sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) {
    return cv::boundingRect(a.mask).x < cv::boundingRect(b.mask).x;
  });
  cv::Mat taken(size, CV_8U, cv::Scalar(0));
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    cv::Mat mask = pieces[i].mask;
    cv::dilate(mask, mask, disc(.008 * longer));
    mask = without_holes(mask);
    mask &= ~taken;
    taken |= mask;
    if (pieces.size() == 1 && cv::countNonZero(mask) > kWhole * static_cast<double>(mask.total()))
      mask.setTo(255);
    proposal.regions.push_back({.name = std::to_string(i + 1),
                                .kind = RegionKind::kIndependent,
                                .mask = enlarged(mask, small[0].size()),
                                .parent = {}});
  }
  cv::Mat slow = (variation > 2 * noise + .7) & ~taken;
  cv::morphologyEx(slow, slow, cv::MORPH_CLOSE, disc(.01 * longer));
  cv::morphologyEx(slow, slow, cv::MORPH_OPEN, disc(.008 * longer));
  slow &= ~taken;
  if (cv::countNonZero(slow) > kSlowArea * static_cast<double>(slow.total()))
    proposal.regions.push_back(
        {.name = "slow", .kind = RegionKind::kSlow, .mask = enlarged(slow, small[0].size()), .parent = {}});
  return proposal;
}

cv::Mat region_sheet(const cv::Mat& still, const std::vector<Region>& regions, const cv::Mat& variation) {
  constexpr int kLine = 26;
  const cv::Size size = reduced_size(still.size(), 640);
  cv::Mat left, right, heat;
  cv::resize(still, left, size, 0, 0, cv::INTER_AREA);
  cv::resize(variation, heat, size, 0, 0, cv::INTER_LINEAR);
  double most = 0;
  cv::minMaxLoc(heat, nullptr, &most);
  heat.convertTo(heat, CV_8U, 255 / std::max(most, 1.0));
  cv::applyColorMap(heat, right, cv::COLORMAP_INFERNO);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    cv::Mat mask;
    cv::resize(regions[i].mask, mask, size, 0, 0, cv::INTER_NEAREST);
    std::vector<std::vector<cv::Point>> outlines;
    cv::findContours(mask, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE);
    const bool slow = regions[i].kind == RegionKind::kSlow;
    const cv::Scalar colour = slow ? cv::Scalar::all(150) : tint(i);
    cv::Mat tinted = left.clone();
    tinted.setTo(colour, mask);
    cv::addWeighted(left, .75, tinted, .25, 0, left);
    cv::drawContours(left, outlines, -1, colour, slow ? 1 : 2, cv::LINE_AA);
  }
  for (const Region& region : regions) {
    cv::Mat mask;
    cv::resize(region.mask, mask, size, 0, 0, cv::INTER_NEAREST);
    // Where the region is widest, so that its name lies in it.
    cv::Mat depth;
    cv::Point deepest;
    cv::distanceTransform(mask, depth, cv::DIST_L2, 3);
    cv::minMaxLoc(depth, nullptr, nullptr, nullptr, &deepest);
    write(left, region.name, deepest + cv::Point(-5, 5), size.width);
  }
  cv::Mat sheet(size.height + kLine, 2 * size.width + 6, CV_8UC3, cv::Scalar::all(32));
  left.copyTo(sheet(cv::Rect({0, 0}, size)));
  right.copyTo(sheet(cv::Rect({size.width + 6, 0}, size)));
  write(sheet, "Regions, by name. Grey: slow. No tint: stands still.", {6, size.height + 18},
        size.width - 12);
  write(sheet, fmt::format("Variation over the stills; white is {:.0f} of 255.", most),
        {size.width + 12, size.height + 18}, size.width - 12);
  return sheet;
}

}  // namespace freshet::synth::stills
