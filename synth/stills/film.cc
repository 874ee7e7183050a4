#include "synth/stills/film.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"
#include "synth/stills/alignment.h"
#include "synth/stills/edits.h"
#include "synth/stills/region_file.h"
#include "synth/stills/region_proposal.h"

namespace freshet::synth::stills {
namespace {

constexpr int kWorkSide = 960;  // px: regions and weights are kept so large
constexpr int kPreviewSide = 480, kPreviewFlowSide = 320;

std::vector<Region> choose_regions(const FilmOptions& options, const StillSet& set,
                                   const std::vector<cv::Mat>& small, std::vector<std::string>& notices) {
  if (!options.regions.empty()) return read_regions(options.regions, set.size(), small[0].size(), notices);
  if (!options.scribbles.empty()) {
    cv::Mat still = set.pictures[0];
    if (still.depth() == CV_16U) still.convertTo(still, CV_8U, 1.0 / 257);
    return scribbled_regions(options.scribbles, still, small, notices);
  }
  RegionProposal proposal = propose_regions(small);
  if (options.one_region)
    return {{.name = "1", .mask = cv::Mat(small[0].size(), CV_8U, cv::Scalar(255)), .parent = {}}};
  return std::move(proposal.regions);
}

/// Takes the things in front out of the set; their parts of the plan, without the regions behind them.
std::vector<PlannedRegion> plan_fronts(StillSet& set, const FilmOptions& options,
                                       std::vector<std::string>& notices, const Job& job) {
  std::vector<PlannedRegion> planned;
  std::vector<std::vector<cv::Mat>> all;
  for (const FrontEdit& edit : options.fronts) {
    const auto same = [&](const FrontEdit& each) { return each.name == edit.name; };
    if (edit.name == "*" || std::ranges::count_if(options.fronts, same) > 1)
      throw Error(ErrorKind::kInput, "front " + edit.name,
                  edit.name == "*" ? "this name means all regions" : "another thing in front has this name",
                  "Give it another name");
    all.push_back(front_mattes(edit.mattes, set));
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    const FrontEdit& edit = options.fronts[k];
    const std::vector<cv::Mat>& mattes = all[k];
    // What is filled must not show a farther thing where it is in another still, nor be taken for that thing.
    std::vector<cv::Mat> farther(mattes.size());
    for (std::size_t i = 0; i < mattes.size(); ++i) {
      farther[i] = cv::Mat(mattes[i].size(), CV_8U, cv::Scalar(0));
      const cv::Mat replaced = replaced_share(mattes[i]);
      for (std::size_t other = k + 1; other < all.size(); ++other) {
        cv::max(farther[i], all[other][i], farther[i]);
        cv::multiply(all[other][i], 1 - replaced, all[other][i], 1, CV_8U);
      }
    }
    auto thing = std::make_shared<FrontThing>(part_stills(set.pictures, mattes, farther, edit.name, notices));
    for (std::size_t i = 0; i < mattes.size(); ++i)
      thing->small.push_back(over_grey(thing->light[i], thing->alpha[i]));
    const std::vector<cv::Mat>& grey = thing->small = reduced(thing->small, kWorkSide);
    Region region{.name = edit.name, .mask = cv::Mat(grey[0].size(), CV_8U, cv::Scalar(0)), .parent = {}};
    for (const cv::Mat& matte : mattes) {
      cv::Mat small;
      cv::resize(matte, small, region.mask.size(), 0, 0, cv::INTER_AREA);
      region.mask.setTo(255, small > 0);
    }
    PlanOptions plan = options.plan;
    plan.split = 1;
    std::erase_if(plan.edits,
                  [&](const RegionEdits& each) { return each.region != "*" && each.region != edit.name; });
    for (RegionEdits& each : plan.edits) {
      if (each.region == edit.name && (each.kind || each.split))
        throw Error(ErrorKind::kInput, "region " + edit.name, "a thing in front has no kind and no parts",
                    "Take out kind and split");
      each.kind = {}, each.split = {};
    }
    Plan made = make_plan(grey, set.names, {region}, plan, job);
    notices.insert(notices.end(), made.notices.begin(), made.notices.end());
    planned.push_back(std::move(made.regions[0]));
    planned.back().front = std::move(thing);
  }
  return planned;
}

}  // namespace

void settle(FilmOptions& options) {
  if (!options.regions.empty() + !options.scribbles.empty() + options.one_region > 1)
    throw Error(ErrorKind::kUsage, "synth stills", "regions are said more than once",
                "Give one of --regions, --scribbles and --one-region");
  if (options.preview) {
    options.fps = std::min(options.fps, 12.5);
    options.render.flow_side = kPreviewFlowSide;
  }
  options.render.fps = options.fps;
  options.render.frames = std::max(1, static_cast<int>(std::lround(options.seconds * options.fps)));
  options.plan.seconds = options.render.frames / options.fps;
  if (options.edits.empty()) return;
  StillsEdits edits = read_edits(options.edits);
  options.plan.edits = std::move(edits.regions);
  options.pins = std::move(edits.pins);
  options.fronts = std::move(edits.fronts);
}

int largest_side(const FilmOptions& options) { return options.preview ? kPreviewSide : 0; }

void straighten(StillSet& set, const FilmOptions& options, const Job& job) {
  bool hand_held = options.camera == "hand";
  if (options.camera != "tripod") {
    const Alignment found =
        find_alignment(set.pictures, set.names, {.side = options.preview ? 480 : 1024}, job);
    if (found.unsure)
      set.notices.emplace_back(
          "nothing stands still in these stills by which they could be aligned; the camera is taken to "
          "have stood still (--camera tripod)");
    hand_held |= !found.tripod;
    if (!found.tripod) {
      align(set.pictures, found);
      for (std::size_t i = 0; i < set.from_file.size(); ++i) {
        const cv::Matx33d map = found.maps[i];
        const cv::Matx33d cut(1, 0, found.common.x, 0, 1, found.common.y, 0, 0, 1);
        set.from_file[i] = (map * cut).inv() * set.from_file[i];
      }
      set.notices.push_back(
          fmt::format("taken from the hand: aligned by up to {:.1f} px, and cut to {} x {} px",
                      found.largest_px, set.size().width, set.size().height));
    }
  }
  if (options.level == "on" || (options.level == "auto" && hand_held))
    if (const int changed = level(set.pictures, find_levels(reduced(set.pictures, 320))))
      set.notices.push_back(
          fmt::format("{} stills were brought to the others' exposure and white balance", changed));
}

Film plan_film(StillSet set, const FilmOptions& options, const Job& job) {
  Film film{.stills = std::move(set), .small = {}, .plan = {}, .render = options.render, .notices = {}};
  film.notices = film.stills.notices;
  std::vector<PlannedRegion> fronts = plan_fronts(film.stills, options, film.notices, job);
  film.small = reduced(film.stills.pictures, kWorkSide);
  // Widths are said for a picture of the work side; smaller ones are not enlarged to it.
  const double scale = std::max(film.small[0].cols, film.small[0].rows) / static_cast<double>(kWorkSide);
  film.render.feather_px *= scale;
  film.render.grown_px *= scale;
  const std::vector<Region> regions = choose_regions(options, film.stills, film.small, film.notices);
  PlanOptions behind = options.plan;
  for (const FrontEdit& edit : options.fronts) {
    if (std::ranges::find(regions, edit.name, &Region::name) != regions.end())
      throw Error(ErrorKind::kInput, "front " + edit.name, "another region has this name",
                  "Give it another name");
    std::erase_if(behind.edits, [&](const RegionEdits& each) { return each.region == edit.name; });
  }
  film.plan = make_plan(film.small, film.stills.names, regions, behind, job);
  std::move(fronts.begin(), fronts.end(), std::back_inserter(film.plan.regions));
  film.notices.insert(film.notices.end(), film.plan.notices.begin(), film.plan.notices.end());
  film.render.pins = placed_pins(options.pins, film.stills);
  for (std::string& notice : check_pins(film.plan, film.stills.size(), film.render))
    film.notices.push_back(std::move(notice));
  return film;
}

}  // namespace freshet::synth::stills
