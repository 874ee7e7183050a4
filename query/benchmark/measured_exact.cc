#include "query/benchmark/measured_indexes.h"
#include "query/index/exact_index.h"

namespace freshet::query {

MeasuredIndex measured_exact() {
  return {.name = "exact",
          .what = "inverted lists of visual words, what freshet searches by",
          .is_exact = true,
          .build = [](const SearchSpace& space) -> BuiltIndex {
            return {std::make_shared<ExactIndex>(space.words, space.word_count), {{"exact", [] {}}}};
          }};
}

}  // namespace freshet::query
