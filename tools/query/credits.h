// tools/query/credits.h — the clips that a film shows, and whom they are owed to.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "query/labelling/assignment.h"
#include "store/store.h"

namespace freshet::tools {

struct Credit {
  std::string clip, class_name, licence, author, source;
  std::string source_hash;  // 32 hex digits
  double share = 0;         // of the picture's pieces
};

/// Of the assignment's clips, the largest share first. forms   clips whose flames the film shows; they join the others.
std::vector<Credit> credits_of(const store::Snapshot& snapshot, const query::Assignment& assignment,
                               std::span<const store::ClipId> forms = {});

/// A manifest. Texts as they stand in the store.
nlohmann::json to_json(const std::vector<Credit>& credits);
/// A line a clip: name, share, author, licence, source.
std::string to_text(const std::vector<Credit>& credits);
/// The manifest where the name ends in .json, lines otherwise. Throws Error{kIo}.
void write_credits(const std::filesystem::path& file, const std::vector<Credit>& credits);

}  // namespace freshet::tools
