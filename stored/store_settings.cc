#include "stored/store_settings.h"

#include "freshet/error.h"

namespace freshet::stored {

vision::Settings settings_of(const store::Snapshot& snapshot) {
  try {
    return vision::settings_from_json(snapshot.settings());
  } catch (const Error& fault) {
    throw Error(fault.kind(), snapshot.path().string(), fault.what(), "Restore the file from a copy");
  }
}

}  // namespace freshet::stored
