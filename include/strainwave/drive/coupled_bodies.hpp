#pragma once
#include <strainwave/field.hpp>
#include <strainwave/load/load.hpp>
#include <strainwave/motor/rotor.hpp>
#include <strainwave/structure/structure.hpp>

/// The bodies within a gear, and both shafts: masses, dampers and even springs act linearly on them. A step takes these
/// numbers as one block (system.hpp), however stiff it is: input speed, transmission error, output speed, then the state of the
/// structure.
namespace strainwave::coupled_bodies {

/// Count of the numbers.
template <class S, class Gear, class Structure>
inline constexpr int count = Gear::always_rigid ? 0 : 3 + size_of<S, typename Structure::State>;

namespace detail {
template <class S, int n, class Inner>
struct NumbersWith {
    using type = Array<S, (n > 0 ? n : 1)>;
};
template <class S, int n, int capacity>
struct NumbersWith<S, n, Counted<S, capacity>> {
    using type = Counted<S, n>;
};
}  // namespace detail

/// The numbers: as many as the structure's law has, if that is chosen at run time.
template <class S, class Gear, class Structure>
using Numbers = typename detail::NumbersWith<S, count<S, Gear, Structure>, Flat<S, typename Structure::State>>::type;

template <class S, class Drive>
constexpr typename Drive::Coupled numbers(const typename Drive::Continuous& y) {
    const auto inner = flattened<S>(y.structure);
    typename Drive::Coupled z;
    if constexpr (requires { z.count; }) z.count = 3 + inner.size();
    z[0] = y.input_speed;
    z[1] = y.transmission_error;
    z[2] = y.output_speed;
    for (int i = 0; i < inner.size(); ++i) z[3 + i] = inner[i];
    return z;
}
template <class S, class Drive>
constexpr void set_numbers(typename Drive::Continuous& y, const typename Drive::Coupled& z) {
    y.input_speed = z[0];
    y.transmission_error = z[1];
    y.output_speed = z[2];
    auto inner = flattened<S>(y.structure);
    for (int i = 0; i < inner.size(); ++i) inner[i] = z[3 + i];
    refill(y.structure, inner);
}

/// 1 for each shaft that moves freely, else 0: it sticks, or its motion is prescribed.
template <class S, class Drive>
constexpr Array<S, 2> mode(const Drive& drive, const typename Drive::State& x) {
    const auto moves = [](const S& slip_direction) { return select(slip_direction == S(0.0), S(0.0), S(1.0)); };
    return {{motor::prescribes(drive.motor) ? S(0.0) : moves(x.input_slip_direction),
             prescribes(drive.load) ? S(0.0) : moves(x.output_slip_direction)}};
}

template <class S, class Drive>
constexpr typename Drive::Coupled rate(const Drive& drive, const Array<S, 2>& moves, const typename Drive::Coupled& z) {
    typename Drive::Continuous y{};
    y.structure = initial_state(drive.gear.structure);
    set_numbers<S, Drive>(y, z);
    const auto even = drive.gear.even_reaction(y.structure, drive.gear_shafts(typename Drive::State{}, y, typename Drive::Input{}));
    typename Drive::Continuous rate{};
    rate.input_speed = -moves[0] * even.input_torque / drive.input_inertia();
    rate.transmission_error = y.input_speed * drive.gear.kinematics.inverse_ratio() - y.output_speed;
    rate.output_speed = moves[1] * even.torque / drive.output_inertia();
    rate.structure = even.rate;
    return numbers<S, Drive>(rate);
}

/// On the way from one state to another, `dt` [s] later. By the angle of the wave generator: there the torque on it jumps.
template <class S, class Drive>
constexpr S side(const Drive& drive, const typename Drive::State& x, const typename Drive::State& after, const S& dt,
                 const S& fraction) {
    const structure::Generator<S> from = drive.generator(x), to = drive.generator(after);
    const S moved = to.angle.within - from.angle.within + S(2.0 * pi) * (to.angle.turns - from.angle.turns);
    const S begin = dt * from.speed, end = dt * to.speed, bend = S(3.0) * moved - S(2.0) * begin - end;
    const S way = fraction * (begin + fraction * (bend + fraction * (begin + end - S(2.0) * moved)));
    return drive.gear.side({from.angle.within + way, from.angle.turns});
}

}  // namespace strainwave::coupled_bodies
