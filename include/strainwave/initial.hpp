#pragma once
#include <strainwave/drive.hpp>
#include <strainwave/initial_quantities.hpp>
#include <strainwave/quasi_static.hpp>

/// States that a run can begin in, from a few quantities that are known.
namespace strainwave::initial {

namespace detail {

/// The search for the state: rounds, each of which brings every quantity closer to the others.
template <class S, class Drive>
class Search {
    const Drive& drive;
    const Known<S>& known;
    const Input<S>& u;
    typename Drive::State x;
    QuasiStatic<S, decltype(Drive{}.gear)> spring;

    using MotorState = decltype(Drive{}.motor.relaxation_rate());
    using MotorNumbers = Flat<S, MotorState>;
    static constexpr int count = size_of<S, MotorState>;

public:
    constexpr Search(const Drive& drive_, const Known<S>& known_, const Input<S>& u_)
        : drive(drive_),
          known(known_),
          u(u_),
          x(drive_.initial_state()),
          spring(drive_.gear, drive_.temperatures(x.continuous, u_).gear) {
        x.input_slip_direction = x.output_slip_direction = S(0.0);  // what does not move has slipped to neither side
    }

    /// The state found. Its transmission error is infinite if the rounds do not converge.
    constexpr typename Drive::State found() {
        // Derivatives are a round or two behind the values; the rounding of an error is that of a larger angle [rad].
        constexpr int max_rounds = 500, converged_rounds = 3;
        constexpr double max_relative_change = 1e-15, min_angle = 1e-3;
        S before(unbounded);
        int converged = 0;
        for (int i = 0; i < max_rounds && converged < converged_rounds; ++i) {
            const S twist = round();
            const auto& y = x.continuous;
            const S output = (y.input_angle + S(2.0 * pi) * x.turns) * drive.gear.kinematics.inverse_ratio();
            converged =
                S(max_relative_change) * max(max(abs(output), abs(twist)), S(min_angle)) >= abs(twist - before) ? converged + 1 : 0;
            before = twist;
        }
        drive.advance_hysteresis(x, before);
        settle();
        if (converged < converged_rounds) x.continuous.transmission_error = S(unbounded) * S(10.0);
        return x;
    }

private:
    /// Takes the angles from the twist, the speeds from each other, and returns the twist.
    constexpr S round() {
        auto& y = x.continuous;
        const S inverse = drive.gear.kinematics.inverse_ratio();
        const auto mesh = drive.geometry(x, y, u);
        spring.vary(drive.gear.stiffness_factor(y.structure, drive.gear_shafts(x, y, u)).value);
        move(mesh.per_input, mesh.per_output);
        const S total_input = y.input_angle + S(2.0 * pi) * x.turns;
        const bool both = known.knows(input_angle) && known.knows(output_angle);
        const S between = both ? known[input_angle] * inverse - known[output_angle] : S(0.0);
        settle_gear(mesh, both ? twist_between(mesh, between) : wanted_twist(mesh));
        const S error = both ? between : y.transmission_error;
        const S input = known.knows(input_angle)    ? known[input_angle]
                        : known.knows(output_angle) ? (known[output_angle] + error) / inverse
                                                    : total_input;
        place(input, error);
        return drive.geometry(x, y, u).twist;
    }
    /// The twist of the spring at this difference of the shaft angles [rad]. The share of the other joints is that of the last
    /// round, and follows their mean stiffness beyond it.
    constexpr S twist_between(const typename decltype(Drive{}.gear)::Mesh& mesh, const S& between) {
        if (drive.gear.structure.rigid()) return between - mesh.error;
        const S compliance = drive.gear.compliance(drive.gear_shafts(x, x.continuous, u), mesh), before = mesh.twist;
        settle_gear(mesh, before);
        const S others = x.continuous.transmission_error - before - compliance * spring.torque(before);
        return spring.twist_within(between - others, compliance);
    }
    constexpr void settle_gear(const typename decltype(Drive{}.gear)::Mesh& mesh, const S& twist) {
        const S temperature = drive.temperatures(x.continuous, u).gear;
        drive.settle_gear(x, mesh, twist, drive.gear.structure.rigid() ? S(0.0) : spring.torque(twist), temperature);
    }
    constexpr void place(const S& input, const S& transmission_error) {
        x.turns = rint(input * S(0.5 / pi));
        x.continuous.input_angle = input - x.turns * S(2.0 * pi);
        x.continuous.transmission_error = transmission_error;
    }
    /// Each speed follows from the other at constant twist.
    constexpr void move(const S& per_input, const S& per_output) {
        auto& y = x.continuous;
        y.input_speed = known.knows(input_speed)    ? known[input_speed]
                        : known.knows(output_speed) ? known[output_speed] * per_output / per_input
                                                    : S(0.0);
        y.output_speed = known.knows(output_speed) ? known[output_speed] : per_input / per_output * y.input_speed;
    }
    constexpr S wanted_twist(const typename decltype(Drive{}.gear)::Mesh& mesh) {
        if (known.knows(twist)) return known[twist];
        if (!known.knows(torque) && prescribes(drive.load)) return S(0.0);
        const S transmitted = known.knows(torque) ? known[torque] : balancing_torque();
        const S wanted = drive.gear.spring_torque_for(mesh, transmitted);
        if (!drive.gear.structure.rigid()) return spring.twist(wanted);
        const S rate = mesh.per_input * x.continuous.input_speed - mesh.per_output * x.continuous.output_speed;
        return spring.twist(wanted - drive.gear.damping * rate);
    }
    /// Torque of the gear that balances load and friction at the output.
    constexpr S balancing_torque() {
        settle_friction();
        const auto now = drive.derivatives(x, x.continuous, u);
        return now.load_torque + now.friction_output;
    }

