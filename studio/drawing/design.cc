#include "studio/drawing/design.h"

#include <nlohmann/json.hpp>

#include "media/frame/filmed_ground.h"
#include "studio/drawing/fields.h"

namespace freshet::studio {

using Json = nlohmann::json;

Design read_design(const Fields& fields) {
  fields.only({"fluid", "sources", "winds", "look", "ground", "frames", "full"});
  Design design{.fluid = fields.text("fluid"),
                .sources = fields.drawn("sources"),
                .winds = fields.strokes("winds"),
                .look = fields.text("look"),
                .ground = fields.word("ground", media::ground_names()),
                .frames = fields.integer("frames", 1, 500),
                .full = fields.flag("full")};
  if (design.fluid != "smoke" && design.fluid != "fire" && design.fluid != "water")
    fields.fail("\"fluid\" is none of smoke, fire, water");
  if (design.look.starts_with('-')) fields.fail("\"look\" is no clip's name");
  return design;
}

Json design_json(const Design& design) {
  return {{"fluid", design.fluid},
          {"sources", drawn_json(design.sources)},
          {"winds", strokes_json(design.winds)},
          {"look", design.look},
          {"ground", design.ground},
          {"frames", design.frames},
          {"full", design.full}};
}

}  // namespace freshet::studio
