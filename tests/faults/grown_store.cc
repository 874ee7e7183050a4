#include "tests/faults/grown_store.h"

#include <xxhash.h>

#include <stdexcept>

#include "store/store.h"
#include "tests/faults/campaign.h"

namespace freshet::tools {

namespace {

std::uint64_t hash_of(std::span<const std::byte> bytes, std::uint64_t before = 1) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), before);
}

}  // namespace

Holdings holdings_of(const std::string& file) {
  const store::Snapshot snapshot = store::Store::open_read(file).snapshot();
  Holdings held;
  if (const auto codebook = snapshot.blob("codebook")) held.codebook = hash_of(*codebook);
  for (const store::ClipId id : snapshot.clips()) {
    const store::ClipRecord& record = snapshot.clip(id);
    std::uint64_t hash = 1;
    for (const auto& [stream, shape] : {std::pair(store::Stream::kFrames, &record.frames),
                                        {store::Stream::kFlow, &record.flow},
                                        {store::Stream::kAverage, &record.average}})
      for (std::uint32_t p = 0; p < shape->planes.size(); ++p) {
        const store::PlaneShape& plane = shape->planes[p];
        std::vector<std::byte> samples(std::size_t{plane.width} * plane.height * plane.bytes_per_sample *
                                       shape->frames);
        snapshot.read(id, stream, p, {0, 0, plane.width, plane.height}, 0, shape->frames, samples);
        hash = hash_of(samples, hash);
      }
    const store::ReadableClip clip{record.name, record.source_hash};
    held.clips[clip] = hash_of(std::as_bytes(std::span(record.metadata)), hash);
    if (!snapshot.has_column(id, "patch.words")) continue;
    const auto words = snapshot.column<std::array<std::byte, 81>>(id, "patch.words");
    held.words[clip] = hash_of(std::as_bytes(std::span(words)));
  }
  return held;
}

Grown::Grown() {
  const Campaign& c = campaign();
  c.begin_with("one.store", "g.store");
  const auto keep = [&] {
    files.push_back(text_of(c.folder / "g.store"));
    states.push_back(holdings_of(c.folder / "g.store"));
  };
  const auto run = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = c.run(arguments);
    if (outcome.exit_code == 0) return keep();
    throw std::runtime_error("the campaign's store cannot be made: " + outcome.err);
  };
  keep();
  run({"index", "g.store"});
  run(c.ingest("g.store", {"clip2.mkv"}));
  run({"index", "g.store"});
  run(c.ingest("g.store", {"clip3.mkv"}));
  run({"index", "g.store"});
  run({"index", "--rebuild", "--samples", "1000", "g.store"});
}

const Grown& grown() {
  static const Grown made;
  return made;
}

}  // namespace freshet::tools
