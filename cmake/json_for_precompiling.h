// cmake/json_for_precompiling: nlohmann/json.hpp for a precompiled header, without the bodies of its two literals.
#pragma once

// GCC instantiates anew, in every unit that uses a precompiled header, what the inline functions in it call; the
// literal ""_json calls the whole parser: .4 s for each of 1,000 units. Here the bodies become those of templates that
// nobody calls. Nothing of ours uses the literals; a unit that did would not link.
#define _json(text, size) \
  _json(text, size);      \
  template <class>        \
  nlohmann::json unused_json_literal(text, size)
#define _json_pointer(text, size) \
  _json_pointer(text, size);      \
  template <class>                \
  nlohmann::json::json_pointer unused_json_pointer_literal(text, size)
#include <nlohmann/json.hpp>
#undef _json
#undef _json_pointer
