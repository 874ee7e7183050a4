#include "vision/detail_lifetime.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <span>
#include <string>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "vision/flow.h"

namespace freshet::vision {
namespace {

constexpr std::array<std::uint32_t, 8> kLags{1, 2, 4, 8, 12, 16, 24, 32};  // frames
constexpr std::size_t kLagCount = kLags.size();
constexpr std::uint32_t kEvery = 8;        // frames between beginnings
constexpr int kSpacing = 4;                // px between tracks
constexpr float kMoving_px = 0.2f;         // a frame, at 25 frames per second
constexpr float kRepeated = 0.1f;          // of the speed of the frames before
constexpr std::size_t kOutlierSpan = 256;  // frames
constexpr double kMinMoving = 0.25;        // of a cell
constexpr double kPoolSamples = 50;        // weight of the neighbours, and of the clip among them
constexpr double kLeast = 0.01;            // a correlation below is noise
// Of local contrast, which is found at half of a band's samples.
constexpr float kFaint = 2e-3f;             // luma: of what is flat
constexpr double kContrastReach = 1.5;      // sigma of the mean of magnitudes, samples
constexpr int kAroundStep = 4;              // samples, in steps of which ...
constexpr double kAroundReach = 1.75;       // ... sigma of what a place stands out of
constexpr float kContrastGone = 2;          // wavelengths that the flow has gone by
constexpr std::uint32_t kContrastFrom = 4;  // lag, frames: it changes slowly

using Bands = std::array<float, kLifeBands>;

/// px of the frame.
constexpr float wavelength_px(int band) { return static_cast<float>(4 << band); }

/// A band at a place, bilinear; the place is inside the frame.
inline float sample(const cv::Mat& band, float x, float y) {
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const int right = std::min(left + 1, band.cols - 1), bottom = std::min(top + 1, band.rows - 1);
  const float fx = x - static_cast<float>(left), fy = y - static_cast<float>(top);
  const float *upper = band.ptr<float>(top), *lower = band.ptr<float>(bottom);
  const float above = upper[left] + fx * (upper[right] - upper[left]);
  const float below = lower[left] + fx * (lower[right] - lower[left]);
  return above + fy * (below - above);
}

/// Stored flow read at pixels of the frame, px.
class FlowAt {
 public:
  FlowAt(const cv::Mat& u, const cv::Mat& v, int step)
      : u_(u), v_(v), per_px_(1.0f / static_cast<float>(step)), shift_(0.5f * per_px_ - 0.5f) {}
  cv::Vec2f at(float x, float y) const {
    const float sx = std::clamp(x * per_px_ + shift_, 0.0f, static_cast<float>(u_.cols - 1));
    const float sy = std::clamp(y * per_px_ + shift_, 0.0f, static_cast<float>(u_.rows - 1));
    const int left = static_cast<int>(sx), top = static_cast<int>(sy);
    const int right = std::min(left + 1, u_.cols - 1), bottom = std::min(top + 1, u_.rows - 1);
    const float fx = sx - static_cast<float>(left), fy = sy - static_cast<float>(top);
    const auto mixed = [&](const cv::Mat& plane) {
      const auto *upper = plane.ptr<short>(top), *lower = plane.ptr<short>(bottom);
      const float above =
          static_cast<float>(upper[left]) + fx * static_cast<float>(upper[right] - upper[left]);
      const float below =
          static_cast<float>(lower[left]) + fx * static_cast<float>(lower[right] - lower[left]);
      return kFlowUnit * (above + fy * (below - above));
    };
    return {mixed(u_), mixed(v_)};
  }

 private:
  const cv::Mat &u_, &v_;
  float per_px_, shift_;
};

float mean_speed(const cv::Mat& u, const cv::Mat& v) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < u.rows; y += 2)
    for (int x = 0; x < u.cols; x += 2, ++count)
      sum += std::hypot(static_cast<float>(u.at<short>(y, x)), static_cast<float>(v.at<short>(y, x)));
  return static_cast<float>(sum * kFlowUnit / std::max(1, count));
}

