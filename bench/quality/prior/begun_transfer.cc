#include "bench/quality/prior/begun_transfer.h"

#include <unistd.h>

#include <filesystem>

#include <fmt/format.h>

#include "synth/transfer/state_file.h"

namespace freshet::bench {

using namespace synth::transfer;

void begin_with_still(const cv::Mat& bgra, const cv::Mat& flow, const TransferOptions& options,
                      Transfer& transfer) {
  const PixelGrid picture = premultiplied(bgra);
  State state{1, picture, alpha_of(picture), vectors_of(flow),
              synth::GridOf<std::int32_t>(picture.width, picture.height)};
  for (std::size_t i = 0; i < state.sources.values.size(); ++i)
    state.sources.values[i] = static_cast<std::int32_t>(i);
  // A transfer takes what a frame left to it from a file.
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("freshet_begun_transfer_{}", getpid());
  write_state(file, state, options);
  transfer.load_state(file);
  std::filesystem::remove(file);
}

}  // namespace freshet::bench
