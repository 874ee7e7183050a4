// query/labelling/contact_sheet.h — pieces of a picture beside what was found for them.
#pragma once

#include <opencv2/core.hpp>

#include "query/labelling/labelling.h"
#include "store/store.h"

namespace freshet::query {

struct ContactSheetOptions {
  int pieces = 24;      // rows of the sheet, chosen evenly
  int candidates = 10;  // best ones of each
};

/// One row per piece: where it lies, the piece itself, then its best candidates, of the frame in the middle of their
/// clips, as their variants show them, in colour, each with its score in per cent and its clip's number (as in the
/// store).
/// labels   when given, the chosen candidate follows at the right end, framed in green.
/// Returns  CV_8UC3. Twofold size. Decodes a frame of each clip that it shows.
cv::Mat contact_sheet(const store::Snapshot& snapshot, const cv::Mat& picture, const CandidateSearch& search,
                      const Labels* labels = nullptr, const ContactSheetOptions& options = {});

}  // namespace freshet::query