/// Sums over what is compared at one lag.
template <class Real>
struct LagSums {
  Real count = 0;
  std::array<Real, kLifeBands> product{}, first{}, second{};
  // Of detail whose place has been left by the flow, there.
  std::array<Real, kLifeBands> left{}, stood{}, left_first{}, left_second{};
  // The same of local contrast; and that along the flow.
  std::array<Real, kLifeBands> contrasts{}, contrast_stood{}, contrast_went{}, contrast_first{},
      contrast_here{}, contrast_there{};

  template <class Other>
  void add(const LagSums<Other>& from) {
    count += from.count;
    const auto gather = [](std::array<Real, kLifeBands>& to, const std::array<Other, kLifeBands>& more) {
      for (std::size_t b = 0; b < kLifeBands; ++b) to[b] += more[b];
    };
    gather(product, from.product), gather(first, from.first), gather(second, from.second);
    gather(left, from.left), gather(stood, from.stood);
    gather(left_first, from.left_first), gather(left_second, from.left_second);
    gather(contrasts, from.contrasts), gather(contrast_stood, from.contrast_stood);
    gather(contrast_went, from.contrast_went), gather(contrast_first, from.contrast_first);
    gather(contrast_here, from.contrast_here), gather(contrast_there, from.contrast_there);
  }
};

/// All tracks that began in one frame, and what they compared. Tracks that end are taken out, the others keep their
/// order, so that sums are the same each time.
struct Beginning {
  std::uint32_t frame = 0;
  std::uint32_t lag = 0;
  std::vector<float> x, y;
  std::vector<cv::Vec2f> from;  // where each began, px
  std::vector<std::uint32_t> cell;
  std::vector<Bands> bands, contrast;  // at the beginning
  std::vector<LagSums<float>> sums;    // lag by lag, cell by cell
};

/// Correlations by lag, with the weight of each in independent samples; the power, and the share of noise in it.
struct Curve {
  std::array<double, kLagCount> correlation{}, weight{};
  double power = 0, noise = 0;

  void add(const Curve& other, double factor) {
    power = mean_of(power, weight[0], other.power, factor * other.weight[0]);
    noise = mean_of(noise, weight[0], other.noise, factor * other.weight[0]);
    for (std::size_t i = 0; i < kLagCount; ++i) {
      const double more = factor * other.weight[i];
      correlation[i] = mean_of(correlation[i], weight[i], other.correlation[i], more);
      weight[i] += more;
    }
  }
  /// Of no more weight than `most` at its first lag.
  Curve limited(double most) const {
    Curve curve;
    if (weight[0] > 0) curve.add(*this, std::min(1.0, most / weight[0]));
    return curve;
  }

 private:
  static double mean_of(double a, double weight_a, double b, double weight_b) {
    const double weight = weight_a + weight_b;
    return weight > 0 ? (weight_a * a + weight_b * b) / weight : 0;
  }
};

Curve curve_of(std::span<const LagSums<double>> sums, std::size_t band) {
  Curve curve;
  const LagSums<double>& first = sums[0];
  if (first.count <= 0) return curve;
  curve.power = (first.first[band] + first.second[band]) / (2 * first.count);
  if (curve.power <= kDetailNoise * kDetailNoise) return curve;
  curve.noise = kDetailNoise * kDetailNoise / curve.power;
  const double independent_px = std::pow(2 << band, 2);
  const double per_sample = std::min(1.0, kSpacing * kSpacing / independent_px) * (1 - curve.noise);
  for (std::size_t i = 0; i < kLagCount; ++i) {
    const LagSums<double>& sum = sums[i];
    const double powers = sum.first[band] * sum.second[band];
    if (powers <= 0) continue;
    curve.correlation[i] = sum.product[band] / std::sqrt(powers);
    curve.weight[i] = sum.count * per_sample;
  }
  return curve;
}

/// Of a band, what stood where the flow had left, with its weight in independent samples.
struct Stood {
  double share = 0, weight = 0;

  void add(const Stood& other, double factor) {
    const double more = factor * other.weight;
    if (more <= 0) return;
    share = (weight * share + more * other.share) / (weight + more);
    weight += more;
  }
  Stood limited(double most) const { return {share, std::min(weight, most)}; }
};

