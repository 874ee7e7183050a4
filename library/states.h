// library/states.h — what the public classes hold.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/label.h"
#include "freshet/search.h"
#include "freshet/store.h"
#include "query/index/search_base.h"
#include "query/labelling/label_request.h"
#include "query/labelling/labelling.h"
#include "store/store.h"

namespace freshet {

struct Store::Impl {
  explicit Impl(store::Snapshot opened) : snapshot(std::move(opened)) {}
  /// Opened by the first search; shared by all.
  std::shared_ptr<const query::SearchBase> search_base() const;

  store::Snapshot snapshot;

 private:
  mutable std::mutex guard_;
  mutable std::shared_ptr<const query::SearchBase> base_;
};

struct Search::Impl {
  Store store;
  std::shared_ptr<const query::SearchBase> base;  // that `found` borrows
  cv::Mat picture, matte;                         // less what is held
  cv::Mat held;
  int frames;
  double fps;
  query::KindChoice kind;
  query::LabelRequest request;
  query::LabelOptions options;  // that follow from it
  query::CandidateSearch found;
  std::vector<std::string> notices;
};

struct Labelling::Impl {
  Search search;
  query::Labels labels;  // of each piece, its candidate's place among them
  query::Assignment assignment;
};

/// Throws Error{kUsage} for what is no BGR picture of 8 bits, or a matte that is neither empty nor 8-bit grey of its
/// size.
void check_picture(const cv::Mat& picture, const cv::Mat& matte);
/// Throws Error{kUsage} for a number of candidates out of range.
void check_count(int k);

}  // namespace freshet
