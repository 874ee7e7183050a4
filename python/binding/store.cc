#include "freshet/store.h"

#include "freshet/footage.h"
#include "python/binding/calls.h"

namespace freshet::python {

void bind_store(py::module_& module) {
  py::class_<Clip>(module, "Clip", "What is known of a clip without reading it.")
      .def_readonly("name", &Clip::name, "Path below the folder that was ingested; unique in a store.")
      .def_readonly("class_name", &Clip::class_name, "water, fire, ...")
      .def_readonly("licence", &Clip::licence, "Free text; may be empty.")
      .def_readonly("width", &Clip::width, "px")
      .def_readonly("height", &Clip::height, "px")
      .def_readonly("frames", &Clip::frames)
      .def_readonly("fps", &Clip::fps, "Frames per second, average.")
      .def_readonly("patches", &Clip::patches)
      .def("__repr__", [](const Clip& clip) {
        return py::str("<freshet.Clip {} {}x{}, {} frames, {} patches>")
            .format(clip.name, clip.width, clip.height, clip.frames, clip.patches);
      });
  py::class_<Store>(module, "Store", R"(A store as it was when it was opened.

Store(path) needs no write permission. Clips that are added later are not seen. Safe from many threads. What is read
from a store keeps it open.)")
      .def(py::init<const std::filesystem::path&>(), "path"_a, Unlocked())
      .def_property_readonly("path", &Store::path)
      .def_property_readonly("clips", &Store::clips, "list[Clip], in the order in which they were added.")
      .def_property_readonly(
          "first_patches", [](const Store& store) { return py::array(py::cast(store.first_patches())); },
          R"(int64, clips + 1: the number of each clip's first patch, and of all patches at the end.

Searches number patches through the store. Patch p belongs to clip
`numpy.searchsorted(store.first_patches, p, "right") - 1`.)")
      .def_property_readonly("variants", &variants,
                             "list[PatchVariant]: what the values of the column patch.variant number.")
      .def("__len__", [](const Store& store) { return store.clips().size(); })
      .def(
          "__getitem__", [](const Store& store, const std::string& name) { return Footage(store, name); },
          "clip"_a, "The Footage of a clip by its name.", Unlocked())
      .def(
          "digest",
          [](const Store& store) { return run_for(py::none(), [&](const Job&) { return store.digest(); }); },
          "One hash (32 hex digits) of all content, whatever the order of the clips. Reads everything.")
      .def(
          "verify",
          [](const Store& store) { return run_for(py::none(), [&](const Job&) { return store.verify(); }); },
          "Reads everything. list[str]: a line for each damaged record; empty when all is well.");
}

}  // namespace freshet::python
