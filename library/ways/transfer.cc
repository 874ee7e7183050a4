#include "freshet/ways/transfer.h"

#include "freshet/error.h"
#include "library/opencv_threads.h"
#include "synth/transfer/files/design_files.h"
#include "synth/transfer/files/exemplar_files.h"
#include "synth/transfer/transfer.h"

namespace freshet {

TransferReport transfer(const Design& design, const Look& look,
                        const std::function<void(const cv::Mat&)>& sink, const TransferOptions& options,
                        const Job& job) {
  namespace engine = synth::transfer;
  const OneOpenCvThread one;
  engine::TransferOptions chosen;
  chosen.patch = options.patch;
  chosen.lambda = options.lambda;
  chosen.curvature = options.curvature;
  chosen.divergence = options.divergence;
  chosen.stabilised = options.stabilise;
  chosen.motion_blur = options.motion_blur;
  chosen.seed = options.seed;
  engine::check(chosen);
  const auto follow = [&](const char* stage) {
    return [&job, stage](std::size_t done, std::size_t of) {
      if (job.progress) job.progress({stage, done, of});
    };
  };
  engine::DesignFiles files(design.alpha, design.flow, options.frames);
  engine::ExemplarFiles exemplar(look.exemplar, {.alpha = look.alpha,
                                                 .patch = options.patch,
                                                 .frames = files.frames(),
                                                 .motion = engine::needs_motion(chosen)});
  files.check(follow("checking the design"), job.stop);
  exemplar.check(follow("checking the exemplar"), job.stop);
  engine::check_outline(files, exemplar, design.alpha);
  engine::check_guides(exemplar, chosen, look.exemplar);

  engine::Transfer making([&exemplar](int t) { return exemplar.at(t); }, chosen);
  const auto frames = static_cast<std::size_t>(files.frames());
  for (std::size_t i = 0; i < frames; ++i) {
    const auto stop_or_show = [&](double = 0) {
      if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "transfer", "stopped");
      if (job.progress) job.progress({"transfer", i, frames});
    };
    stop_or_show();
    sink(making.next(files.read(static_cast<int>(i)), stop_or_show).bgra);
  }
  return {.frames = files.frames(), .size = files.size()};
}

}  // namespace freshet
