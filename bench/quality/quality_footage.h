// quality_footage.h — frames of a clip around its middle, reduced, from a store or from a file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "ingest/source_list.h"
#include "store/store.h"

namespace freshet::bench {

struct CaseOptions {
  int width =
      640;  // px; clips whose longer side is greater are reduced to it, and all cropped to whole blocks
  int frames = 75;  // at most
};

struct Footage {
  std::string name, class_name;
  std::vector<std::string>
      same_scene;  // clips of the store that show the same place, itself among them: left out together
  double fps = 25;
  std::vector<cv::Mat> frames;          // CV_8UC3, around the middle
  int middle = 0;                       // index of the still
  int truth_begin = 0, truth_size = 0;  // what an animation of the still is compared with
  int half = 0;                         // frames before and after the middle: the clip's halves
};

/// The part of a clip that a case needs: options.frames around its middle, and as many before and after it as
/// there are.
Footage stored_footage(const store::Snapshot& snapshot, store::ClipId clip, const CaseOptions& options);
/// The same of a clip that is in no store; a store's clips of its name or scene are left out all the same.
/// Throws Error{kInput} as media::VideoReader.
Footage held_out_footage(const store::Snapshot& snapshot, const ingest::Source& source,
                         const CaseOptions& options);

/// All frames of a video, CV_8UC3, at most `longest` px long and cropped to whole blocks (kSpectrumBlock).
/// fps   of it; may be null. Throws Error{kInput}.
std::vector<cv::Mat> read_video(const std::filesystem::path& path, int longest, double* fps);

/// Luma of BGR frames, as the measures take it.
std::vector<cv::Mat> luma_of(const std::vector<cv::Mat>& frames);

}  // namespace freshet::bench
