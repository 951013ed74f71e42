#pragma once
#include <strainwave/integrate/interval.hpp>

namespace strainwave::integrate {

/// What a member of the motion, and the torque, may err by: `absolute`, in its own unit, plus `relative` times the largest it has
/// been.
struct Tolerance {
    double relative = 1e-6;
    double absolute = 1e-12;
};

/// Steps as long as a tolerance allows. The error of two steps is told by one of twice their length; both are of fourth order.
/// Between its ends a step is known as exactly as there: by a step of part of its length. For scalars that are plain numbers.
template <class S, class Drive, class Step>
class Adaptive {
    using Standing = typename Drive::Standing;
    static constexpr int n = size_of<S, typename Drive::Motion> + 1;
    using Measured = Array<S, n>;

    const Drive& drive;
    const Step& step;
    const Tolerance tolerance;
    Measured largest{};
    S next;  ///< length of the next step, s

public:
    long accepted = 0, rejected = 0;

    /// Whether one of the shortest steps after the other missed the tolerance, where `through` ended.
    constexpr bool gave_up() const { return missed > most_missed; }

    constexpr Adaptive(const Drive& drive_, const Step& step_, const Tolerance& tolerance_, const S& first)
        : drive(drive_), step(step_), tolerance(tolerance_), next(first) {}

    /// The drive after the interval `u` of `dt` [s]. Calls within(from, half, end, done, middle, to) for each step taken: where it
    /// stands at these three fractions of the interval.
    template <class Within>
    constexpr Standing through(Standing from, const Interval<S>& u, const S& dt, const Within& within) {
        S done{0.0};
        while (done < S(1.0)) {
            // What is left is not cut so that a sliver remains.
            const S left = (S(1.0) - done) * dt, steps = left / next;
            const S length = steps <= S(1.0) ? left : steps < S(2.0) ? S(0.5) * left : next;
            const S to = length < left ? done + length / dt : S(1.0), middle = S(0.5) * (done + to);
            const Standing whole = step(drive, from, u.part(done, to, dt), (to - done) * dt);
            const Standing half = step(drive, from, u.part(done, middle, dt), (middle - done) * dt);
            const Standing end = step(drive, half, u.part(middle, to, dt), (to - middle) * dt);
            const S error = this->error(whole, end) * S(forgetting) / (length + S(brief));
            // An error of what is not a number is larger than any; a step must not become nothing.
            const S factor = error < S(1e4) ? clip(S(0.9) * exp(S(-0.25) * log(max(error, S(1e-3)))), S(0.2), S(4.0)) : S(0.2);
            next = max(length * factor, S(shortest));
            const bool kept = error <= S(1.0);
            if (!kept && length > S(shortest)) {
                ++rejected;
                continue;
            }
            missed = kept ? 0 : missed + 1;
            if (missed > most_missed) return from;
            ++accepted;
            within(from, half, end, done, middle, to);
            note(end);
            from = end;
            done = to;
        }
        return from;
    }

private:
    static constexpr double shortest = 1e-9;  ///< s
    static constexpr int most_missed = 100;
    int missed = 0;  ///< of the shortest steps, one after the other
    /// s. Where a jump of the forces makes a step this short, its error no longer falls faster than its length.
    static constexpr double brief = 1e-6;
    /// s. A drive forgets an error within about this time, so that errors of steps may add up to the tolerance over it.
    static constexpr double forgetting = 0.1;

    /// What is held to the tolerance: the motion, and the torque, which shows what the hysteresis remembers.
    constexpr Measured measured(const Standing& at) const {
        const auto y = flattened<S>(at.state.motion);
        Measured found{};
        for (int i = 0; i < y.size(); ++i) found[i] = y[i];
        found[n - 1] = at.flow.mesh.torque;
        return found;
    }
    /// The error of `fine` in units of what is tolerated, the largest of all.
    constexpr S error(Standing coarse, const Standing& fine) const {
        S& angle = coarse.state.motion.input_angle;
        angle = angle + S(2.0 * pi) * (coarse.state.turns - fine.state.turns);
        const Measured a = measured(coarse), b = measured(fine);
        S worst{0.0};
        for (int i = 0; i < n; ++i) {
            const S tolerated = S(tolerance.absolute) + S(tolerance.relative) * max(largest[i], abs(b[i]));
            const S relative = abs(a[i] - b[i]) / (S(15.0) * tolerated);
            if (!(relative <= worst) && worst == worst) worst = relative;  // what is not a number stays
        }
        return worst;
    }
    constexpr void note(const Standing& at) {
        const Measured y = measured(at);
        for (int i = 0; i < n; ++i) largest[i] = max(largest[i], abs(y[i]));
    }
};

}  // namespace strainwave::integrate
