// Motion fields: .flo and .exr. What is read of a .flo is written and read the same again.

#include <opencv2/core.hpp>

#include "media/picture/motion_file.h"
#include "tests/fuzz/fuzz.h"

using namespace freshet;

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::Data data(bytes, size);
  const bool exr = fuzz::take(data) % 4 == 0;
  const fuzz::InputFile file(data, exr ? ".exr" : ".flo");
  fuzz::allow_errors([&] {
    const cv::Mat motion = media::read_motion(file.path());
    if (exr) return;
    const std::filesystem::path copy = file.path().parent_path() / "again.flo";
    media::write_motion(copy, motion);
    const cv::Mat again = media::read_motion(copy);
    fuzz::expect(again.size() == motion.size() &&
                     std::memcmp(again.data, motion.data, motion.total() * motion.elemSize()) == 0,
                 "motion comes back as it was");
  });
  return 0;
}
