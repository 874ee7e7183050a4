#include "synth/tour/scenery.h"

#include <algorithm>
#include <utility>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "synth/scene/layers/cut_layers.h"

namespace freshet::synth::tour {
namespace {

/// Whatever depth of what lies behind is uncovered, it is patches of the picture.
constexpr double kAll_px = 1e5;

template <class Work>
void for_rows(int rows, const Work& work) {
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<int>(0, rows, 16), [&](const auto& range) {
    for (int y = range.begin(); y < range.end(); ++y) work(y);
  });
}

}  // namespace

Scenery::Scenery(const cv::Mat& first, std::vector<Upright> things, std::stop_token stop)
    : first_(first), ground_(first.size(), Texture::Beyond::kMirrored) {
  behind_ = first;
  if (!things.empty()) {
    std::stable_sort(things.begin(), things.end(),
                     [](const Upright& a, const Upright& b) { return a.depth < b.depth; });
    std::vector<scene::LayerMatte> mattes;
    for (const Upright& thing : things)
      mattes.push_back({.name = thing.name, .matte = thing.matte, .kind = scene::kind_of_matte(thing.matte)});
    mattes.push_back({.name = "(rest)", .kind = scene::MatteKind::kRest});
    scene::CutOptions options;
    options.uncover_px = kAll_px;
    const std::vector<scene::CutLayer> layers = scene::cut_layers(first, mattes, options, {}, stop);
    behind_ = layers.back().colour;
    for (std::size_t i = things.size(); i-- > 0;) {
      const scene::CutLayer& layer = layers[i];
      const cv::Rect box = cv::boundingRect(layer.alpha > 0);
      Board board{.depth = things[i].depth,
                  .box = box,
                  .left = box.x == 0,
                  .right = box.br().x == first.cols,
                  .bottom = box.br().y == first.rows,
                  .texture = Texture(box.size(), Texture::Beyond::kNothing),
                  .colour = {},
                  .alpha = layer.alpha(box).clone()};
      cv::Mat thrice;
      cv::merge(std::vector<cv::Mat>(3, board.alpha), thrice);
      board.colour = layer.colour(box).mul(thrice);
      boards_.push_back(std::move(board));
      behind_boards_.push_back(copies_of(layer.source));
    }
    change_.create(first.size(), CV_32FC3);
  }
  show_first();
}

// source   of a cut layer.
std::vector<Scenery::Copy> Scenery::copies_of(const cv::Mat& source) {
  constexpr int kBeside = 4;  // px: a patch is 9 px wide
  const cv::Rect all({}, source.size());
  const auto from = [&](cv::Point p) { return source.at<cv::Point>(p); };
  std::vector<Copy> copies;
  for (int y = 0; y < source.rows; ++y)
    for (int x = 0; x < source.cols; ++x) {
      const cv::Point here(x, y);
      if (from(here).x < 0 || from(here) == here) continue;
      Copy copy{.to = y * source.cols + x, .count = 0, .from = {}};
      for (const cv::Point aside : {cv::Point(0, 0), cv::Point(-kBeside, 0), cv::Point(kBeside, 0),
                                    cv::Point(0, -kBeside), cv::Point(0, kBeside)}) {
        const cv::Point beside = here + aside;
        if (!all.contains(beside) || from(beside).x < 0 || from(beside) == beside) continue;
        const cv::Point place = from(beside) - aside;
        // Of what lies behind it nothing can be copied.
        if (all.contains(place) && from(place) == place)
          copy.from[static_cast<std::size_t>(copy.count++)] = place.y * source.cols + place.x;
      }
      copies.push_back(copy);
    }
  return copies;
}

