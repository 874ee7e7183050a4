#include "freshet/error.h"

#include <exception>

#include "python/binding/binding.h"

namespace freshet::python {
namespace {

const char* name_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return "usage";
    case ErrorKind::kInput:
      return "input";
    case ErrorKind::kIo:
      return "io";
    case ErrorKind::kDamaged:
      return "damaged";
    case ErrorKind::kNotFound:
      return "not_found";
    case ErrorKind::kCancelled:
      break;
  }
  return "cancelled";
}

PyObject* error_type = nullptr;  // as long as the module, which is never unloaded

}  // namespace

void bind_error(py::module_& module) {
  error_type = PyErr_NewExceptionWithDoc("freshet.Error", R"(What a file, a user or a machine can cause.

str() reads "WHERE: FAULT. REMEDY". `kind` is "usage", "input", "io", "damaged", "not_found" or "cancelled".)",
                                         PyExc_RuntimeError, nullptr);
  if (error_type == nullptr) throw py::error_already_set();
  module.add_object("Error", error_type);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      py::object raised = py::handle(error_type)(error.what());
      raised.attr("kind") = name_of(error.kind());
      PyErr_SetObject(error_type, raised.ptr());
    }
  });
}

}  // namespace freshet::python
