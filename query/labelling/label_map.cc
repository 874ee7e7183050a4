#include "query/labelling/label_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "query/search/picture_scale.h"
#include "report/sheet_words.h"

namespace freshet::query {
namespace {

constexpr int kLine = 20, kMinWidth = 480;  // px
constexpr std::size_t kMaxLines = 40;

// Hues a golden angle apart: neighbours in the list differ, however many there are.
cv::Vec3b colour_of(std::size_t rank) {
  const double hue = std::fmod(static_cast<double>(rank) * 137.508, 360.0);
  const cv::Mat hsv(1, 1, CV_32FC3, cv::Scalar(hue, rank % 2 == 0 ? 0.75 : 0.5, 0.95));
  cv::Mat bgr;
  cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
  const cv::Vec3f colour = bgr.at<cv::Vec3f>(0, 0) * 255;
  return {cv::saturate_cast<std::uint8_t>(colour[0]), cv::saturate_cast<std::uint8_t>(colour[1]),
          cv::saturate_cast<std::uint8_t>(colour[2])};
}

// The piece whose middle is nearest to each pixel of the picture, -1 where no piece lies: CV_32S.
cv::Mat nearest_piece(const Assignment& assignment) {
  const cv::Size size = reduced_size(assignment.picture, assignment.piece_scale);
  cv::Mat nearest(size, CV_32S, cv::Scalar(-1));
  cv::Mat distance(size, CV_32F, cv::Scalar(1e30));
  const cv::Rect picture({0, 0}, size);
  for (std::size_t i = 0; i < assignment.pieces.size(); ++i) {
    const cv::Point corner = assignment.pieces[i].corner;
    const cv::Rect box = cv::Rect(corner, cv::Size(assignment.side, assignment.side)) & picture;
    for (int y = box.y; y < box.br().y; ++y) {
      for (int x = box.x; x < box.br().x; ++x) {
        const double dx = x + 0.5 - corner.x - assignment.side / 2.0,
                     dy = y + 0.5 - corner.y - assignment.side / 2.0;
        const auto found = static_cast<float>(dx * dx + dy * dy);
        if (found >= distance.at<float>(y, x)) continue;
        distance.at<float>(y, x) = found;
        nearest.at<int>(y, x) = static_cast<int>(i);
      }
    }
  }
  if (size == assignment.picture) return nearest;
  cv::Mat enlarged;
  cv::resize(nearest, enlarged, assignment.picture, 0, 0, cv::INTER_NEAREST);
  return enlarged;
}

bool continues(const AssignedPiece& a, const AssignedPiece& b) {
  return a.clip == b.clip && a.variant == b.variant && b.patch - a.patch == b.corner - a.corner;
}

// A line for each clip of order, the most used first, from top on; one more counts those that have no line.
void write_legend(const Assignment& assignment, const std::vector<std::size_t>& used,
                  const std::vector<std::size_t>& order, int top, cv::Mat& map) {
  const std::size_t shown = std::min(order.size(), kMaxLines), rest = order.size() - shown;
  const auto write_line = [&](const std::string& text) {
    report::write_caption(map, text, {30, top + 12}, map.cols - 36);
    top += kLine;
  };
  for (std::size_t i = 0; i < shown; ++i) {
    const AssignedClip& clip = assignment.clips[order[i]];
    const double fraction =
        static_cast<double>(used[order[i]]) / static_cast<double>(assignment.pieces.size());
    cv::rectangle(map, cv::Rect(8, top, 14, 14), cv::Scalar(colour_of(i)), cv::FILLED);
    std::string text = fmt::format("{:4.1f} %  {}", 100 * fraction, clip.name);
    if (!clip.class_name.empty()) text += "  (" + clip.class_name + ")";
    if (!clip.licence.empty()) text += "  " + clip.licence;
    write_line(text);
  }
  if (rest > 0) write_line(fmt::format("and {} more {}", rest, rest == 1 ? "clip" : "clips"));
}

}  // namespace

cv::Mat label_map(const cv::Mat& picture, const cv::Mat* matte, const Assignment& assignment) {
  std::vector<std::size_t> used(assignment.clips.size());
  for (const AssignedPiece& piece : assignment.pieces) ++used[piece.clip];
  std::vector<std::size_t> order(used.size()), rank(used.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return used[a] > used[b]; });
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = i;

  const cv::Rect region = matte == nullptr ? cv::Rect({}, picture.size()) : report::shown_region(*matte);
  const int legend = 10 + static_cast<int>(std::min(order.size(), kMaxLines + 1)) * kLine;
  cv::Mat map(region.height + legend, std::max(region.width, kMinWidth), CV_8UC3,
              cv::Scalar::all(report::kSheetPaper));
  cv::Mat grey, body = map(cv::Rect({0, 0}, region.size()));
  cv::cvtColor(picture(region), grey, cv::COLOR_BGR2GRAY);
  cv::cvtColor(grey, body, cv::COLOR_GRAY2BGR);
  const cv::Mat nearest = nearest_piece(assignment);
  for (int y = region.y; y < std::min(region.br().y, nearest.rows); ++y) {
    for (int x = region.x; x < std::min(region.br().x, nearest.cols); ++x) {
      const int piece = nearest.at<int>(y, x);
      if (piece < 0 || (matte != nullptr && matte->at<std::uint8_t>(y, x) == 0)) continue;
      const AssignedPiece& own = assignment.pieces[piece];
      cv::Vec3b& pixel = body.at<cv::Vec3b>(y - region.y, x - region.x);
      pixel = pixel * 0.5 + colour_of(rank[own.clip]) * 0.5;
      const int right = x + 1 < nearest.cols ? nearest.at<int>(y, x + 1) : -1;
      const int below = y + 1 < nearest.rows ? nearest.at<int>(y + 1, x) : -1;
      const bool seam = (right >= 0 && right != piece && !continues(own, assignment.pieces[right])) ||
                        (below >= 0 && below != piece && !continues(own, assignment.pieces[below]));
      if (seam) pixel *= 0.6;
    }
  }

  write_legend(assignment, used, order, region.height + 8, map);
  return report::with_legend(
      map,
      {fmt::format("Each pixel of the fluid has the colour of the clip whose patch lies on it: above, how "
                   "many of the {} pieces each clip has.",
                   assignment.pieces.size()),
       "Dark lines: neighbours whose patches do not go on in each other.",
       report::crop_words(region, picture.size())});
}

}  // namespace freshet::query
