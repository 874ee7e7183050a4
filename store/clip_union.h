// store/clip_union.h — which clips of several stores are one set, whether these are merged or read together.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "store/format/clip.h"

namespace freshet::store {

/// Of clips from the same source the first is taken.
class ClipUnion {
 public:
  struct Taken {
    std::string name;
    std::filesystem::path store;
  };
  /// Throws Error{kInput} when the settings of a store are not those of the first.
  void expect_settings(const std::filesystem::path& store, const std::string& settings);
  /// Takes a clip, or returns the one from the same source that was taken before.
  /// Throws Error{kInput} when one of the same name comes from another source.
  const Taken* add(const std::filesystem::path& store, const ClipRecord& clip);

 private:
  std::filesystem::path first_;  // store
  std::string settings_;
  std::map<std::string, Taken, std::less<>> by_source_;
  std::map<std::string, std::filesystem::path, std::less<>> store_of_name_;
};

}  // namespace freshet::store
