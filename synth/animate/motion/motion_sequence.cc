#include "synth/animate/motion/motion_sequence.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "query/search/picture_scale.h"
#include "synth/animate/sampling/bilinear.h"
#include "synth/animate/sampling/patch_window.h"
#include "synth/animate/sampling/pull_push.h"
#include "vision/flow.h"

namespace freshet::synth::animate {
namespace {

constexpr float kFastest = 2.5f;     // times the mean speed of a frame
constexpr double kSmoothing = 1.25;  // squares
constexpr int kSquare = 8;           // px: finer than flow is true, fine enough for a flame's edge
constexpr std::uint32_t kSlab = 16;  // flow frames decoded together, as the store keeps them

/// One placed patch: where its squares lie in its clip's flow, and how velocities turn.
struct Probe {
  cv::Point corner;                // on the grid of squares
  std::size_t blur = 0;            // which of the clip's blurred flows it reads
  std::vector<cv::Point2f> spots;  // samples of the clip's flow, row-major over the patch's squares
  cv::Matx22d turn;
};

/// The flow of one clip, checked against its record.
store::StreamShape checked_flow(const store::ClipRecord& record, int step) {
  const store::StreamShape& flow = record.flow;
  const auto reduced = [&](std::uint32_t length) {
    return (length + static_cast<std::uint32_t>(step) - 1) / static_cast<std::uint32_t>(step);
  };
  const store::PlaneShape expected{reduced(record.width), reduced(record.height), 2};
  if (flow.planes.size() != 2 || flow.planes[0] != expected || flow.planes[1] != expected ||
      flow.frames == 0 || flow.frames + 1 != record.frame_count)
    throw Error(ErrorKind::kDamaged, record.name, "its flow does not fit its frames",
                "Run freshet store verify, and ingest the clip again");
  return flow;
}

/// From sums to means; then the motion of what moves goes on over what hardly does, and beyond the pieces. A
/// patch from a flame's edge is half dark and stands still there: taken at its word, no flame would ever
/// leave its outline.
void spread(cv::Mat& squares, const cv::Mat& mass) {
  double speed_sum = 0;
  cv::Mat speed = cv::Mat::zeros(squares.size(), CV_32F);
  for (int row = 0; row < squares.rows; ++row)
    for (int column = 0; column < squares.cols; ++column) {
      const float weight = mass.at<float>(row, column);
      if (weight <= 0) continue;
      auto& v = squares.at<cv::Vec2f>(row, column);
      v /= weight;
      speed.at<float>(row, column) = std::hypot(v[0], v[1]);
      speed_sum += speed.at<float>(row, column);
    }
  const auto mean = static_cast<float>(speed_sum / std::max(1, cv::countNonZero(mass)));
  if (mean <= 0) return;
  // Flow is wrong here and there by much, and such a place would tear the matte into rings.
  for (int row = 0; row < squares.rows; ++row)
    for (int column = 0; column < squares.cols; ++column)
      if (const float v = speed.at<float>(row, column); v > kFastest * mean)
        squares.at<cv::Vec2f>(row, column) *= kFastest * mean / v;
  cv::Mat trust = speed / (mean / 2);
  cv::min(trust, 1.0, trust);
  trust = trust.mul(trust);
  squares = pull_push(squares, trust);
  cv::GaussianBlur(squares, squares, {}, kSmoothing, kSmoothing, cv::BORDER_REPLICATE);
}

}  // namespace

MotionSequence::MotionSequence(const store::Snapshot& snapshot, const vision::Settings& settings,
                               const Placement& placement, std::span<const PlayedPatches> played,
                               cv::Size picture, int frames)
    : picture_(picture), piece_scale_(placement.piece_scale), squares_(frames) {
  const int square = common_step(placement, kSquare), per_side = placement.side / square;
  const int step = settings.flow_step;
  // The grid of squares coincides with the pieces' and holds the whole picture, reduced as they are.
  const cv::Size reduced = query::reduced_size(picture, placement.piece_scale);
  const cv::Rect canvas = canvas_of(placement);
  const auto whole = [&](int length) { return (std::max(length, 0) + square - 1) / square; };
  const cv::Point before(whole(canvas.x), whole(canvas.y));
  const cv::Point corner = canvas.tl() - before * square;
  const cv::Size grid(before.x + std::max(canvas.width / square, whole(reduced.width - canvas.x)),
                      before.y + std::max(canvas.height / square, whole(reduced.height - canvas.y)));
  squares_from_picture_ = squares_from_picture(placement, corner, square, picture);

  cv::Mat tent(per_side, per_side, CV_32F);
  for (int row = 0; row < per_side; ++row)
    for (int column = 0; column < per_side; ++column) {
      const auto fraction = [&](int i) { return 1 - std::abs((2.0 * i + 1) / per_side - 1); };
      tent.at<float>(row, column) = static_cast<float>(fraction(row) * fraction(column));
    }

  cv::Mat mass = cv::Mat::zeros(grid, CV_32F);
  for (cv::Mat& sum : squares_) sum = cv::Mat::zeros(grid, CV_32FC2);

  // One group after another, so that sums do not depend on threads.
  for (const PlayedPatches& group : played) {
    const store::ClipId clip = group.clip;
    const std::vector<std::size_t>& patches = group.patches;
    const std::vector<ShownFrame>& frames_of = group.shown;
    assert(frames_of.size() == squares_.size());
    const store::ClipRecord& record = snapshot.clip(clip);
    const store::StreamShape flow = checked_flow(record, step);
    const cv::Size source(static_cast<int>(record.width), static_cast<int>(record.height));

    // What of the flow is needed.
    cv::Rect needed;
    for (const std::size_t p : patches)
      needed |= PatchWindow(source, placement.patches[p].variant, placement.patches[p].patch, placement.side)
                    .needed();
    cv::Rect samples(cv::Point(needed.x / step - kSquare, needed.y / step - kSquare),
                     cv::Point(needed.br().x / step + kSquare, needed.br().y / step + kSquare));
    samples &=
        cv::Rect(0, 0, static_cast<int>(flow.planes[0].width), static_cast<int>(flow.planes[0].height));

    // Where each patch reads it.
    std::vector<float> scales;
    std::vector<Probe> probes;
    for (const std::size_t number : patches) {
      const PlacedPatch* placed = &placement.patches[number];
      const vision::VariantFrame frame = vision::variant_frame(source, placed->variant);
      Probe probe;
      probe.corner = (placed->piece - corner) / square;
      probe.turn = frame.variant_from_source_velocity;
      const auto scale = std::find(scales.begin(), scales.end(), placed->variant.scale);
      probe.blur = static_cast<std::size_t>(scale - scales.begin());
      if (scale == scales.end()) scales.push_back(placed->variant.scale);
      for (int row = 0; row < per_side; ++row)
        for (int column = 0; column < per_side; ++column) {
          const cv::Vec2d at =
              frame.source_from_variant * cv::Vec3d(placed->patch.x + column * square + (square - 1) / 2.0,
                                                    placed->patch.y + row * square + (square - 1) / 2.0, 1);
          probe.spots.emplace_back(static_cast<float>((at[0] + 0.5) / step - 0.5 - samples.x),
                                   static_cast<float>((at[1] + 0.5) / step - 0.5 - samples.y));
        }
      probes.push_back(std::move(probe));
      cv::Mat covered = mass(cv::Rect(probes.back().corner, tent.size()));
      covered += tent;
    }

    // The output frames that show each frame of the clip, by slab.
    std::map<std::uint32_t, std::vector<std::pair<std::uint32_t, int>>> slabs;
    for (int i = 0; i < frames; ++i) {
      // From the last frame no flow leads on: the one before it stands for it.
      const std::uint32_t at = std::min(frames_of[i].frame, flow.frames - 1);
      slabs[at / kSlab].emplace_back(at, i);
    }
    std::vector<std::pair<std::uint32_t, std::vector<std::pair<std::uint32_t, int>>>> work(slabs.begin(),
                                                                                           slabs.end());
    const double fps = static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den);
    oneapi::tbb::parallel_for(std::size_t{0}, work.size(), [&](std::size_t w) {
      auto& outputs = work[w].second;
      std::sort(outputs.begin(), outputs.end());
      const std::uint32_t first = outputs.front().first, count = outputs.back().first - first + 1;
      const std::size_t area = static_cast<std::size_t>(samples.area());
      std::vector<std::int16_t> planes[2];
      for (std::uint32_t p = 0; p < 2; ++p) {
        planes[p].resize(area * count);
        snapshot.read(clip, store::Stream::kFlow, p,
                      {static_cast<std::uint32_t>(samples.x), static_cast<std::uint32_t>(samples.y),
                       static_cast<std::uint32_t>(samples.width), static_cast<std::uint32_t>(samples.height)},
                      first, count, std::as_writable_bytes(std::span(planes[p])));
      }
      cv::Mat field;
      std::vector<cv::Mat> blurred(scales.size());
      std::uint32_t in_hand = record.frame_count;
      for (const auto& [at, output] : outputs) {
        if (at != in_hand) {
          const std::size_t offset = area * (at - first);
          cv::merge(std::vector<cv::Mat>{cv::Mat(samples.size(), CV_16S, planes[0].data() + offset),
                                         cv::Mat(samples.size(), CV_16S, planes[1].data() + offset)},
                    field);
          field.convertTo(field, CV_32F, vision::kFlowUnit * fps);
          for (std::size_t s = 0; s < scales.size(); ++s) {
            const int reach = std::max(1, static_cast<int>(std::lround(square / scales[s] / step))) | 1;
            cv::blur(field, blurred[s], {reach, reach}, {-1, -1}, cv::BORDER_REPLICATE);
          }
          in_hand = at;
        }
        const double rate = frames_of[output].rate;
        for (const Probe& probe : probes)
          for (int row = 0; row < per_side; ++row)
            for (int column = 0; column < per_side; ++column) {
              const cv::Point2f& spot = probe.spots[row * per_side + column];
              const cv::Vec2d v = bilinear<cv::Vec2f>(blurred[probe.blur], spot.x, spot.y);
              const cv::Vec2d turned = probe.turn * v * (rate * tent.at<float>(row, column));
              squares_[output].at<cv::Vec2f>(probe.corner.y + row, probe.corner.x + column) +=
                  cv::Vec2f(static_cast<float>(turned[0]), static_cast<float>(turned[1]));
            }
      }
    });
  }

  oneapi::tbb::parallel_for(0, frames, [&](int i) { spread(squares_[i], mass); });
}

cv::Mat MotionSequence::at(int i) const { return at(i, 1, picture_); }

cv::Mat MotionSequence::at(int i, int step, cv::Size size) const {
  // Sample (x, y) lies in the middle of its square.
  const double middle = (step - 1) / 2.0;
  const cv::Matx33d picture_from_samples(step, 0, middle, 0, step, middle, 0, 0, 1);
  cv::Mat field;
  cv::warpAffine(squares_[i] * piece_scale_, field, squares_from_picture_ * picture_from_samples, size,
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return field;
}

}  // namespace freshet::synth::animate
