// studio/drawing/document.h — what a person has drawn over a picture and chosen for it: all that a project holds of
// them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core.hpp>

#include "studio/drawing/design.h"
#include "studio/drawing/drawn.h"
#include "studio/drawing/drawn_scene.h"
#include "studio/drawing/flowlines.h"
#include "studio/drawing/stills.h"
#include "studio/drawing/sweep.h"

namespace freshet::studio {

/// Where its clips play slower or faster, painted: a later line lies over earlier ones.
struct DrawnTempo {
  std::vector<cv::Point2f> points;
  float width = 0;   // px
  float factor = 1;  // 0.5..2
  bool operator==(const DrawnTempo&) const = default;
};

/// A piece that was given its patch by hand.
struct Pin {
  cv::Point corner;  // px, of the picture that was cut (Assignment::piece_scale)
  std::string clip;  // its name
  int variant = 0;   // index into the store's
  cv::Point patch;   // px, in the variant's frame
  bool operator==(const Pin&) const = default;
};

enum class MatteBase { kScribbles, kAlpha, kWhole, kFile };

/// Every field has a default, so that an empty document is a picture just opened.
struct Document {
  std::string store;  // its path; empty: none yet
  MatteBase matte_base = MatteBase::kScribbles;
  std::string edge = "guided";   // as `synth matte --edge`
  std::vector<Drawn> scribbles;  // from which the matte is found
  std::vector<Drawn> paint;      // laid over it as it is
  std::vector<Drawn> held;       // what stands still in front of the fluid, painted
  std::vector<DrawnStroke> strokes;
  std::vector<Drawn> directions;  // a brush along the flow; a later line lies over earlier ones
  std::vector<DrawnTempo> tempo;
  std::string class_name;  // empty: all
  std::vector<std::string> excluded_clips;
  std::vector<Pin> pins;
  int frames = 96;  // 1..2000
  double fps = 25;  // 1..240
  // Options of `synth animate`, a row of each_option for each:
  bool loop = true;
  double speed = 0;              // times as filmed; 0: as `--speed auto`
  std::string horizon = "auto";  // or "none"
  bool moving_outline = false;
  std::string layout = {};  // as --layout; empty: as in the clips
  double detail_life = 0;   // as --detail-life, s; 0: as the clips have it
  std::string flames = {};  // --method forms --flames clips; empty: no method is named
  // Of the other ways, a row of each_way for each:
  Design design = {};
  Stills stills = {};
  Flowlines flowlines = {};
  DrawnScene scene = {};
  Sweep sweep = {};
  bool operator==(const Document&) const = default;
};

/// Settings of the method that makes the frames, by their names in `synth animate`, but '_' for '-'; the command is not
/// given those that are a document's default: visit(name, field, its range or its words).
template <class Visit>
void each_method_setting(const Visit& visit) {
  visit("layout", &Document::layout, std::vector<std::string>{"", "goes", "stands"});
  visit("detail_life", &Document::detail_life, 0.0, 60.0);
}

/// What is chosen of the animation without another labelling, likewise. A document that is older than an option has its
/// default.
template <class Visit>
void each_option(const Visit& visit) {
  using Words = std::vector<std::string>;
  visit("loop", &Document::loop);
  visit("speed", &Document::speed, 0.0, 20.0);
  visit("horizon", &Document::horizon, Words{"auto", "none"});
  visit("moving_outline", &Document::moving_outline);
  visit("flames", &Document::flames, Words{"", "clips"});
  each_method_setting(visit);
}

/// What a document holds of the ways (ways/way.h): visit(the way's name, field, how it is read, how it is written).
template <class Visit>
void each_way(const Visit& visit) {
  visit("design", &Document::design, read_design, design_json);
  visit("stills", &Document::stills, read_stills, stills_json);
  visit("flowlines", &Document::flowlines, read_flowlines, flowlines_json);
  visit("scene", &Document::scene, read_scene, scene_json);
  visit("sweep", &Document::sweep, read_sweep, sweep_json);
}

/// The smallest text that says all of it, one line.
std::string to_json(const Document& document);
/// Checks everything: types, ranges, lengths, and that there is no field it does not know.
/// Throws Error{kInput} naming `where` and the field; above 16 MB, 20,000 lines or a million points too.
Document document_from_json(std::string_view json, const std::string& where);

/// What is said of the flow: the strokes, and those that the brush of direction means. picture   px.
std::vector<DrawnStroke> flow_strokes(const Document& document, cv::Size picture);
/// These as the SVG that `--strokes` reads.
std::string strokes_svg(const Document& document, cv::Size picture);
/// The scribbles as the JSON that `synth matte --marks` reads.
std::string marks_json(const Document& document);

/// Hashes of what a result depends on, so that one that is unchanged is not made again.
std::uint64_t matte_key(const Document& document);
std::uint64_t labels_key(const Document& document);
std::uint64_t frames_key(const Document& document);

}  // namespace freshet::studio
