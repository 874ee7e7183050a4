// studio/ways/way.h — another way to synthesise, as files and the command lines that make a film of them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core.hpp>

#include "studio/drawing/document.h"
#include "studio/drawing/recipe.h"
#include "studio/ways/way_file.h"

namespace freshet::studio {

/// What is run, one after another, in the project's folder; all that it reads and leaves lies in PROJECT/ways/FOLDER.
struct WayPlan {
  std::string folder = {};
  std::vector<std::vector<std::string>> commands = {};  // without the program's name
  std::string film = {};    // MP4 that the last one leaves, from the project's folder; "": none
  std::string fluid = {};   // what that one leaves of the fluid alone, with alpha; "": nothing
  bool layers = false;      // it can leave its layers in one file a frame (--layers-out)
  std::string answer = {};  // file of the way's folder that takes what the last one prints, JSON
  std::vector<std::string> shown =
      {};                  // files of the way's folder that a page may look at: .png, .html, .svg, .mp4
  std::string store = {};  // that the commands read, as the document names it; "": none
  bool animates = false;   // it reads what a preview leaves: the matte, and pieces that were pinned
};

/// What a way's files are made of.
struct WayInput {
  const Document& document;
  const cv::Mat& picture;             // CV_8UC3, the project's
  const RecipeFiles& files;           // what lies in the project's folder
  std::filesystem::path folder = {};  // that one; empty: films that other ways have made are not looked at
};

/// One way to synthesise; what a document says of it is a part of the same name (drawing/document.cc).
/// Both functions throw Error{kUsage} where what was drawn is too little, saying what is missing.
struct Way {
  std::string_view name;
  WayPlan (*plan)(const Document&);
  std::vector<WayFile> (*files)(const WayInput&);  // written into the folder before
};

/// Throws Error{kNotFound} for no way's name.
const Way& way_of(std::string_view name);

}  // namespace freshet::studio
