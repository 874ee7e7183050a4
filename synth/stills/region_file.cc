#include "synth/stills/region_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "hints/strokes.h"
#include "media/picture/picture.h"
#include "platform/text.h"
#include "synth/matte/marks.h"
#include "synth/stills/region_proposal.h"

namespace freshet::synth::stills {
namespace {

constexpr std::size_t kMostRegions = 32;
constexpr double kLeastArea = 1e-4;  // of the picture: a mask's soft edges hold colours of their own

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& fault,
                         const std::string& remedy) {
  throw Error(ErrorKind::kInput, path.string(), fault, remedy);
}

RegionKind kind_of_name(const std::string& name) {
  const std::string lower = lower_case(name);
  if (lower.find("standing") != std::string::npos) return RegionKind::kStanding;
  if (lower.find("slow") != std::string::npos) return RegionKind::kSlow;
  return RegionKind::kIndependent;
}

// path "flame" -> flame
std::string short_name(const std::string& name, std::size_t number) {
  const std::size_t open = name.find('"'), close = name.rfind('"');
  if (open != std::string::npos && close > open + 1) return name.substr(open + 1, close - open - 1);
  return std::to_string(number);
}

std::vector<Region> drawn_regions(const std::filesystem::path& path, cv::Size full, cv::Size work,
                                  std::vector<std::string>& notices) {
  std::vector<Region> regions;
  const double sx = static_cast<double>(work.width) / full.width,
               sy = static_cast<double>(work.height) / full.height;
  for (const hints::Stroke& stroke : hints::read_strokes(path, full, &notices)) {
    std::vector<cv::Point> corners;
    for (const cv::Point2f& p : stroke.points)
      corners.emplace_back(cvRound(p.x * sx - .5), cvRound(p.y * sy - .5));
    if (corners.size() < 3) {
      notices.push_back(stroke.name + ": a line has no inside, and is left out");
      continue;
    }
    Region region{.name = short_name(stroke.name, regions.size() + 1),
                  .kind = kind_of_name(stroke.name),
                  .mask = cv::Mat(work, CV_8U, cv::Scalar(0)),
                  .parent = {}};
    cv::fillPoly(region.mask, std::vector<std::vector<cv::Point>>{corners}, cv::Scalar(255));
    if (cv::countNonZero(region.mask) > 0) regions.push_back(std::move(region));
  }
  return regions;
}

// What a pixel of a picture of masks says.
enum : int { kBlack = -1, kGrey = -2, kWhite = -3, kEdge = -4 };

int meaning(const cv::Vec3b& bgr) {
  const int most = std::max({bgr[0], bgr[1], bgr[2]}), least = std::min({bgr[0], bgr[1], bgr[2]});
  if (most < 48) return kBlack;
  if (most - least < 40) return most < 64 ? kBlack : least > 191 ? kWhite : kGrey;
  // Six bits of colour: what two bits a channel tell apart, a person does too.
  return (bgr[0] >> 6) << 4 | (bgr[1] >> 6) << 2 | bgr[2] >> 6;
}

std::vector<Region> masked_regions(const std::filesystem::path& path, cv::Size full, cv::Size work) {
  cv::Mat picture = media::read_picture(path).bgr;
  const double shape =
      static_cast<double>(picture.cols) * full.height / (static_cast<double>(picture.rows) * full.width);
  if (std::abs(shape - 1) > .01)
    refuse(path,
           fmt::format("it is {} x {} px, the stills are {} x {}: other proportions", picture.cols,
                       picture.rows, full.width, full.height),
           "Draw it over a still; where stills were aligned, over the sheet's (--sheet)");
  cv::resize(picture, picture, work, 0, 0, cv::INTER_NEAREST);
  std::map<int, cv::Mat> areas;
  for (int y = 0; y < work.height; ++y)
    for (int x = 0; x < work.width; ++x) {
      const int said = meaning(picture.at<cv::Vec3b>(y, x));
      if (said == kBlack) continue;
      cv::Mat& area = areas[said];
      if (area.empty()) area = cv::Mat(work, CV_8U, cv::Scalar(0));
      area.at<std::uint8_t>(y, x) = 255;
    }
  const double least = kLeastArea * work.area();
  std::vector<Region> regions;
  const auto add = [&](const cv::Mat& mask, RegionKind kind) {
    if (cv::countNonZero(mask) < least) return;
    regions.push_back({.name = kind == RegionKind::kSlow ? "slow" : std::to_string(regions.size() + 1),
                       .kind = kind,
                       .mask = mask,
                       .parent = {}});
  };
  for (const auto& [said, area] : areas) {
    if (said != kWhite) {
      if (said != kGrey) add(area, RegionKind::kIndependent);
      continue;
    }
    cv::Mat labels;
    const int count = cv::connectedComponents(area, labels, 8, CV_32S);
    for (int label = 1; label < count; ++label) add(labels == label, RegionKind::kIndependent);
  }
  if (areas.contains(kGrey)) add(areas.at(kGrey), RegionKind::kSlow);
  return regions;
}

}  // namespace

