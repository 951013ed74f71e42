#include "kinematics.hpp"

#include <strainwave/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

template <class S>
void Kinematics<S>::read(kernel::Reader<S>& from) {
    Part chosen;
    Laws<S, kinematics::Models>::read(chosen, from);
    Laws<S, kinematics::Models>::visit(chosen, [this](const auto& law) {
        this->reduction = law.ratio();
        this->inverse = law.inverse_ratio();
    });
}

SW_GENERAL(Kinematics)

}  // namespace strainwave::general
