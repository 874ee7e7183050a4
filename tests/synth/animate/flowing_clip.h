// tests/synth/animate/flowing_clip.h — a clip whose every frame and flow a test can look into, in a store.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "media/frame/frame.h"
#include "store/store.h"
#include "stored/clip_columns.h"
#include "stored/clip_metadata.h"
#include "vision/settings.h"

namespace freshet::synth::animate {

struct FlowingClip {
  cv::Size size{150, 110};
  int frames = 20;
  int flow_step = 2;
  cv::Vec2f steady{0, 0};  // px per frame, everywhere; the rest of the flow varies about it
  float varying = 1;       // px per frame: how far
  int range = 2;           // of its samples, as media::PixelLayout has it: 1 limited, 2 full
  std::uint64_t seed = 1;
  double anew =
      -1;  // >= 0: frames are a texture that goes along `steady`, and of its variance this part dies away,
  double kept = 0;                      // by this from frame to frame
  std::function<cv::Mat(int)> drawn{};  // CV_8U, `size`: frames as this draws them
  std::string class_name = "water";
  std::vector<double> rates{};  // column "flow.rate", of clips whose frame rate varies
  std::optional<vision::CellMap> life{}, standing{}, contrast{},
      motion{};  // columns "cells.life", "cells.standing", "cells.layout" and "cells.motion", as ingest writes them

  static cv::Mat moved(const cv::Mat& from, cv::Point by) {
    cv::Mat out(from.size(), from.type());
    const auto wrapped = [](int at, int n) { return (at % n + n) % n; };
    for (int y = 0; y < from.rows; ++y)
      for (int x = 0; x < from.cols; ++x)
        out.at<float>(y, x) = from.at<float>(wrapped(y - by.y, from.rows), wrapped(x - by.x, from.cols));
    return out;
  }
  cv::Point way(int steps) const {
    return {steps * static_cast<int>(steady[0]), steps * static_cast<int>(steady[1])};
  }
  /// What dies away, of standard deviation 1: new parts of this frame and of those before it.
  cv::Mat passing(int i) const {
    constexpr int kBefore = 8;
    cv::Mat sum = cv::Mat::zeros(size, CV_32F);
    for (int age = kBefore; age >= 0; --age) {
      const double weight = std::sqrt(1 - kept * kept) * std::pow(kept, age);
      sum += weight * moved(texture(1000 * seed + static_cast<std::uint64_t>(kBefore + i - age)), way(age));
    }
    return sum;
  }
  /// CV_32F, of standard deviation 1; the same for one seed.
  cv::Mat texture(std::uint64_t of) const {
    cv::Mat grain(size, CV_32F);
    cv::RNG(of).fill(grain, cv::RNG::NORMAL, 0, 1);
    cv::GaussianBlur(grain, grain, {}, 1.5, 1.5, cv::BORDER_REFLECT_101);
    cv::Scalar mean, deviation;
    cv::meanStdDev(grain, mean, deviation);
    return (grain - mean[0]) / deviation[0];
  }
  /// CV_8U: that texture, carried by whole px.
  cv::Mat renewed_frame(int i) const {
    const cv::Mat carried = moved(texture(seed), way(i));
    cv::Mat out;
    const cv::Mat mixed = std::sqrt(1 - anew) * carried + std::sqrt(anew) * passing(i);
    mixed.convertTo(out, CV_8U, 25, 128);
    return out;
  }
  /// CV_8U: waves that go their way, and noise that stays.
  cv::Mat frame(int i) const {
    if (drawn) return drawn(i);
    if (anew >= 0) return renewed_frame(i);
    cv::Mat grain(size, CV_8U), out(size, CV_8U);
    cv::RNG(seed + 7).fill(grain, cv::RNG::UNIFORM, 0, 30);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        out.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(
            110 + 50 * std::sin(0.13 * x + 0.09 * y + 0.5 * i) +
            30 * std::sin(0.05 * x - 0.11 * y - 0.3 * i) + grain.at<std::uint8_t>(y, x));
    return out;
  }
  cv::Size flow_size() const {
    return {(size.width + flow_step - 1) / flow_step, (size.height + flow_step - 1) / flow_step};
  }
  /// From frame i to the next, x and y: CV_16S, 1/64 px.
  std::array<cv::Mat, 2> flow(int i) const {
    std::array<cv::Mat, 2> flow{cv::Mat(flow_size(), CV_16S), cv::Mat(flow_size(), CV_16S)};
    for (int y = 0; y < flow_size().height; ++y)
      for (int x = 0; x < flow_size().width; ++x) {
        const double u = steady[0] + varying * std::sin(0.11 * x + 0.07 * y + 0.4 * i);
        const double v = steady[1] + varying * std::cos(0.06 * x - 0.12 * y + 0.2 * i);
        flow[0].at<std::int16_t>(y, x) = static_cast<std::int16_t>(std::lround(64 * u));
        flow[1].at<std::int16_t>(y, x) = static_cast<std::int16_t>(std::lround(64 * v));
      }
    return flow;
  }

