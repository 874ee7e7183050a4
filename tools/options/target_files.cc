#include "tools/options/target_files.h"

#include <utility>

#include "freshet/error.h"
#include "store/signature.h"
#include "store/store_list.h"
#include "tools/options/starter_option.h"
#include "vision/look/bars.h"

namespace freshet::tools {

std::string fault_of_key(const std::string& key) {
  return key.empty() ? "an empty key would be anybody's. Give the maker's, or leave the option out" : "";
}

void TargetFiles::add_to(CLI::App& command) {
  command.add_option(
      "STORE", store,
      "The store file, or a list of stores (NAME.stores, a name a line) that are searched as one [the "
      "starter store, which Freshet makes itself, once]");
  command.add_option("PICTURE", picture, "REQUIRED. The still picture (PNG, JPEG, TIFF, ...)");
  command.add_option("--store", added, "Additional store, searched together with STORE; repeatable [none]")
      ->allow_extra_args(false);
  command
      .add_option(
          "--signed-by", signed_by,
          "Public key of minisign, or its file: only stores that it signed (STORE.minisig) are read [any]")
      ->check(fault_of_key);
  CLI::Option* given = command.add_option("--matte", matte,
                                          "Grey picture, white where the fluid is [the picture's own alpha]");
  command.add_flag("--whole", whole, kWholeHelp)->excludes(given);
}

store::Snapshot TargetFiles::open_store(const RunContext& context) {
  if (picture.empty()) {  // not while the command line is read: a file of options may name both
    if (store.empty() || is_store(store)) throw CLI::RequiredError("PICTURE");
    picture = std::exchange(store, "");
  }
  if (store.empty() && added.empty()) {
    // First what costs nothing to find out.
    if (!std::filesystem::exists(picture))
      throw Error(ErrorKind::kInput, picture.string(), "there is no such file", "Check the name");
    store = starter_store(context).string();
  }
  std::vector<std::filesystem::path> stores = added;
  if (!store.empty()) stores.insert(stores.begin(), store);
  if (!signed_by.empty())
    for (const std::filesystem::path& each : stores)
      for (const std::filesystem::path& file : store::stores_named(each))
        store::expect_signed(file, signed_by);
  return store::Store::open_read(stores).snapshot();
}

TargetFiles::Loaded TargetFiles::load() const {
  Loaded loaded{.picture = {}, .matte = {}, .still = media::read_still(picture)};
  for (const std::string& notice : loaded.still.notices) say(picture.string() + ": " + notice);
  loaded.picture = loaded.still.bgr;
  media::Matte read;
  if (!matte.empty()) {
    read = media::read_matte(matte, loaded.picture.size());
    for (const std::string& notice : read.notices) say(matte.string() + ": " + notice);
    if (!loaded.still.alpha.empty()) say(picture.string() + ": alpha channel ignored, as there is a matte");
  } else if (!loaded.still.alpha.empty() && !whole) {
    read = media::matte_of_alpha(loaded.still.alpha, picture);
    say(picture.string() + ": its alpha channel is the matte");
    for (const std::string& notice : read.notices) say(picture.string() + ": " + notice);
  }
  loaded.matte_known = whole || !read.alpha.empty();
  loaded.matte = read.alpha.empty() ? vision::matte_within_bars(loaded.picture) : read.alpha;
  if (read.alpha.empty() && cv::countNonZero(loaded.matte == 0) > 0)
    say(picture.string() + ": the black bars at its sides are no fluid");
  return loaded;
}

TargetFiles::Loaded TargetFiles::load_with_matte() const {
  Loaded loaded = load();
  if (!loaded.matte_known)
    throw Error(
        ErrorKind::kUsage, picture.string(), "nothing says where its fluid is",
        "Give --matte (freshet synth matte makes one from a few strokes), a picture with alpha, or --whole "
        "where all of it moves");
  return loaded;
}

void say_reduction(const TargetFiles& target, const TargetFiles::Loaded& loaded) {
  if (!loaded.still.reduction.empty()) say(target.picture.string() + ": " + loaded.still.reduction);
}

}  // namespace freshet::tools
