// synth/simulate/design/emitters.h — what lets a design's fluid in, drives it and blows it up.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/simulate/design/placed_shape.h"
#include "synth/simulate/design/stage.h"

namespace freshet::synth::simulate {

class Emitters {
 public:
  /// phases  by emitter: where in the noise each reads. The emitters are borrowed.
  Emitters(const std::vector<Emitter>& emitters, std::vector<float> phases, const Stage& stage);

  /// Holds the shapes filled: density on the picture, heat on cells.
  void feed(const Stage& stage, Grid& density, Grid& heat);

  /// Adds to `force` (cells per step per step) what gives the fluid in the shapes its velocity, and to `growth`
  /// (a fraction per step; cleared before, where anything ever grows) what blows it up, but where it is solid.
  void drive(const Stage& stage, const VectorGrid& velocity, const GridOf<std::uint8_t>& solid,
             VectorGrid& force, Grid& growth) const;

  /// CV_8U of the picture: how far each pixel is held filled now.
  void show(const Stage& stage, cv::Mat& shown) const;

  /// Whether any blows its fluid up.
  bool grow() const { return grow_; }

 private:
  float rate(std::size_t i, const Stage& stage) const;
  void feed_density(std::size_t i, float rate, const Stage& stage, Grid& density) const;
  void feed_heat(std::size_t i, float rate, const Stage& stage, Grid& heat) const;

  const std::vector<Emitter>& emitters_;
  std::vector<float> phases_;
  std::vector<PlacedShape> placed_;
  bool grow_ = false;
};

}  // namespace freshet::synth::simulate
