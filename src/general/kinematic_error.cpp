#include "kinematic_error.hpp"

#include <strainwave/kinematic_error/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

template <class S>
using KinematicErrorLaws = Laws<S, kinematic_error::Models, KinematicError<S>>;
template <class S>
using KinematicNoiseLaws = Laws<S, kinematic_error::Noises>;

SW_READ(KinematicError)
SW_CALL(KinematicError, kinematic_error::Error<S>, at, (const Angle<S>& angle), law.at(angle))
SW_CALL(KinematicError, bool, follows_temperature, (), kinematic_error::follows_temperature(law))
SW_CALL(KinematicError, kinematic_error::Error<S>, warmed, (const Angle<S>& angle, const S& temperature),
        kinematic_error::warmed<S>(law, angle, temperature))
SW_CALL(KinematicError, S, per_kelvin, (const Angle<S>& angle), kinematic_error::per_kelvin<S>(law, angle))
SW_CALL(KinematicError, S, side, (const Angle<S>& angle), kinematic_error::side<S>(law, angle))
SW_CALL(KinematicError, bool, follows_load, (), kinematic_error::follows_load(law))
SW_CALL(KinematicError, kinematic_error::Relief<S>, relief, (const S& torque), kinematic_error::relief(law, torque))

SW_READ(KinematicNoise)
SW_CALL(KinematicNoise, bool, active, (), law.active())
SW_CALL(KinematicNoise, kinematic_error::Error<S>, at, (const Angle<S>& angle, const S& torque, const S& speed),
        law.at(angle, torque, speed))
SW_CALL(KinematicNoise, S, drift,
        (const Angle<S>& angle, const S& torque, const S& torque_rate, const S& speed, const S& acceleration),
        law.drift(angle, torque, torque_rate, speed, acceleration))
template <class S>
MaxChange<S> KinematicNoise<S>::max_change() const {
    return KinematicNoiseLaws<S>::visit(*this, [](const auto& law) {
        const auto found = law.max_change();
        return MaxChange<S>{found.slope, found.per_torque, found.per_speed};
    });
}

SW_GENERAL(KinematicError)
SW_GENERAL(KinematicNoise)

}  // namespace strainwave::general