    /// Friction after a long motion at these speeds. A shaft whose speed is that of rounding is at rest.
    constexpr void settle_friction() {
        const auto fresh = drive.initial_state();
        auto& y = x.continuous;
        y.friction_input = fresh.continuous.friction_input;
        y.friction_mesh = fresh.continuous.friction_mesh;
        y.friction_output = fresh.continuous.friction_output;
        const S input = y.input_speed, output = y.output_speed;
        y.input_speed = motion(input);
        y.output_speed = motion(output);
        x = drive.relaxed(drive.consistent(x), u, S(1e30));
        y.input_speed = input;
        y.output_speed = output;
    }
    static constexpr S motion(const S& speed) {
        constexpr double min_speed = 1e-9;  // rad/s: a turn in 200 years; the rate of a large sine at its peak is 1e-13 by rounding
        return select(abs(speed) > S(min_speed), speed, S(0.0));
    }
    /// Friction, a sampled controller, the motor and the sensors, in this order: each as those before have it.
    constexpr void settle() {
        settle_friction();
        auto at = drive.evaluate(x, u);
        at = system::up_to_date(drive, at, u, S(0.0));  // before the first sample none is due but that
        x = at.state;
        settle_motor(at.derivatives.mesh.torque);
        x.continuous.sensors = drive.sensors.steady_state(drive.measurable(x, x.continuous, u, at.derivatives.mesh.torque));
    }
    /// The currents at which none changes, with controller and sensors as they are then, under a torque [N.m] of the gear: by
    /// Newton's iteration, which for a linear winding ends at once. Where it finds none the motor stays as it was.
    constexpr void settle_motor(const S& gear_torque) {
        if constexpr (count > 0) {
            constexpr int max_steps = 30;
            constexpr double max_relative_step = sizeof(Real<S>) == sizeof(float) ? 1e-5 : 1e-13, min_current = 1e-3;  // A
            MotorNumbers start = flattened<S>(x.continuous.motor), relaxation = flattened<S>(drive.motor.relaxation_rate());
            if (known.knows(current)) {
                start[0] = known[current];
                relaxation[0] = S(0.0);
            }
            MotorNumbers at = start;
            auto goes_on = S(0.0) == S(0.0), converged = !goes_on;
            for (int i = 0; i < max_steps && any(goes_on); ++i) {
                const MotorNumbers step = newton_step(at, relaxation, gear_torque);
                auto close = goes_on;
                for (int k = 0; k < at.size(); ++k) {
                    at[k] = select(goes_on, at[k] + step[k], at[k]);
                    close = close & (abs(step[k]) < S(max_relative_step) * max(abs(at[k]), S(min_current)));
                }
                const auto left = !close;
                converged = !(left & !converged);
                goes_on = goes_on & left;
            }
            for (int k = 0; k < at.size(); ++k) at[k] = select(converged, at[k], start[k]);
            refill(x.continuous.motor, at);
        }
    }
    /// Change of each number of the motor that makes the rates of those that relax zero, by the slopes there. Gauss's elimination
    /// without exchange of rows, for the resistance stands on the diagonal.
    constexpr MotorNumbers newton_step(const MotorNumbers& at, const MotorNumbers& relaxation, const S& gear_torque) const {
        const S increment(1e-3);  // A, so that no limit hides it
        const int n = at.size();
        MotorNumbers right = motor_rate(at, relaxation, gear_torque);
        Array<MotorNumbers, count> slope{};  // slope[j][i]: of rate i by number j
        for (int j = 0; j < n; ++j) {
            MotorNumbers moved = at;
            moved[j] = moved[j] + increment;
            const MotorNumbers then = motor_rate(moved, relaxation, gear_torque);
            slope[j] = then;
            for (int i = 0; i < n; ++i) slope[j][i] = (then[i] - right[i]) / (moved[j] - at[j]);
            slope[j][j] = select(relaxation[j] > S(0.0), slope[j][j], S(-1.0));
        }
        for (int k = 0; k < n; ++k)
            for (int i = k + 1; i < n; ++i) {
                const S share = slope[k][i] / slope[k][k];
                for (int j = k + 1; j < n; ++j) slope[j][i] = slope[j][i] - share * slope[j][k];
                right[i] = right[i] - share * right[k];
            }
        for (int i = n - 1; i >= 0; --i) {
            for (int j = i + 1; j < n; ++j) right[i] = right[i] + slope[j][i] * right[j];
            right[i] = -right[i] / slope[i][i];
        }
        return right;
    }
    constexpr MotorNumbers motor_rate(const MotorNumbers& numbers, const MotorNumbers& relaxation, const S& gear_torque) const {
        auto y = x.continuous;
        refill(y.motor, numbers);
        y.sensors = drive.sensors.steady_state(drive.measurable(x, y, u, gear_torque));
        MotorNumbers rate = flattened<S>(drive.derivatives(x, y, u).rate.motor);
        for (int i = 0; i < rate.size(); ++i) rate[i] = select(relaxation[i] > S(0.0), rate[i], S(0.0));
        return rate;
    }
};

}  // namespace detail

/// The state of a drive of which some quantities are known. The rest follows: the input angle is 0 if no angle is known, speeds
/// are 0 if none is; the twist is the one at which the output does not accelerate, reached from no history; friction, motor and
/// sensors have settled; a motor for which no currents at rest are found has none. Its transmission error
/// is not finite where there is no such state.
template <class S, class Drive>
constexpr typename Drive::State state(const Drive& drive, Known<S> known, const Input<S>& u) {
    if (prescribes(drive.load)) {
        known.set(output_angle, u.load);
        known.set(output_speed, u.load_rate);
    }
    return detail::Search<S, Drive>(drive, known, u).found();
}

}  // namespace strainwave::initial
