#include "stiffness.hpp"

#include <strainwave/stiffness/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

template <class S>
using StiffnessLaws = Laws<S, stiffness::Models, Stiffness<S>>;

template <class S>
void Stiffness<S>::read(kernel::Reader<S>& from) {
    StiffnessLaws<S>::read(*this, from);
}
template <class S>
S Stiffness<S>::torque(const S& twist) const {
    return StiffnessLaws<S>::visit(*this, [&](const auto& law) { return law.torque(twist); });
}
template <class S>
S Stiffness<S>::twist(const S& torque) const {
    return StiffnessLaws<S>::visit(*this, [&](const auto& law) { return law.twist(torque); });
}
template <class S>
S Stiffness<S>::tangent(const S& twist) const {
    return StiffnessLaws<S>::visit(*this, [&](const auto& law) { return law.tangent(twist); });
}
template <class S>
S Stiffness<S>::energy(const S& twist) const {
    return StiffnessLaws<S>::visit(*this, [&](const auto& law) { return law.energy(twist); });
}
template <class S>
bool Stiffness<S>::is_bounded() const {
    return StiffnessLaws<S>::visit(*this, [](const auto& law) { return strainwave::bounded<S>(law); });
}
template <class S>
Domain<S> Stiffness<S>::domain(const S& twist) const {
    return StiffnessLaws<S>::visit(*this, [&](const auto& law) { return strainwave::domain<S>(law, twist); });
}

SW_GENERAL(Stiffness)

}  // namespace strainwave::general
