#include "query/labelling/shown_kind.h"

#include "query/labelling/shares.h"

namespace freshet::query {

ShownKind shown_kind(const std::string& asked_class, const KindChoice& choice, const Assignment& assignment) {
  if (!choice.taken.empty()) return {.name = choice.taken, .seen = true, .sure = choice.look.sure()};
  if (!asked_class.empty() && asked_class != kAnyClass) return {.name = asked_class, .asked = true};
  const LargestClass most = largest_class(assignment);
  return {.name = most.name, .share = most.share};
}

}  // namespace freshet::query