Stood stood_of(std::span<const LagSums<double>> sums, std::size_t band) {
  double count = 0, product = 0, first = 0, second = 0;
  for (const LagSums<double>& sum : sums) {
    count += sum.left[band];
    product += sum.stood[band];
    first += sum.left_first[band];
    second += sum.left_second[band];
  }
  const double noise = kDetailNoise * kDetailNoise * count, powers = (first - noise) * (second - noise);
  if (first <= noise || second <= noise) return {};
  const double per_sample = std::min(1.0, kSpacing * kSpacing / std::pow(2 << band, 2));
  return {std::clamp(product / std::sqrt(powers), 0.0, 1.0), count * per_sample / kLagCount};
}

/// Of local contrast, what was found where it had been, or where the flow had taken it.
Stood contrast_of(std::span<const LagSums<double>> sums, std::size_t band,
                  std::array<double, kLifeBands> LagSums<double>::*product,
                  std::array<double, kLifeBands> LagSums<double>::*found) {
  double count = 0, products = 0, first = 0, second = 0;
  for (const LagSums<double>& sum : sums) {
    count += sum.contrasts[band];
    products += (sum.*product)[band];
    first += sum.contrast_first[band];
    second += (sum.*found)[band];
  }
  if (first <= 0 || second <= 0) return {};
  const double per_sample = std::min(1.0, kSpacing * kSpacing / std::pow(8 << band, 2));
  return {std::clamp(products / std::sqrt(first * second), 0.0, 1.0), count * per_sample / kLagCount};
}

/// Frames until half of the correlation is left; 0: not known.
double half_life_frames(const Curve& curve) {
  if (curve.weight[0] <= 0) return 0;
  double left = 1;  // of the correlation, beside noise
  const double c1 = curve.correlation[0];
  if (curve.weight[1] > 0 && c1 > 0 && curve.correlation[1] > 0) {
    const double c2 = std::min(c1, curve.correlation[1]);
    left -= std::clamp(1 - c1 * c1 / c2, 0.0, curve.noise);
  }
  double last = 1, last_lag = 0;
  for (std::size_t i = 0; i < kLagCount && curve.weight[i] > 0; ++i) {
    const double here = std::clamp(curve.correlation[i] / left, kLeast, 1.0), lag = kLags[i];
    if (here < 0.5) return last_lag + (lag - last_lag) * std::log(last / 0.5) / std::log(last / here);
    last = here;
    last_lag = lag;
  }
  return last_lag * std::log(2.0) / -std::log(std::min(last, 0.9999));
}

}  // namespace

struct DetailLifetimeAccumulator::Impl {
  cv::Size frame;
  int flow_step;
  double fps;
  float moving_px;
  int rows, columns;                           // of cells
  std::uint32_t at = 0;                        // the frame that came last
  std::uint32_t next = 0;                      // the frame in which the next tracks begin
  std::uint32_t begun = 0;                     // beginnings
  std::array<cv::Mat, kLifeBands> bands;       // of the frame that came last, where it is needed
  std::array<cv::Mat, kLifeBands + 1> levels;  // luma in 0..1, halved each time
  std::array<cv::Mat, kLifeBands> contrast;    // of the bands, at half their size, where it is needed
  std::vector<float> speeds;                   // by flow frame
  std::deque<Beginning> in_hand;               // oldest first
  std::vector<Beginning> spare;                // their memory is used again
  std::vector<LagSums<double>> totals;         // cell by cell, lag by lag

  Impl(cv::Size size, int step, double rate)
      : frame(size),
        flow_step(step),
        fps(rate),
        moving_px(kMoving_px * 25 / static_cast<float>(rate)),
        rows((size.height + kLifeCell - 1) / kLifeCell),
        columns((size.width + kLifeCell - 1) / kLifeCell),
        totals(cells() * kLagCount) {}

