#include "query/labelling/assignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <system_error>

#include "freshet/error.h"
#include "platform/text_file.h"
#include "platform/unfinished_files.h"
#include "query/search/picture_scale.h"

namespace freshet::query {
namespace {

using Json = nlohmann::json;

constexpr int kVersion = 1, kScaledVersion = 2;
constexpr const char* kFormat = "freshet-assignment";
constexpr std::int64_t kMaxPx = 1 << 20;  // of a side
constexpr std::size_t kMaxPieces = 1 << 22, kMaxClips = 1 << 20;
constexpr std::size_t kMaxBytes = 256u << 20, kDeepest = 32;

// Reads fields and says which one is wrong.
class Fields {
 public:
  Fields(const Json& object, std::string where) : object_(object), where_(std::move(where)) {
    if (!object_.is_object()) fail("an object expected");
  }
  std::int64_t integer(const char* name, std::int64_t low, std::int64_t high) const {
    const Json& value = at(name);
    if (!value.is_number_integer()) fail(fmt::format("\"{}\" is not a whole number", name));
    if (value.is_number_unsigned() &&
        value.get<std::uint64_t>() > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      fail(fmt::format("\"{}\" is out of range", name));
    }
    const auto number = value.get<std::int64_t>();
    if (number < low || number > high) {
      fail(fmt::format("\"{}\" is {}, {} to {} expected", name, number, low, high));
    }
    return number;
  }
  double number(const char* name, double low, double high) const {
    const Json& value = at(name);
    if (!value.is_number()) fail(fmt::format("\"{}\" is not a number", name));
    const double found = value.get<double>();
    if (!(found >= low && found <= high))
      fail(fmt::format("\"{}\" is {}, {} to {} expected", name, found, low, high));
    return found;
  }
  std::string text(const char* name) const {
    const Json& value = at(name);
    if (!value.is_string()) fail(fmt::format("\"{}\" is not a text", name));
    return value.get<std::string>();
  }
  bool flag(const char* name) const {
    const Json& value = at(name);
    if (!value.is_boolean()) fail(fmt::format("\"{}\" is not true or false", name));
    return value.get<bool>();
  }
  const Json& list(const char* name, std::size_t max_entries) const {
    const Json& value = at(name);
    if (!value.is_array()) fail(fmt::format("\"{}\" is not a list", name));
    if (value.size() > max_entries)
      fail(fmt::format("\"{}\" has {} entries, at most {} expected", name, value.size(), max_entries));
    return value;
  }
  bool null(const char* name) const { return at(name).is_null(); }
  const Json& at(const char* name) const {
    const auto found = object_.find(name);
    if (found == object_.end()) fail(fmt::format("\"{}\" is missing", name));
    return *found;
  }
  [[noreturn]] void fail(const std::string& fault) const {
    throw Error(ErrorKind::kInput, where_, fault, "Label the picture again: freshet query label");
  }

