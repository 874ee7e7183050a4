// studio/dropped_files.h — files that were given to a project: beside each other in a folder of it, under plain names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace freshet::studio {

/// A folder of a project, and which files it takes.
struct DroppedFiles {
  std::filesystem::path project;                           // the project's folder
  std::filesystem::path within;                            // from there: "ways/stills/pictures"
  bool (*wanted)(const std::filesystem::path&) = nullptr;  // by its name

  bool takes(const std::string& name) const { return wanted(name); }
  /// Throws Error{kIo} where a link leads out of the project.
  std::filesystem::path folder() const;
  /// In order; empty where there are none.
  std::vector<std::string> names() const;
  /// file   moved there; one of the same bytes and name is there once. name   as a person called it; takes() it.
  /// Returns the plain name that was made of it. Throws Error{kIo}.
  std::string keep(const std::filesystem::path& file, const std::string& name) const;
};

}  // namespace freshet::studio
