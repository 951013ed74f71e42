#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstdint>
#include <memory>
#include <new>
#include <vector>

/// Arrays that Python owns.
namespace strainwave::host {

namespace nb = nanobind;
/// An array for Python's type checkers.
#define SW_ARRAY "numpy.typing.NDArray[numpy.float64]"
using Values = nb::ndarray<nb::numpy, double, nb::c_contig>;
using Numbers = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Flags = nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// Memory for so many numbers, not yet filled; or a MemoryError that contains their count.
template <class T = double>
std::unique_ptr<T[]> room(std::size_t size) {
    std::unique_ptr<T[]> numbers(new (std::nothrow) T[size + 1]);
    if (numbers) return numbers;
    PyErr_Format(PyExc_MemoryError, "there is no memory for %zu numbers, which need %zu MB; use fewer at a time", size,
                 size / 1000000 * sizeof(T));
    throw nb::python_error();
}

/// An array that Python owns, not yet filled.
template <class T = double>
nb::ndarray<nb::numpy, T, nb::c_contig> array(const std::vector<std::size_t>& shape) {
    std::size_t size = 1;
    for (std::size_t n : shape) size *= n;
    auto* const data = room<T>(size).release();
    nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<T*>(p); });
    return {data, shape.size(), shape.data(), owner};
}

}  // namespace strainwave::host
