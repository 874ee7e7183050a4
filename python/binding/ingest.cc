#include "freshet/ingest.h"

#include "python/binding/calls.h"

namespace freshet::python {
namespace {

const char* name_of(IngestOutcome outcome) {
  switch (outcome) {
    case IngestOutcome::kAdded:
      return "added";
    case IngestOutcome::kAlreadyThere:
      return "already there";
    case IngestOutcome::kRefused:
      return "refused";
    case IngestOutcome::kFailed:
      break;
  }
  return "failed";
}

}  // namespace

void bind_ingest(py::module_& module) {
  py::class_<IngestedClip>(module, "IngestedClip", "What became of one clip.")
      .def_readonly("name", &IngestedClip::name)
      .def_property_readonly(
          "outcome", [](const IngestedClip& clip) { return name_of(clip.outcome); },
          R"("added", "already there", "refused" (by screening) or "failed".)")
      .def_readonly("reasons", &IngestedClip::reasons,
                    "list[str]: why it was not added, or what was overridden.")
      .def_readonly("frames", &IngestedClip::frames)
      .def_readonly("patches", &IngestedClip::patches);
  module.def(
      "ingest",
      [](const std::filesystem::path& store, const std::vector<std::filesystem::path>& paths,
         const std::string& class_name, const std::string& licence, bool force, const py::object& progress) {
        const IngestOptions options{.class_name = class_name, .licence = licence, .force = force};
        IngestReport report =
            run_for(progress, [&](const Job& job) { return add_clips(store, paths, options, job); });
        if (report.stopped) throw Error(*report.stopped);
        return report.clips;
      },
      "store"_a, "paths"_a, py::kw_only(), "class_name"_a = IngestOptions{}.class_name,
      "licence"_a = IngestOptions{}.licence, "force"_a = IngestOptions{}.force, "progress"_a = py::none(),
      R"(Adds all clips below some paths to a store, and indexes it: list[IngestedClip]. A missing store is made.

paths       Videos, or folders of them, searched to any depth.
class_name  Of all clips; "": the name of the folder that each lies in.
licence     Of all clips, free text; kept with every use of them.
force       Take each clip whole, also where screening refuses it (moving camera, cuts, too short).
progress    Called with (clip, frames, of).

Each clip is one transaction: after an exception or Ctrl-C those before are kept, and the same call goes on. Costs
some 14 frames of 1280 x 720 a second on two cores.)");
}

}  // namespace freshet::python
