#include "query/index/search_base.h"

#include <mutex>
#include <string>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "query/index/exact_index.h"
#include "stored/store_settings.h"
#include "stored/stored_codebook.h"

namespace freshet::query {

namespace {

// An exact index that is built when it is first asked: a search whose answers are all known needs none.
class LateIndex final : public CandidateIndex {
 public:
  LateIndex(vision::WordMaps words, int word_count) : words_(words), word_count_(word_count) {}
  std::size_t rows() const override { return words_.size(); }
  std::vector<std::vector<ScoredPatch>> search(std::span<const PieceQuery> queries, std::size_t k,
                                               const SearchFilter& search_filter) const override {
    std::call_once(built_, [this] { index_ = std::make_unique<const ExactIndex>(words_, word_count_); });
    return index_->search(queries, k, search_filter);
  }

 private:
  vision::WordMaps words_;
  int word_count_;
  mutable std::once_flag built_;
  mutable std::unique_ptr<const ExactIndex> index_;
};

std::unique_ptr<const CandidateIndex> open_index(const store::Snapshot& snapshot, const SearchBase& base,
                                                 const IndexChoice& choice) {
  if (!choice.flann && choice.built_late)
    return std::make_unique<LateIndex>(base.table.words, base.codebook.words);
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
  const Stopwatch watch;
  SearchBase base;
  base.settings = stored::settings_of(snapshot);
  base.codebook = stored::read_codebook(snapshot);
  base.table = stored::read_patch_table(snapshot);
  base.index = open_index(snapshot, base, choice);
  base.is_exact = !choice.flann;
  base.seconds = watch.seconds();
  return base;
}

}  // namespace freshet::query
