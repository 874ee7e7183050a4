// quality_measures.h — how far the motion picture that was made is from the one that was filmed.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "bench/quality/quality_lifetime.h"
#include "bench/quality/quality_structure.h"

namespace freshet::bench {

inline constexpr int kSpectrumBlock = 16, kMotionBlock = 8, kMotionCell = 4;        // px
inline constexpr int kSpectrumBands = 8, kSpectrumWindow = 32, kTextureLevels = 3;  // window in frames
inline constexpr double kMinSpeed = 2.5;  // px/s; slower motion has no direction that counts
inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// How the fluid moved from one frame to the next, by cells of kMotionCell px.
struct PairMotion {
  cv::Mat flow;    // CV_32FC2, px per frame, x right, y down: the cell's mean
  cv::Mat speed;   // CV_32F, px per frame: the cell's mean of |flow|
  cv::Mat fine{};  // CV_32FC2, px per frame: by cells of 2 px, as fine as DIS computes it. May be empty: then
                   // no lifetime is measured
};
/// luma   CV_8U, all of one size, sides multiples of kSpectrumBlock. One entry per pair of neighbours: one
/// fewer than frames. DIS. All threads.
std::vector<PairMotion> pair_motions(std::span<const cv::Mat> luma);

/// Mean motion of each second, CV_32FC2, px/s, by blocks of kMotionBlock px; a rest of half a second counts.
std::vector<cv::Mat> motion_by_second(std::span<const PairMotion> motions, double fps);

/// Where films are judged: inside a matte, and against the lattice on which pieces meet.
struct Region {
  cv::Mat matte;     // CV_8U, the films' size; counted where above 127
  cv::Point border;  // px: pieces meet at x = border.x + i * stride, between pixels x - 1 and x; so in y
  int stride = 24;   // px
};

/// What is measured of one film by itself. Luma in grey levels, 0..255.
struct Film {
  cv::Mat mean, deviation;  // CV_32F: over time, of each pixel
  /// CV_32F, a row per block of kSpectrumBlock px (row-major), kSpectrumBands columns: power of luma's
  /// changes, grey levels squared, mean over the block's pixels.
  cv::Mat power;
  cv::Mat motion;                                // CV_32FC2, a block of kMotionBlock px: mean flow, px/s
  std::array<double, kTextureLevels> texture{};  // mean |Laplacian| by level, fine to coarse, in the matte
  double flicker = 0;                            // deviation over time of the matte's mean level
  double seam = 0;                               // see seam_of
  double dead = 0;                               // fraction of the matte's pixels whose deviation is below 1
  double pace = 0;                               // mean |flow| over time and the matte, px/s: eddies count,
                                                 // which `motion` averages away
  std::vector<cv::Mat> by_second;                // see motion_by_second
  LifetimeCurve lifetime{};                      // NaN when not measured
  double half_life_s = 0;                        // of it
  PatchSample patches;                           // of its frames
  double coherence = 0;                          // see synth::judging
  double again = kNotMeasured;                   // see synth::judging::recurrence
  /// Of a truth: how far apart the patches of its clip's two halves are, by level (grey levels). NaN when not
  /// known. Set by whoever has the halves.
  std::array<double, kPatchLevels> halves_apart{kNotMeasured, kNotMeasured, kNotMeasured, kNotMeasured,
                                                kNotMeasured};
};

/// First frames of the windows over which power is averaged, and the bands' first bins.
///
/// Windows are Welch's: Hann, at least half overlapping, each pixel's mean in a window taken away. The bands
/// are kSpectrumBands + 1 bins, log-spaced over 1 .. window / 2 as vision::motion_bands spaces them; some may
/// be empty when frames are few.
///
/// One window over all frames would give one sample a bin for a block of smooth cloud. Two halves of a clip
/// of fast clouds lie 8.1 dB apart so, and 7.1 dB with windows. The rest is no error: other clouds pass in
/// the second half.
std::vector<int> spectrum_windows(int frames);
std::array<int, kSpectrumBands + 1> spectrum_bands(int frames);

/// How much more luma's change from frame to frame jumps where pieces meet than beside it: the ratio less
/// one. 0 when the lattice cannot be seen, whatever the picture.
///
/// "Beside it" are the other lines whose distance is a multiple of 8 px. Footage that is shown at its own
/// size has its codec's blocks there, and so has the lattice: against all lines the real brook of 640 px had
/// a seam of 0.39.
double seam_of(std::span<const cv::Mat> luma, const Region& region);

/// luma     at least 8 frames, CV_8U, sides multiples of kSpectrumBlock.
/// motions  pair_motions of these frames.
/// All threads; the same figures for any number.
Film measure(std::span<const cv::Mat> luma, std::span<const PairMotion> motions, double fps,
             const Region& region);

/// One film against another of as many frames. 0 where they agree, but for ssim.
struct Distance {
  double spectrum_db = 0;  // mean |difference| over blocks and bands. Power below 1e-3 (30 dB below one grey
                           // level) counts as that: a still is some 40 dB away, not infinitely far.
  double matte_db = 0;     // the same of the power of all blocks together: where in the matte does not matter
  double angle_deg = 0;  // mean over blocks of the angle between mean motions, where the truth's is at least
                         // kMinSpeed; 90 where nothing moves in the film
  double speed = 0;      // log2 of the ratio of mean speeds over these blocks; signed
  double block_speed = 0;       // mean over these blocks of |log2 of the ratio of speeds|
  double texture = 0;           // mean over levels of |log2 of the ratio|
  double contrast = 0;          // the same, signed: below 0 detail was lost
  double ssim = 0;              // of mean images; 1 is best
  double flicker = 0;           // log2 of the ratio; signed
  double seam = 0;              // the film's own
  double dead = 0;              // the film's own
  double moving = 0;            // fraction of the matte's blocks that angle and speed are measured over
  double pace = 0;              // log2 of the ratio of Film::pace; signed
  double again = kNotMeasured;  // synth::judging::recurrence, the film's own
  double again_beyond = kNotMeasured;  // the same less the truth's; signed: above 0 forms come back
  double ribbon = 0;               // log2 of the ratio of mean coherences; signed: below 0 structure was torn
  double lifetime = kNotMeasured;  // mean |difference| of the lifetime curves
  double half_life_s = kNotMeasured;  // the film's own
  /// Distance of patches by level over that of the truth's own halves: 1 is as good as footage of the scene.
  std::array<double, kPatchLevels> patches{kNotMeasured, kNotMeasured, kNotMeasured, kNotMeasured,
                                           kNotMeasured};
  double drift = kNotMeasured;   // synth::judging::colour_drift; compare() knows luma alone
  double faults = kNotMeasured;  // synth::judging::Verdict::faults: what the critic says, who knows no truth
  // What compare() cannot know; see quality_asked.h.
  double start = kNotMeasured;         // detail_correlation of the first frame with the still
  double back_seconds = kNotMeasured;  // reversals
  double back_blocks = kNotMeasured;
  double loop = kNotMeasured;                                    // motion_after_loop
  double clip_share = kNotMeasured, patch_share = kNotMeasured;  // largest_shares
};
Distance compare(const Film& film, const Film& truth, const Region& region);

/// Structural similarity by pixel (Wang et al. 2004: windows of 11 px, sigma 1.5). CV_32F, grey levels.
cv::Mat ssim_map(const cv::Mat& a, const cv::Mat& b);

}  // namespace freshet::bench