  std::size_t cells() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns); }

  /// vision::laplacian_pyramid in memory that is kept.
  void take_bands(const cv::Mat& luma) {
    luma.convertTo(levels[0], CV_32F, 1.0 / 255);
    for (std::size_t b = 0; b < kLifeBands; ++b) {
      cv::pyrDown(levels[b], levels[b + 1]);
      cv::pyrUp(levels[b + 1], bands[b], levels[b].size());
      cv::subtract(levels[b], bands[b], bands[b]);
    }
  }

  /// How much more a band varies at a place than around it, log.
  void take_contrast() {
    for (std::size_t b = 0; b < kLifeBands; ++b) {
      const auto part = [](int n, int by) { return std::max(1, (n + by - 1) / by); };
      cv::Mat magnitude = cv::abs(bands[b]), around;
      cv::resize(magnitude, contrast[b], {part(magnitude.cols, 2), part(magnitude.rows, 2)}, 0, 0,
                 cv::INTER_AREA);
      cv::GaussianBlur(contrast[b], contrast[b], {}, kContrastReach, kContrastReach, cv::BORDER_REPLICATE);
      cv::log(contrast[b] + kFaint, contrast[b]);
      cv::resize(contrast[b], around,
                 {part(contrast[b].cols, kAroundStep), part(contrast[b].rows, kAroundStep)}, 0, 0,
                 cv::INTER_AREA);
      cv::GaussianBlur(around, around, {}, kAroundReach, kAroundReach, cv::BORDER_REPLICATE);
      cv::resize(around, magnitude, contrast[b].size(), 0, 0, cv::INTER_LINEAR);
      contrast[b] -= magnitude;
    }
  }

  static Bands found_at(const std::array<cv::Mat, kLifeBands>& planes, float x, float y, float scale) {
    Bands found;
    for (std::size_t b = 0; b < kLifeBands; ++b, scale *= 0.5f)
      found[b] = sample(planes[b], std::min(x * scale, static_cast<float>(planes[b].cols - 1)),
                        std::min(y * scale, static_cast<float>(planes[b].rows - 1)));
    return found;
  }
  Bands bands_at(float x, float y) const { return found_at(bands, x, y, 1); }
  Bands contrast_at(float x, float y) const { return found_at(contrast, x, y, 0.5f); }

  bool inside(float x, float y) const {
    return x >= 1 && y >= 1 && x <= static_cast<float>(frame.width - 2) &&
           y <= static_cast<float>(frame.height - 2);
  }

  /// A repeated frame tells nothing of what moves.
  bool repeated() const {
    const std::size_t n = speeds.size();
    float before = 0;
    for (std::size_t i = n - std::min<std::size_t>(n, 3); i + 1 < n; ++i)
      before = std::max(before, speeds[i]);
    return speeds.back() < kRepeated * before;
  }

  /// Tracks begin in the frame before the one to which this flow leads.
  void begin_tracks(const FlowAt& flow) {
    Beginning beginning;
    if (!spare.empty()) {
      beginning = std::move(spare.back());
      spare.pop_back();
    }
    beginning.frame = at;
    beginning.lag = 0;
    beginning.x.clear(), beginning.y.clear(), beginning.from.clear();
    beginning.cell.clear(), beginning.bands.clear(), beginning.contrast.clear();
    beginning.sums.assign(cells() * kLagCount, {});
    const int shift_x = static_cast<int>(begun % kSpacing),
              shift_y = static_cast<int>((3 * begun + begun / 4) % kSpacing);
    ++begun;
    for (int y = shift_y; y < frame.height; y += kSpacing)
      for (int x = shift_x; x < frame.width; x += kSpacing) {
        const auto px = static_cast<float>(x), py = static_cast<float>(y);
        if (!inside(px, py)) continue;
        const cv::Vec2f v = flow.at(px, py);
        if (v.dot(v) < moving_px * moving_px) continue;
        beginning.x.push_back(px);
        beginning.y.push_back(py);
        beginning.from.emplace_back(px, py);
        beginning.cell.push_back(static_cast<std::uint32_t>(y / kLifeCell * columns + x / kLifeCell));
        beginning.bands.push_back(bands_at(px, py));
        beginning.contrast.push_back(contrast_at(px, py));
      }
    in_hand.push_back(std::move(beginning));
    next = at + kEvery;
  }

  void advance(Beginning& tracks, const FlowAt& flow) const {
    ++tracks.lag;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < tracks.x.size(); ++i) {
      const cv::Vec2f v = flow.at(tracks.x[i], tracks.y[i]);
      const float x = tracks.x[i] + v[0], y = tracks.y[i] + v[1];
      if (!inside(x, y)) continue;
      tracks.x[kept] = x;
      tracks.y[kept] = y;
      tracks.from[kept] = tracks.from[i];
      tracks.cell[kept] = tracks.cell[i];
      tracks.bands[kept] = tracks.bands[i];
      tracks.contrast[kept] = tracks.contrast[i];
      ++kept;
    }
    tracks.x.resize(kept), tracks.y.resize(kept), tracks.from.resize(kept);
    tracks.cell.resize(kept), tracks.bands.resize(kept), tracks.contrast.resize(kept);
  }

  void compare(Beginning& tracks) const {
    const auto found = std::find(kLags.begin(), kLags.end(), tracks.lag);
    if (found == kLags.end()) return;
    LagSums<float>* sums = tracks.sums.data() + static_cast<std::size_t>(found - kLags.begin()) * cells();
    for (std::size_t i = 0; i < tracks.x.size(); ++i) {
      const Bands now = bands_at(tracks.x[i], tracks.y[i]), &then = tracks.bands[i];
      LagSums<float>& sum = sums[tracks.cell[i]];
      sum.count += 1;
      for (std::size_t b = 0; b < kLifeBands; ++b) {
        sum.product[b] += then[b] * now[b];
        sum.first[b] += then[b] * then[b];
        sum.second[b] += now[b] * now[b];
      }
      compare_place(tracks, i, sum);
      if (tracks.lag >= kContrastFrom) compare_contrast(tracks, i, sum);
    }
  }

  /// The same place, where the flow has taken away what was there.
  void compare_place(const Beginning& tracks, std::size_t i, LagSums<float>& sum) const {
    const cv::Vec2f way = cv::Vec2f(tracks.x[i], tracks.y[i]) - tracks.from[i];
    const float gone = way.dot(way);
    if (gone < wavelength_px(0) * wavelength_px(0)) return;
    const Bands here = bands_at(tracks.from[i][0], tracks.from[i][1]), &then = tracks.bands[i];
    for (int b = 0; b < kLifeBands && gone >= wavelength_px(b) * wavelength_px(b); ++b) {
      sum.left[b] += 1;
      sum.stood[b] += then[b] * here[b];
      sum.left_first[b] += then[b] * then[b];
      sum.left_second[b] += here[b] * here[b];
    }
  }

  /// Local contrast, at the old place and along the flow.
  void compare_contrast(const Beginning& tracks, std::size_t i, LagSums<float>& sum) const {
    const cv::Vec2f way = cv::Vec2f(tracks.x[i], tracks.y[i]) - tracks.from[i];
    const float gone = way.dot(way) / (kContrastGone * kContrastGone);
    if (gone < wavelength_px(0) * wavelength_px(0)) return;
    const Bands here = contrast_at(tracks.from[i][0], tracks.from[i][1]), &then = tracks.contrast[i],
                there = contrast_at(tracks.x[i], tracks.y[i]);
    for (int b = 0; b < kLifeBands && gone >= wavelength_px(b) * wavelength_px(b); ++b) {
      sum.contrasts[b] += 1;
      sum.contrast_stood[b] += then[b] * here[b];
      sum.contrast_went[b] += then[b] * there[b];
      sum.contrast_first[b] += then[b] * then[b];
      sum.contrast_here[b] += here[b] * here[b];
      sum.contrast_there[b] += there[b] * there[b];
    }
  }

  /// Into the totals, up to the first fast flow: it is known only now which that is.
  void settle(const Beginning& tracks) {
    const std::size_t first = speeds.size() - std::min(speeds.size(), kOutlierSpan);
    const std::vector<FlowOutlier> outliers = flow_outliers(std::span(speeds).subspan(first));
    std::uint32_t good = 0;
    while (good < tracks.lag && outliers[tracks.frame + good - first] != FlowOutlier::kFast) ++good;
    for (std::size_t lag = 0; lag < kLagCount && kLags[lag] <= good; ++lag)
      for (std::size_t cell = 0; cell < cells(); ++cell)
        totals[cell * kLagCount + lag].add(tracks.sums[lag * cells() + cell]);
  }

  bool moves(const cv::Mat& moving, std::size_t cell) const {
    const int row = static_cast<int>(cell) / columns, column = static_cast<int>(cell) % columns;
    const cv::Rect place =
        cv::Rect(column * kLifeCell, row * kLifeCell, kLifeCell, kLifeCell) & cv::Rect({}, frame);
    return cv::countNonZero(moving(place)) >= kMinMoving * place.area();
  }

  template <class Use>
  void each_neighbour(std::size_t cell, const Use& use) const {
    const int row = static_cast<int>(cell) / columns, column = static_cast<int>(cell) % columns;
    for (int r = std::max(0, row - 1); r <= std::min(rows - 1, row + 1); ++r)
      for (int c = std::max(0, column - 1); c <= std::min(columns - 1, column + 1); ++c)
        if (r != row || c != column) use(static_cast<std::size_t>(r) * columns + c);
  }

  /// Of one band, after the finer ones: one channel of `cells`, pooled, of what each cell says; 0 before the first that
  /// is known. own: what each cell says of the band's lives.
  template <class Of>
  void pool(std::size_t band, std::size_t channel, std::span<const Curve> own, const Of& of,
            CellMap& cells_of, float& of_clip) const {
    std::vector<Stood> stood(cells());
    Stood clip;
    for (std::size_t cell = 0; cell < stood.size(); ++cell) {
      if (own[cell].power <= 0) continue;
      stood[cell] = of(std::span<const LagSums<double>>(totals).subspan(cell * kLagCount, kLagCount));
      clip.add(stood[cell], own[cell].power);
    }
    const auto or_finer = [band](const Stood& found, float finer) {
      return found.weight > 0 || band == 0 ? static_cast<float>(found.share) : finer;
    };
    of_clip = or_finer(clip, of_clip);
    // Weighed by power, its samples do not count as such.
    clip.weight = clip.weight > 0 ? kPoolSamples : 0;
    for (std::size_t cell = 0; cell < stood.size(); ++cell) {
      Stood around = clip;
      each_neighbour(cell, [&](std::size_t neighbour) { around.add(stood[neighbour], 1); });
      Stood pooled = around.limited(kPoolSamples);
      pooled.add(stood[cell], 1);
      float* values = cells_of.values.data() + cell * static_cast<std::size_t>(cells_of.channels) + channel;
      *values = or_finer(pooled, band > 0 ? *(values - 1) : 0);
    }
  }

  void find_standing(std::size_t band, std::span<const Curve> own, DetailLifetimes& lifetimes) const {
    float& of_clip = lifetimes.clip_standing[band];
    of_clip = band > 0 ? lifetimes.clip_standing[band - 1] : 0;
    pool(
        band, band, own, [band](auto sums) { return stood_of(sums, band); }, lifetimes.standing, of_clip);
    using Sums = LagSums<double>;
    float unused = 0;
    pool(
        band, band, own,
        [band](auto sums) { return contrast_of(sums, band, &Sums::contrast_stood, &Sums::contrast_here); },
        lifetimes.layout, unused);
    pool(
        band, kLifeBands + band, own,
        [band](auto sums) { return contrast_of(sums, band, &Sums::contrast_went, &Sums::contrast_there); },
        lifetimes.layout, unused);
  }

  bool needs_contrast() const {
    return at >= next || std::any_of(in_hand.begin(), in_hand.end(), [](const Beginning& tracks) {
             return tracks.lag >= kContrastFrom &&
                    std::find(kLags.begin(), kLags.end(), tracks.lag) != kLags.end();
           });
  }

  bool needs_bands() const {
    return at >= next || std::any_of(in_hand.begin(), in_hand.end(), [](const Beginning& tracks) {
             return std::find(kLags.begin(), kLags.end(), tracks.lag) != kLags.end();
           });
  }
};

