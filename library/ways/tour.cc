#include "freshet/ways/tour.h"

#include <algorithm>

#include "freshet/error.h"
#include "library/opencv_threads.h"
#include "synth/tour/tour.h"

namespace freshet {
namespace {

namespace tour = synth::tour;

tour::TourPlan plan_of(const TourOptions& options) {
  tour::TourPlan plan = options.plan.empty() ? tour::TourPlan{} : tour::read_tour(options.plan);
  tour::change(plan, options.move, options.amount, options.horizon);
  return plan;
}

tour::TourOptions options_of(const TourOptions& options) {
  if (options.frames < 0 || !(options.fps >= 0 && options.fps <= 240))
    throw Error(ErrorKind::kUsage, "a tour", "its frames or their rate are out of range",
                "Give 0 or more frames, and at most 240 a second");
  return {.frames = options.frames,
          .fps = options.fps,
          .size = options.size,
          .film_end = tour::parse_film_end(options.film_end)};
}

}  // namespace

std::vector<std::string> tour_moves() { return tour::move_names(); }

struct Tour::Impl {
  Impl(const std::filesystem::path& film, const TourOptions& options, const Job& job)
      : made(film, plan_of(options), options_of(options), job.stop) {}
  tour::Tour made;
  int shown = 0;
};

Tour::Tour(const std::filesystem::path& film, const TourOptions& options, const Job& job) {
  const OneOpenCvThread one;
  impl_ = std::make_unique<Impl>(film, options, job);
}
Tour::~Tour() = default;

cv::Size Tour::size() const { return impl_->made.size(); }
int Tour::frames() const { return impl_->made.frames(); }
double Tour::fps() const { return impl_->made.fps(); }
const std::vector<std::string>& Tour::notices() const { return impl_->made.notices(); }

bool Tour::next(TourFrame& frame) {
  if (impl_->shown == frames()) return false;
  const OneOpenCvThread one;
  frame.picture.create(size(), CV_8UC3);
  impl_->made.render(frame.picture, &frame.depth);
  ++impl_->shown;
  return true;
}

}  // namespace freshet
