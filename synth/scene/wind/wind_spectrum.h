// synth/scene/wind/wind_spectrum.h — the wind's fluctuations, and what swings in them (Chuang et al. 2005, Sec. 3.2).
#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "synth/scene/cycle.h"
#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// A real function of time by its harmonics: f(t) = sum over k of Re(a[k] exp(2 pi i k t / T)), T the cycle's
/// seconds, t in seconds. a[0] is 0 where the wind stays: a still shows the mean.
using Harmonics = std::vector<std::complex<double>>;

/// Power density of the wind's speed at one place, (m/s)^2 / Hz, one-sided (Eq. 8), f in Hz.
/// The paper leaves its factor open; here the integral over all f >= 0 is (turbulence * speed)^2, so that the
/// wind's strength depends neither on the cycle nor on kappa.
double wind_power(const Wind& wind, double f_hz);

/// One realisation (Eq. 9), m/s, up to half the frame rate. stream   another, another wind.
Harmonics wind_harmonics(const Wind& wind, const Cycle& cycle, std::uint64_t stream);

/// A damped oscillator of this natural frequency and damping under a force per mass (Eq. 4), in its periodic state:
/// D = W / (4 pi^2 (f0^2 - f^2) + 2 pi i gamma f).
/// Eq. 5 is solved as it stands. Eq. 6 has exp(2 pi i theta) for exp(i theta), and the tangent of Eq. 7 has the sign of
/// -theta and leaves its quadrant open; f0 = k / m, as printed, is no frequency: the natural frequency is a parameter.
Harmonics oscillator(const Harmonics& force_per_mass, const Cycle& cycle, double natural_hz,
                     double damping_per_s);

/// The function that arrives `delay_s` later.
Harmonics delayed(const Harmonics& of, const Cycle& cycle, double delay_s);
/// a * x + b * y, of equal length.
Harmonics mixed(double a, const Harmonics& x, double b, const Harmonics& y);

/// Its values at every frame of the cycle.
std::vector<float> series(const Harmonics& of, const Cycle& cycle);

}  // namespace freshet::synth::scene
