#include "freshet/ways/flowlines.h"

#include <utility>

#include "library/checks.h"
#include "library/opencv_threads.h"
#include "library/states.h"
#include "synth/flowlines/files/asked_lines.h"
#include "synth/flowlines/files/footage_files.h"
#include "synth/flowlines/files/line_files.h"
#include "synth/flowlines/flowlines.h"

namespace freshet {
namespace {

namespace flowlines = synth::flowlines;

void check(const FlowLinesOptions& options) {
  check_range("frames", options.frames, 1, 1e7);
  if (options.fps != 0) check_range("fps", options.fps, 1, 240);
  check_range("from", options.from, 0, 1e6);
  if (options.input_frames != 0) check_range("input_frames", options.input_frames, 16, 1e5);
  if (options.spacing_px != 0) check_range("spacing_px", options.spacing_px, 2, 1000);
  if (options.patch_px != 0) check_range("patch_px", options.patch_px, 4, 1000);
  if (options.entries != 0) check_range("entries", options.entries, 8, 1e5);
  if (!(options.strand_px < 0)) check_range("strand_px", options.strand_px, 0, 1e5);
  if (options.join_px != 0) check_range("join_px", options.join_px, 1, 1e5);
}

flowlines::FootageOptions footage_of(const FlowLinesOptions& options) {
  check(options);
  return {.from = options.from, .frames = options.input_frames, .memory_bytes = options.memory_bytes};
}

flowlines::FlowlinesOptions options_of(const FlowLinesOptions& options, double fps) {
  flowlines::FlowlinesOptions chosen;
  chosen.fps = fps;
  if (options.loop) chosen.loop_frames = options.frames;
  chosen.moving_camera = options.moving_camera;
  chosen.spacing_px = options.spacing_px;
  chosen.patch_px = options.patch_px;
  chosen.dynamics = flowlines::parse_dynamics(options.dynamics);
  chosen.entries = options.entries;
  chosen.in_turn = options.in_turn;
  chosen.strand_px = options.strand_px;
  chosen.mixing = flowlines::parse_mixing(options.blend);
  chosen.seed = options.seed;
  chosen.join_px = options.join_px;
  chosen.view.correspondence = flowlines::parse_correspondence(options.correspondence);
  chosen.view.ground = media::parse_ground(options.ground);
  chosen.view.on_background = options.on_background;
  return chosen;
}

}  // namespace

struct FlowLines::Impl {
  Impl(flowlines::Footage read, const FlowLinesOptions& options, const Job& job)
      : footage(std::move(read)),
        notices(footage.notices),
        frames(options.frames),
        fps(options.fps > 0 ? options.fps : footage.fps),
        engine(footage, with_files(options), job) {
    const std::vector<std::string>& more = engine.report().notices;
    notices.insert(notices.end(), more.begin(), more.end());
    for (const flowlines::FlowLine& line : engine.lines())
      lines.push_back({.name = line.name, .points = line.points});
  }
  flowlines::FlowlinesOptions with_files(const FlowLinesOptions& options) {
    flowlines::FlowlinesOptions chosen = options_of(options, fps);
    flowlines::read_asked({.lines = options.lines,
                           .edited = options.edited,
                           .matte = options.matte,
                           .background = options.background},
                          footage, chosen, notices);
    return chosen;
  }

  flowlines::Footage footage;
  std::vector<std::string> notices;
  int frames;
  double fps;
  flowlines::Flowlines engine;
  std::vector<FlowLine> lines;
  int shown = 0;
};

FlowLines::FlowLines(const std::filesystem::path& clip, const FlowLinesOptions& options, const Job& job) {
  const OneOpenCvThread one;
  impl_ = std::make_unique<Impl>(flowlines::read_footage(clip, footage_of(options)), options, job);
}
FlowLines::FlowLines(const Store& store, const std::string& clip, const FlowLinesOptions& options,
                     const Job& job) {
  const OneOpenCvThread one;
  impl_ = std::make_unique<Impl>(flowlines::read_footage(store.impl().snapshot, clip, footage_of(options)),
                                 options, job);
}
FlowLines::~FlowLines() = default;

cv::Size FlowLines::size() const { return impl_->footage.size(); }
int FlowLines::frames() const { return impl_->frames; }
double FlowLines::fps() const { return impl_->fps; }
const std::vector<FlowLine>& FlowLines::lines() const { return impl_->lines; }
void FlowLines::write_lines(const std::filesystem::path& svg) const {
  flowlines::write_lines(svg, impl_->engine.lines(), size());
}
const std::vector<std::string>& FlowLines::notices() const { return impl_->notices; }

bool FlowLines::next(FlowLinesFrame& frame) {
  if (impl_->shown == frames()) return false;
  const OneOpenCvThread one;
  impl_->engine.next().copyTo(frame.picture);
  impl_->engine.fluid().copyTo(frame.fluid);
  ++impl_->shown;
  return true;
}

}  // namespace freshet
