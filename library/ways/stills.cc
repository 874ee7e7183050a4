#include "freshet/ways/stills.h"

#include <utility>

#include "library/checks.h"
#include "library/opencv_threads.h"
#include "synth/stills/film.h"

namespace freshet {
namespace {

namespace stills = synth::stills;

stills::FilmOptions options_of(const StillsOptions& options) {
  check_range("seconds", options.seconds, 0.04, 3600);
  check_range("fps", options.fps, 1, 240);
  check_word("camera", options.camera, {"auto", "tripod", "hand"});
  check_word("level", options.level, {"auto", "on", "off"});
  check_range("split", options.split, 1, 8);
  check_range("step_s", options.step_s, 0.04, 60);
  check_range("speed", options.speed, 0.05, 20);
  check_range("sigma", options.sigma, 1e-4, 100);
  check_range("irregularity", options.irregularity, 0, 1);
  check_range("flow_side", options.flow_side, 64, 8192);
  stills::FilmOptions chosen{.seconds = options.seconds,
                             .fps = options.fps,
                             .preview = options.preview,
                             .camera = options.camera,
                             .level = options.level,
                             .regions = options.regions,
                             .scribbles = options.scribbles,
                             .one_region = options.one_region,
                             .edits = options.edits};
  chosen.plan.loop = options.loop;
  chosen.plan.split = options.split;
  chosen.plan.timing.step_s = options.step_s;
  chosen.plan.timing.speed = options.speed;
  chosen.plan.sampling.sigma = options.sigma;
  chosen.plan.sampling.irregularity = options.irregularity;
  chosen.plan.sampling.seed = options.seed;
  chosen.render.flow_side = options.flow_side;
  stills::settle(chosen);
  return chosen;
}

stills::Film film_of(const std::filesystem::path& folder, const StillsOptions& options, const Job& job) {
  const stills::FilmOptions chosen = options_of(options);
  stills::StillSet set = stills::read_stills(folder, stills::largest_side(chosen), job);
  stills::straighten(set, chosen, job);
  return stills::plan_film(std::move(set), chosen, job);
}

}  // namespace

struct StillsFilm::Impl {
  explicit Impl(stills::Film made) : film(std::move(made)) {
    for (const stills::PlannedRegion& planned : film.plan.regions) {
      StillsRegion region{
          .name = planned.region.name, .kind = stills::to_string(planned.region.kind), .sequence = {}};
      for (const int still : planned.sequence) region.sequence.push_back(film.stills.names[still]);
      regions.push_back(std::move(region));
    }
  }
  stills::Film film;
  std::vector<StillsRegion> regions;
};

StillsFilm::StillsFilm(const std::filesystem::path& folder, const StillsOptions& options, const Job& job) {
  const OneOpenCvThread one;
  impl_ = std::make_unique<Impl>(film_of(folder, options, job));
}
StillsFilm::~StillsFilm() = default;

cv::Size StillsFilm::size() const { return impl_->film.size(); }
int StillsFilm::frames() const { return impl_->film.render.frames; }
double StillsFilm::fps() const { return impl_->film.render.fps; }
const std::vector<StillsRegion>& StillsFilm::regions() const { return impl_->regions; }
const std::vector<std::string>& StillsFilm::notices() const { return impl_->film.notices; }

void StillsFilm::render(const std::function<void(const cv::Mat&)>& sink, const Job& job) const {
  const OneOpenCvThread one;
  const stills::Film& film = impl_->film;
  stills::render_frames(film.plan, film.stills.pictures, film.render, sink, job);
}

}  // namespace freshet
