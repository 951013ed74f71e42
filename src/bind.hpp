#pragma once
#include "members.hpp"

/// One function binds every described struct as a frozen value: keyword constructor, properties, checks, repr, equality, help.
namespace strainwave::host {

/// No subclass is possible: compiled code would not call a method that Python overrides.
template <class M>
nb::class_<M> bind(nb::handle scope, const char* python_name, const std::string& name) {
    static_assert(fully_described<M>, "every member needs a Field");
    const Description& description = describe<M>(python_name, name);
    auto type = nb::class_<M>(scope, python_name, nb::is_final(), kept(documentation(description)));
    define_value(type, description);
    return type;
}

}  // namespace strainwave::host
