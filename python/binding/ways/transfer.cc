#include "freshet/ways/transfer.h"

#include "python/binding/calls.h"

namespace freshet::python {

void bind_transfer(py::module_& module) {
  static const TransferOptions kDefault;
  module.def(
      "transfer",
      [](const std::filesystem::path& alpha, const std::filesystem::path& flow,
         const std::filesystem::path& exemplar, const std::optional<std::filesystem::path>& exemplar_alpha,
         int frames, int patch, double lambda, double curvature, double divergence, bool stabilise,
         double motion_blur, std::uint64_t seed, const py::object& progress) {
        const Design design{.alpha = alpha, .flow = flow};
        const Look look{.exemplar = exemplar, .alpha = exemplar_alpha.value_or(std::filesystem::path())};
        const TransferOptions options{.frames = frames,
                                      .patch = patch,
                                      .lambda = lambda,
                                      .curvature = curvature,
                                      .divergence = divergence,
                                      .stabilise = stabilise,
                                      .motion_blur = motion_blur,
                                      .seed = seed};
        return std::make_unique<Frames>(
            [design, look, options](const Frames::Sink& sink, const Job& job) {
              freshet::transfer(design, look, sink, options, job);
            },
            progress);
      },
      "alpha"_a, "flow"_a, "exemplar"_a, "exemplar_alpha"_a = py::none(), py::kw_only(),
      "frames"_a = kDefault.frames, "patch"_a = kDefault.patch, "lambda_"_a = kDefault.lambda,
      "curvature"_a = kDefault.curvature, "divergence"_a = kDefault.divergence,
      "stabilise"_a = kDefault.stabilise, "motion_blur"_a = kDefault.motion_blur, "seed"_a = kDefault.seed,
      "progress"_a = py::none(),
      R"(Frames of a designed motion with the look of an exemplar: (height, width, 4), float32 BGRA, 0 to 1,
straight alpha.

alpha           Masks: a folder or a pattern (%05d, ####) of pictures, or a video.
flow            Motion, px per frame: a folder or a pattern of .flo (y down) or .exr (y up).
exemplar        A picture, a folder or a pattern of pictures, or a video.
exemplar_alpha  Its masks; None: its own alpha.
frames          Only so many of the first; 0: all.
patch           Side, px, odd, 3 to 9.
lambda_         Weight of temporal coherence, 0 to 1.
curvature       Weight of how the outline bends, 0 to 16; the exemplar has one. 1 is strong.
divergence      Weight of how the flow spreads, 0 to 16; the exemplar is a video. 1 is strong.
stabilise       The exemplar's own motion is taken out, so that the design alone moves its texture; of a video.
motion_blur     Length along the motion, frames, 0 to 4.)");
}

}  // namespace freshet::python
