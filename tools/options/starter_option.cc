#include "tools/options/starter_option.h"

#include <fmt/format.h>

#include "freshet/error.h"
#include "starter/starter_store.h"
#include "store/store.h"
#include "tools/console/progress.h"
#include "tools/options/cache_options.h"

namespace freshet::tools {

std::filesystem::path starter_store(const RunContext& context) {
  const starter::Recipe recipe = starter::own_recipe();
  const std::filesystem::path path =
      starter::kept_name(user_cache_folder("the starter store", "Name a store"), recipe);
  if (!std::filesystem::exists(path)) {
    say(fmt::format("no store was given: making the starter store, once ({})", path.string()));
    Progress progress;
    starter::make_store(path, recipe, {.progress = progress.callback(), .stop = context.stop});
    progress.finish();
  }
  return path;
}

bool is_store(const std::filesystem::path& path) {
  try {
    store::Store::open_read(path);
    return true;
  } catch (const Error& fault) {
    if (fault.kind() == ErrorKind::kDamaged) throw;
    return false;
  }
}

}  // namespace freshet::tools
