#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <strainwave/condition.hpp>
#include <strainwave/field.hpp>

#include <string>

/// Numbers, limits and values of Python as messages and help show them.
namespace strainwave::host {

namespace nb = nanobind;

/// The shortest text that is read as the same number.
std::string shortest(double x);
std::string with_unit(double x, const char* unit);
/// True for a number that has a unit, not for a count, a share or a part.
bool has_unit(const Field& field);
/// Limits of a field, as "[0, inf)".
std::string limits(const Field& field);
/// Message that a law is used outside its range of validity.
std::string outside(const Domain<double>& domain);
std::string text_of(nb::handle value);
/// The text of a value, shortened if it is long; a note if the value was never constructed.
std::string shortened(nb::handle value);
/// A text written in a raw string, with the indent of its source taken off.
std::string dedented(const char* text);
/// The name of the first template of `double` in the signature of a function.
const char* name_of_template(const std::string& signature);
/// Keeps a text that nanobind only points at.
const char* kept(std::string text);

}  // namespace strainwave::host
