#include "query/index/patch_descriptors.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "freshet/error.h"
#include "vision/sift_points.h"

namespace freshet::query {

SharedGrid shared_grid(const vision::PatchGrid& grid) {
  const int pitch = grid.patch / (vision::kGridSide - 1);
  const int step = std::gcd(pitch, grid.stride);
  return {step, pitch / step};
}

PatchPoints::PatchPoints(const store::ClipRecord& clip, const vision::Settings& settings,
                         std::span<const vision::Variant> variants, const stored::ClipPatches& patches) {
  const SharedGrid shared = shared_grid(settings.grid);
  step_ = shared.step;
  spread_ = shared.spread;
  word_bytes_ = vision::word_bytes(settings.codebook.words);
  const int span = spread_ * (vision::kGridSide - 1);  // grid points on a patch's side, less one
  const cv::Size source(static_cast<int>(clip.width), static_cast<int>(clip.height));

  // Every variant's sheet is that of its unflipped twin.
  constexpr std::uint32_t kNone = 0xffffffff;
  std::vector<std::uint32_t> sheet_of(variants.size(), kNone);
  std::vector<cv::Size> sizes(variants.size());
  places_.resize(patches.variant.size());
  std::vector<cv::Point> corners(places_.size());  // px, in the unflipped frame
  std::vector<cv::Rect> boxes;
  for (std::size_t row = 0; row < places_.size(); ++row) {
    const std::size_t v = patches.variant[row];
    if (sheet_of[v] == kNone) {
      vision::Variant unflipped = variants[v];
      unflipped.flip = false;
      const auto known = std::find_if(sheets_.begin(), sheets_.end(),
                                      [&](const Sheet& sheet) { return sheet.variant == unflipped; });
      sheet_of[v] = static_cast<std::uint32_t>(known - sheets_.begin());
      sizes[v] = vision::variant_frame(source, unflipped).size;
      if (known == sheets_.end()) {
        sheets_.push_back({unflipped, {}, 0, 0, {}});
        boxes.emplace_back();
      }
    }
    const int x = patches.x[row];
    corners[row] = {variants[v].flip ? sizes[v].width - x - settings.grid.patch : x, patches.y[row]};
    if (corners[row].x % step_ != 0 || corners[row].y % step_ != 0) {
      throw Error(ErrorKind::kDamaged, clip.name,
                  "patch " + std::to_string(row) + " does not lie on the patch grid",
                  "Run freshet store verify");
    }
    places_[row].sheet = sheet_of[v];
    places_[row].flipped = variants[v].flip;
    boxes[sheet_of[v]] |= cv::Rect(corners[row], cv::Size(settings.grid.patch, settings.grid.patch));
  }

  // A sheet's grid spans its patches only; its points are those that a patch uses.
  std::vector<std::vector<bool>> used(sheets_.size());
  for (std::size_t s = 0; s < sheets_.size(); ++s) {
    Sheet& sheet = sheets_[s];
    sheet.origin = boxes[s].tl();
    sheet.columns = boxes[s].width / step_ + 1;
    sheet.rows = boxes[s].height / step_ + 1;
    used[s].resize(static_cast<std::size_t>(sheet.columns) * sheet.rows);
  }
  for (std::size_t row = 0; row < places_.size(); ++row) {
    Place& place = places_[row];
    const Sheet& sheet = sheets_[place.sheet];
    place.column = (corners[row].x - sheet.origin.x) / step_;
    place.row = (corners[row].y - sheet.origin.y) / step_;
    for (int j = 0; j <= span; j += spread_) {
      for (int i = 0; i <= span; i += spread_) {
        used[place.sheet][static_cast<std::size_t>(place.row + j) * sheet.columns + place.column + i] = true;
      }
    }
  }
  for (std::size_t s = 0; s < sheets_.size(); ++s) {
    for (std::uint32_t point = 0; point < used[s].size(); ++point) {
      if (used[s][point]) sheets_[s].points.push_back(point);
    }
  }
}

std::size_t PatchPoints::points() const {
  std::size_t sum = 0;
  for (const Sheet& sheet : sheets_) sum += sheet.points.size();
  return sum;
}

std::vector<vision::Descriptor> PatchPoints::describe(const Sheet& sheet, const cv::Mat& average,
                                                      std::span<const std::uint32_t> points) const {
  return vision::sift_points(vision::warp_to_variant(average, sheet.variant), sheet.origin, sheet.columns,
                             sheet.rows, step_, points);
}

vision::OwnWordMaps PatchPoints::words(const vision::Codebook& codebook,
                                       std::span<const std::vector<vision::Descriptor>> descriptors) const {
  vision::OwnWordMaps words(word_bytes_, places_.size());
  std::vector<vision::Descriptor> mirrored;
  std::vector<vision::Word> of_points, of_grid;
  vision::WordMap map;
  for (std::size_t s = 0; s < sheets_.size(); ++s) {
    const Sheet& sheet = sheets_[s];
    for (const bool flipped : {false, true}) {
      const auto concerned = [&](const Place& place) { return place.sheet == s && place.flipped == flipped; };
      if (std::none_of(places_.begin(), places_.end(), concerned)) continue;
      of_points.resize(sheet.points.size());
      if (flipped) {
        mirrored.clear();
        for (const vision::Descriptor& descriptor : descriptors[s])
          mirrored.push_back(vision::mirrored(descriptor));
      }
      vision::assign_words(codebook, flipped ? mirrored : descriptors[s], of_points);
      of_grid.assign(static_cast<std::size_t>(sheet.columns) * sheet.rows, 0);
      for (std::size_t i = 0; i < of_points.size(); ++i) of_grid[sheet.points[i]] = of_points[i];
      for (std::size_t row = 0; row < places_.size(); ++row) {
        const Place& place = places_[row];
        if (!concerned(place)) continue;
        for (int j = 0; j < vision::kGridSide; ++j) {
          for (int i = 0; i < vision::kGridSide; ++i) {
            const int column = flipped ? vision::kGridSide - 1 - i : i;
            map[j * vision::kGridSide + i] =
                of_grid[static_cast<std::size_t>(place.row + j * spread_) * sheet.columns + place.column +
                        column * spread_];
          }
        }
        words.set(row, map);
      }
    }
  }
  return words;
}

}  // namespace freshet::query
