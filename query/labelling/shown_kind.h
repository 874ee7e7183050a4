// query/labelling/shown_kind.h — what an animation shows: its class, for the norms of speed and look.
#pragma once

#include <string>

#include "query/labelling/assignment.h"
#include "query/labelling/kind_choice.h"

namespace freshet::query {

/// The class asked or taken by its look, or that of most pieces.
struct ShownKind {
  std::string name;
  double share = 1;  // of the pieces
  bool asked = false, seen = false;
  bool sure = true;  // what is seen
};
ShownKind shown_kind(const std::string& asked_class, const KindChoice& choice, const Assignment& assignment);

}  // namespace freshet::query
