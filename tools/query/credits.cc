#include "tools/query/credits.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "platform/printable.h"
#include "platform/whole_file.h"
#include "stored/clip_metadata.h"

namespace freshet::tools {
namespace {

Credit credit_of(const store::Snapshot& snapshot, store::ClipId id) {
  const store::ClipRecord& record = snapshot.clip(id);
  const stored::ClipMetadata metadata = stored::metadata_of(snapshot, id);
  return {.clip = record.name,
          .class_name = record.class_name,
          .licence = record.licence,
          .author = metadata.author,
          .source = metadata.source,
          .source_hash = record.source_hash};
}

}  // namespace

std::vector<Credit> credits_of(const store::Snapshot& snapshot, const query::Assignment& assignment,
                               std::span<const store::ClipId> forms) {
  std::vector<std::size_t> pieces(assignment.clips.size());
  for (const query::AssignedPiece& piece : assignment.pieces) ++pieces[piece.clip];
  std::vector<Credit> credits;
  for (const store::ClipId id : snapshot.clips()) {
    const std::string& hash = snapshot.clip(id).source_hash;
    const auto assigned = std::ranges::find(assignment.clips, hash, &query::AssignedClip::source_hash);
    const std::size_t shown = assigned == assignment.clips.end()
                                  ? 0
                                  : pieces[static_cast<std::size_t>(assigned - assignment.clips.begin())];
    if (shown == 0 && std::ranges::find(forms, id) == forms.end()) continue;
    credits.push_back(credit_of(snapshot, id));
    credits.back().share =
        static_cast<double>(shown) / static_cast<double>(std::max<std::size_t>(1, assignment.pieces.size()));
  }
  std::ranges::stable_sort(credits, std::greater(), &Credit::share);
  return credits;
}

nlohmann::json to_json(const std::vector<Credit>& credits) {
  nlohmann::json json = nlohmann::json::array();
  for (const Credit& each : credits)
    json.push_back({{"clip", each.clip},
                    {"class", each.class_name},
                    {"share", each.share},
                    {"author", each.author},
                    {"licence", each.licence},
                    {"source", each.source},
                    {"source_hash", each.source_hash}});
  return json;
}

std::string to_text(const std::vector<Credit>& credits) {
  std::string text = "The motion comes from these clips:\n";
  for (const Credit& each : credits)
    text += fmt::format("{} ({:.0f} %): {}, {}{}{}\n", printable(each.clip), 100 * each.share,
                        each.author.empty() ? "author not said" : printable(each.author),
                        each.licence.empty() ? "licence not said" : printable(each.licence),
                        each.source.empty() ? "" : ", ", printable(each.source));
  return text;
}

void write_credits(const std::filesystem::path& file, const std::vector<Credit>& credits) {
  write_whole_file(file,
                   file.extension() == ".json"
                       ? to_json(credits).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"
                       : to_text(credits));
}

}  // namespace freshet::tools
