#pragma once
#include <strainwave/any.hpp>
#include <strainwave/scalar/pack.hpp>

#include <algorithm>

/// Drives chosen from shorter lists. What a step carries along is as large as the largest state among the models it could meet, and
/// all that it calls is inlined only where there are not too many; so drives that need few models run in code of their own.
namespace strainwave::host {

/// Which models the parts of a drive are chosen from. A list of one model leaves no choice at run time.
template <class Error_, class Stiffness_, class Hysteresis_, class FrictionInput_, class FrictionMesh_, class FrictionOutput_>
struct Models {
    using Error = Error_;
    using Stiffness = Stiffness_;
    using Hysteresis = Hysteresis_;
    using FrictionInput = FrictionInput_;
    using FrictionMesh = FrictionMesh_;
    using FrictionOutput = FrictionOutput_;
};

namespace detail {

/// The models of a list that have a state of at most `most` scalars and hold no other law.
template <int most, class Found, class L>
struct Short;
template <int most, class Found>
struct Short<most, Found, List<>> {
    using type = Found;
};
template <int most, template <class...> class... Found, template <class...> class First, template <class...> class... Rest>
struct Short<most, List<Found...>, List<First, Rest...>> {
    using Law = AtRunTime<First, double>;
    static constexpr bool fits = strainwave::detail::state_size<double, Law>() <= most && !friction::Modulation<Law>;
    using type = typename Short<most, std::conditional_t<fits, List<Found..., First>, List<Found...>>, List<Rest...>>::type;
};

template <class S, class L>
struct Narrow {
    using type = AnyOf<S, L>;
};
template <class S, template <class...> class Law>
struct Narrow<S, List<Law>> {
    using type = AtRunTime<Law, S>;
};

}  // namespace detail

template <int most, class L>
using Short = typename detail::Short<most, List<>, L>::type;

/// Most drives: laws with short states.
using Small = Models<kinematic_error::Models, stiffness::Models, Short<16, hysteresis::Models>, Short<1, friction::Models>,
                     Short<1, friction::Models>, Short<1, friction::Models>>;
/// The drives of most papers and of most catalogues, each by the friction at its input.
template <template <class...> class... FrictionInput>
using Usual =
    Models<List<kinematic_error::Fourier>, List<stiffness::Linear, stiffness::Piecewise, stiffness::ThreeSegment, stiffness::Cubic>,
           List<hysteresis::MaxwellSlip>, List<FrictionInput...>, List<friction::Viscous>, List<friction::Viscous>>;

using DrivesOnBristles = Usual<friction::LuGre>;
using DrivesWithoutMemory = Usual<friction::Viscous, friction::Coulomb, friction::Stribeck>;

/// Whether all that a step of such a drive calls is inlined into one function. Of scalars of many registers that takes minutes to
/// compile where there is more to choose from than in the usual drives; where each access is checked, more than ten for any.
#ifdef SW_CHECKED
template <class S, class M>
inline constexpr bool inlined = false;
#else
template <class S, class M>
inline constexpr bool inlined = true;
template <class S>
inline constexpr bool inlined<S, Small> = std::is_same_v<S, double>;
template <int n>
inline constexpr bool inlined<Pack<n>, Small> = Pack<n>::count == 1;
#endif

/// A drive whose parts are chosen from these lists.
template <class S, class M>
using NarrowDrive = PositionDrive<
    S,
    Gear<S, AnyOf<S, kinematics::Models>, typename detail::Narrow<S, typename M::Error>::type,
         typename detail::Narrow<S, kinematic_error::Noises>::type, typename detail::Narrow<S, typename M::Stiffness>::type,
         typename detail::Narrow<S, typename M::Hysteresis>::type, typename detail::Narrow<S, typename M::FrictionInput>::type,
         typename detail::Narrow<S, typename M::FrictionMesh>::type, typename detail::Narrow<S, typename M::FrictionOutput>::type>,
    typename detail::Narrow<S, motor::Models>::type, AnyOf<S, control::Models>, AnyOf<S, load::Models>>;

namespace detail {

/// Sets a part to the model chosen if it is among those it can be; says whether it is.
template <class S, class... Law, class... Wider>
bool narrowed(Choice<S, Law...>& part, const Choice<S, Wider...>& from) {
    return from.visit([&]<class Chosen>(const Chosen& law) {
        constexpr bool among = (std::is_same_v<Chosen, Law> || ...);
        if constexpr (among) part.model = law;
        return among;
    });
}
template <class Law, class S, class... Wider>
bool narrowed(Law& part, const Choice<S, Wider...>& from) {
    const Law* law = std::get_if<Law>(&from.model);
    if (law) part = *law;
    return law != nullptr;
}

}  // namespace detail

/// Sets `narrow` to the same drive; false if it needs other models.
template <class S, class Narrow>
bool narrowed(Narrow& narrow, const AnyPositionDrive<S>& drive) {
    const auto& from = drive.gear;
    auto& gear = narrow.gear;
    gear.damping = from.damping;
    gear.input_inertia = from.input_inertia;
    return detail::narrowed(gear.kinematics, from.kinematics) && detail::narrowed(gear.kinematic_error, from.kinematic_error) &&
           detail::narrowed(gear.kinematic_noise, from.kinematic_noise) && detail::narrowed(gear.stiffness, from.stiffness) &&
           detail::narrowed(gear.hysteresis, from.hysteresis) && detail::narrowed(gear.friction_input, from.friction_input) &&
           detail::narrowed(gear.friction_mesh, from.friction_mesh) &&
           detail::narrowed(gear.friction_output, from.friction_output) && detail::narrowed(narrow.motor, drive.motor) &&
           detail::narrowed(narrow.control, drive.control) && detail::narrowed(narrow.load, drive.load);
}

namespace detail {

/// One part's state as another type of drive has it: the model's own comes first in either.
template <class S, class To, class From>
void refill(To& to, const From& from) {
    if constexpr (size_of<S, To> > 0 && size_of<S, From> > 0) {
        auto slots = flattened<S>(to);
        const auto values = flattened<S>(from);
        for (int i = 0; i < std::min(slots.size(), values.size()); ++i) slots[i] = values[i];
        to = shaped<To>(slots);
    }
}

}  // namespace detail

/// The state of a drive as the same drive of another type has it.
template <class S, class To, class From>
To refilled(const From& from) {
    To to{};
    to.held_twist = from.held_twist;
    to.held_rate = from.held_rate;
    to.elapsed = from.elapsed;
    to.turns = from.turns;
    to.input_slip_direction = from.input_slip_direction;
    to.output_slip_direction = from.output_slip_direction;
    detail::refill<S>(to.hysteresis, from.hysteresis);
    auto& motion = to.continuous;
    motion.input_angle = from.continuous.input_angle;
    motion.input_speed = from.continuous.input_speed;
    motion.transmission_error = from.continuous.transmission_error;
    motion.output_speed = from.continuous.output_speed;
    detail::refill<S>(motion.motor, from.continuous.motor);
    detail::refill<S>(motion.control, from.continuous.control);
    detail::refill<S>(motion.friction_input, from.continuous.friction_input);
    detail::refill<S>(motion.friction_mesh, from.continuous.friction_mesh);
    detail::refill<S>(motion.friction_output, from.continuous.friction_output);
    return to;
}

}  // namespace strainwave::host
