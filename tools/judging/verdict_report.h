// tools/judging/verdict_report.h — what the critic found, for programs and for a person.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "query/labelling/assignment.h"
#include "query/labelling/shown_kind.h"
#include "synth/judging/critic.h"

namespace freshet::tools {

/// {"faults", "seconds", "kind", "words", "findings": [{"measure", "unit", "value", "usual", "fault", "place",
/// "map"}]}; a map is a list of spans of rows of cells, null where nothing is fluid; so is a value that was not
/// measured.
nlohmann::json verdict_json(const synth::judging::Verdict& verdict, const synth::judging::Evidence& film,
                            const std::string& kind);

/// One line that a person can act on: what was assumed of kind, direction, speed and what stands, what looks worst and
/// where, and the options that change each.
struct Assumed {
  query::ShownKind kind;
  bool direction_asked = false, speed_asked = false, holds = false;
};
std::string take_words(const Assumed& assumed, const synth::judging::Verdict& verdict,
                       const synth::judging::Evidence& film);

}  // namespace freshet::tools
