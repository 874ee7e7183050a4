#include "synth/animate/placement/retiming.h"

#include <cmath>

#include <fmt/format.h>

#include "freshet/error.h"
#include "query/search/picture_scale.h"

namespace freshet::synth::animate {

void retime(Placement& placement, double factor, const cv::Mat& map, cv::Size picture) {
  if (!(factor >= 0.05 && factor <= 20))
    throw Error(ErrorKind::kUsage, "speed", fmt::format("{:g} is out of range, 0.05 to 20 expected", factor));
  if (!map.empty() && map.size() != picture)
    throw Error(ErrorKind::kInput, "retiming map",
                fmt::format("it has {} x {} px, the picture {} x {}", map.cols, map.rows, picture.width,
                            picture.height),
                "Give one of the picture's size");
  const cv::Mat reduced = map.empty() ? map : query::reduce(map, placement.piece_scale);
  for (PlacedPatch& placed : placement.patches) {
    placed.speed = factor;
    if (map.empty()) continue;
    const int margin = (placement.side - placement.stride) / 2;
    const cv::Rect middle =
        cv::Rect(placed.piece.x + margin, placed.piece.y + margin, placement.stride, placement.stride) &
        cv::Rect({}, reduced.size());
    if (middle.empty()) continue;
    const cv::Scalar bgr = cv::mean(reduced(middle));
    const double grey = 0.114 * bgr[0] + 0.587 * bgr[1] + 0.299 * bgr[2] - 128;
    const double octaves = grey / (grey < 0 ? 128 : 127);
    placed.speed *= std::exp2(std::round(4 * octaves) / 4);
  }
}

}  // namespace freshet::synth::animate
