// tests/query/index/random_words.h — word maps that resemble those of real patches, and an obvious search.
#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "query/index/candidate_index.h"

namespace freshet::query {

struct RandomWordsOptions {
  std::size_t rows = 1000;
  int words = 200;
  int clusters = 0;    // 0: every map by itself; else noisy copies of so many maps
  double noise = 0.3;  // fraction of points that differ from the cluster's map
  std::uint64_t seed = 1;
};

/// As many bytes a word as a codebook of so many words asks for.
inline vision::OwnWordMaps packed(std::span<const vision::WordMap> maps, int words) {
  vision::OwnWordMaps rows(vision::word_bytes(words), maps.size());
  for (std::size_t row = 0; row < maps.size(); ++row) rows.set(row, maps[row]);
  return rows;
}

inline vision::OwnWordMaps random_words(const RandomWordsOptions& options) {
  std::mt19937_64 random(options.seed);
  const auto random_map = [&] {
    // A few words per map, as in textures.
    vision::WordMap map;
    std::array<vision::Word, 12> few;
    for (auto& word : few) word = static_cast<vision::Word>(random() % options.words);
    for (auto& word : map) word = few[random() % few.size()];
    return map;
  };
  std::vector<vision::WordMap> centres(options.clusters);
  for (auto& centre : centres) centre = random_map();
  std::vector<vision::WordMap> maps(options.rows);
  for (auto& map : maps) {
    if (centres.empty()) {
      map = random_map();
      continue;
    }
    map = centres[random() % centres.size()];
    for (auto& word : map) {
      if (static_cast<double>(random() % 1000) < 1000 * options.noise) {
        word = static_cast<vision::Word>(random() % options.words);
      }
    }
  }
  return packed(maps, options.words);
}

inline PieceQuery whole(const vision::WordMap& words) {
  PieceQuery query{words, {}};
  query.mask.fill(1);
  return query;
}

inline std::vector<ScoredPatch> brute_force(vision::WordMaps rows, int words, const PieceQuery& query,
                                            std::size_t k, const RowFilter* filter = nullptr) {
  std::vector<ScoredPatch> scored_patches;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (filter != nullptr && !filter->allows(row)) continue;
    scored_patches.push_back(
        {static_cast<stored::Row>(row),
         static_cast<std::uint32_t>(vision::intersection(query.words, rows[row], words, &query.mask))});
  }
  std::sort(scored_patches.begin(), scored_patches.end(), better);
  if (scored_patches.size() > k) scored_patches.resize(k);
  return scored_patches;
}

}  // namespace freshet::query
