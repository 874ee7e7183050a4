#include "freshet/picture.h"

#include "python/binding/calls.h"

namespace freshet::python {

void bind_picture(py::module_& module) {
  py::class_<Picture>(module, "Picture", "A still picture.")
      .def_readonly("bgr", &Picture::bgr, "(height, width, 3), uint8, sRGB: what is searched with.")
      .def_readonly("deep", &Picture::deep,
                    "The same with all of its bits: uint16, sRGB, or float32, linear light. Empty: it has 8.")
      .def_readonly("notices", &Picture::notices);
  py::class_<Matte>(module, "Matte", "Where the fluid is.")
      .def_readonly("alpha", &Matte::alpha, "(height, width), uint8, 255 where the fluid is.")
      .def_readonly("notices", &Matte::notices);
  module.def("read_picture", &read_picture, "path"_a, "PNG, JPEG, TIFF, EXR, ..., upright.", Unlocked());
  module.def("read_matte", &read_matte, "path"_a, "size"_a,
             "A grey picture, white where the fluid is. size: (width, height) of its picture, px.",
             Unlocked());
  py::class_<VideoWriter>(module, "VideoWriter", R"(A video chosen by its ending, for `with`.

.mp4 (H.264), .mkv (FFV1, lossless), .mov (ProRes 4444), .webp, .apng, or a numbered sequence (frames/%05d.png). A file
appears when it is whole: at finish(), or at the end of a `with` that nothing was raised in.)")
      .def(py::init([](const std::filesystem::path& path, cv::Size size, int frames, double fps) {
             return std::make_unique<VideoWriter>(path, size, VideoOptions{.frames = frames, .fps = fps});
           }),
           "path"_a, "size"_a, py::kw_only(), "frames"_a = VideoOptions{}.frames,
           "fps"_a = VideoOptions{}.fps, "size: (width, height), px. frames: how many will be written.")
      .def("write", &VideoWriter::write, "frame"_a,
           "(height, width, 3) BGR or with alpha 4, or grey; uint8, uint16 or, for .exr, float32.",
           Unlocked())
      .def("finish", &VideoWriter::finish, Unlocked())
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__", [](VideoWriter& writer, const py::object& type, const py::object&, const py::object&) {
        if (type.is_none()) writer.finish();
      });
}

}  // namespace freshet::python
