// tools/options/target_files.h — the picture that is animated, and where its fluid is.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

#include "media/picture/picture.h"
#include "store/store.h"
#include "tools/console/run_context.h"

namespace freshet::tools {

/// What is wrong with the key of --signed-by: it is empty, as of a variable that is not set. Empty when nothing is.
std::string fault_of_key(const std::string& key);

/// Of --whole.
inline constexpr const char* kWholeHelp =
    "All of the picture is fluid, but for black bars at its sides [off]";

/// What is searched for: a picture and where its fluid is.
struct TargetFiles {
  std::string store;                         // empty: the starter store
  std::vector<std::filesystem::path> added;  // stores that are searched with it as one
  std::filesystem::path picture, matte;
  std::string signed_by;  // public key of the stores' maker; empty: anybody's

  bool whole = false;  // kWholeHelp, whatever its alpha says

  /// STORE, PICTURE, --store, --signed-by, --matte, --whole. One name alone is the picture. This must outlive the
  /// command.
  void add_to(CLI::App& command);
  /// Opens the stores; the starter store, from then on in `store`, where none was given. To be called before what needs
  /// the picture. Throws CLI::RequiredError when there is none.
  store::Snapshot open_store(const RunContext& context);
  struct Loaded {
    cv::Mat picture, matte;  // CV_8UC3, CV_8U
    cv::Mat whole_matte{};   // before HoldOptions::take_out; empty: nothing was taken out
    media::Still still;      // with all that the file holds
    bool matte_known = false;

    /// The fluid that tells the class (LabelRequest::looked_at).
    const cv::Mat& looked_at() const { return whole_matte.empty() ? matte : whole_matte; }
  };
  /// Reads both; says what had to be changed about them. Without a matte the picture's alpha is it; without that
  /// the whole picture is fluid, less black bars at its sides (vision::within_bars).
  Loaded load() const;
  /// The same for what is rendered: throws Error{kUsage} where nobody says where the fluid is.
  Loaded load_with_matte() const;
};

/// Says that bits were lost, for commands that use eight of them.
void say_reduction(const TargetFiles& target, const TargetFiles::Loaded& loaded);

}  // namespace freshet::tools