  store::ClipId add_to(store::Store& store, const std::string& name) const {
    store::ClipWriter writer = store.add_clip();
    stored::ClipColumns columns;
    columns.rates = rates;
    if (life) columns.life = *life;
    if (standing) columns.standing = *standing;
    if (contrast) columns.layout = *contrast;
    if (motion) columns.motion = *motion;
    for (int i = 0; i < frames; ++i) {
      const cv::Mat picture = frame(i);
      const std::array<cv::Mat, 2> by = flow(i);
      if (i == 0) {
        stored::begin_stream(writer, store::Stream::kFrames, {picture});
        stored::begin_stream(writer, store::Stream::kFlow, {by[0], by[1]});
      }
      stored::append(writer, store::Stream::kFrames, {picture});
      columns.times_s.push_back(i / 25.0);
      if (i + 1 < frames) stored::append(writer, store::Stream::kFlow, {by[0], by[1]});
    }
    stored::write_columns(writer, columns);
    store::ClipRecord record;
    record.name = name;
    record.class_name = class_name;
    record.source_hash = "hash of " + name;
    record.pixel_format = "gray";
    record.width = static_cast<std::uint32_t>(size.width);
    record.height = static_cast<std::uint32_t>(size.height);
    record.fps_num = 25;
    const media::PixelLayout layout{
        .format = "gray", .width = size.width, .height = size.height, .range = range};
    record.metadata = to_json(
        stored::ClipMetadata{.layout = layout, .cells = stored::shapes_of(columns), .loop_known = false});
    return writer.commit(record);
  }
};

/// A store of such clips in a folder of its own, which goes when the test does.
class FlowingStore {
 public:
  explicit FlowingStore(const std::vector<FlowingClip>& clips = {{}}) {
    std::string name = (std::filesystem::temp_directory_path() / "freshet-flowing-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    settings_.flow_step = clips.front().flow_step;
    store::Store store = store::Store::create(folder_ / "a.store", vision::to_json(settings_));
    for (const FlowingClip& clip : clips)
      ids_.push_back(clip.add_to(store, std::to_string(ids_.size()) + ".mkv"));
    snapshot_ = store.snapshot();
  }
  ~FlowingStore() { std::filesystem::remove_all(folder_); }
  FlowingStore(const FlowingStore&) = delete;
  FlowingStore& operator=(const FlowingStore&) = delete;

  const store::Snapshot& snapshot() const { return snapshot_; }
  const vision::Settings& settings() const { return settings_; }
  store::ClipId id(std::size_t i = 0) const { return ids_[i]; }

 private:
  std::filesystem::path folder_;
  vision::Settings settings_;
  store::Snapshot snapshot_;
  std::vector<store::ClipId> ids_;
};

}  // namespace freshet::synth::animate
