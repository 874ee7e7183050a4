#include "synth/flowlines/lines/arc_map.h"

#include <algorithm>
#include <cmath>

namespace freshet::synth::flowlines {

ArcMap::ArcMap(const FlowLine& edited, const FlowLine& input, Correspondence correspondence) {
  at_.reserve(edited.points.size());
  at_.push_back(0);
  for (int s = 1; s < edited.samples(); ++s)
    at_.push_back(at_.back() + 1 / speed_at(edited, static_cast<float>(s) - 0.5f));
  if (correspondence == Correspondence::kEqual) return;
  const float stretch = input.length() / at_.back();
  for (float& at : at_) at *= stretch;
}

float ArcMap::operator()(float arc) const {
  const std::size_t last = at_.size() - 1;
  const auto i = static_cast<std::size_t>(std::clamp(std::floor(arc), 0.0f, static_cast<float>(last - 1)));
  return at_[i] + (at_[i + 1] - at_[i]) * (arc - static_cast<float>(i));
}

}  // namespace freshet::synth::flowlines
