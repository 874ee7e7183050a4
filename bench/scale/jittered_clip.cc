#include "bench/scale/jittered_clip.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "bench/harness/seeded_random.h"
#include "ingest/clip_analysis.h"
#include "platform/text.h"
#include "query/index/patch_descriptors.h"
#include "vision/flow.h"
#include "vision/textureness.h"

namespace freshet::bench {
namespace {

/// Where a window's pixels lie in the source: turned, zoomed and mirrored as a variant is, about its centre.
struct Placement {
  vision::Variant variant;
  cv::Size size;                                   // px
  cv::Point2d centre;                              // of the window, in the source
  cv::Matx22d clip_from_source, source_from_clip;  // of a velocity
  cv::Mat bend;                                    // CV_32FC2, px of the window; empty: straight

  cv::Point2d source_of(double x, double y) const {
    cv::Vec2d at(x - (size.width - 1) / 2.0, y - (size.height - 1) / 2.0);
    if (!bend.empty()) {
      const auto& moved = bend.at<cv::Vec2f>(std::clamp(static_cast<int>(std::lround(y)), 0, bend.rows - 1),
                                             std::clamp(static_cast<int>(std::lround(x)), 0, bend.cols - 1));
      at += cv::Vec2d(moved[0], moved[1]);
    }
    const cv::Vec2d from = source_from_clip * at;
    return {centre.x + from[0], centre.y + from[1]};
  }
};

/// The largest window of the asked shape, at most the asked size, that lies in the turned source anywhere.
cv::Size window_that_fits(cv::Size source, cv::Size asked, double zoom, double rotation_deg) {
  const double radians = rotation_deg * CV_PI / 180;
  const double c = std::abs(std::cos(radians)), s = std::abs(std::sin(radians));
  const double aspect = static_cast<double>(asked.width) / asked.height;
  const double height = std::min({static_cast<double>(asked.height), zoom * source.width / (aspect * c + s),
                                  zoom * source.height / (aspect * s + c)});
  const auto even = [](double length) { return std::max(16, static_cast<int>(length) / 8 * 8); };
  return {even(aspect * height), even(height)};
}

Placement place_window(cv::Size source, cv::Size asked, const Jitter& jitter, SeededRandom& random) {
  Placement place;
  place.variant.rotation_deg = static_cast<float>(random.uniform(-jitter.rotation_deg, jitter.rotation_deg));
  place.variant.scale = static_cast<float>(std::pow(1 + jitter.zoom, random.uniform(-1, 1)));
  place.variant.flip = random.uniform() < 0.5 && jitter.mirrored;
  const double zoom = place.variant.scale;
  place.size = window_that_fits(source, asked, zoom, place.variant.rotation_deg);
  place.clip_from_source = vision::variant_frame(source, place.variant).variant_from_source_velocity;
  place.source_from_clip = place.clip_from_source.inv();
  // Half of the window's bounding box in the source: as far as its centre stays from the edges.
  const cv::Matx22d& back = place.source_from_clip;
  const double reach_x =
      (std::abs(back(0, 0)) * place.size.width + std::abs(back(0, 1)) * place.size.height) / 2;
  const double reach_y =
      (std::abs(back(1, 0)) * place.size.width + std::abs(back(1, 1)) * place.size.height) / 2;
  const auto between = [&](double reach, int length) {
    const double room = std::max(0.0, length - 2 * reach);
    return (length - room) / 2 + random.uniform(0, room) - 0.5;
  };
  place.centre.x = between(reach_x, source.width);
  place.centre.y = between(reach_y, source.height);
  return place;
}

cv::Mat smooth_bend(cv::Size size, const Jitter& jitter, SeededRandom& random) {
  if (!(jitter.bend_px > 0)) return {};
  const auto knots = [&](int length) { return static_cast<int>(length / jitter.bend_length_px) + 3; };
  cv::Mat coarse(knots(size.height), knots(size.width), CV_32FC2), bend;
  for (int y = 0; y < coarse.rows; ++y) {
    for (int x = 0; x < coarse.cols; ++x) {
      const double u = random.normal(), v = random.normal();
      coarse.at<cv::Vec2f>(y, x) = {static_cast<float>(jitter.bend_px * u),
                                    static_cast<float>(jitter.bend_px * v)};
    }
  }
  const double length = jitter.bend_length_px;
  cv::resize(coarse, bend, {static_cast<int>(coarse.cols * length), static_cast<int>(coarse.rows * length)},
             0, 0, cv::INTER_CUBIC);
  return bend(cv::Rect({0, 0}, size)).clone();
}

cv::Mat map_of(const Placement& place) {
  cv::Mat map(place.size, CV_32FC2);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      const cv::Point2d at = place.source_of(x, y);
      map.at<cv::Vec2f>(y, x) = {static_cast<float>(at.x), static_cast<float>(at.y)};
    }
  }
  return map;
}

