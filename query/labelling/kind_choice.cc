#include "query/labelling/kind_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "freshet/error.h"

namespace freshet::query {
namespace {

constexpr float kOneWay = 0.7f;      // length of the mean of unit vectors: less goes several ways
constexpr float kSameWay = 0.7071f;  // cosine
constexpr double kEveryWay = 0.25;   // of all directions, that many lie within that

std::string class_of(const store::Snapshot& snapshot, store::ClipId clip) {
  return snapshot.clip(clip).class_name;
}

/// The one way in which the fluid is asked to go, a unit vector.
std::optional<cv::Vec2f> way_asked(const MotionGuide& guide, const cv::Mat& matte) {
  if (guide.direction.empty()) return std::nullopt;
  const cv::Scalar mean = cv::mean(guide.direction, matte > 127);
  const cv::Vec2f way(static_cast<float>(mean[0]), static_cast<float>(mean[1]));
  const auto length = static_cast<float>(cv::norm(way));
  return length > kOneWay ? std::optional(way / length) : std::nullopt;
}

/// By class, the share of its patches that move which go about that way: the mean over its clips, and over one more
/// that goes every way.
std::map<std::string, double> goes_so(const store::Snapshot& snapshot, const stored::PatchTable& table,
                                      const MotionGuide& guide, const cv::Vec2f& way) {
  std::map<std::string, std::pair<double, int>> sums;
  for (std::size_t clip = 0; clip < table.clips.size(); ++clip) {
    auto& [sum, clips] = sums.try_emplace(class_of(snapshot, table.clips[clip]), kEveryWay, 1).first->second;
    int moving = 0, so = 0;
    for (stored::Row row = table.first_row[clip]; row < table.first_row[clip + 1]; ++row) {
      const float u = table.mean_u[row], v = table.mean_v[row], speed = std::hypot(u, v);
      if (speed < guide.min_speed_px_per_s) continue;
      ++moving;
      so += u * way[0] + v * way[1] > kSameWay * speed ? 1 : 0;
    }
    if (moving > 0) sum += static_cast<double>(so) / moving, ++clips;
  }
  std::map<std::string, double> out;
  for (const auto& [name, sum] : sums) out[name] = sum.first / sum.second;
  return out;
}

/// The likeliest class by its look, and by its way where the look is unsure.
std::string likeliest(const store::Snapshot& snapshot, const SearchBase& base, const vision::FluidKind& look,
                      const MotionGuide& guide, const cv::Mat& matte) {
  if (look.sure()) return std::string(look.name());
  const std::optional<cv::Vec2f> way = way_asked(guide, matte);
  if (!way) return std::string(look.name());
  const std::map<std::string, double> goes = goes_so(snapshot, base.table, guide, *way);
  std::array<double, vision::kFluidKinds.size()> share = look.share;
  for (std::size_t kind = 0; kind < share.size(); ++kind) {
    const auto found = goes.find(vision::kFluidKinds[kind]);
    share[kind] *= found == goes.end() ? kEveryWay : found->second;
  }
  return vision::kFluidKinds[static_cast<std::size_t>(std::ranges::max_element(share) - share.begin())];
}

}  // namespace

KindChoice choose_kind(const store::Snapshot& snapshot, const SearchBase& base, const cv::Mat& picture,
                       const cv::Mat& matte, const MotionGuide& guide, CandidateOptions& candidates) {
  if (picture.type() != CV_8UC3 || matte.type() != CV_8U || picture.size() != matte.size())
    throw Error(ErrorKind::kUsage, "picture and matte", "8-bit BGR and 8-bit grey of the same size expected");
  check_guide(guide, picture.size());
  KindChoice choice{.look = vision::fluid_kind(vision::fluid_look(picture, matte))};
  std::set<std::string> classes;
  for (const store::ClipId clip : base.table.clips) classes.insert(class_of(snapshot, clip));
  if (!candidates.class_name.empty() || classes.size() < 2) return choice;

  const std::string name = likeliest(snapshot, base, choice.look, guide, matte);
  std::string seems = fmt::format("looks like {} ({:.2f})", choice.look.name(), choice.look.sureness());
  if (!choice.look.sure()) seems += ", unsure";
  if (name != choice.look.name()) seems += fmt::format(", and goes as {}", name);
  CandidateOptions narrowed = candidates;
  narrowed.class_name = name;
  try {
    if (!classes.contains(name)) throw Error(ErrorKind::kNotFound, name, "the store has none");
    filter_rows(snapshot, base.table, base.settings.variants(), narrowed);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kNotFound) throw;
    choice.words = fmt::format(
        "{}, and the store has no clip of it that may be taken: all classes may be mixed; "
        "--class says which to take",
        seems);
    return choice;
  }
  candidates.class_name = choice.taken = name;
  choice.words = fmt::format("{}: {} only; --class {}", seems, name,
                             choice.look.sure() ? "any for all" : "says which it is, or any for all");
  return choice;
}

}  // namespace freshet::query
