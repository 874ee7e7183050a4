#include "freshet/label.h"

#include "python/binding/calls.h"

namespace freshet::python {

void bind_label(py::module_& module) {
  py::class_<UsedClip>(module, "UsedClip", "A clip that a labelling takes patches from, to be credited.")
      .def_readonly("name", &UsedClip::name)
      .def_readonly("class_name", &UsedClip::class_name)
      .def_readonly("licence", &UsedClip::licence)
      .def_readonly("pieces", &UsedClip::pieces);
  py::class_<Labelling>(module, "Labelling",
                        "One patch chosen for each piece of a search. Keeps its store open.")
      .def_property_readonly("search", &Labelling::search)
      .def("__len__", [](const Labelling& labelling) { return labelling.search().pieces(); })
      .def(
          "chosen",
          [](const Labelling& labelling, std::size_t piece) {
            if (piece >= labelling.search().pieces()) throw py::index_error("no such piece");
            return labelling.chosen(piece);
          },
          "piece"_a, "The Candidate of one piece.")
      .def_property_readonly(
          "patches", [](const Labelling& labelling) { return vector_of(labelling.patches()); },
          "(pieces,), int32: the patch of each piece, numbered through the store (Store.first_patches).")
      .def_property_readonly("clips", &Labelling::clips, "list[UsedClip], in order of their first piece.")
      .def_property_readonly("energy", &Labelling::energy)
      .def_property_readonly("gap", &Labelling::gap,
                             "How far the energy can be above the lowest, as a fraction of it; 0.01 is good.")
      .def("write", &Labelling::write, "path"_a, "As JSON, for `freshet synth animate --assignment`.",
           Unlocked());
  static const LabelOptions kDefault;
  module.def(
      "label",
      [](const Search& search, double lambda, int max_iterations, const py::object& progress) {
        return run_for(progress, [&](const Job& job) {
          return freshet::label(search, {.lambda = lambda, .max_iterations = max_iterations}, job);
        });
      },
      "search"_a, py::kw_only(), "lambda_"_a = kDefault.lambda, "max_iterations"_a = kDefault.max_iterations,
      "progress"_a = py::none(),
      R"(Chooses among the candidates of a search, so that neighbours go together.

lambda_         Weight of neighbours against likeness; 0: each piece takes what it is most like.
max_iterations  Passes of the solver (TRW-S), at most.)");
}

}  // namespace freshet::python