/// CV_32F, luma over 0..1.
cv::Mat resampled(const cv::Mat& picture, const cv::Mat& map) {
  cv::Mat samples, scaled;
  cv::remap(picture, samples, map, {}, cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  samples.convertTo(scaled, CV_32F, picture.depth() == CV_16U ? 1.0 / 65535 : 1.0 / 255);
  return scaled;
}

cv::Mat fine_part(const cv::Mat& picture, double sigma) {
  cv::Mat coarse;
  cv::GaussianBlur(picture, coarse, {}, sigma, sigma, cv::BORDER_REFLECT_101);
  return picture - coarse;
}

/// luma^gamma * gain.
struct Tone {
  double gain = 1, gamma = 1;
  float of(float luma) const {
    return static_cast<float>(
        std::clamp(gain * std::pow(std::clamp(static_cast<double>(luma), 0.0, 1.0), gamma), 0.0, 1.0));
  }
  /// Its steepness: contrast here over contrast of the source. Not of the darkest, where it has no bound.
  float slope(float luma) const {
    return static_cast<float>(gain * gamma *
                              std::pow(std::clamp(static_cast<double>(luma), 0.05, 1.0), gamma - 1));
  }
};

template <class Sample>
cv::Mat toned(const cv::Mat& picture, const Tone& tone, double noise, SeededRandom& random, int type) {
  constexpr double kMax = std::numeric_limits<Sample>::max();
  constexpr int kSteps = 4096;
  std::array<float, kSteps + 1> table;
  for (int i = 0; i <= kSteps; ++i) table[i] = tone.of(static_cast<float>(i) / kSteps);
  cv::Mat out(picture.size(), type);
  for (int y = 0; y < picture.rows; ++y) {
    const auto* from = picture.ptr<float>(y);
    auto* to = out.ptr<Sample>(y);
    for (int x = 0; x < picture.cols; ++x) {
      const float at = std::clamp(from[x], 0.0f, 1.0f) * kSteps;
      const int i = std::min(static_cast<int>(at), kSteps - 1);
      double luma = table[i] + (table[i + 1] - table[i]) * (at - static_cast<float>(i));
      if (noise > 0) luma += noise * random.normal();
      to[x] = static_cast<Sample>(std::lround(std::clamp(luma, 0.0, 1.0) * kMax));
    }
  }
  return out;
}

/// Bilinear, all channels; beyond the outermost cells' centres they go on.
void read_cells(const vision::CellMap& cells, cv::Point2d at, float* out) {
  const double column = std::clamp((at.x + 0.5) / cells.cell - 0.5, 0.0, cells.columns - 1.0);
  const double row = std::clamp((at.y + 0.5) / cells.cell - 0.5, 0.0, cells.rows - 1.0);
  const int left = static_cast<int>(column), top = static_cast<int>(row);
  const int right = std::min(left + 1, cells.columns - 1), below = std::min(top + 1, cells.rows - 1);
  const auto fx = static_cast<float>(column - left), fy = static_cast<float>(row - top);
  const auto a = cells.at(top, left), b = cells.at(top, right), c = cells.at(below, left),
             d = cells.at(below, right);
  for (int i = 0; i < cells.channels; ++i)
    out[i] = (1 - fy) * ((1 - fx) * a[i] + fx * b[i]) + fy * ((1 - fx) * c[i] + fx * d[i]);
}

/// A map of the same cells over a frame of another size, all zero.
vision::CellMap empty_cells(const vision::CellMap& like, cv::Size size) {
  vision::CellMap cells;
  cells.cell = like.cell;
  cells.channels = like.channels;
  cells.columns = static_cast<int>(std::ceil(size.width / like.cell));
  cells.rows = static_cast<int>(std::ceil(size.height / like.cell));
  cells.values.resize(static_cast<std::size_t>(cells.rows) * cells.columns * cells.channels);
  return cells;
}

/// visit(source px of a cell's centre, px of it in the window, its values).
template <class Visit>
void for_each_cell(vision::CellMap& cells, const Placement& place, Visit visit) {
  float* values = cells.values.data();
  for (int row = 0; row < cells.rows; ++row) {
    for (int column = 0; column < cells.columns; ++column, values += cells.channels) {
      const double x = std::min((column + 0.5) * cells.cell - 0.5, place.size.width - 1.0);
      const double y = std::min((row + 0.5) * cells.cell - 0.5, place.size.height - 1.0);
      visit(place.source_of(x, y), cv::Point2d(x, y), values);
    }
  }
}

vision::CellMap turned_motion(const vision::CellMap& source, const Placement& place, double speed) {
  vision::CellMap cells = empty_cells(source, place.size);
  const cv::Matx22d A = place.clip_from_source * speed;
  const auto a = static_cast<float>(A(0, 0)), b = static_cast<float>(A(0, 1));
  const auto c = static_cast<float>(A(1, 0)), d = static_cast<float>(A(1, 1));
  std::vector<float> here(static_cast<std::size_t>(source.channels));
  for_each_cell(cells, place, [&](cv::Point2d from, cv::Point2d, float* to) {
    read_cells(source, from, here.data());
    to[0] = a * here[0] + b * here[1];
    to[1] = c * here[0] + d * here[1];
    for (int band = 0; band < vision::bands_of(source.channels); ++band) {
      const auto [uu, vv, uv] = vision::band_power(here.data(), band);
      vision::set_band_power(to, band,
                             {.u = std::max(0.0f, a * a * uu + 2 * a * b * uv + b * b * vv),
                              .v = std::max(0.0f, c * c * uu + 2 * c * d * uv + d * d * vv),
                              .cross = a * c * uu + (a * d + b * c) * uv + b * d * vv});
    }
  });
  return cells;
}

/// Enlarged, a size of detail lies log2(zoom) levels further up.
vision::CellMap turned_texture(const vision::CellMap& source, const Placement& place, const Tone& tone,
                               const cv::Mat& luma) {
  vision::CellMap cells = empty_cells(source, place.size);
  const double shift = std::log2(static_cast<double>(place.variant.scale));
  std::array<float, vision::kTextureLevels> here;
  for_each_cell(cells, place, [&](cv::Point2d from, cv::Point2d in_window, float* to) {
    read_cells(source, from, here.data());
    const float slope = tone.slope(luma.at<float>(static_cast<int>(std::lround(in_window.y)),
                                                  static_cast<int>(std::lround(in_window.x))));
    for (int level = 0; level < vision::kTextureLevels; ++level) {
      const double at = std::clamp(level - shift, 0.0, vision::kTextureLevels - 1.0);
      const int below = std::min(static_cast<int>(at), vision::kTextureLevels - 2);
      const auto fraction = static_cast<float>(at - below);
      to[level] = slope * ((1 - fraction) * here[below] + fraction * here[below + 1]);
    }
  });
  return cells;
}

std::array<cv::Mat, 2> turned_flow(const cv::Mat& source, const Placement& place, int step, double speed) {
  const int columns = (place.size.width + step - 1) / step, rows = (place.size.height + step - 1) / step;
  cv::Mat map(rows, columns, CV_32FC2), read;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const cv::Point2d at = place.source_of((x + 0.5) * step - 0.5, (y + 0.5) * step - 0.5);
      map.at<cv::Vec2f>(y, x) = {static_cast<float>((at.x + 0.5) / step - 0.5),
                                 static_cast<float>((at.y + 0.5) / step - 0.5)};
    }
  }
  cv::remap(source, read, map, {}, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  const cv::Matx22d A = place.clip_from_source * (speed / vision::kFlowUnit);
  std::array<cv::Mat, 2> planes{cv::Mat(rows, columns, CV_16S), cv::Mat(rows, columns, CV_16S)};
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const auto& flow = read.at<cv::Vec2f>(y, x);
      const cv::Vec2d turned = A * cv::Vec2d(flow[0], flow[1]);
      planes[0].at<short>(y, x) = cv::saturate_cast<short>(turned[0]);
      planes[1].at<short>(y, x) = cv::saturate_cast<short>(turned[1]);
    }
  }
  return planes;
}

