#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::compensation {

/// The twist [rad] at which spring and hysteresis of a gear, last held at a twist, transmit `torque` [N.m]: reached without turning
/// back. Newton's iteration, by the slope of the branch, within a bracket that closes; of a bounded number of rounds.
template <class Gear, class Memory, class S>
constexpr S inverse_twist(const Gear& gear, const Memory& memory, const S& held, const S& torque, const S& temperature) {
    constexpr int rounds = 40;
    const S none(0.0), far(10.0);  // rad: no gear twists as far
    const auto excess = [&](const S& twist) { return gear.held_torque(twist, memory, twist - held, temperature) - torque; };
    S twist = held, left = excess(twist), low = -far, high = far;
    const S away = select(left < none, S(1.0), S(-1.0));
    S moved(1.0);                                                // where it is 0, no round changes anything any more
    for (int i = 0; i < rounds && any(!(moved == none)); ++i) {  // once at least, for derivatives
        low = select(left < none, max(low, twist), low);
        high = select(left > none, min(high, twist), high);
        const S little = away * max(abs(twist - held) * S(1e-4), S(1e-9));
        const S slope = max((excess(twist + little) - left) / little, S(smallest));
        const S newton = twist - left / slope, middle = low + S(0.5) * (high - low);
        const S inside = select(newton > low, select(newton < high, newton, middle), middle);
        const S next = select(newton == twist, newton, inside);  // a twist that is found is an end of the bracket
        left = excess(next);
        moved = select(left == none, none, next - twist);
        twist = next;
    }
    return twist;
}

}  // namespace strainwave::compensation
