#include "python/binding/arrays.h"

#include <cstring>
#include <memory>
#include <vector>

namespace freshet::python {
namespace {

namespace py = pybind11;

struct Depth {
  const char* name;
  int depth;
};
constexpr Depth kDepths[] = {{"uint8", CV_8U},  {"uint16", CV_16U},  {"int16", CV_16S},
                             {"int32", CV_32S}, {"float32", CV_32F}, {"float64", CV_64F}};

py::array view_of(const cv::Mat& mat, std::vector<py::ssize_t> shape) {
  const char* name = nullptr;
  for (const Depth& depth : kDepths)
    if (depth.depth == mat.depth()) name = depth.name;
  if (name == nullptr) throw py::type_error("a picture whose samples NumPy has no type for");
  const cv::Mat whole = mat.isContinuous() ? mat : mat.clone();
  const auto held = new cv::Mat(whole);
  const py::capsule owner(held, [](void* pointer) { delete static_cast<cv::Mat*>(pointer); });
  py::array array(py::dtype(name), std::move(shape), whole.data, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

std::vector<py::ssize_t> shape_of(const cv::Mat& mat) {
  std::vector<py::ssize_t> shape;
  for (int i = 0; i < mat.dims; ++i) shape.push_back(mat.size[i]);
  if (shape.empty()) shape = {0, 0};
  if (mat.channels() > 1) shape.push_back(mat.channels());
  return shape;
}

}  // namespace

py::array array_of(const cv::Mat& mat) { return view_of(mat, shape_of(mat)); }

py::array vector_of(const cv::Mat& mat) { return mat.cols == 1 ? view_of(mat, {mat.rows}) : array_of(mat); }

bool mat_from(py::handle object, cv::Mat& mat) {
  if (!py::isinstance<py::array>(object)) return false;
  const auto array = py::array::ensure(object, py::array::c_style);
  if (!array || array.ndim() < 2 || array.ndim() > 3) return false;
  const py::ssize_t channels = array.ndim() == 3 ? array.shape(2) : 1;
  if (channels < 1 || channels > 4) return false;
  for (py::ssize_t i = 0; i < 2; ++i)
    if (array.shape(i) > (1 << 30)) return false;
  for (const Depth& depth : kDepths) {
    if (!array.dtype().is(py::dtype(depth.name)) && !array.dtype().equal(py::dtype(depth.name))) continue;
    mat.create(static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)),
               CV_MAKETYPE(depth.depth, static_cast<int>(channels)));
    std::memcpy(mat.data, array.data(), static_cast<std::size_t>(array.nbytes()));
    return true;
  }
  return false;
}

}  // namespace freshet::python
