// Clips of every container that is taken: opened, and some frames read.

#include <array>

#include "media/video/video_reader.h"
#include "tests/fuzz/fuzz.h"

using namespace freshet;

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::array kEndings{".mp4", ".mkv", ".avi", ".webm", ".gif", ".y4m", ".ts"};
  constexpr int kFrames = 8;
  fuzz::Data data(bytes, size);
  const char* ending = kEndings[fuzz::take(data) % kEndings.size()];
  const fuzz::InputFile file(data, ending);
  fuzz::allow_errors([&] {
    media::VideoReader reader(file.path(), 1);
    for (int i = 0; i < kFrames; ++i) {
      const auto frame = reader.next();
      if (!frame) break;
    }
  });
  return 0;
}
