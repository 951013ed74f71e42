#pragma once
#include <strainwave/angle.hpp>

/// How the stiffness of a spring in a gear changes as its wave generator turns. Such a law has
///
///     active()         whether it changes at all; if not, it is not evaluated
///     at(angle)        -> Factor
///     largest()        the most that the factor becomes
namespace strainwave::variation {

/// What a stiffness is multiplied by, and how that changes with the angle [1/rad].
template <class S>
struct Factor {
    S value{1.0};
    S slope{0.0};
};

}  // namespace strainwave::variation