DetailLifetimeAccumulator::DetailLifetimeAccumulator(cv::Size frame, int flow_step, double fps) {
  if (frame.width < 1 || frame.height < 1 || flow_step < 1 || !(fps > 0 && fps < 2000))
    throw Error(ErrorKind::kUsage, "detail lifetime",
                "a frame of " + std::to_string(frame.width) + " x " + std::to_string(frame.height) +
                    " px, a flow step of " + std::to_string(flow_step) + " px, " + std::to_string(fps) +
                    " frames per second");
  impl_ = std::make_unique<Impl>(frame, flow_step, fps);
}

DetailLifetimeAccumulator::~DetailLifetimeAccumulator() = default;

void DetailLifetimeAccumulator::begin(const cv::Mat& luma) {
  CV_Assert(luma.type() == CV_8U && luma.size() == impl_->frame && impl_->at == 0);
  impl_->take_bands(luma);
  impl_->take_contrast();
}

void DetailLifetimeAccumulator::add(const cv::Mat& u, const cv::Mat& v, const cv::Mat& luma) {
  Impl& s = *impl_;
  CV_Assert(luma.type() == CV_8U && luma.size() == s.frame && !s.bands[0].empty());
  CV_Assert(u.type() == CV_16S && v.type() == CV_16S && u.size() == v.size() &&
            u.cols == (s.frame.width + s.flow_step - 1) / s.flow_step &&
            u.rows == (s.frame.height + s.flow_step - 1) / s.flow_step);
  const FlowAt flow(u, v, s.flow_step);
  s.speeds.push_back(mean_speed(u, v));
  if (s.at >= s.next && !s.repeated()) s.begin_tracks(flow);
  ++s.at;
  for (Beginning& tracks : s.in_hand) s.advance(tracks, flow);
  if (s.needs_bands()) s.take_bands(luma);
  if (s.needs_contrast()) s.take_contrast();
  for (Beginning& tracks : s.in_hand) s.compare(tracks);
  while (!s.in_hand.empty() && s.in_hand.front().lag == kLags.back()) {
    s.settle(s.in_hand.front());
    s.spare.push_back(std::move(s.in_hand.front()));
    s.in_hand.pop_front();
  }
}