std::vector<Region> read_regions(const std::filesystem::path& path, cv::Size full, cv::Size work,
                                 std::vector<std::string>& notices) {
  const std::vector<Region> regions = lower_ending(path) == ".svg" ? drawn_regions(path, full, work, notices)
                                                                   : masked_regions(path, full, work);
  if (regions.empty())
    refuse(path, "there is no region in it",
           "Draw a closed outline (SVG), or paint areas white or in colours");
  if (regions.size() > kMostRegions)
    refuse(path, fmt::format("it holds {} regions, more than {}", regions.size(), kMostRegions),
           "Paint what moves together in one colour, without soft edges");
  return regions;
}

std::vector<Region> scribbled_regions(const std::filesystem::path& path, const cv::Mat& still,
                                      const std::vector<cv::Mat>& small, std::vector<std::string>& notices) {
  constexpr double kRises =
      .15;  // of the strongest variation: what varies less stands, where nobody says otherwise
  const cv::Size size = small[0].size();
  matte::Marks marks = matte::read_scribbles(path, still, &notices),
               reduced_marks(size, CV_8U, cv::Scalar(0));
  for (const matte::Mark mark : {matte::kBackground, matte::kFluid}) {
    // By area, so that a thin line is not lost between samples.
    cv::Mat share;
    cv::resize(marks == mark, share, size, 0, 0, cv::INTER_AREA);
    reduced_marks.setTo(mark, share > 24);
  }
  const cv::Mat variation = variation_of(small);
  double most = 0;
  cv::minMaxLoc(variation, nullptr, &most);
  cv::Mat markers, relief, relief3;
  const int count = cv::connectedComponents(reduced_marks == matte::kFluid, markers, 8, CV_32S);
  if (count < 2)
    refuse(path, "no stroke in it marks what moves", "Paint white or green over each thing that moves");
  if (static_cast<std::size_t>(count) > kMostRegions + 1)
    refuse(path, fmt::format("{} strokes mark what moves, more than {}", count - 1, kMostRegions),
           "Join strokes over what moves together");
  markers.setTo(count,
                (reduced_marks == matte::kBackground) | ((variation < kRises * most) & (markers == 0)));
  variation.convertTo(relief, CV_8U, -255 / std::max(most, 1.0), 255);
  cv::merge(std::vector<cv::Mat>(3, relief), relief3);
  cv::watershed(relief3, markers);
  std::vector<Region> regions;
  for (int label = 1; label < count; ++label)
    regions.push_back({.name = std::to_string(label),
                       .kind = RegionKind::kIndependent,
                       .mask = markers == label,
                       .parent = {}});
  return regions;
}

}  // namespace freshet::synth::stills
