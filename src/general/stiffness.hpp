#pragma once
#include <strainwave/condition.hpp>

#include "part.hpp"

namespace strainwave::general {

/// Stiffness by any law.
template <class S>
struct Stiffness : Part {
    void read(kernel::Reader<S>& from);

    S torque(const S& twist) const;
    S twist(const S& torque) const;
    S tangent(const S& twist) const;
    S energy(const S& twist) const;
    bool is_bounded() const;
    Domain<S> domain(const S& twist) const;

    template <class Where>
    bool bounded() const {
        return is_bounded();
    }
};

}  // namespace strainwave::general
