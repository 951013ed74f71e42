#pragma once
#include <strainwave/angle.hpp>

/// Interface of a variation of stiffness over the angle of the wave generator. Such a law has
///
///     active()         whether it changes at all; if not, it is not evaluated
///     at(angle)        -> Factor
///     largest()        the most that the factor becomes
namespace strainwave::variation {

/// Factor of a stiffness, and its slope over the angle [1/rad].
template <class S>
struct Factor {
    S value{1.0};
    S slope{0.0};
};

}  // namespace strainwave::variation
