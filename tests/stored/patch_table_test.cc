#include "stored/patch_table.h"

#include <sys/resource.h>

#include <string>

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "stored/clip_schema.h"
#include "tests/harness/fault.h"
#include "tests/stored/altered_record.h"
#include "tests/stored/made_store.h"

namespace freshet::stored {
namespace {

long peak_kib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

TEST(PatchTable, TakesNoMemoryForRowsThatNoColumnHolds) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "a.store";
  {
    store::Store store = made_store(file, {{.name = "fall.mp4"}});
    const store::Snapshot snapshot = store.snapshot();
    const vision::OwnWordMaps words(1, snapshot.clip(snapshot.clips()[0]).rows);
    const store::Store::Column column = kPatchWords.column(snapshot.clips()[0], words);
    store.write({}, {&column, 1});
    EXPECT_EQ(read_patch_table(store.snapshot()).size(), words.size());
  }
  // The record and its account of the columns agree; the chunks are not there.
  alter_first_clip(file, [](store::StoredClip& clip) {
    clip.record.rows = 10'000'000;  // of 110 bytes each
    for (auto& [name, column] : clip.columns) {
      if (!name.starts_with("patch.")) continue;
      column.bytes = clip.record.rows * column.element_bytes;
      column.sum.records = static_cast<std::uint32_t>(store::chunks_of(column));
    }
  });
  const store::Snapshot snapshot = store::Store::open_read(file).snapshot();
  const long before = peak_kib();
  const std::string fault = fault_of(ErrorKind::kDamaged, [&] { read_patch_table(snapshot); });
  EXPECT_NE(fault.find("patch."), std::string::npos) << fault;
  EXPECT_LT(peak_kib() - before, 100'000);
}

}  // namespace
}  // namespace freshet::stored
