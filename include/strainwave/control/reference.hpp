#pragma once
#include <strainwave/control/law.hpp>
#include <strainwave/drive_model.hpp>

/// Derivatives of a command beyond its rate, and the laws that need them: each derivative is a difference to a lag, over the time
/// of the lag.
namespace strainwave::control {

/// Lags of the rate of the command and of its derivative.
template <class S>
struct ReferenceLags {
    S rate{0.0};
    S acceleration{0.0};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, rate, "rad/s", "Commanded output speed through the lag"));
        visit(SW_FIELD(m, acceleration, "rad/s2", "Commanded output acceleration through the lag"));
    }
};

/// Acceleration [rad/s2] and jerk [rad/s3] of a command; the rates of its lags are the same.
template <class S>
struct ReferenceMotion {
    S acceleration, jerk;

    constexpr ReferenceMotion(const ReferenceLags<S>& x, const Command<S>& command, const S& time)
        : acceleration((command.rate - x.rate) / time), jerk((acceleration - x.acceleration) / time) {}

    constexpr ReferenceLags<S> rate() const { return {acceleration, jerk}; }
};

/// Base of the laws with a model of gear and load, and with derivatives of the command by lags. A law has the members
/// gear, load, reference_time, actuation_per_torque, actuation_per_speed and limit, and
///
///     motor_torque(state, command, measured) -> torque of the motor that it asks for [N.m]
template <class S, class Law>
struct OfModelAndReference {
    using Base = OfModelAndReference;
    using State = ReferenceLags<S>;

    constexpr Contradiction<S> problem() const { return drive_model::problem_of_motion<S>(self().gear, self().load); }
    constexpr S model_ratio() const { return self().gear.kinematics.ratio(); }
    constexpr S max_period() const { return self().reference_time; }

    constexpr S act(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        const S of_motor = self().actuation_per_torque * self().motor_torque(x, command, measured);
        const S unlimited = of_motor + self().actuation_per_speed * measured.input_speed + command.feedforward;
        return measured.limits.within(self().limit).limited(unlimited);
    }
    constexpr State rate(const State& x, const Command<S>& command, const Measurement<S>&) const {
        return ReferenceMotion<S>(x, command, self().reference_time).rate();
    }
    /// 0, as of an integral: forward differences follow a ramp without error, the exact step of a lag does not.
    constexpr State relaxation_rate() const { return {}; }
    /// Rate of the lag over 2.5: a Runge-Kutta step of fourth order is stable up to 2.78 of its time.
    constexpr S fastest() const { return S(1.0 / 2.5) / self().reference_time; }

private:
    constexpr const Law& self() const { return static_cast<const Law&>(*this); }
};

}  // namespace strainwave::control
