#include "query/search/target.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cassert>
#include <queue>

#include "freshet/error.h"
#include "query/index/patch_descriptors.h"
#include "vision/dense_sift.h"

namespace freshet::query {
namespace {

constexpr int kMinPoints = 9;  // of a piece's 81: fewer say too little to search by

// How many lattice places it takes to cover `length`, and where the first starts.
std::pair<int, int> cover(int length, int side, int stride) {
  const int places = length <= side ? 1 : (length - side + stride - 1) / stride + 1;
  return {places, -((places - 1) * stride + side - length) / 2};
}

// Adds the places that cover most of what no kept place covers, until nothing is left.
void cover_rest(const cv::Mat& matte, const std::vector<cv::Rect>& boxes, std::vector<bool>& kept) {
  cv::Mat left = matte > 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (kept[i]) left(boxes[i]).setTo(0);
  }
  // Counts only fall, so that a count that still holds when it comes up is the maximum.
  using Entry = std::pair<int, std::size_t>;
  const auto less = [](const Entry& a, const Entry& b) {
    return a.first != b.first ? a.first < b.first : a.second > b.second;
  };
  std::priority_queue<Entry, std::vector<Entry>, decltype(less)> queue(less);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!kept[i]) queue.emplace(cv::countNonZero(left(boxes[i])), i);
  }
  while (!queue.empty() && queue.top().first > 0) {
    const auto [promised, i] = queue.top();
    queue.pop();
    const int count = cv::countNonZero(left(boxes[i]));
    if (count < promised) {
      queue.emplace(count, i);
      continue;
    }
    kept[i] = true;
    left(boxes[i]).setTo(0);
  }
}

}  // namespace

Target lay_out(const cv::Mat& matte, const vision::PatchGrid& grid, const TargetOptions& options) {
  assert(matte.type() == CV_8U);
  if (matte.empty() || cv::countNonZero(matte) == 0) {
    throw Error(ErrorKind::kInput, "matte", "it is 0 everywhere", "Paint the fluid white");
  }
  Target target;
  target.picture = matte.size();
  target.side = grid.patch;
  target.stride = grid.stride;
  std::tie(target.columns, target.origin.x) = cover(matte.cols, grid.patch, grid.stride);
  std::tie(target.rows, target.origin.y) = cover(matte.rows, grid.patch, grid.stride);

  cv::Mat sums;
  cv::integral(matte, sums, CV_64F);
  const cv::Rect picture({0, 0}, matte.size());
  std::vector<cv::Rect> boxes;  // of all places, inside the picture
  std::vector<bool> kept;
  for (int row = 0; row < target.rows; ++row) {
    for (int column = 0; column < target.columns; ++column) {
      const cv::Point corner = target.origin + cv::Point(column, row) * grid.stride;
      const cv::Rect box = cv::Rect(corner, cv::Size(grid.patch, grid.patch)) & picture;
      const double sum = sums.at<double>(box.br()) - sums.at<double>(box.y, box.br().x) -
                         sums.at<double>(box.br().y, box.x) + sums.at<double>(box.tl());
      boxes.push_back(box);
      kept.push_back(box.area() > 0 && sum >= options.min_matte * 255 * box.area());
    }
  }
  cover_rest(matte, boxes, kept);

  constexpr std::uint32_t kNone = 0xffffffff;
  std::vector<std::uint32_t> piece_at(boxes.size(), kNone);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!kept[i]) continue;
    const cv::Point place(static_cast<int>(i) % target.columns, static_cast<int>(i) / target.columns);
    piece_at[i] = static_cast<std::uint32_t>(target.size());
    target.places.push_back(place);
    target.corners.push_back(target.origin + place * grid.stride);
  }
  for (std::uint32_t p = 0; p < target.size(); ++p) {
    const std::size_t i = static_cast<std::size_t>(target.places[p].y) * target.columns + target.places[p].x;
    if (target.places[p].x + 1 < target.columns && piece_at[i + 1] != kNone) {
      target.edges.emplace_back(p, piece_at[i + 1]);
    }
    if (target.places[p].y + 1 < target.rows && piece_at[i + target.columns] != kNone) {
      target.edges.emplace_back(p, piece_at[i + target.columns]);
    }
  }
  return target;
}

Target make_target(const cv::Mat& picture, const cv::Mat& matte, const vision::PatchGrid& grid,
                   const vision::Codebook& codebook, const TargetOptions& options) {
  assert(picture.type() == CV_8UC3 && picture.size() == matte.size());
  Target target = lay_out(matte, grid, options);
  cv::Mat luma;
  cv::cvtColor(picture, luma, cv::COLOR_BGR2GRAY);
  const SharedGrid shared = shared_grid(grid);
  const int columns = ((target.columns - 1) * grid.stride + grid.patch) / shared.step + 1;
  const int rows = ((target.rows - 1) * grid.stride + grid.patch) / shared.step + 1;
  const vision::DescriptorGrid points = vision::dense_sift(luma, target.origin, columns, rows, shared.step);
  std::vector<vision::Word> words(points.values.size());
  vision::assign_words(codebook, points.values, words);

  target.queries.resize(target.size());
  for (std::size_t p = 0; p < target.size(); ++p) {
    PieceQuery& query = target.queries[p];
    vision::WordMask inside{};
    int counted = 0;
    for (int j = 0; j < vision::kGridSide; ++j) {
      for (int i = 0; i < vision::kGridSide; ++i) {
        const int point = j * vision::kGridSide + i;
        const cv::Point at = target.places[p] * (grid.stride / shared.step) + cv::Point(i, j) * shared.spread;
        query.words[point] = words[static_cast<std::size_t>(at.y) * columns + at.x];
        // A point is the corner of four pixels; the one to its lower right speaks for it, at the far edges
        // the last one. Beyond the picture there is only reflection, which says nothing.
        const cv::Point px = target.origin + at * shared.step;
        if (px.x < 0 || px.y < 0 || px.x > matte.cols || px.y > matte.rows) continue;
        inside[point] = 1;
        query.mask[point] =
            matte.at<std::uint8_t>(std::min(px.y, matte.rows - 1), std::min(px.x, matte.cols - 1)) > 127;
        counted += query.mask[point];
      }
    }
    if (counted < kMinPoints) query.mask = inside;
    if (std::count(query.mask.begin(), query.mask.end(), 1) < kMinPoints) query.mask.fill(1);
  }
  return target;
}

}  // namespace freshet::query
