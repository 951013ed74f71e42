#pragma once
#include <strainwave/drive.hpp>
#include <strainwave/models.hpp>

#include "choice.hpp"

/// Sets of parameters as Python holds them: of a gear, of a drive.
namespace strainwave {

namespace detail {

/// A law around another one accepts any, if it is chosen at run time.
template <class S, class Law>
struct AtRunTime {
    using type = Law;
};

template <class S, class L>
struct ChoiceOf;
template <class S, template <class...> class... Law>
struct ChoiceOf<S, List<Law...>> {
    using type = Choice<S, typename AtRunTime<S, Law<S>>::type...>;
};

}  // namespace detail

template <class S, class L>
using AnyOf = typename detail::ChoiceOf<S, L>::type;
template <template <class...> class Law, class S>
using AtRunTime = typename detail::AtRunTime<S, Law<S>>::type;

namespace detail {

/// A law within `Outer` is chosen from a list.
#define SW_WITHIN(Outer, List)                 \
    template <class S, class Law>              \
    struct AtRunTime<S, Outer<S, Law>> {       \
        using type = Outer<S, AnyOf<S, List>>; \
    };
SW_WITHIN(friction::Asymmetric, friction::Levelled)
SW_WITHIN(friction::Cyclic, friction::Directed)
SW_WITHIN(friction::Thermal, friction::Varying)
SW_WITHIN(sensor::Delayed, sensor::Plain)
SW_WITHIN(sensor::Noisy, sensor::Late)
SW_WITHIN(sensor::Quantised, sensor::Loud)
SW_WITHIN(stiffness::TwoSided, stiffness::Plain)
SW_WITHIN(stiffness::Backlash, stiffness::Sided)
SW_WITHIN(kinematic_error::TemperatureDependent, kinematic_error::Pure)
SW_WITHIN(kinematic_error::Scaled, kinematic_error::Unloaded)
SW_WITHIN(hysteresis::Preisach, hysteresis::Densities)
SW_WITHIN(compensation::BristleObserver, friction::Models)
#undef SW_WITHIN
template <class S, class Ring, class Variation>
struct AtRunTime<S, structure::Staged<S, Ring, Variation>> {
    using type = structure::Staged<S, AnyOf<S, ring::Models>, AnyOf<S, variation::Models>>;
};

}  // namespace detail

template <class S>
using AnyGear = Gear<S, AnyOf<S, kinematics::Models>, AnyOf<S, kinematic_error::Models>, AnyOf<S, kinematic_error::Noises>,
                     AnyOf<S, stiffness::Models>, AnyOf<S, hysteresis::Models>, AnyOf<S, friction::Models>,
                     AnyOf<S, friction::Models>, AnyOf<S, friction::Models>, AnyOf<S, softening::Models>,
                     AnyOf<S, structure::Models>, AnyOf<S, variation::Models>, AnyOf<S, material::Models>>;

namespace detail {

/// A law that contains a model of the drive contains any gear and any load.
#define SW_AROUND_MODEL(Outer)                                     \
    template <class S, class Gear, class Load>                     \
    struct AtRunTime<S, Outer<S, Gear, Load>> {                    \
        using type = Outer<S, AnyGear<S>, AnyOf<S, load::Models>>; \
    };
SW_AROUND_MODEL(compensation::ModelFeedforward)
SW_AROUND_MODEL(control::FeedbackLinearisation)
SW_AROUND_MODEL(control::KinematicErrorTracking)
#undef SW_AROUND_MODEL

template <class S, class Law, class Compensation_>
struct AtRunTime<S, control::Sampled<S, Law, Compensation_>> {
    using type = control::Sampled<S, AnyOf<S, control::Continuous>,
                                  Compensation<S, AnyOf<S, compensation::Feedforwards>, AnyOf<S, compensation::Learners>,
                                               AnyOf<S, compensation::Observers>, AnyOf<S, compensation::Dithers>>>;
};

}  // namespace detail

using ParameterGear = AnyGear<double>;
using ParameterCompensation = AtRunTime<control::Sampled, double>::Compensation;
using ParameterSensors = Sensors<double, AnyOf<double, sensor::Models>>;
using ParameterDrive =
    Drive<double, AnyOf<double, control::Models>, AnyOf<double, motor::Models>, ParameterGear, AnyOf<double, load::Models>,
          ParameterSensors, AnyOf<double, thermal::Models>, AnyOf<double, meter::Models>>;

}  // namespace strainwave
