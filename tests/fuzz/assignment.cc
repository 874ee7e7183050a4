// Assignments: what is read is written and read the same again.

#include "query/labelling/assignment.h"
#include "tests/fuzz/fuzz.h"

using namespace freshet;

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::allow_errors([&] {
    const query::Assignment read = query::assignment_from_json(fuzz::text_of({bytes, size}), "fuzzed");
    const query::Assignment again = query::assignment_from_json(query::to_json(read), "again");
    fuzz::expect(query::to_json(again) == query::to_json(read), "an assignment is written the same again");
  });
  return 0;
}