 private:
  const Json& object_;
  std::string where_;
};

cv::Point point(const Fields& fields, const char* x, const char* y, std::int64_t low) {
  return {static_cast<int>(fields.integer(x, low, kMaxPx)), static_cast<int>(fields.integer(y, low, kMaxPx))};
}

AssignedClip clip_from(const Fields& fields) {
  AssignedClip clip{fields.text("name"), fields.text("class"), fields.text("licence"),
                    fields.text("source_hash")};
  const auto hex = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  if (clip.source_hash.size() != 32 || !std::all_of(clip.source_hash.begin(), clip.source_hash.end(), hex)) {
    fields.fail("\"source_hash\" is not 32 hexadecimal digits");
  }
  return clip;
}

AssignedPiece piece_from(const Fields& fields, const Assignment& assignment) {
  AssignedPiece piece;
  piece.corner = point(fields, "x", "y", -assignment.side);
  piece.clip = static_cast<std::uint32_t>(
      fields.integer("clip", 0, static_cast<std::int64_t>(assignment.clips.size()) - 1));
  piece.variant.scale = static_cast<float>(fields.number("scale", 1.0 / 1024, 16));
  piece.variant.rotation_deg = static_cast<float>(fields.number("rotation_deg", -360, 360));
  piece.variant.flip = fields.flag("flip");
  piece.patch = point(fields, "patch_x", "patch_y", 0);
  piece.score = static_cast<float>(fields.number("score", 0, 1));
  const cv::Rect box(piece.corner, cv::Size(assignment.side, assignment.side));
  if ((box & cv::Rect({0, 0}, reduced_size(assignment.picture, assignment.piece_scale))).empty())
    fields.fail("the piece lies outside the picture");
  return piece;
}

}  // namespace

double Assignment::gap() const {
  if (!std::isfinite(lower_bound)) return std::numeric_limits<double>::infinity();
  return (energy - lower_bound) / std::max(std::abs(lower_bound), 1e-12);
}

std::string to_json(const Assignment& assignment) {
  Json clips = Json::array(), pieces = Json::array();
  for (const AssignedClip& clip : assignment.clips) {
    clips.push_back({{"name", clip.name},
                     {"class", clip.class_name},
                     {"licence", clip.licence},
                     {"source_hash", clip.source_hash}});
  }
  for (const AssignedPiece& piece : assignment.pieces) {
    pieces.push_back({{"x", piece.corner.x},
                      {"y", piece.corner.y},
                      {"clip", piece.clip},
                      {"scale", piece.variant.scale},
                      {"rotation_deg", piece.variant.rotation_deg},
                      {"flip", piece.variant.flip},
                      {"patch_x", piece.patch.x},
                      {"patch_y", piece.patch.y},
                      {"score", piece.score}});
  }
  const bool bounded = std::isfinite(assignment.lower_bound);
  const bool scaled = assignment.piece_scale != 1;
  Json all{{"format", kFormat},
           {"version", scaled ? kScaledVersion : kVersion},
           {"width", assignment.picture.width},
           {"height", assignment.picture.height},
           {"side", assignment.side},
           {"stride", assignment.stride},
           {"minimizer", assignment.minimizer},
           {"cost_form", assignment.cost_form},
           {"energy", assignment.energy},
           {"lower_bound", bounded ? Json(assignment.lower_bound) : Json()},
           {"clips", clips},
           {"pieces", pieces}};
  if (scaled) all["piece_scale"] = assignment.piece_scale;
  // Names may hold bytes that are no UTF-8: a file name is what the file system says it is.
  return all.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Assignment assignment_from_json(const std::string& json, const std::string& where) {
  expect_nesting(json_nesting(json), kDeepest, where, "Name a file that freshet query label has written");
  const Json all = Json::parse(json, nullptr, false);
  if (all.is_discarded()) {
    throw Error(ErrorKind::kInput, where, "not a JSON file",
                "Name a file that freshet query label has written");
  }
  const Fields fields(all, where);
  if (fields.text("format") != kFormat) fields.fail(fmt::format("\"format\" is not {}", kFormat));
  const std::int64_t version = fields.integer("version", 0, 1 << 30);
  if (version != kVersion && version != kScaledVersion) {
    throw Error(ErrorKind::kInput, where,
                fmt::format("version {} or {} of the format expected", kVersion, kScaledVersion),
                "Use the version of Freshet that wrote it");
  }
  Assignment assignment;
  assignment.picture = {static_cast<int>(fields.integer("width", 1, kMaxPx)),
                        static_cast<int>(fields.integer("height", 1, kMaxPx))};
  if (std::int64_t{assignment.picture.width} * assignment.picture.height > 1 << 28) {
    fields.fail("a picture of more than 2^28 pixels");
  }
  if (version == kScaledVersion) assignment.piece_scale = fields.number("piece_scale", 1, kMaxPieceScale);
  assignment.side = static_cast<int>(fields.integer("side", 8, 4096));
  assignment.stride = static_cast<int>(fields.integer("stride", 1, assignment.side));
  assignment.minimizer = fields.text("minimizer");
  assignment.cost_form = fields.text("cost_form");
  constexpr double kMax = std::numeric_limits<double>::max();
  assignment.energy = fields.number("energy", -kMax, kMax);
  assignment.lower_bound = fields.null("lower_bound") ? -std::numeric_limits<double>::infinity()
                                                      : fields.number("lower_bound", -kMax, kMax);
  const Json& clips = fields.list("clips", kMaxClips);
  for (std::size_t i = 0; i < clips.size(); ++i) {
    assignment.clips.push_back(clip_from(Fields(clips[i], fmt::format("{}, clip {}", where, i))));
  }
  const Json& pieces = fields.list("pieces", kMaxPieces);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Fields piece(pieces[i], fmt::format("{}, piece {}", where, i));
    assignment.pieces.push_back(piece_from(piece, assignment));
    const cv::Point off = assignment.pieces.back().corner - assignment.pieces.front().corner;
    if (off.x % assignment.stride != 0 || off.y % assignment.stride != 0) {
      piece.fail("it does not lie on the lattice of the others");
    }
  }
  return assignment;
}

void write_assignment(const std::filesystem::path& path, const Assignment& assignment) {
  const std::string json = to_json(assignment);
  std::filesystem::path beside = path;
  beside += ".part";
  const UnfinishedFile unfinished(beside);
  std::ofstream file(beside, std::ios::binary | std::ios::trunc);
  file << json;
  file.close();
  std::error_code failure;
  if (file) std::filesystem::rename(beside, path, failure);
  if (!file || failure) {
    std::error_code ignored;
    std::filesystem::remove(beside, ignored);
    throw Error(ErrorKind::kIo, path.string(), "cannot be written",
                "Check that its folder exists, may be written to and has room");
  }
}

Assignment read_assignment(const std::filesystem::path& path) {
  const std::string json =
      read_text_file(path, kMaxBytes, "Name a file that freshet query label has written");
  return assignment_from_json(json, path.string());
}

std::vector<store::ClipId> find_clips(const Assignment& assignment, const store::Snapshot& snapshot) {
  std::vector<store::ClipId> ids;
  for (const AssignedClip& clip : assignment.clips) {
    const auto id = snapshot.find_source(clip.source_hash);
    if (!id) {
      throw Error(ErrorKind::kNotFound, "clip " + clip.name,
                  "the store does not hold it (source " + clip.source_hash + ")",
                  "Use the store that the assignment was made with, or ingest the clip");
    }
    ids.push_back(*id);
  }
  for (std::size_t i = 0; i < assignment.pieces.size(); ++i) {
    const AssignedPiece& piece = assignment.pieces[i];
    const store::ClipRecord& record = snapshot.clip(ids[piece.clip]);
    const cv::Size source(static_cast<int>(record.width), static_cast<int>(record.height));
    const cv::Size frame = vision::variant_frame(source, piece.variant).size;
    if (piece.patch.x + assignment.side > frame.width || piece.patch.y + assignment.side > frame.height) {
      throw Error(ErrorKind::kInput, fmt::format("assignment, piece {}", i),
                  fmt::format("its patch reaches beyond the frame of {}", record.name));
    }
  }
  return ids;
}

}  // namespace freshet::query
