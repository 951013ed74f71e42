#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <strainwave/integrate.hpp>
#include <strainwave/models.hpp>
#include <strainwave/scalar/pack.hpp>
#include <type_traits>

using namespace strainwave;

/// Counts, and chatters wherever its input stands beyond a wall: there something is always about to happen, and nothing does.
template <class S, class Base>
struct Chattering : Base {
    S wall{unbounded};
    mutable int events = 0, arrivals = 0;

    using Standing = typename Base::Standing;
    S before_wall(const Standing& at) const { return wall - at.state.motion.input_angle - S(2.0 * pi) * at.state.turns; }
    S margin(const Standing& at) const { return min(Base::margin(at), before_wall(at)); }
    template <class Mask>
    typename Base::State settled(const Standing& at, const Input<S>& u, const Mask& lanes) const {
        ++events;
        return chosen<S>(Base::margin(at) < before_wall(at), Base::settled(at, u, lanes), at.state);
    }
    typename Base::State arriving(const typename Base::State& x, const typename Base::Motion& end, const typename Base::Flow& now,
                                  const S& dt) const {
        ++arrivals;
        return Base::arriving(x, end, now, dt);
    }
};

template <class S>
auto made(const S& wall) {
    using Sticking = friction::Coulomb<S>;
    using Smooth = friction::Viscous<S>;
    using Spring = strainwave::Gear<S, kinematics::PlainRatio<S>, kinematic_error::Fourier<S>, kinematic_error::Stochastic<S>,
                                    stiffness::Linear<S>, hysteresis::MaxwellSlip<S>, Sticking, Smooth, Sticking>;
    PositionDrive<S, Spring, motor::DC<S>, control::OpenLoop<S>, load::Inertia<S>> drive{};
    drive.gear.kinematics.reduction = S(100.0);
    drive.gear.stiffness.k = S(1.2e4);
    drive.gear.damping = S(10.0);
    drive.gear.friction_input = {S(0.03), S(0.045), S(1e-4)};
    drive.gear.friction_output = {S(3.0), S(4.0), S(0.5)};
    drive.motor = {S(0.5), S(0.0), S(0.1), S(0.1), S(1e-4)};
    drive.load.inertia = S(0.5);
    const auto compiled = drive.compile();
    Chattering<S, std::remove_cv_t<decltype(compiled)>> found{compiled};
    found.wall = wall;
    return found;
}

template <class S>
Input<S> voltage(double time) {
    const double w = 2.0 * std::numbers::pi * 5.0;
    Input<S> input{};
    input.command = S(6.0 * std::sin(w * time));
    input.command_rate = S(6.0 * w * std::cos(w * time));
    return input;
}

struct Most {
    int events = 0, arrivals = 0;
};

/// The state after a tenth of a second, and the most events and arrivals that a step had.
template <class S>
auto run(const S& wall, int steps, Most& most) {
    const auto drive = made<S>(wall);
    const double dt = 0.1 / steps;
    auto x = drive.rest();
    for (int i = 0; i < steps; ++i) {
        drive.events = drive.arrivals = 0;
        x = step<S>(drive, x, {voltage<S>(i * dt), voltage<S>((i + 0.5) * dt), voltage<S>((i + 1) * dt)}, S(dt));
        most.events = std::max(most.events, drive.events);
        most.arrivals = std::max(most.arrivals, drive.arrivals);
    }
    return x;
}

/// How many numbers of the lanes' states are not what each lane has alone, to the last bit.
int different(const double (&walls)[8], int steps) {
    Pack<8> wall{0.0};
    for (int lane = 0; lane < 8; ++lane) wall.set(lane, walls[lane]);
    Most most;
    const auto together = flattened<Pack<8>>(run<Pack<8>>(wall, steps, most).motion);
    int count = 0;
    for (int lane = 0; lane < 8; ++lane) {
        const auto alone = flattened<double>(run<double>(walls[lane], steps, most).motion);
        for (int i = 0; i < alone.size(); ++i) count += together[i][lane] != alone[i];
    }
    return count;
}

int main() {
    for (const double wall : {unbounded, 0.6})
        for (const int steps : {100, 200, 400, 800}) {
            Most most;
            const auto y = flattened<double>(run<double>(wall, steps, most).motion);
            std::printf("%d %d", most.events, most.arrivals);
            for (int i = 0; i < y.size(); ++i) std::printf(" %.17g", y[i]);
            std::printf("\n");
        }
    std::printf("%d\n", different({0.2, 0.6, 1.0, 1.4, 1.8, unbounded, 2.6, unbounded}, 100));
}
