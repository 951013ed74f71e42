#pragma once
#include <strainwave/kinematics.hpp>
#include <strainwave/math.hpp>

/// Facts of a gear that more than one of its parts contains, so that each can be used alone.
namespace strainwave::facts {

/// Value that `known` reads of a part, or else of its inner law or springs; for a choice, of the chosen part.
template <class Fact, class Part, class Known>
constexpr Fact of(const Part& part, const Known& known) {
    if constexpr (requires { known(part); })
        return known(part);
    else if constexpr (requires { part.model; })
        return part.visit([&](const auto& chosen) { return of<Fact>(chosen, known); });
    else if constexpr (requires { part.law; })
        return of<Fact>(part.law, known);
    else if constexpr (requires { part.springs; })
        return of<Fact>(part.springs, known);
    else
        return Fact{};
}

/// The reduction of a spring, which is the ratio without its sign; 0 if it has none.
template <class S, class Spring>
constexpr S reduction(const Spring& spring) {
    return of<S>(
        spring,
        [](const auto& law) -> S
            requires requires { law.reduction; }
        { return law.reduction; });
}

/// 0 where a part has none.
template <class S, class Part>
constexpr S pitch_radius(const Part& part) {
    return of<S>(
        part,
        [](const auto& law) -> S
            requires requires { law.pitch_radius; }
        { return law.pitch_radius; });
}

/// 0 where a part has none.
template <class S, class Part>
constexpr S pressure_angle(const Part& part) {
    return of<S>(
        part,
        [](const auto& law) -> S
            requires requires { law.pressure_angle; }
        { return law.pressure_angle; });
}

/// Teeth of a part; 0 if it has none.
struct Teeth {
    int flexspline{0};
    int circular_spline{0};
    kinematics::Fixed fixed{kinematics::Fixed::circular_spline};

    /// The ratio without its sign.
    constexpr double ratio() const {
        return double(fixed == kinematics::Fixed::flexspline ? circular_spline : flexspline) / double(circular_spline - flexspline);
    }
};

template <class Part>
constexpr Teeth teeth(const Part& part) {
    return of<Teeth>(
        part,
        [](const auto& law) -> Teeth
            requires requires { law.flexspline_teeth; }
        { return {law.flexspline_teeth, law.circular_spline_teeth, law.fixed}; });
}

/// True if one of two numbers is not given, or both are the same within rounding.
template <class S>
constexpr bool agree(const S& first, const S& second) {
    const S rounding(1e-9);
    return all((first == S(0.0)) | (second == S(0.0)) | (abs(first - second) <= rounding * abs(second)));
}

}  // namespace strainwave::facts
