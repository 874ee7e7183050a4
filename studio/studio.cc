#include "studio/studio.h"

#include <nlohmann/json.hpp>

#include "media/frame/file_format.h"
#include "studio/drawing/drawn.h"
#include "synth/scene/scene_file.h"
#include "synth/stills/edits.h"

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

/// What an export can be: rows of the table of endings that are offered.
Json offered_formats() {
  Json formats = Json::array();
  for (const media::FileFormat& each : media::file_formats()) {
    if (each.name.empty()) continue;
    Json depths = Json::array();
    for (const media::Depth depth : media::kDepths)
      if (each.depths.has(depth)) depths.push_back(to_string(depth));
    formats.push_back({{"ending", each.ending},
                       {"name", each.name},
                       {"use", each.use},
                       {"alpha", each.alpha},
                       {"sequence", each.kind == media::FormatKind::kPicture},
                       {"depths", depths}});
  }
  return formats;
}

}  // namespace

Studio::Studio(const StudioOptions& options)
    : folder_(options.folder),
      stores_(folder_, jobs_, options.stores, options.program),
      projects_(folder_, jobs_, stores_),
      ways_(folder_, jobs_, stores_, projects_, options.program) {}

Studio::~Studio() { jobs_.end(); }

std::string Studio::home_json() const {
  Json stores = Json::array();
  for (const std::shared_ptr<OpenedStore>& store : stores_.all())
    stores.push_back(Json::parse(store->to_json()));
  Json ranges = Json::object();
  for (const synth::scene::SceneRange& each : synth::scene::scene_ranges())
    ranges[each.table + "." + each.key] = {each.slider.low, each.slider.high};
  Json films = Json::array();
  for (const media::FileFormat& each : media::file_formats())
    if (media::looks_like_video("film" + std::string(each.ending))) films.push_back(each.ending);
  return json_text({{"projects", projects_.list()},
                    {"stores", stores},
                    {"folder", folder_.path().string()},
                    {"formats", offered_formats()},
                    {"films", films},
                    {"ranges", ranges},
                    {"pin_reach", synth::stills::kPinReach},
                    {"furthest", kFurthest},
                    {"widest", kWidest}});
}

}  // namespace freshet::studio
