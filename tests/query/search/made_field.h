// tests/query/search/made_field.h — pieces, candidates and features without a store.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <opencv2/core.hpp>

#include "query/costs/pairwise.h"
#include "query/search/candidates.h"
#include "query/search/target.h"

namespace freshet::query {

inline constexpr stored::Row kRows = 60;

// Features with the spread of real ones: still places and torrents.
inline std::vector<float> features_of(stored::Row row, const FeatureShape& shape) {
  std::mt19937_64 random(row);
  std::normal_distribution<float> normal;
  std::vector<float> values(shape.values());
  const float liveliness = std::exp(1.5f * normal(random));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto channel = static_cast<int>(i % static_cast<std::size_t>(shape.channels()));
    const float unit = normal(random);
    if (channel < 2) {
      values[i] = 40 * liveliness * unit;
    } else if (channel < 2 + 2 * shape.bands) {
      values[i] = 500 * liveliness * liveliness * unit * unit;
    } else {
      values[i] = std::min(1.0f, 0.02f * liveliness * std::abs(unit));
    }
  }
  return values;
}

inline FeatureSource source_of(const FeatureShape& shape) {
  const int side = shape.square(), across = shape.squares();
  return {[=](stored::Row row, std::span<Square> out) {
            for (int k = 0; k < across * across; ++k)
              out[static_cast<std::size_t>(k)] = {row, 0, static_cast<std::uint16_t>(k / across * side),
                                                  static_cast<std::uint16_t>(k % across * side)};
          },
          [=](std::span<const Square> squares, const SquareSink& sink) {
            const auto line = static_cast<std::ptrdiff_t>(side) * shape.channels();
            for (std::size_t i = 0; i < squares.size(); ++i) {
              const auto values = features_of(squares[i].clip, shape);
              std::vector<float> square;
              for (int y = 0; y < side; ++y) {
                const auto from = values.begin() + ((squares[i].y + y) * shape.cells + squares[i].x) *
                                                       static_cast<std::ptrdiff_t>(shape.channels());
                square.insert(square.end(), from, from + line);
              }
              sink(i, square);
            }
          }};
}

inline Target some_target() {
  cv::Mat matte(150, 130, CV_8U, cv::Scalar(255));
  matte(cv::Rect(60, 0, 70, 60)).setTo(0);
  return lay_out(matte, {});
}

inline Candidates some_candidates(std::size_t pieces, std::size_t k) {
  Candidates candidates;
  candidates.k = k;
  candidates.rows.assign(pieces * k, stored::kNoRow);
  candidates.scores.assign(pieces * k, 0);
  std::mt19937_64 random(4);
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    candidates.counts.push_back(static_cast<std::uint32_t>(1 + random() % k));
    for (std::size_t i = 0; i < candidates.counts[piece]; ++i) {
      candidates.rows[piece * k + i] = static_cast<stored::Row>(random() % kRows);
      candidates.scores[piece * k + i] = 1 - 0.05f * static_cast<float>(i);
    }
  }
  return candidates;
}

}  // namespace freshet::query
