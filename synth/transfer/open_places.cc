#include "synth/transfer/open_places.h"

#include <algorithm>

#include "platform/random.h"

namespace freshet::synth::transfer {

OpenPlaces::OpenPlaces(int width, int height, const std::vector<int>& places)
    : width_(width),
      height_(height),
      count_(static_cast<int>(places.size())),
      open_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0) {
  for (int w = width, h = height; w > 1 || h > 1 || squares_.empty();) {
    w = (w + 1) / 2;
    h = (h + 1) / 2;
    squares_.emplace_back(w, h, 0);
  }
  for (const int place : places) {
    open_[static_cast<std::size_t>(place)] = 1;
    ++squares_[0](place % width / 2, place / width / 2);
  }
  for (std::size_t k = 1; k < squares_.size(); ++k)
    for (int y = 0; y < squares_[k - 1].height; ++y)
      for (int x = 0; x < squares_[k - 1].width; ++x) squares_[k](x / 2, y / 2) += squares_[k - 1](x, y);
}

void OpenPlaces::add(int place) { change(place, 1); }
void OpenPlaces::remove(int place) { change(place, -1); }

void OpenPlaces::change(int place, int by) {
  open_[static_cast<std::size_t>(place)] = by > 0;
  count_ += by;
  int x = place % width_, y = place / width_;
  for (GridOf<std::int32_t>& level : squares_) {
    x /= 2;
    y /= 2;
    level(x, y) += by;
  }
}

int OpenPlaces::near(int x, int y, std::uint64_t random) const {
  if (count_ == 0) return -1;
  x = std::clamp(x, 0, width_ - 1);
  y = std::clamp(y, 0, height_ - 1);
  if (open_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)])
    return y * width_ + x;
  std::size_t k = 0;
  x /= 2;
  y /= 2;
  while (squares_[k](x, y) == 0) {
    ++k;
    x /= 2;
    y /= 2;
  }
  // Down again: every open place of the square is as likely as any other.
  for (;; --k) {
    const int left = 2 * x, top = 2 * y;
    std::int32_t counts[4], sum = 0;
    for (int child = 0; child < 4; ++child) {
      const int cx = left + child % 2, cy = top + child / 2;
      const bool inside =
          k == 0 ? cx < width_ && cy < height_ : cx < squares_[k - 1].width && cy < squares_[k - 1].height;
      counts[child] = !inside  ? 0
                      : k == 0 ? open_[static_cast<std::size_t>(cy) * static_cast<std::size_t>(width_) +
                                       static_cast<std::size_t>(cx)]
                               : squares_[k - 1](cx, cy);
      sum += counts[child];
    }
    std::int32_t pick =
        static_cast<std::int32_t>((random & 0xffffffffu) * static_cast<std::uint64_t>(sum) >> 32);
    random = scramble(random);
    int child = 0;
    while (pick >= counts[child]) pick -= counts[child++];
    x = left + child % 2;
    y = top + child / 2;
    if (k == 0) return y * width_ + x;
  }
}

}  // namespace freshet::synth::transfer
