// python/binding/binding.h — what all parts of the module share: a part for each public header.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <opencv2/core.hpp>

#include "python/binding/arrays.h"

namespace freshet::python {

namespace py = pybind11;
using namespace py::literals;  // NOLINT

/// The interpreter's lock is given up for the length of a call.
using Unlocked = py::call_guard<py::gil_scoped_release>;

void bind_error(py::module_& module);
void bind_store(py::module_& module);
void bind_footage(py::module_& module);
void bind_picture(py::module_& module);
void bind_motion(py::module_& module);
void bind_search(py::module_& module);
void bind_label(py::module_& module);
void bind_frames(py::module_& module);
void bind_animate(py::module_& module);
void bind_ingest(py::module_& module);
void bind_flowlines(py::module_& module);
void bind_scene(py::module_& module);
void bind_simulate(py::module_& module);
void bind_stills(py::module_& module);
void bind_tour(py::module_& module);
void bind_transfer(py::module_& module);
void bind_sample(py::module_& module);
void bind_benchmark(py::module_& module);

}  // namespace freshet::python
