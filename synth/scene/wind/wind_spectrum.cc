#include "synth/scene/wind/wind_spectrum.h"

#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>

#include "synth/scene/wind/gaussian.h"

namespace freshet::synth::scene {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

}  // namespace

double wind_power(const Wind& wind, double f_hz) {
  if (!(wind.speed_m_per_s > 0)) return 0;
  const double deviation = wind.turbulence * wind.speed_m_per_s;
  const double slowness = wind.kappa_m / wind.speed_m_per_s;  // s
  // The integral of (1 + s f)^(-5/3) over f >= 0 is 3 / (2 s).
  return deviation * deviation * slowness * 2 / 3 / std::pow(1 + slowness * f_hz, 5.0 / 3);
}

Harmonics wind_harmonics(const Wind& wind, const Cycle& cycle, std::uint64_t stream) {
  const Random random(wind.seed, stream);
  const double step_hz = 1 / cycle.seconds();
  Harmonics harmonics(static_cast<std::size_t>((cycle.frames - 1) / 2 + 1));
  // The variance of Re(a exp(i w t)) is E|a|^2 / 2.
  for (std::size_t k = 1; k < harmonics.size(); ++k)
    harmonics[k] = complex_gaussian(random, k) *
                   std::sqrt(2 * wind_power(wind, static_cast<double>(k) * step_hz) * step_hz);
  return harmonics;
}

Harmonics oscillator(const Harmonics& force_per_mass, const Cycle& cycle, double natural_hz,
                     double damping_per_s) {
  Harmonics moved(force_per_mass.size());
  for (std::size_t k = 0; k < moved.size(); ++k) {
    const double f = static_cast<double>(k) / cycle.seconds();
    const std::complex<double> stiffness(kTurn * kTurn * (natural_hz * natural_hz - f * f),
                                         kTurn * damping_per_s * f);
    moved[k] = force_per_mass[k] / stiffness;
  }
  return moved;
}

Harmonics delayed(const Harmonics& of, const Cycle& cycle, double delay_s) {
  Harmonics later(of.size());
  for (std::size_t k = 0; k < of.size(); ++k)
    later[k] = of[k] * std::polar(1.0, -kTurn * static_cast<double>(k) * delay_s / cycle.seconds());
  return later;
}

Harmonics mixed(double a, const Harmonics& x, double b, const Harmonics& y) {
  Harmonics sum(x.size());
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] = a * x[k] + b * y[k];
  return sum;
}

std::vector<float> series(const Harmonics& of, const Cycle& cycle) {
  cv::Mat spectrum(1, cycle.frames, CV_64FC2, cv::Scalar::all(0));
  for (std::size_t k = 0; k < of.size(); ++k)
    spectrum.at<cv::Vec2d>(static_cast<int>(k)) = {of[k].real(), of[k].imag()};
  cv::Mat values;
  cv::dft(spectrum, values, cv::DFT_INVERSE);
  std::vector<float> out(static_cast<std::size_t>(cycle.frames));
  for (int t = 0; t < cycle.frames; ++t)
    out[static_cast<std::size_t>(t)] = static_cast<float>(values.at<cv::Vec2d>(t)[0]);
  return out;
}

}  // namespace freshet::synth::scene