void Scenery::carry(const std::vector<Copy>& copies) {
  auto* change = change_.ptr<cv::Vec3f>();
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, copies.size(), 4096),
                            [&](const auto& range) {
                              for (std::size_t k = range.begin(); k < range.end(); ++k) {
                                const Copy& copy = copies[k];
                                cv::Vec3f sum{0, 0, 0};
                                for (int i = 0; i < copy.count; ++i)
                                  sum += change[copy.from[static_cast<std::size_t>(i)]];
                                change[copy.to] = sum * (1 / static_cast<float>(std::max(1, copy.count)));
                              }
                            });
}

void Scenery::show_first() {
  for (Board& board : boards_) {
    for (int y = 0; y < board.box.height; ++y)
      for (int x = 0; x < board.box.width; ++x) {
        const cv::Vec3f& colour = board.colour.at<cv::Vec3f>(y, x);
        board.texture.plane().at<cv::Vec4f>(y, x) = {colour[0], colour[1], colour[2],
                                                     board.alpha.at<float>(y, x)};
      }
    board.texture.filled();
  }
  for_rows(behind_.rows, [&](int y) {
    const auto* from = behind_.ptr<cv::Vec3f>(y);
    auto* to = ground_.plane().ptr<cv::Vec4f>(y);
    for (int x = 0; x < behind_.cols; ++x) to[x] = {from[x][0], from[x][1], from[x][2], 1};
  });
  ground_.filled();
}

// A thing's colours, times alpha, are the frame less what of the background shows through. Both change by what the
// frame changes: the background as it does where its copy comes from. So a frame that is the first gives what the cut
// gave, and whatever the frame, all laid over each other give it again.
void Scenery::show(const cv::Mat& frame) {
  if (boards_.empty()) {
    ground_.set(frame);
    return;
  }
  for_rows(frame.rows, [&](int y) {
    const auto* now = frame.ptr<cv::Vec3b>(y);
    const auto* before = first_.ptr<cv::Vec3f>(y);
    auto* change = change_.ptr<cv::Vec3f>(y);
    for (int x = 0; x < frame.cols; ++x)
      for (int c = 0; c < 3; ++c) change[x][c] = static_cast<float>(now[x][c]) * (1.0f / 255) - before[x][c];
  });
  for (std::size_t i = boards_.size(); i-- > 0;) {
    Board& board = boards_[i];
    // Colours of the frame are needed once more, below those of the copies.
    for_rows(board.box.height, [&](int y) {
      const auto* colour = board.colour.ptr<cv::Vec3f>(y);
      const auto* alpha = board.alpha.ptr<float>(y);
      const auto* own = change_.ptr<cv::Vec3f>(y + board.box.y) + board.box.x;
      auto* to = board.texture.plane().ptr<cv::Vec4f>(y);
      for (int x = 0; x < board.box.width; ++x)
        to[x] = alpha[x] <= 0 ? cv::Vec4f(0, 0, 0, 0)
                              : cv::Vec4f(colour[x][0] + own[x][0], colour[x][1] + own[x][1],
                                          colour[x][2] + own[x][2], alpha[x]);
    });
    carry(behind_boards_[i]);
    for_rows(board.box.height, [&](int y) {
      const auto* behind = change_.ptr<cv::Vec3f>(y + board.box.y) + board.box.x;
      auto* to = board.texture.plane().ptr<cv::Vec4f>(y);
      for (int x = 0; x < board.box.width; ++x) {
        const float alpha = to[x][3];
        for (int c = 0; c < 3; ++c) to[x][c] = std::clamp(to[x][c] - (1 - alpha) * behind[x][c], 0.0f, alpha);
      }
    });
    board.texture.filled();
  }
  for_rows(frame.rows, [&](int y) {
    const auto* from = behind_.ptr<cv::Vec3f>(y);
    const auto* by = change_.ptr<cv::Vec3f>(y);
    auto* to = ground_.plane().ptr<cv::Vec4f>(y);
    for (int x = 0; x < frame.cols; ++x)
      for (int c = 0; c < 3; ++c) to[x][c] = std::clamp(from[x][c] + by[x][c], 0.0f, 1.0f);
  });
  ground_.filled();
}

}  // namespace freshet::synth::tour
