#pragma once
#include <strainwave/math.hpp>

/// Three phases that are not alike, in the frame of the rotor. Amplitudes are those of a phase in every frame.
namespace strainwave::motor {

/// A voltage [V] in the frame of the rotor.
template <class S>
struct RotorVoltage {
    S along{0.0}, across{0.0};

    friend constexpr RotorVoltage operator+(const RotorVoltage& a, const RotorVoltage& b) {
        return {a.along + b.along, a.across + b.across};
    }
};

/// The currents of three phases in star without a neutral conductor, in the frame of the stator. Its first axis is that of the
/// first phase, which the magnets face at the electric angle 0.
template <class S>
struct Phases {
    SinCos<S> angle{};
    S first{0.0}, second{0.0};  ///< A

    static constexpr Phases of(const S& along, const S& across, const S& electric_angle) {
        const SinCos<S> at = sincos(electric_angle);
        return {at, along * at.cos - across * at.sin, along * at.sin + across * at.cos};
    }

    /// Voltage drop of a resistance [Ohm] in the first phase alone.
    constexpr RotorVoltage<S> resistance_drop(const S& excess) const {
        const S share = S(2.0 / 3.0) * excess * first;
        return {share * angle.cos, -(share * angle.sin)};
    }
    /// Voltage drop of three phases, each of `voltage` [V] against its current, in proportion below the current `clamp` [A].
    constexpr RotorVoltage<S> dead_time_drop(const S& voltage, const S& clamp) const {
        const auto drop = [&](const S& current) { return voltage * clip(current / clamp, S(-1.0), S(1.0)); };
        const S half = S(-0.5) * first, side = S(half_root_3) * second;
        const S a = drop(first), b = drop(half + side), c = drop(half - side);
        const S on_first = S(2.0 / 3.0) * (a - S(0.5) * (b + c)), on_second = S(2.0 / 3.0 * half_root_3) * (b - c);
        return {on_first * angle.cos + on_second * angle.sin, on_second * angle.cos - on_first * angle.sin};
    }

private:
    static constexpr double half_root_3 = 0.86602540378443865;
};

}  // namespace strainwave::motor
