// bench/scale/jittered_clip.h — a clip that was never filmed: a window of a real one, turned, bent and relit.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "bench/scale/source_clip.h"
#include "vision/codebook.h"
#include "vision/settings.h"
#include "vision/spatial_pyramid.h"

namespace freshet::bench {

/// How far a copy departs from its source. Turn and zoom fill the gaps between a store's 18 variants.
struct Jitter {
  double rotation_deg = 11.25;  // at most, to either side
  double zoom = 0.15;           // size times 1 / 1.15 to 1.15
  bool mirrored = true;         // half of the copies
  double bend_px = 4;           // root mean square of a smooth displacement,
  double bend_length_px = 64;   // independent at this distance
  /// Fraction of the amplitude below detail_px that is taken from another place of the clip.
  double detail = 0.7;
  double detail_px = 6;            // sigma of the blur that tells fine from coarse
  double gain = 0.3, gamma = 0.2;  // luma^g times 1 / 1.3 to 1, g = 1 / 1.2 to 1.2
  double noise = 0.5;              // grey levels of 255, of the average image
  double speed = 0.25;             // motion times 1 / 1.25 to 1.25; power by its square
};

/// All that a store keeps of a clip.
struct JitteredClip {
  store::ClipRecord record;                  // without shapes of streams, rows and metadata
  stored::ClipMetadata metadata;             // more: "generated", how it was made
  std::vector<cv::Mat> frames;               // CV_8U: grey, whatever the source's were
  std::vector<std::array<cv::Mat, 2>> flow;  // u, v, CV_16S
  stored::ClipColumns columns;  // without times; patches may be none: nothing moves in the window
};

/// The copy numbered `number` of those that `seed` makes.
///
/// Average image and frames are resampled (bicubic) through one smooth map: turn, zoom, mirror, place of the
/// window, and a bend. Detail of another place of the same clip, turned and mirrored by itself, takes a
/// fraction of the amplitude of the clip's own, so that no patch is a copy of a source's.
///
/// Words come from the average image as an index build has them, but with a codebook given. Spectra and
/// textureness are the source's cells, read through the same map. Velocities are turned, zoomed and sped up,
/// powers by the squares, cross power included. Textureness is moved between its levels by the zoom and
/// steepened with the tone curve. The bend does not turn velocities. What moves goes through the map as well,
/// and find_patches decides, as it does at ingest.
///
/// window   px; smaller where the turned source does not hold it.
/// Cost     0.3 s of CPU for 640 x 480 px and 2,000 patches, most of it descriptors. Same bytes for any
///          number of threads.
JitteredClip jittered_clip(const SourceClip& source, const vision::Settings& settings,
                           const vision::Codebook& codebook, const Jitter& jitter, cv::Size window,
                           std::uint64_t seed, std::uint64_t number);

}  // namespace freshet::bench
