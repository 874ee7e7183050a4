// A store of any records, all of whose hashes and sums are right: whoever makes a store computes them. The entries of
// the bytes are sealed again and written as a new file, which is then read, as the table of patches too; or refused.

#include <algorithm>

#include "store/rewrite/record_scan.h"
#include "store/store.h"
#include "stored/patch_table.h"
#include "tests/fuzz/fuzz.h"
#include "tests/store/sealed_tables.h"

using namespace freshet;
using namespace freshet::store;

namespace {

/// Takes the entries of a file apart and seals them.
SealedTables sealed(const RecordScan& scan) {
  SealedTables tables(5);
  for (const RecordScan::Entry& entry : scan.entries) {
    if (!entry.live) continue;
    const Bytes key(entry.key.begin(), entry.key.end());
    const std::size_t size = key.size();
    const bool array = size >= 6 && key[size - 5] == std::byte{0};
    const bool meta =
        std::ranges::equal(key, bytes_of(kSettingsKey)) || std::ranges::equal(key, bytes_of(kAccountKey));
    const Table table = meta                              ? Table::kMeta
                        : size == 4                       ? Table::kClips
                        : size == kTileKeyBytes           ? Table::kTiles
                        : array && key[0] == std::byte{0} ? Table::kColumns  // of the first clips
                                                          : Table::kBlobs;
    tables.put(table, key, {entry.value.begin(), entry.value.end()});
  }
  return tables;
}

void read_all(const std::filesystem::path& file) {
  const Store opened = Store::open_read(file);
  const Snapshot snapshot = opened.snapshot();
  fuzz::allow_errors([&] { snapshot.verify(); });
  fuzz::allow_errors([&] { snapshot.digest(); });
  fuzz::allow_errors([&] { snapshot.usage(); });
  fuzz::allow_errors([&] { stored::read_patch_table(snapshot); });
  fuzz::allow_errors([&] {
    for (const std::string& name : snapshot.blob_names()) fuzz::allow_errors([&] { snapshot.blob(name); });
  });
  for (const ClipId id : snapshot.clips())
    fuzz::allow_errors([&] {
      const StreamShape& shape = snapshot.clip(id).frames;
      for (std::uint32_t p = 0; p < shape.planes.size(); ++p) {
        const PlaneShape& plane = shape.planes[p];
        std::vector<std::byte> out(std::size_t{plane.width} * plane.bytes_per_sample);
        if (shape.frames > 0)
          fuzz::allow_errors([&] {
            snapshot.read(id, Stream::kFrames, p, {0, 0, plane.width, 1}, 0, 1, out);
          });
      }
    });
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const fuzz::InputFile file({bytes, size}, ".freshet");
  const std::filesystem::path made = file.path().string() + ".sealed";
  fuzz::allow_errors([&] {
    sealed(scan_records(file.path(), {})).write(made);
    read_all(made);
  });
  std::error_code ignored;
  std::filesystem::remove(made, ignored);
  std::filesystem::remove(made.string() + "-lock", ignored);
  return 0;
}
