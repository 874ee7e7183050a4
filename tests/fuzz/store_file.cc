// A store of any bytes: opened, verified, its digest taken and all that it says read; or refused.

#include "store/store.h"
#include "tests/fuzz/fuzz.h"

using namespace freshet;

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const fuzz::InputFile file({bytes, size}, ".freshet");
  fuzz::allow_errors([&] {
    const store::Store opened = store::Store::open_read(file.path());
    const store::Snapshot snapshot = opened.snapshot();
    snapshot.verify();
    fuzz::allow_errors([&] { snapshot.digest(); });
    for (const store::ClipId clip : snapshot.clips()) {
      const store::ClipRecord& record = snapshot.clip(clip);
      for (std::uint32_t p = 0; p < record.frames.planes.size(); ++p)
        fuzz::allow_errors([&] {
          std::vector<std::byte> out(record.frames.planes[p].bytes_per_sample);
          snapshot.read(clip, store::Stream::kFrames, p, {0, 0, 1, 1}, 0, 1, out);
        });
    }
  });
  return 0;
}
