#include "bench/quality/quality_measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "synth/judging/coherence.h"
#include "synth/judging/recurrence.h"
#include "vision/flow.h"
#include "vision/pyramid.h"

namespace freshet::bench {
namespace {

constexpr int kCodecBlock = 8;          // px; where compressed footage may jump by itself
constexpr double kPowerFloor = 1e-3;    // grey levels squared, a band
constexpr double kSpeedFloor = 1e-6;    // px/s
constexpr double kTextureFloor = 1e-3;  // grey levels
constexpr double kFlickerFloor = 5e-3;  // grey levels
constexpr double kPatchFloor = 1e-4;    // grey levels
constexpr double kCoherenceFloor = 1e-6;
constexpr int kFineCell = 2;  // px

double log2_ratio(double a, double b, double floor) {
  return std::log2(std::max(a, floor) / std::max(b, floor));
}

double in_matte(const cv::Mat& values, const cv::Mat& mask) { return cv::mean(values, mask)[0]; }

/// 255 for blocks of which half lies in the matte.
cv::Mat blocks_in(const cv::Mat& matte, int block) {
  cv::Mat fraction;
  cv::resize(matte > 127, fraction, {matte.cols / block, matte.rows / block}, 0, 0, cv::INTER_AREA);
  return fraction > 127;
}

/// Power by block and band, as Film has it.
cv::Mat spectrum(std::span<const cv::Mat> luma) {
  const int frames = static_cast<int>(luma.size()), width = luma[0].cols;
  const int columns = width / kSpectrumBlock, rows = luma[0].rows / kSpectrumBlock;
  const int length = std::min(kSpectrumWindow, frames);
  const auto bands = spectrum_bands(frames);
  const std::vector<int> starts = spectrum_windows(frames);
  std::vector<float> window(length);
  double squares = 0;
  for (int t = 0; t < length; ++t) {
    window[t] = static_cast<float>(0.5 - 0.5 * std::cos(2 * std::numbers::pi * (t + 0.5) / length));
    squares += window[t] * window[t];
  }
  const double fraction =
      1 / (length * squares * kSpectrumBlock * kSpectrumBlock * static_cast<double>(starts.size()));
  cv::Mat power = cv::Mat::zeros(rows * columns, kSpectrumBands, CV_32F);
  oneapi::tbb::parallel_for(0, rows, [&](int block_row) {
    cv::Mat series(width, length, CV_32F), transform;
    std::vector<double> sums(static_cast<std::size_t>(columns) * kSpectrumBands, 0.0);
    for (int y = block_row * kSpectrumBlock; y < (block_row + 1) * kSpectrumBlock; ++y) {
      for (const int start : starts) {
        for (int t = 0; t < length; ++t) {
          const std::uint8_t* row = luma[start + t].ptr<std::uint8_t>(y);
          for (int x = 0; x < width; ++x) series.at<float>(x, t) = row[x];
        }
        for (int x = 0; x < width; ++x) {
          float* values = series.ptr<float>(x);
          float mean = 0;
          for (int t = 0; t < length; ++t) mean += values[t];
          mean /= static_cast<float>(length);
          for (int t = 0; t < length; ++t) values[t] = (values[t] - mean) * window[t];
        }
        cv::dft(series, transform, cv::DFT_ROWS);
        for (int x = 0; x < width; ++x) {
          const float* packed = transform.ptr<float>(x);  // re 0, re 1, im 1, re 2, im 2, ...
          double* sum = &sums[static_cast<std::size_t>(x / kSpectrumBlock) * kSpectrumBands];
          for (int b = 0; b < kSpectrumBands; ++b) {
            for (int k = bands[b]; k < bands[b + 1]; ++k) {
              const double re = packed[2 * k - 1], im = 2 * k < length ? packed[2 * k] : 0.0;
              sum[b] += (2 * k < length ? 2 : 1) * (re * re + im * im);
            }
          }
        }
      }
    }
    for (int column = 0; column < columns; ++column)
      for (int b = 0; b < kSpectrumBands; ++b)
        power.at<float>(block_row * columns + column, b) =
            static_cast<float>(sums[static_cast<std::size_t>(column) * kSpectrumBands + b] * fraction);
  });
  return power;
}

/// By blocks of kMotionBlock px, px/s.
cv::Mat mean_motion(std::span<const PairMotion> motions, double fps) {
  cv::Mat flow = cv::Mat::zeros(motions[0].flow.size(), CV_32FC2), blocks;
  for (const PairMotion& motion : motions) flow += motion.flow;
  flow *= fps / static_cast<double>(motions.size());
  cv::resize(flow, blocks, {flow.cols * kMotionCell / kMotionBlock, flow.rows * kMotionCell / kMotionBlock},
             0, 0, cv::INTER_AREA);
  return blocks;
}

}  // namespace

cv::Mat ssim_map(const cv::Mat& a, const cv::Mat& b) {
  const auto blur = [](const cv::Mat& values) {
    cv::Mat out;
    cv::GaussianBlur(values, out, {11, 11}, 1.5);
    return out;
  };
  const double c1 = std::pow(0.01 * 255, 2), c2 = std::pow(0.03 * 255, 2);
  const cv::Mat ma = blur(a), mb = blur(b), aa = ma.mul(ma), bb = mb.mul(mb), ab = ma.mul(mb);
  const cv::Mat sa = blur(a.mul(a)) - aa, sb = blur(b.mul(b)) - bb, sab = blur(a.mul(b)) - ab;
  cv::Mat above, below, ssim;
  cv::multiply(2 * ab + c1, 2 * sab + c2, above);
  cv::multiply(aa + bb + c1, sa + sb + c2, below);
  cv::divide(above, below, ssim);
  return ssim;
}

std::vector<PairMotion> pair_motions(std::span<const cv::Mat> luma) {
  std::vector<PairMotion> motions(luma.empty() ? 0 : luma.size() - 1);
  oneapi::tbb::parallel_for(std::size_t{0}, motions.size(), [&](std::size_t i) {
    const cv::Mat flow = vision::optical_flow(luma[i], luma[i + 1]);
    const cv::Size cells(flow.cols / kMotionCell, flow.rows / kMotionCell);
    cv::resize(flow, motions[i].flow, cells, 0, 0, cv::INTER_AREA);
    cv::resize(flow, motions[i].fine, {flow.cols / kFineCell, flow.rows / kFineCell}, 0, 0, cv::INTER_AREA);
    std::vector<cv::Mat> parts;
    cv::split(flow, parts);
    cv::Mat speed;
    cv::magnitude(parts[0], parts[1], speed);
    cv::resize(speed, motions[i].speed, cells, 0, 0, cv::INTER_AREA);
  });
  return motions;
}

std::vector<int> spectrum_windows(int frames) {
  const int length = std::min(kSpectrumWindow, frames), rest = frames - length;
  const int more = (rest + length / 2 - 1) / (length / 2);  // half overlapping, or a little more
  std::vector<int> starts{0};
  for (int i = 1; i <= more; ++i) starts.push_back(rest * i / more);
  return starts;
}

std::array<int, kSpectrumBands + 1> spectrum_bands(int frames) {
  std::array<int, kSpectrumBands + 1> first{};
  const int last = std::min(kSpectrumWindow, frames) / 2;
  first[0] = 1;
  for (int b = 1; b <= kSpectrumBands; ++b) {
    const int wanted =
        static_cast<int>(std::lround(std::pow(last + 1.0, static_cast<double>(b) / kSpectrumBands)));
    first[b] = std::min(std::max(wanted, first[b - 1] + 1), last + 1);
  }
  return first;
}

double seam_of(std::span<const cv::Mat> luma, const Region& region) {
  const cv::Size size = region.matte.size();
  // Of each line between two pixels: whether pieces meet there (0), or it is compared with such lines (1).
  enum : std::uint8_t { kBorder, kBeside, kNeither };
  const auto kinds_of = [&](int length, int border) {
    std::vector<std::uint8_t> kinds(length, kNeither);
    for (int at = 0; at < length; ++at) {
      const int phase = ((at - border) % region.stride + region.stride) % region.stride;
      if (phase == 0)
        kinds[at] = kBorder;
      else if (phase % kCodecBlock == 0 || region.stride <= kCodecBlock)
        kinds[at] = kBeside;
    }
    return kinds;
  };
  const std::vector<std::uint8_t> across = kinds_of(size.width, region.border.x),
                                  down = kinds_of(size.height, region.border.y);
  // Integers: the same sum in any order.
  struct Jumps {
    std::array<std::uint64_t, 3> sum{}, count{};
  };
  std::vector<Jumps> jumps(luma.size());
  oneapi::tbb::parallel_for(std::size_t{1}, luma.size(), [&](std::size_t i) {
    cv::Mat change;
    cv::subtract(luma[i], luma[i - 1], change, cv::noArray(), CV_16S);
    Jumps& here = jumps[i];
    const auto add = [&](std::uint8_t kind, int jump) {
      here.sum[kind] += static_cast<std::uint64_t>(std::abs(jump));
      ++here.count[kind];
    };
    for (int y = 1; y < size.height; ++y) {
      const std::uint8_t* matte = region.matte.ptr<std::uint8_t>(y);
      const std::uint8_t* matte_above = region.matte.ptr<std::uint8_t>(y - 1);
      const std::int16_t* row = change.ptr<std::int16_t>(y);
      const std::int16_t* above = change.ptr<std::int16_t>(y - 1);
      for (int x = 1; x < size.width; ++x) {
        if (matte[x] <= 127) continue;
        if (matte[x - 1] > 127) add(across[x], row[x] - row[x - 1]);
        if (matte_above[x] > 127) add(down[y], row[x] - above[x]);
      }
    }
  });
  Jumps all;
  for (const Jumps& frame : jumps) {
    for (std::size_t kind = 0; kind < 3; ++kind) {
      all.sum[kind] += frame.sum[kind];
      all.count[kind] += frame.count[kind];
    }
  }
  if (all.sum[kBeside] == 0 || all.count[kBorder] == 0) return 0;
  const auto mean = [&](std::size_t kind) {
    return static_cast<double>(all.sum[kind]) / static_cast<double>(all.count[kind]);
  };
  return mean(kBorder) / mean(kBeside) - 1;
}

std::vector<cv::Mat> motion_by_second(std::span<const PairMotion> motions, double fps) {
  const auto second = std::max(std::size_t{1}, static_cast<std::size_t>(std::lround(fps)));
  std::vector<cv::Mat> seconds;
  for (std::size_t from = 0; from + second / 2 < motions.size(); from += second)
    seconds.push_back(mean_motion(motions.subspan(from, std::min(second, motions.size() - from)), fps));
  return seconds;
}

Film measure(std::span<const cv::Mat> luma, std::span<const PairMotion> motions, double fps,
             const Region& region) {
  CV_Assert(luma.size() >= 8 && motions.size() + 1 == luma.size() && luma[0].size() == region.matte.size() &&
            luma[0].cols % kSpectrumBlock == 0 && luma[0].rows % kSpectrumBlock == 0);
  Film film;
  const double n = static_cast<double>(luma.size());
  const cv::Mat mask = region.matte > 127;

  cv::Mat sum = cv::Mat::zeros(mask.size(), CV_32S), squares = cv::Mat::zeros(mask.size(), CV_64F);
  std::vector<double> levels;
  for (const cv::Mat& frame : luma) {
    cv::add(sum, frame, sum, cv::noArray(), CV_32S);
    cv::accumulateSquare(frame, squares);
    levels.push_back(in_matte(frame, mask));
  }
  cv::Mat mean;
  sum.convertTo(mean, CV_64F, 1 / n);
  const cv::Mat variance = cv::max(squares / n - mean.mul(mean), 0);
  cv::Mat deviation;
  cv::sqrt(variance, deviation);
  mean.convertTo(film.mean, CV_32F);
  deviation.convertTo(film.deviation, CV_32F);
  film.dead = in_matte(film.deviation < 1, mask) / 255;
  double level = 0, spread = 0;
  for (double value : levels) level += value / n;
  for (double value : levels) spread += (value - level) * (value - level) / n;
  film.flicker = std::sqrt(spread);

  film.power = spectrum(luma);
  film.motion = mean_motion(motions, fps);
  film.by_second = motion_by_second(motions, fps);
  cv::Mat speed = cv::Mat::zeros(motions[0].speed.size(), CV_32F), fluid;
  for (const PairMotion& motion : motions) speed += motion.speed;
  cv::resize(mask, fluid, speed.size(), 0, 0, cv::INTER_AREA);
  film.pace = in_matte(speed, fluid > 127) * fps / static_cast<double>(motions.size());

  std::vector<std::array<double, kTextureLevels>> textures(luma.size());
  oneapi::tbb::parallel_for(std::size_t{0}, luma.size(), [&](std::size_t i) {
    cv::Mat values, inside;
    luma[i].convertTo(values, CV_32F);
    std::vector<cv::Mat> bands;
    vision::laplacian_pyramid(values, kTextureLevels, bands);
    for (int l = 0; l < kTextureLevels; ++l) {
      cv::resize(mask, inside, bands[l].size(), 0, 0, cv::INTER_NEAREST);
      textures[i][l] = in_matte(cv::abs(bands[l]), inside);
    }
  });
  for (const auto& texture : textures)
    for (int l = 0; l < kTextureLevels; ++l) film.texture[l] += texture[l] / n;
  film.seam = seam_of(luma, region);

  film.lifetime.fill(kNotMeasured);
  if (!motions[0].fine.empty()) {
    std::vector<cv::Mat> fine;
    for (const PairMotion& motion : motions) fine.push_back(motion.fine);
    film.lifetime = lifetime_curve(luma, fine, region.matte);
  }
  film.half_life_s = half_life_s(film.lifetime, fps);
  film.patches = sample_patches(luma, region.matte);
  film.coherence = synth::judging::mean_coherence(luma, region.matte);
  film.again = synth::judging::recurrence(luma, region.matte).value;
  return film;
}

Distance compare(const Film& film, const Film& truth, const Region& region) {
  Distance distance;
  const cv::Mat blocks = blocks_in(region.matte, kSpectrumBlock);
  const auto apart = [](double a, double b) {
    return 10 / std::log2(10.0) * std::abs(log2_ratio(a, b, kPowerFloor));
  };
  double decibels = 0;
  int compared = 0;
  std::array<double, kSpectrumBands> film_power{}, true_power{};
  for (int block = 0; block < truth.power.rows; ++block) {
    if (blocks.at<std::uint8_t>(block / blocks.cols, block % blocks.cols) == 0) continue;
    for (int b = 0; b < kSpectrumBands; ++b, ++compared) {
      const double a = film.power.at<float>(block, b), t = truth.power.at<float>(block, b);
      decibels += apart(a, t);
      film_power[b] += a;
      true_power[b] += t;
    }
  }
  const double count = std::max(1, compared / kSpectrumBands);
  for (int b = 0; b < kSpectrumBands; ++b)
    distance.matte_db += apart(film_power[b] / count, true_power[b] / count) / kSpectrumBands;
  distance.spectrum_db = compared > 0 ? decibels / compared : 0;

  const cv::Mat inside = blocks_in(region.matte, kMotionBlock);
  double angles = 0, film_speed = 0, true_speed = 0, ratios = 0;
  int moving = 0, in_all = 0;
  for (int y = 0; y < inside.rows; ++y) {
    for (int x = 0; x < inside.cols; ++x) {
      if (inside.at<std::uint8_t>(y, x) == 0) continue;
      ++in_all;
      const cv::Vec2f a = film.motion.at<cv::Vec2f>(y, x), b = truth.motion.at<cv::Vec2f>(y, x);
      const double speed_a = cv::norm(a), speed_b = cv::norm(b);
      if (speed_b < kMinSpeed) continue;
      ++moving;
      angles += speed_a < kSpeedFloor
                    ? 90
                    : std::atan2(std::abs(a[0] * b[1] - a[1] * b[0]), a.dot(b)) * 180 / std::numbers::pi;
      film_speed += speed_a;
      true_speed += speed_b;
      ratios += std::abs(log2_ratio(speed_a, speed_b, kSpeedFloor));
    }
  }
  if (moving > 0) {
    distance.angle_deg = angles / moving;
    distance.speed = log2_ratio(film_speed / moving, true_speed / moving, kSpeedFloor);
    distance.block_speed = ratios / moving;
    distance.moving = static_cast<double>(moving) / in_all;
  }

  for (int l = 0; l < kTextureLevels; ++l) {
    const double ratio = log2_ratio(film.texture[l], truth.texture[l], kTextureFloor);
    distance.texture += std::abs(ratio) / kTextureLevels;
    distance.contrast += ratio / kTextureLevels;
  }
  distance.ssim = in_matte(ssim_map(film.mean, truth.mean), region.matte > 127);
  distance.flicker = log2_ratio(film.flicker, truth.flicker, kFlickerFloor);
  distance.seam = film.seam;
  distance.dead = film.dead;

  distance.pace = log2_ratio(film.pace, truth.pace, kSpeedFloor);
  distance.ribbon = log2_ratio(film.coherence, truth.coherence, kCoherenceFloor);
  distance.lifetime = curve_distance(film.lifetime, truth.lifetime);
  distance.half_life_s = film.half_life_s;
  distance.again = film.again;
  distance.again_beyond = film.again - truth.again;
  const auto patches_apart = patch_distances(film.patches, truth.patches);
  for (int l = 0; l < kPatchLevels; ++l)
    distance.patches[l] = patches_apart[l] / std::max(truth.halves_apart[l], kPatchFloor);
  return distance;
}

}  // namespace freshet::bench
