// ingest/clip_sources.h — whose clips they are, where they come from, and what may be done with them.
#pragma once

#include <string>
#include <vector>

namespace freshet::ingest {

/// Free texts; empty: nothing is said.
struct ClipSource {
  std::string name{};  // of a clip, or of a folder of clips
  std::string licence{}, author{}, source{};
};

/// The row that names the clip, or else the longest name of a folder that it lies in. clip   a part's name
/// (FILM@START-END) is its film's. Null: none does.
const ClipSource* source_of(const std::vector<ClipSource>& sources, const std::string& clip);

}  // namespace freshet::ingest
