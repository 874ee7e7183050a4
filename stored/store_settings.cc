#include "stored/store_settings.h"

#include "freshet/error.h"

namespace freshet::stored {

vision::Settings settings_of(const store::Snapshot& snapshot) {
  try {
    return vision::settings_from_json(snapshot.settings());
  } catch (const Error& fault) {
    std::string what = fault.what();
    what.pop_back();  // the full stop, which an error adds
    throw Error(fault.kind(), snapshot.path().string(), what,
                "Make the store again, or restore it from a copy");
  }
}

}  // namespace freshet::stored
