// python/binding/arrays.h — cv::Mat as a NumPy array, and back.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <opencv2/core.hpp>

namespace freshet::python {

/// A read-only array on the Mat's own samples, which it keeps alive: rows x columns, with the channels last where there
/// are several; Mats of more dimensions likewise.
pybind11::array array_of(const cv::Mat& mat);
/// One value a row: the same without the second dimension.
pybind11::array vector_of(const cv::Mat& mat);

/// A copy of an array of uint8, uint16, int16, int32, float32 or float64, of two dimensions or three; of three the last
/// are channels, 1 to 4. Nothing otherwise.
bool mat_from(pybind11::handle array, cv::Mat& mat);

}  // namespace freshet::python

namespace pybind11::detail {

/// None is an empty Mat.
template <>
struct type_caster<cv::Mat> {
  PYBIND11_TYPE_CASTER(cv::Mat, const_name("numpy.ndarray"));
  bool load(handle from, bool) {
    if (!from.is_none()) return freshet::python::mat_from(from, value);
    value.release();
    return true;
  }
  static handle cast(const cv::Mat& mat, return_value_policy, handle) {
    return freshet::python::array_of(mat).release();
  }
};

/// Sizes are (width, height), px.
template <>
struct type_caster<cv::Size> {
  PYBIND11_TYPE_CASTER(cv::Size, const_name("tuple[int, int]"));
  bool load(handle from, bool) {
    if (!isinstance<sequence>(from) || len(from) != 2) return false;
    try {
      value = {from[int_(0)].cast<int>(), from[int_(1)].cast<int>()};
    } catch (const cast_error&) {
      return false;
    }
    return true;
  }
  static handle cast(cv::Size size, return_value_policy, handle) {
    return make_tuple(size.width, size.height).release();
  }
};

}  // namespace pybind11::detail