DetailLifetimes DetailLifetimeAccumulator::finish(const cv::Mat& moving) {
  Impl& s = *impl_;
  CV_Assert(moving.type() == CV_8U && moving.size() == s.frame);
  for (const Beginning& tracks : s.in_hand) s.settle(tracks);
  s.in_hand.clear();

  DetailLifetimes lifetimes;
  lifetimes.flow_outliers = flow_outliers(s.speeds);
  lifetimes.cells = {
      .rows = s.rows, .columns = s.columns, .channels = kLifeChannels, .cell = kLifeCell, .values = {}};
  lifetimes.cells.values.resize(s.cells() * kLifeChannels);
  lifetimes.standing = lifetimes.cells;
  lifetimes.standing.channels = kStandingChannels;
  lifetimes.standing.values.resize(s.cells() * kStandingChannels);
  lifetimes.layout = lifetimes.cells;
  lifetimes.layout.channels = kLayoutChannels;
  lifetimes.layout.values.resize(s.cells() * kLayoutChannels);
  const auto seconds = [&](const Curve& curve) {
    return static_cast<float>(std::min(kLongestLife_s, half_life_frames(curve) / s.fps));
  };
  std::vector<Curve> own(s.cells());
  for (std::size_t band = 0; band < kLifeBands; ++band) {
    Curve equally, clip;
    for (std::size_t cell = 0; cell < own.size(); ++cell) {
      own[cell] = s.moves(moving, cell)
                      ? curve_of(std::span(s.totals).subspan(cell * kLagCount, kLagCount), band)
                      : Curve{};
      equally.add(own[cell], 1);
    }
    if (equally.power > 0)
      for (const Curve& curve : own) clip.add(curve, curve.power / equally.power);
    lifetimes.clip[band] = seconds(clip);
    for (std::size_t cell = 0; cell < own.size(); ++cell) {
      Curve around = clip.limited(kPoolSamples);
      s.each_neighbour(cell, [&](std::size_t neighbour) { around.add(own[neighbour], 1); });
      Curve pooled = around.limited(kPoolSamples);
      pooled.add(own[cell], 1);
      float* values = lifetimes.cells.values.data() + cell * kLifeChannels;
      values[band] = seconds(pooled);
      values[kLifeBands + band] = static_cast<float>(std::sqrt(own[cell].power));
    }
    s.find_standing(band, own, lifetimes);
  }
  return lifetimes;
}

}  // namespace freshet::vision
