#include "motor.hpp"

#include <strainwave/fastest.hpp>
#include <strainwave/motor/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

template <class S>
using MotorLaws = Laws<S, motor::Models>;

template <class S>
void Motor<S>::read(kernel::Reader<S>& from) {
    MotorLaws<S>::read(*this, from, [this](const auto& law) { inertia = law.inertia; });
}
SW_STATE(Motor)
SW_OUTPUT_PLACES(Motor)
SW_CALL(Motor, S, torque, (const State& x, const S& actuation, const Rotor& rotor),
        law.torque(unpack_state<S>(law, x), actuation, rotor))
SW_CALL(Motor, S, current, (const State& x, const S& actuation, const Rotor& rotor),
        law.current(unpack_state<S>(law, x), actuation, rotor))
SW_PACK(Motor, Output, output, (const State& x, const S& actuation, const Rotor& rotor),
        law.output(unpack_state<S>(law, x), actuation, rotor))
SW_CALL(Motor, motor::Power<S>, power, (const State& x, const S& actuation, const Rotor& rotor),
        law.power(unpack_state<S>(law, x), actuation, rotor))
SW_PACK(Motor, State, rate, (const State& x, const S& actuation, const Rotor& rotor),
        law.rate(unpack_state<S>(law, x), actuation, rotor))
SW_PACK(Motor, State, relaxation_rate, (), law.relaxation_rate())
SW_CALL(Motor, Limits<S>, limits, (const State& x, const Rotor& rotor), motor::limits(law, unpack_state<S>(law, x), rotor))
SW_CALL(Motor, bool, prescribes, (), motor::prescribes(law))
SW_CALL(Motor, S, acceleration, (const S& asked), motor::acceleration<S>(law, asked))
SW_CALL(Motor, S, fastest, (), strainwave::fastest<S>(law))

SW_GENERAL(Motor)

}  // namespace strainwave::general
