// stored/clip_columns.h — what is kept of a clip beside its frames and its flow, and how it is written.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "vision/cell_map.h"
#include "vision/flow_outliers.h"
#include "vision/spatial_pyramid.h"

namespace freshet::stored {

/// A clip's patches: variant by variant, each in row-major order of its grid. All columns have equal length.
struct PatchColumns {
  std::vector<std::uint8_t> variant;         // index into the settings' variants
  std::vector<std::uint16_t> x, y;           // px, top-left corner in the variant's frame
  std::vector<std::array<float, 2>> motion;  // px/s, mean u, v in the variant's frame
  std::vector<float> coverage;               // 0..1, fraction of pixels that move
  vision::OwnWordMaps words;                 // empty: the store has no index yet
  std::size_t size() const { return variant.size(); }
  void keep_first(std::size_t rows);
};

/// An empty field is not written.
struct ClipColumns {
  cv::Mat average;              // CV_16U, source size: mean luma over 0..65535
  std::vector<double> times_s;  // of the frames
  std::vector<double> rates;    // of the flow frames: pairs of frames per second; empty: the clip's fps
  vision::CellMap motion;       // vision::motion_channels
  std::vector<vision::CellMap> texture;  // of each scale of the settings, vision::kTextureLevels
  vision::CellMap life, standing;        // vision::kLifeChannels, vision::kStandingChannels
  vision::CellMap layout;                // vision::kLayoutChannels
  std::vector<vision::FlowOutlier> flow_outliers;
  PatchColumns patches;
};

/// Writes the average image and the columns; ingest, tests and benches go through it.
void write_columns(store::ClipWriter& writer, const ClipColumns& columns);

/// Declares a stream, with the planes of one frame.
/// planes   CV_8U, CV_8S, CV_16U or CV_16S.
void begin_stream(store::ClipWriter& writer, store::Stream stream, const std::vector<cv::Mat>& planes);
/// Appends one frame.
void append(store::ClipWriter& writer, store::Stream stream, const std::vector<cv::Mat>& planes);

}  // namespace freshet::stored
