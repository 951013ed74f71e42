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

template <class S, class Law>
struct AtRunTime<S, friction::Asymmetric<S, Law>> {
    using type = friction::Asymmetric<S, AnyOf<S, friction::Levelled>>;
};
template <class S, class Law>
struct AtRunTime<S, friction::Cyclic<S, Law>> {
    using type = friction::Cyclic<S, AnyOf<S, friction::Directed>>;
};
template <class S, class Law>
struct AtRunTime<S, friction::Thermal<S, Law>> {
    using type = friction::Thermal<S, AnyOf<S, friction::Varying>>;
};
template <class S, class Law>
struct AtRunTime<S, sensor::Delayed<S, Law>> {
    using type = sensor::Delayed<S, AnyOf<S, sensor::Plain>>;
};
template <class S, class Law>
struct AtRunTime<S, sensor::Noisy<S, Law>> {
    using type = sensor::Noisy<S, AnyOf<S, sensor::Late>>;
};
template <class S, class Law>
struct AtRunTime<S, sensor::Quantised<S, Law>> {
    using type = sensor::Quantised<S, AnyOf<S, sensor::Loud>>;
};
template <class S, class Law>
struct AtRunTime<S, stiffness::Backlash<S, Law>> {
    using type = stiffness::Backlash<S, AnyOf<S, stiffness::Plain>>;
};
template <class S, class Law>
struct AtRunTime<S, kinematic_error::Scaled<S, Law>> {
    using type = kinematic_error::Scaled<S, AnyOf<S, kinematic_error::Pure>>;
};
template <class S, class Variation>
struct AtRunTime<S, structure::Staged<S, Variation>> {
    using type = structure::Staged<S, AnyOf<S, variation::Models>>;
};
template <class S, class Density>
struct AtRunTime<S, hysteresis::Preisach<S, Density>> {
    using type = hysteresis::Preisach<S, AnyOf<S, hysteresis::Densities>>;
};

}  // namespace detail

template <class S>
using AnyGear =
    Gear<S, AnyOf<S, kinematics::Models>, AnyOf<S, kinematic_error::Models>, AnyOf<S, kinematic_error::Noises>,
         AnyOf<S, stiffness::Models>, AnyOf<S, hysteresis::Models>, AnyOf<S, friction::Models>, AnyOf<S, friction::Models>,
         AnyOf<S, friction::Models>, AnyOf<S, softening::Models>, AnyOf<S, structure::Models>, AnyOf<S, variation::Models>>;

namespace detail {

template <class S, class Gear, class Load>
struct AtRunTime<S, compensation::ModelFeedforward<S, Gear, Load>> {
    using type = compensation::ModelFeedforward<S, AnyGear<S>, AnyOf<S, load::Models>>;
};
template <class S, class Law>
struct AtRunTime<S, compensation::BristleObserver<S, Law>> {
    using type = compensation::BristleObserver<S, AnyOf<S, friction::Models>>;
};
template <class S, class Gear, class Load>
struct AtRunTime<S, control::FeedbackLinearisation<S, Gear, Load>> {
    using type = control::FeedbackLinearisation<S, AnyGear<S>, AnyOf<S, load::Models>>;
};
template <class S, class Gear, class Load>
struct AtRunTime<S, control::KinematicErrorTracking<S, Gear, Load>> {
    using type = control::KinematicErrorTracking<S, AnyGear<S>, AnyOf<S, load::Models>>;
};
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
