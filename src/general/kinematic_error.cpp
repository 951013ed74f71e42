#include "kinematic_error.hpp"

#include <strainwave/kinematic_error/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

template <class S>
using ErrorLaws = Laws<S, kinematic_error::Models, KinematicError<S>>;
template <class S>
using NoiseLaws = Laws<S, kinematic_error::Noises>;

template <class S>
void KinematicError<S>::read(kernel::Reader<S>& from) {
    ErrorLaws<S>::read(*this, from);
}
template <class S>
kinematic_error::Error<S> KinematicError<S>::at(const Angle<S>& angle) const {
    return ErrorLaws<S>::visit(*this, [&](const auto& law) { return law.at(angle); });
}
template <class S>
S KinematicError<S>::side(const Angle<S>& angle) const {
    return ErrorLaws<S>::visit(*this, [&](const auto& law) { return kinematic_error::side<S>(law, angle); });
}
template <class S>
bool KinematicError<S>::follows_load() const {
    return ErrorLaws<S>::visit(*this, [](const auto& law) { return kinematic_error::follows_load(law); });
}
template <class S>
kinematic_error::Relief<S> KinematicError<S>::relief(const S& torque) const {
    return ErrorLaws<S>::visit(*this, [&](const auto& law) { return kinematic_error::relief(law, torque); });
}

template <class S>
void KinematicNoise<S>::read(kernel::Reader<S>& from) {
    NoiseLaws<S>::read(*this, from);
}
template <class S>
bool KinematicNoise<S>::active() const {
    return NoiseLaws<S>::visit(*this, [](const auto& law) { return law.active(); });
}
template <class S>
kinematic_error::Error<S> KinematicNoise<S>::at(const Angle<S>& angle, const S& torque, const S& speed) const {
    return NoiseLaws<S>::visit(*this, [&](const auto& law) { return law.at(angle, torque, speed); });
}
template <class S>
S KinematicNoise<S>::growth(const S& torque, const S& torque_rate, const S& speed, const S& acceleration) const {
    return NoiseLaws<S>::visit(*this, [&](const auto& law) { return law.growth(torque, torque_rate, speed, acceleration); });
}
template <class S>
MaxChange<S> KinematicNoise<S>::max_change() const {
    return NoiseLaws<S>::visit(*this, [](const auto& law) {
        const auto found = law.max_change();
        return MaxChange<S>{found.slope, found.per_torque, found.per_speed};
    });
}

SW_GENERAL(KinematicError)
SW_GENERAL(KinematicNoise)

}  // namespace strainwave::general
