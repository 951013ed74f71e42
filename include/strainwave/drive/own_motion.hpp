#pragma once
#include <strainwave/control/law.hpp>
#include <strainwave/drive/prescribed_motion.hpp>
#include <strainwave/fastest.hpp>
#include <strainwave/friction/resistance.hpp>
#include <strainwave/load/load.hpp>
#include <strainwave/motor/rotor.hpp>
#include <strainwave/structure/structure.hpp>

/// Rates of a drive that fixed steps must resolve. The gear is as stiff as it becomes at twists up to `twist` [rad], and as warm
/// as it begins in a run of `temperature` [K].
namespace strainwave::own_motion {

namespace detail {

/// Initial temperature of the gear [K] in a run of a given temperature.
template <class S, class Drive>
constexpr S temperature(const Drive& drive, const S& temperature) {
    return drive.thermal.at(strainwave::initial_state(drive.thermal), temperature).gear;
}

template <class S, class Drive>
constexpr S steepest(const Drive& drive, const S& twist, const S& temperature) {
    return drive.gear.steepest(twist, detail::temperature<S>(drive, temperature));
}

/// The faster angular frequency [rad/s] of two masses, one spring between them and one behind the output: of gear and load. A
/// kinematic error with a slope [rad/rad] adds to what the input twists the spring by.
template <class S, class Drive>
constexpr S of_two_masses(const Drive& drive, const S& stiffness, const S& slope) {
    const S lever = abs(drive.gear.kinematics.inverse_ratio()) + slope;
    const S by_input = lever * lever / prescribed_motion::movable<S>(drive, inertia_of<S>(drive.motor) + drive.gear.input_inertia);
    const S of_gear = stiffness * (S(1.0) / drive.output_inertia() + by_input);
    const S of_load = load_stiffness<S>(drive.load) / drive.output_inertia();
    const S mean = S(0.5) * (of_gear + of_load), share = stiffness * by_input / max(mean, S(smallest));
    return sqrt(mean * (S(1.0) + sqrt(max(S(1.0) - share * (of_load / max(mean, S(smallest))), S(0.0)))));
}

/// Highest decay rate of speeds [1/s], of a drive at the beginning of its way whose sides both slide: by damping, friction,
/// back-EMF and control, without the part that steps take exactly. The larger eigenvalue of the matrix from two speeds to their
/// rates.
template <class S, class Drive>
constexpr S damping(const Drive& drive) {
    auto x = drive.rest();
    x.input_slip_direction = x.output_slip_direction = S(1.0);
    const auto rate = [&](double input_speed, double output_speed) {
        auto y = x.continuous;
        y.input_speed = S(input_speed);
        y.output_speed = S(output_speed);
        auto found = drive.derivatives(x, y, typename Drive::Input{}).rate;
        if constexpr (Drive::coupled_count > 0)
            if (drive.couples()) {
                const auto taken = drive.coupled_rate(drive.coupled_mode(x), drive.coupled(y));
                found.input_speed = found.input_speed - taken[0];
                found.output_speed = found.output_speed - taken[2];
            }
        return found;
    };
    const auto slow = rate(1.0, 1.0), by_input = rate(2.0, 1.0), by_output = rate(1.0, 2.0);
    const S input = slow.input_speed - by_input.input_speed, output = slow.output_speed - by_output.output_speed;
    const S across = (slow.input_speed - by_output.input_speed) * (slow.output_speed - by_input.output_speed);
    const S mean = S(0.5) * (input + output), product = input * output - across, square = mean * mean - product;
    return select(square < S(0.0), sqrt(max(product, S(0.0))), max(mean + sqrt(max(square, S(0.0))), S(0.0)));
}

/// Decay rate of the current by the controller [1/s], in excess of that of the winding, which steps take exactly.
template <class S, class Drive>
constexpr S current_damping(const Drive& drive) {
    if constexpr (size_of<S, typename decltype(Drive{}.motor)::State> == 0) {
        return S(0.0);
    } else {
        if (!motor::has_current<S>(drive.motor)) return S(0.0);
        const auto x = drive.rest();
        const auto rate = [&](const S& current) {
            auto y = x.continuous;
            auto numbers = flattened<S>(y.motor);
            numbers[0] = numbers[0] + current;
            y.motor = refilled(y.motor, numbers);
            return flattened<S>(drive.derivatives(x, y, typename Drive::Input{}).rate.motor)[0];
        };
        const S little{1e-3};  // A, so that no limit hides it
        const S decay = (rate(S(0.0)) - rate(little)) / little;
        return max(decay - flattened<S>(drive.motor.relaxation_rate())[0], S(0.0));
    }
}

}  // namespace detail

/// The fastest angular frequency [rad/s] at which gear and load vibrate.
template <class S, class Drive>
constexpr S natural_frequency(const Drive& drive, const S& twist, const S& temperature) {
    const S stiffness = detail::steepest<S>(drive, twist, temperature);
    return drive.gear.structure.rigid() ? detail::of_two_masses<S>(drive, stiffness, S(0.0))
                                        : drive.gear.structure.natural_frequency(drive.bodies(stiffness));
}

/// The fastest that fixed steps must follow, as an angular frequency [rad/s]: vibrations, the decay of speeds and of a controlled
/// current, sensors, what the controller filters, and temperatures; with the random error of the gear, which stiffens the one and
/// damps the other, be it the wrong way round. Of a decay a Runge-Kutta step of fourth order bears 2.78 times its length, of a
/// vibration 2.83 times, and 2.5 leaves room. Of bodies within the gear it is the part that their even reaction leaves out, for
/// steps take the even reaction exactly. If that part is large, the vibrations of the bodies count: 1.25 radians of these a step
/// are stable, whatever is left out.
template <class S, class Drive>
constexpr S max_rate(const Drive& drive, const S& twist, const S& temperature) {
    const auto& gear = drive.gear;
    const S filters = max(drive.sensors.fastest(), strainwave::fastest<S>(drive.control));
    const S inner = max(max(filters, strainwave::fastest<S>(drive.motor)), strainwave::fastest<S>(drive.thermal));
    const S stiffest = detail::steepest<S>(drive, twist, temperature);
    const auto random = gear.random_unevenness(stiffest);
    const S stiffness = gear.structure.rigid() ? stiffest * (S(1.0) + random.per_twist) : stiffest;
    auto bodies = drive.bodies(stiffness);
    const S decay = max(detail::damping<S>(drive) + gear.structure.uneven_decay(bodies, random), detail::current_damping<S>(drive));
    if (gear.structure.rigid()) return max(max(detail::of_two_masses<S>(drive, stiffness, random.slope), decay / S(2.5)), inner);
    const auto x = drive.rest();
    const S softer = S(1.0) + stiffness * gear.compliance(drive.gear_shafts(x, x.continuous, temperature),
                                                          drive.geometry(x, x.continuous, typename Drive::Input{}));
    const S uneven = gear.structure.uneven_frequency(bodies, gear.unevenness(twist, detail::temperature<S>(drive, temperature)));
    bodies.inverse_ratio = along(bodies.inverse_ratio, abs(bodies.inverse_ratio) + random.slope);
    const S of_bodies = max(gear.structure.natural_frequency(bodies), gear.structure.decay(bodies)) / S(1.25);
    const S of_shafts = detail::of_two_masses<S>(drive, stiffness / softer, random.slope);
    return max(max(of_shafts, max(decay / S(2.5), min(uneven, of_bodies))), inner);
}

/// The fastest angular frequency [rad/s] at which a shaft vibrates on the bristles that hold it.
template <class S, class Drive>
constexpr S bristle_frequency(const Drive& drive) {
    const auto& gear = drive.gear;
    const S inverse = gear.kinematics.inverse_ratio();
    const S input = friction::presliding_stiffness<S>(gear.friction_input) +
                    friction::presliding_stiffness<S>(gear.friction_mesh) * inverse * inverse;
    const S output = friction::presliding_stiffness<S>(gear.friction_output);
    return sqrt(max(input / prescribed_motion::movable<S>(drive, drive.input_inertia()), output / drive.output_inertia()));
}

}  // namespace strainwave::own_motion
