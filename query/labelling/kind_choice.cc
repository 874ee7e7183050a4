#include "query/labelling/kind_choice.h"

#include <set>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::query {
namespace {

std::set<std::string> classes_with_patches(const store::Snapshot& snapshot, const stored::PatchTable& table) {
  std::set<std::string> names;
  for (const store::ClipId clip : table.clips) names.insert(snapshot.clip(clip).class_name);
  return names;
}

}  // namespace

KindChoice choose_kind(const store::Snapshot& snapshot, const SearchBase& base, const cv::Mat& picture,
                       const cv::Mat& matte, CandidateOptions& candidates) {
  if (picture.type() != CV_8UC3 || matte.type() != CV_8U || picture.size() != matte.size())
    throw Error(ErrorKind::kUsage, "picture and matte", "8-bit BGR and 8-bit grey of the same size expected");
  KindChoice choice{.look = vision::fluid_kind(vision::fluid_look(picture, matte))};
  const std::set<std::string> classes = classes_with_patches(snapshot, base.table);
  if (!candidates.class_name.empty() || classes.size() < 2) return choice;

  const std::string name(choice.look.name());
  const std::string seems = fmt::format("looks like {} ({:.2f})", name, choice.look.sureness());
  CandidateOptions narrowed = candidates;
  narrowed.class_name = name;
  try {
    if (!classes.contains(name)) throw Error(ErrorKind::kNotFound, name, "the store has none");
    filter_rows(snapshot, base.table, base.settings.variants(), narrowed);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kNotFound) throw;
    choice.words = fmt::format(
        "{}, and the store has no clip of it that may be taken: all classes may be mixed; "
        "--class says which to take",
        seems);
    return choice;
  }
  candidates.class_name = choice.taken = name;
  choice.words =
      choice.look.sure()
          ? fmt::format("{}: {} only; --class any for all", seems, name)
          : fmt::format("{}, unsure: {} only; --class says which it is, or any for all", seems, name);
  return choice;
}

}  // namespace freshet::query
