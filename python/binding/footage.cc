#include "freshet/footage.h"

#include "python/binding/calls.h"

namespace freshet::python {
namespace {

using Range = std::optional<std::uint32_t>;

std::uint32_t count_of(const Footage& footage, std::uint32_t first, Range count, std::uint32_t less) {
  const std::uint32_t there = footage.clip().frames - less;
  return count.value_or(first < there ? there - first : 0);
}

// A method of `first` and `count` frames.
template <auto Read, std::uint32_t Less = 0>
auto read_frames(const Footage& footage, std::uint32_t first, Range count) {
  return run_for(py::none(),
                 [&](const Job&) { return (footage.*Read)(first, count_of(footage, first, count, Less)); });
}

}  // namespace

void bind_footage(py::module_& module) {
  py::class_<PatchVariant>(module, "PatchVariant", "One way to look at clips: scaled, turned, then flipped.")
      .def_readonly("scale", &PatchVariant::scale)
      .def_readonly("rotation_deg", &PatchVariant::rotation_deg, "Degrees, counter-clockwise as seen.")
      .def_readonly("flip", &PatchVariant::flip, "Left to right.")
      .def("__repr__", [](const PatchVariant& variant) {
        return py::str("<freshet.PatchVariant scale {}, {} degrees{}>")
            .format(variant.scale, variant.rotation_deg, variant.flip ? ", flipped" : "");
      });
  py::class_<Footage>(module, "Footage",
                      R"(What a store keeps of one clip: Footage(store, clip), or store[clip].

Arrays are read-only and own what they show: they outlive footage and store. Frames and columns are coded in the store,
so each call decodes; nothing is copied after that. `first` and `count` are frames; without a count all that follow.)")
      .def(py::init<const Store&, const std::string&>(), "store"_a, "clip"_a, Unlocked())
      .def_property_readonly("clip", &Footage::clip)
      .def_property_readonly("pixel_format", &Footage::pixel_format, "FFmpeg's name: yuv420p, ...")
      .def_property_readonly("flow_step", &Footage::flow_step,
                             "px of the frame from a value of flow to the next.")
      .def("planes", &read_frames<&Footage::planes>, "first"_a = 0, "count"_a = py::none(),
           "list of (count, rows, columns), uint8 or uint16: the planes as they were decoded, to the bit.")
      .def("bgr", &read_frames<&Footage::bgr>, "first"_a = 0, "count"_a = py::none(),
           "(count, height, width, 3), uint8: frames as a player shows them, blue first.")
      .def("luma", &read_frames<&Footage::luma>, "first"_a = 0, "count"_a = py::none(),
           "(count, height, width), uint8: luminance, full range.")
      .def("flow", &read_frames<&Footage::flow, 1>, "first"_a = 0, "count"_a = py::none(),
           R"((count, rows, columns, 2), float32: px of the frame to the next frame, x right, y down.

A value for each `flow_step` px both ways; one field less than there are frames.)")
      .def("average", &Footage::average, "(height, width), uint8: mean luminance over time.", Unlocked())
      .def_property_readonly("columns", &Footage::columns, "list[str]: names for column().")
      .def(
          "column",
          [](const Footage& footage, const std::string& name) {
            return vector_of(run_for(py::none(), [&](const Job&) { return footage.column(name); }));
          },
          "name"_a,
          R"((rows,) or (rows, values): a row for each frame, pair of frames, or patch.

frame.time (s), flow.rate (pairs a second), patch.variant, patch.x and patch.y (px, upper left corner in the variant's
frame), patch.motion (px/s, x right, y down), patch.coverage (0 to 1), patch.words (81 visual words; with an index).)")
      .def_property_readonly("cell_maps", &Footage::cell_maps, "list[str]: names for cells().")
      .def("cells", &Footage::cells, "name"_a,
           "(rows, columns, values), float32: what was measured in square cells of the frame.", Unlocked());
}

}  // namespace freshet::python
