#include "query/search_base.h"

#include <chrono>
#include <string>

#include "freshet_error.h"
#include "query/exact_index.h"
#include "query/stored_codebook.h"

namespace freshet::query {

namespace {

std::unique_ptr<const CandidateIndex> open_index(const store::Snapshot& snapshot, const SearchBase& base,
                                                 const IndexChoice& choice) {
  if (!choice.flann) return std::make_unique<ExactIndex>(base.table.words, base.codebook.words);
  const auto bytes = snapshot.blob(blob_name(*choice.flann));
  if (!bytes) {
    throw Error(ErrorKind::kNotFound, snapshot.path().string(),
                std::string("it has no FLANN index ") + name_of(*choice.flann),
                std::string("Run freshet index --flann ") + name_of(*choice.flann) + ", or use exact search");
  }
  FlannOptions options = choice.flann_options;
  options.kind = *choice.flann;
  return std::make_unique<FlannIndex>(base.table.words, base.codebook.words, *bytes, options);
}

}  // namespace

SearchBase open_search(const store::Snapshot& snapshot, const IndexChoice& choice) {
  const auto start = std::chrono::steady_clock::now();
  SearchBase base;
  base.settings = vision::settings_from_json(snapshot.settings());
  base.codebook = read_codebook(snapshot);
  base.table = read_patch_table(snapshot);
  base.index = open_index(snapshot, base, choice);
  base.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return base;
}

}  // namespace freshet::query
