// The module freshet._freshet: the public headers for Python. It computes nothing itself.
#include "python/binding/binding.h"

PYBIND11_MODULE(_freshet, module) {
  using namespace freshet::python;  // NOLINT
  module.doc() = "A patch database engine for fluid video.";
  module.attr("__version__") = FRESHET_VERSION;
  bind_error(module);
  bind_store(module);
  bind_footage(module);
  bind_picture(module);
  bind_motion(module);
  bind_search(module);
  bind_label(module);
  bind_frames(module);
  bind_animate(module);
  bind_ingest(module);
  bind_flowlines(module);
  bind_scene(module);
  bind_simulate(module);
  bind_stills(module);
  bind_tour(module);
  bind_transfer(module);
  bind_sample(module);
  bind_benchmark(module);
}
