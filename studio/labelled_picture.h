// studio/labelled_picture.h — a picture's pieces and their patches, as the command line would choose them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cache/result_cache.h"
#include "freshet/job.h"
#include "query/labelling/label_request.h"
#include "query/labelling/labelling.h"
#include "studio/drawing/document.h"
#include "studio/opened_store.h"
#include "synth/takes/pace.h"

namespace freshet::studio {

struct LabelledPicture {
  std::shared_ptr<const StoreBase> store;  // that the labelling borrows from
  query::LabelRequest request;
  query::KindChoice kind;
  query::Labelling labelling;
  std::vector<bool> pinned;          // of each piece
  std::vector<std::string> notices;  // for a person: what was guessed, what was left out
  synth::takes::Filmed filmed_speed;
};

/// The request that the command line makes of a project.toml of this document.
/// Throws Error{kInput} for strokes that no field goes through.
/// horizon   of `picture`, where its water ends at one.
query::LabelRequest request_of(const Document& document, cv::Size picture,
                               const std::optional<Horizon>& horizon = {});
/// How fast it plays where the document says no speed, as --speed auto: 1 where strokes say theirs.
double own_pace(const LabelledPicture& labelled);

/// Searches and labels. Pieces that are pinned have their patch, and their neighbours are chosen to fit it.
/// picture  CV_8UC3. matte   CV_8U of its size, less what is held. whole_matte   with it: what tells the class.
/// cache    of earlier labellings; may be null. Throws as query::label.
LabelledPicture label_picture(std::shared_ptr<const StoreBase> store, const cv::Mat& picture,
                              const cv::Mat& matte, const cv::Mat& whole_matte, const Document& document,
                              cache::ResultCache* cache, const Job& job);

/// Pieces, clips and figures, for the page. where   px, of the picture.
std::string pieces_json(const LabelledPicture& labelled);
/// A piece's best candidates. Throws Error{kNotFound}.
std::string candidates_json(const LabelledPicture& labelled, std::size_t piece);
/// JPEG of patch_strip() of a candidate. Throws Error{kNotFound}.
std::string candidate_strip(const LabelledPicture& labelled, std::size_t piece, std::size_t candidate);
/// Clips, licences and their share of the picture, as text.
std::string credits(const LabelledPicture& labelled);

}  // namespace freshet::studio
