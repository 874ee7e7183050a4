#include "media/frame/layout_json.h"

namespace freshet::media {

nlohmann::json to_json(const PixelLayout& layout) {
  return {{"format", layout.format},     {"width", layout.width},       {"height", layout.height},
          {"range", layout.range},       {"matrix", layout.matrix},     {"primaries", layout.primaries},
          {"transfer", layout.transfer}, {"rotation", layout.rotation}, {"sar_num", layout.sar_num},
          {"sar_den", layout.sar_den}};
}

std::optional<PixelLayout> layout_from_json(const nlohmann::json& json) {
  constexpr int kMaxSide = 1 << 16;
  try {
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
    if (layout.width < 1 || layout.height < 1 || layout.width > kMaxSide || layout.height > kMaxSide)
      return std::nullopt;
    return layout;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

}  // namespace freshet::media
