#include "media/frame/layout_json.h"

#include <nlohmann/json.hpp>

#include "freshet/error.h"

namespace freshet::media {

std::string to_json(const PixelLayout& layout) {
  return nlohmann::json{{"format", layout.format},     {"width", layout.width},
                        {"height", layout.height},     {"range", layout.range},
                        {"matrix", layout.matrix},     {"primaries", layout.primaries},
                        {"transfer", layout.transfer}, {"rotation", layout.rotation},
                        {"sar_num", layout.sar_num},   {"sar_den", layout.sar_den}}
      .dump();
}

PixelLayout layout_from_json(const std::string& metadata) {
  try {
    const nlohmann::json json = nlohmann::json::parse(metadata).at("layout");
    PixelLayout layout;
    json.at("format").get_to(layout.format);
    json.at("width").get_to(layout.width);
    json.at("height").get_to(layout.height);
    json.at("range").get_to(layout.range);
    json.at("matrix").get_to(layout.matrix);
    json.at("primaries").get_to(layout.primaries);
    json.at("transfer").get_to(layout.transfer);
    json.at("rotation").get_to(layout.rotation);
    json.at("sar_num").get_to(layout.sar_num);
    json.at("sar_den").get_to(layout.sar_den);
    if (layout.width < 1 || layout.height < 1 || layout.width > (1 << 16) || layout.height > (1 << 16))
      throw Error(ErrorKind::kDamaged, "clip metadata", "the layout's size is out of range",
                  "Run freshet store verify");
    return layout;
  } catch (const nlohmann::json::exception& fault) {
    throw Error(ErrorKind::kDamaged, "clip metadata",
                std::string("no layout can be read from it: ") + fault.what(), "Run freshet store verify");
  }
}

}  // namespace freshet::media
