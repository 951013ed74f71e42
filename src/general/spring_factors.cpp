#include "spring_factors.hpp"

#include <strainwave/softening/models.hpp>
#include <strainwave/variation/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

template <class S>
using VariationLaws = Laws<S, variation::Models>;
template <class S>
using SofteningLaws = Laws<S, softening::Models>;

template <class S>
void Variation<S>::read(kernel::Reader<S>& from) {
    VariationLaws<S>::read(*this, from);
}
template <class S>
bool Variation<S>::active() const {
    return VariationLaws<S>::visit(*this, [](const auto& law) { return law.active(); });
}
template <class S>
S Variation<S>::largest() const {
    return VariationLaws<S>::visit(*this, [](const auto& law) { return law.largest(); });
}
template <class S>
variation::Factor<S> Variation<S>::at(const Angle<S>& angle) const {
    return VariationLaws<S>::visit(*this, [&](const auto& law) { return law.at(angle); });
}

template <class S>
void Softening<S>::read(kernel::Reader<S>& from) {
    SofteningLaws<S>::read(*this, from);
}
template <class S>
bool Softening<S>::active() const {
    return SofteningLaws<S>::visit(*this, [](const auto& law) { return law.active(); });
}
template <class S>
S Softening<S>::of_stiffness(const S& temperature) const {
    return SofteningLaws<S>::visit(*this, [&](const auto& law) { return law.of_stiffness(temperature); });
}
template <class S>
S Softening<S>::of_hysteresis(const S& temperature) const {
    return SofteningLaws<S>::visit(*this, [&](const auto& law) { return law.of_hysteresis(temperature); });
}
template <class S>
S Softening<S>::dissipation_rate(const S& warming) const {
    return SofteningLaws<S>::visit(*this, [&](const auto& law) { return law.dissipation_rate(warming); });
}

SW_GENERAL(Variation)
SW_GENERAL(Softening)

}  // namespace strainwave::general
