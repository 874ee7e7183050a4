#include "synth/animate/frames/frame_batches.h"

#include <mutex>
#include <set>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tests/synth/animate/flowing_clip.h"

namespace freshet::synth::animate {
namespace {

/// Frames that say which one they are, and what was asked in between.
class Numbers final : public Renderer {
 public:
  int batch_frames = 10, first_frame = 0;
  std::vector<std::vector<int>> read_frames, prepared;
  std::vector<std::size_t> passed;
  std::multiset<int> finished;

  int batch() const override { return batch_frames; }
  int first() const override { return first_frame; }
  cv::Mat motion(int) const override { return cv::Mat(4, 4, CV_32FC2, cv::Scalar::all(0)); }
  cv::Mat step(int output) const override { return cv::Mat(4, 4, CV_32FC2, cv::Scalar::all(output)); }
  void read(std::span<const int> outputs) override {
    read_frames.emplace_back(outputs.begin(), outputs.end());
  }
  void prepare(std::span<const int> outputs, std::span<const cv::Mat> mattes, std::size_t count) override {
    EXPECT_EQ(mattes.size(), outputs.size());
    prepared.emplace_back(outputs.begin(), outputs.end());
    passed.push_back(count);
  }
  cv::Mat finish(int output, const cv::Mat& matte) override {
    EXPECT_EQ(matte.type(), CV_32F);
    const std::lock_guard lock(guard_);
    finished.insert(output);
    return cv::Mat(1, 1, CV_32S, cv::Scalar(output));
  }

 private:
  std::mutex guard_;
};

class FrameBatches : public testing::Test {
 protected:
  std::vector<int> made(const FrameOptions& options) {
    Animation animation{.snapshot = store_.snapshot(),
                        .settings = store_.settings(),
                        .picture = picture_,
                        .matte = matte_,
                        .placement = placement_,
                        .options = options,
                        .progress = progress_};
    StillPart still;
    still.alpha = cv::Mat(4, 4, CV_32F, cv::Scalar(1));
    still.asked_motion = cv::Mat(4, 4, CV_32FC2, cv::Scalar::all(0));
    std::vector<int> frames;
    make_frames(animation, still, numbers_,
                [&](const cv::Mat& frame) { frames.push_back(frame.at<int>(0)); });
    batches_ = animation.report.batches;
    return frames;
  }

  Numbers numbers_;
  int batches_ = 0;

 private:
  FlowingStore store_{{FlowingClip{.size = {64, 64}, .frames = 4}}};
  Placement placement_;
  cv::Mat picture_ = cv::Mat(4, 4, CV_8UC3, cv::Scalar::all(0)),
          matte_ = cv::Mat(4, 4, CV_8U, cv::Scalar(255));
  ProgressFunction progress_;
};

std::vector<int> counted(int from, int until) {
  std::vector<int> numbers;
  for (int i = from; i < until; ++i) numbers.push_back(i);
  return numbers;
}

TEST_F(FrameBatches, AllFramesComeOnceAndInOrder) {
  EXPECT_EQ(made({.frames = 23}), counted(0, 23));
  EXPECT_EQ(numbers_.read_frames, (std::vector{counted(0, 10), counted(10, 20), counted(20, 23)}));
  EXPECT_EQ(numbers_.prepared,
            (std::vector{counted(0, 8), counted(8, 10), counted(10, 18), counted(18, 20), counted(20, 23)}));
  EXPECT_EQ(numbers_.finished.size(), 23u);
  EXPECT_EQ(batches_, 3);
}

TEST_F(FrameBatches, FramesThatAreNotWantedArePreparedAndNotFinished) {
  EXPECT_EQ(made({.frames = 23, .from = 9, .until = 12}), counted(9, 12));
  EXPECT_EQ(numbers_.read_frames, (std::vector{counted(0, 10), counted(10, 12)}));
  EXPECT_EQ(numbers_.passed, (std::vector<std::size_t>{8, 1, 0}));
  EXPECT_EQ(numbers_.finished, (std::multiset<int>{9, 10, 11}));
}

TEST_F(FrameBatches, ALoopBeginsWhereItsRendererSays) {
  numbers_.first_frame = 4;
  EXPECT_EQ(made({.frames = 6, .loop = true}), (std::vector{4, 5, 0, 1, 2, 3}));
}

TEST_F(FrameBatches, MotionComesForFramesThatAreWantedAsTheyAreShown) {
  numbers_.first_frame = 2;
  FrameOptions options{.frames = 12, .from = 5, .loop = true};
  std::vector<int> motions;
  options.motion_sink = [&](const cv::Mat& motion) {
    motions.push_back(static_cast<int>(motion.at<cv::Vec2f>(3, 3)[1]));
  };
  EXPECT_EQ(made(options), motions);
  EXPECT_EQ(motions, (std::vector{7, 8, 9, 10, 11, 0, 1}));
}

TEST_F(FrameBatches, MattesComeForFramesThatAreWanted) {
  for (const outline::Outline boundary : {outline::Outline::kStatic, outline::Outline::kMoving}) {
    FrameOptions options{.frames = 12, .from = 5};
    options.outline.kind = boundary;
    int mattes = 0;
    options.matte_sink = [&](const cv::Mat& matte) {
      ++mattes;
      EXPECT_EQ(matte.size(), cv::Size(4, 4));
    };
    made(options);
    EXPECT_EQ(mattes, 7);
  }
}

TEST_F(FrameBatches, ASinkThatThrowsEndsIt) {
  FrameOptions options{.frames = 12};
  options.matte_sink = [](const cv::Mat&) { throw std::runtime_error("full"); };
  EXPECT_THROW(made(options), std::runtime_error);
}

}  // namespace
}  // namespace freshet::synth::animate