std::string hash_text(const std::string& text) {
  const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
  return hex(hash.high64) + hex(hash.low64);
}

}  // namespace

JitteredClip jittered_clip(const SourceClip& source, const vision::Settings& settings,
                           const vision::Codebook& codebook, const Jitter& jitter, cv::Size window,
                           std::uint64_t seed, std::uint64_t number) {
  SeededRandom random(seed, number);
  const cv::Size whole = source.average.size();
  Placement place = place_window(whole, window, jitter, random);
  place.bend = smooth_bend(place.size, jitter, random);
  const Tone tone{std::pow(1 + jitter.gain, random.uniform(-1, 0)),
                  std::pow(1 + jitter.gamma, random.uniform(-1, 1))};
  const double speed = std::pow(1 + jitter.speed, random.uniform(-1, 1));
  Placement other = place_window(whole, window, jitter, random);
  other.size = place.size;

  JitteredClip clip;
  const cv::Mat map = map_of(place);
  cv::Mat average = resampled(source.average, map);
  cv::Mat added;  // to every frame, so that their differences from the average stay
  if (jitter.detail > 0) {
    const cv::Mat own = fine_part(average, jitter.detail_px);
    const cv::Mat foreign = fine_part(resampled(source.average, map_of(other)), jitter.detail_px);
    added = (std::sqrt(1 - jitter.detail * jitter.detail) - 1) * own + jitter.detail * foreign;
    average += added;
  }
  clip.columns.average = toned<std::uint16_t>(average, tone, jitter.noise / 255, random, CV_16U);
  for (const cv::Mat& frame : source.frames) {
    cv::Mat luma = resampled(frame, map);
    if (!added.empty()) luma += added;
    clip.frames.push_back(toned<std::uint8_t>(luma, tone, 0, random, CV_8U));
  }
  for (const cv::Mat& flow : source.flow)
    clip.flow.push_back(turned_flow(flow, place, settings.flow_step, speed));
  clip.columns.motion = turned_motion(source.motion, place, speed);
  for (const vision::CellMap& scale : source.texture)
    clip.columns.texture.push_back(turned_texture(scale, place, tone, average));
  cv::Mat moving;
  cv::remap(source.moving, moving, map, {}, cv::INTER_NEAREST, cv::BORDER_REFLECT_101);
  clip.columns.patches = ingest::find_patches(moving, {}, clip.columns.motion, settings);

  store::ClipRecord& record = clip.record;
  record.class_name = source.record.class_name;
  record.licence = source.record.licence;
  record.name = fmt::format("{}#{}", source.record.name, number);
  record.source_hash = hash_text(fmt::format("{} {} {}", source.record.source_hash, seed, number));
  record.pixel_format = "gray";
  record.width = static_cast<std::uint32_t>(place.size.width);
  record.height = static_cast<std::uint32_t>(place.size.height);
  record.fps_num = source.record.fps_num;
  record.fps_den = source.record.fps_den;

  const std::vector<vision::Variant> variants = settings.variants();
  const query::PatchPoints points(
      record, settings, variants,
      {clip.columns.patches.variant, clip.columns.patches.x, clip.columns.patches.y});
  cv::Mat average_8(clip.columns.average.size(), CV_8U);  // as stored::average_image reads it
  for (std::size_t i = 0; i < clip.columns.average.total(); ++i)
    average_8.data[i] =
        static_cast<std::uint8_t>((clip.columns.average.ptr<std::uint16_t>()[i] + 128u) / 257u);
  std::vector<std::vector<vision::Descriptor>> descriptors;
  for (const query::PatchPoints::Sheet& sheet : points.sheets())
    descriptors.push_back(points.describe(sheet, average_8));
  clip.columns.patches.words = points.words(codebook, descriptors);

  media::PixelLayout layout;
  layout.format = "gray";
  layout.width = place.size.width;
  layout.height = place.size.height;
  layout.range = 2;
  stored::ClipMetadata& metadata = clip.metadata;
  metadata.layout = layout;
  metadata.codec = metadata.container = "generated";
  metadata.notices = {"made by bench_scaled_store from " + source.record.name};
  metadata.cells = stored::shapes_of(clip.columns);
  metadata.patches.assign(variants.size(), 0);
  for (const std::uint8_t variant : clip.columns.patches.variant) ++metadata.patches[variant];
  // The shortest that a rule can describe, so that animating needs no long clip.
  if (clip.frames.size() >= 5) metadata.loop = {.from = 3, .to = 1, .fade = 2, .distance = 1};
  metadata.more["generated"] = {{"source", source.record.name},
                                {"seed", seed},
                                {"number", number},
                                {"rotation_deg", place.variant.rotation_deg},
                                {"zoom", place.variant.scale},
                                {"mirrored", place.variant.flip},
                                {"centre", {place.centre.x, place.centre.y}},
                                {"gain", tone.gain},
                                {"gamma", tone.gamma},
                                {"speed", speed}};
  if (const auto found = source.metadata.more.find("screening"); found != source.metadata.more.end())
    metadata.more["screening"] = *found;
  return clip;
}

}  // namespace freshet::bench
