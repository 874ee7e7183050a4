#include "stored/clip_metadata.h"

#include <cmath>
#include <utility>

#include "freshet/error.h"
#include "media/frame/layout_json.h"

namespace freshet::stored {
namespace {

using Json = nlohmann::json;

/// A field that cannot be what it claims; metadata_of says where.
struct Fault {
  std::string what;
};

std::optional<CellShape> shape_of(const vision::CellMap& cells) {
  if (cells.channels == 0) return std::nullopt;
  return CellShape{cells.rows, cells.columns, cells.channels, cells.cell};
}

Json json_of(const CellShape& shape) {
  return {
      {"rows", shape.rows}, {"columns", shape.columns}, {"channels", shape.channels}, {"cell", shape.cell}};
}

Json json_of(const CellShapes& shapes) {
  Json json{{"texture", Json::array()}};
  for (const CellShape& scale : shapes.texture) json["texture"].push_back(json_of(scale));
  if (shapes.motion) json["motion"] = json_of(*shapes.motion);
  if (shapes.life) json["life"] = json_of(*shapes.life);
  if (shapes.standing) json["standing"] = json_of(*shapes.standing);
  if (shapes.layout) json["layout"] = json_of(*shapes.layout);
  return json;
}

Json json_of(const std::optional<vision::LoopRule>& loop) {
  if (!loop) return nullptr;
  return {{"from", loop->from}, {"to", loop->to}, {"fade", loop->fade}, {"distance", loop->distance}};
}

std::int64_t integer(const Json& json, std::int64_t min, std::int64_t max, const std::string& name) {
  if (!json.is_number_integer()) throw Fault{name + " is no integer"};
  const auto value = json.get<std::int64_t>();
  if (value < min || value > max) throw Fault{name + " cannot be " + json.dump()};
  return value;
}

float number(const Json& json, const std::string& name) {
  if (!json.is_number() || !std::isfinite(json.get<float>())) throw Fault{name + " is no number"};
  return json.get<float>();
}

CellShape shape_from(const Json& json, const std::string& name) {
  constexpr int kMaxCells = 1 << 16, kMaxChannels = 1 << 16;  // on a side; frames have at most 32767 px
  CellShape shape{
      .rows = static_cast<int>(integer(json.at("rows"), 1, kMaxCells, name + " rows")),
      .columns = static_cast<int>(integer(json.at("columns"), 1, kMaxCells, name + " columns")),
      .channels = static_cast<int>(integer(json.at("channels"), 1, kMaxChannels, name + " channels")),
      .cell = number(json.at("cell"), name + " cell")};
  if (!(shape.cell > 0)) throw Fault{name + " cell cannot be " + json.at("cell").dump()};
  return shape;
}

CellShapes shapes_from(const Json& json) {
  CellShapes shapes;
  const auto one = [&](const char* key) -> std::optional<CellShape> {
    if (!json.contains(key)) return std::nullopt;
    return shape_from(json[key], std::string("cells ") + key);
  };
  shapes.motion = one("motion");
  shapes.life = one("life");
  shapes.standing = one("standing");
  shapes.layout = one("layout");
  if (json.contains("texture"))
    for (const Json& scale : json["texture"]) shapes.texture.push_back(shape_from(scale, "cells texture"));
  return shapes;
}

vision::LoopRule loop_from(const Json& json) {
  constexpr std::int64_t kMaxFrames = 0xffffffff;
  const auto frames = [&](const char* key) {
    return static_cast<std::uint32_t>(integer(json.at(key), 0, kMaxFrames, std::string("loop ") + key));
  };
  return {.from = frames("from"),
          .to = frames("to"),
          .fade = frames("fade"),
          .distance = json.at("distance").get<double>()};
}

std::array<float, vision::kLifeBands> bands_from(const Json& json, const std::string& name) {
  std::array<float, vision::kLifeBands> bands{};
  if (!json.is_array() || json.size() != bands.size()) throw Fault{name + " is not a value for each band"};
  for (std::size_t b = 0; b < bands.size(); ++b) bands[b] = number(json[b], name);
  return bands;
}

ClipMetadata from_json(Json json) {
  if (!json.is_object()) throw Fault{"they are no JSON object"};
  ClipMetadata metadata;
  const auto take = [&](const char* key, const auto& use) {
    const auto found = json.find(key);
    if (found == json.end()) return;
    use(*found);
    json.erase(found);
  };
  take("layout", [&](const Json& value) {
    metadata.layout = media::layout_from_json(value);
    if (!metadata.layout) throw Fault{"no pixel layout can be read from them"};
  });
  take("codec", [&](const Json& value) { value.get_to(metadata.codec); });
  take("container", [&](const Json& value) { value.get_to(metadata.container); });
  take("variable_frame_rate", [&](const Json& value) { value.get_to(metadata.variable_frame_rate); });
  take("repairs", [&](const Json& value) { value.get_to(metadata.repairs); });
  take("author", [&](const Json& value) { value.get_to(metadata.author); });
  take("source", [&](const Json& value) { value.get_to(metadata.source); });
  take("notices", [&](const Json& value) { value.get_to(metadata.notices); });
  take("cells", [&](const Json& value) { metadata.cells = shapes_from(value); });
  take("patches", [&](const Json& value) { value.get_to(metadata.patches); });
  metadata.loop_known = json.contains("loop");
  take("loop", [&](const Json& value) {
    if (!value.is_null()) metadata.loop = loop_from(value);
  });
  take("half_life_s", [&](const Json& value) { metadata.half_life_s = bands_from(value, "half_life_s"); });
  take("standing", [&](const Json& value) { metadata.standing = bands_from(value, "standing"); });
  metadata.more = std::move(json);
  return metadata;
}

}  // namespace

CellShapes shapes_of(const ClipColumns& columns) {
  CellShapes shapes{.motion = shape_of(columns.motion),
                    .life = shape_of(columns.life),
                    .standing = shape_of(columns.standing),
                    .layout = shape_of(columns.layout),
                    .texture = {}};
  for (const vision::CellMap& scale : columns.texture) shapes.texture.push_back(shape_of(scale).value());
  return shapes;
}

std::string to_json(const ClipMetadata& metadata) {
  Json json = metadata.more;
  if (metadata.layout) json["layout"] = media::to_json(*metadata.layout);
  json["codec"] = metadata.codec;
  json["container"] = metadata.container;
  json["variable_frame_rate"] = metadata.variable_frame_rate;
  json["repairs"] = metadata.repairs;
  if (!metadata.author.empty()) json["author"] = metadata.author;
  if (!metadata.source.empty()) json["source"] = metadata.source;
  json["notices"] = metadata.notices;
  json["cells"] = json_of(metadata.cells);
  json["patches"] = metadata.patches;
  if (metadata.loop_known) json["loop"] = json_of(metadata.loop);
  if (metadata.half_life_s) json["half_life_s"] = *metadata.half_life_s;
  if (metadata.standing) json["standing"] = *metadata.standing;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

ClipMetadata metadata_of(const store::Snapshot& snapshot, store::ClipId clip) {
  const store::ClipRecord& record = snapshot.clip(clip);
  const auto fail = [&](const std::string& fault) {
    return Error(ErrorKind::kDamaged, snapshot.path().string() + ", clip \"" + record.name + "\", metadata",
                 fault, "Remove the clip (freshet store remove) and ingest it again");
  };
  try {
    return from_json(Json::parse(record.metadata));
  } catch (const Fault& fault) {
    throw fail(fault.what);
  } catch (const Json::parse_error&) {
    throw fail("they are no JSON");
  } catch (const Json::exception& fault) {
    throw fail(std::string("a field is missing or of another type: ") + fault.what());
  }
}

}  // namespace freshet::stored
