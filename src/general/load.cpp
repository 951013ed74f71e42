#include "load.hpp"

#include <strainwave/load/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

template <class S>
using LoadLaws = Laws<S, load::Models>;

template <class S>
void Load<S>::read(kernel::Reader<S>& from) {
    LoadLaws<S>::read(*this, from);
    LoadLaws<S>::visit(*this, [this]<class Law>(const Law& law) {
        inertia = strainwave::inertia_of<S>(law);
        prescribes = load::can_prescribe<Law>;
        brakes = load::can_brake<Law>;
    });
}
SW_CALL(Load, S, load_torque, (const S& angle, const S& speed, const S& input),
        strainwave::load_torque<S>(law, angle, speed, input))
SW_CALL(Load, S, steepest, (), load_stiffness<S>(law))
SW_CALL(Load, Braking<S>, braking, (const S& input), strainwave::braking<S>(law, input))

SW_GENERAL(Load)

}  // namespace strainwave::general
