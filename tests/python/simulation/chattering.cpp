#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <strainwave/drive.hpp>
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

    using Evaluation = typename Base::Evaluation;
    S before_wall(const Evaluation& at) const { return wall - at.state.continuous.input_angle - S(2.0 * pi) * at.state.turns; }
    S of_base(const Evaluation& at) const { return system::event_function<S>(static_cast<const Base&>(*this), at); }
    S event_function(const Evaluation& at) const { return min(of_base(at), before_wall(at)); }
    template <class Mask>
    typename Base::State apply_event(const Evaluation& at, const Input<S>& u, const Mask& lanes) const {
        ++events;
        const auto applied = system::apply_event(static_cast<const Base&>(*this), at, u, lanes);
        return chosen<S>(of_base(at) < before_wall(at), applied, at.state);
    }
    typename Base::State impulse_step(const typename Base::State& x, const typename Base::Continuous& end,
                                      const typename Base::Derivatives& now, const S& dt) const {
        ++arrivals;
        return system::impulse_step(static_cast<const Base&>(*this), x, end, now, dt);
    }
};

template <class S, class Hysteresis, class FrictionOutput>
using Tried = Drive<S, control::OpenLoop<S>, motor::DC<S>,
                    strainwave::Gear<S, kinematics::PlainRatio<S>, kinematic_error::Fourier<S>, kinematic_error::Stochastic<S>,
                                     stiffness::Linear<S>, Hysteresis, friction::Coulomb<S>, friction::Viscous<S>, FrictionOutput,
                                     softening::ThermalSoftening<S>>,
                    load::Inertia<S>, Sensors<S, sensor::Ideal<S>>>;

template <class S>
auto made(const S& wall) {
    Tried<S, hysteresis::MaxwellSlip<S>, friction::Coulomb<S>> drive{};
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
    const auto together = flattened<Pack<8>>(run<Pack<8>>(wall, steps, most).continuous);
    int count = 0;
    for (int lane = 0; lane < 8; ++lane) {
        const auto alone = flattened<double>(run<double>(walls[lane], steps, most).continuous);
        for (int i = 0; i < alone.size(); ++i) count += together[i][lane] != alone[i];
    }
    return count;
}

template <class D>
typename D::Evaluation smooth_step(const D& drive, const typename D::Evaluation& from, const Interval<Input<double>>& u,
                                   double dt) {
    return drive.evaluate(integrate::exponential_step(drive, from, u, dt), u.end);
}

/// A tenth of a second in steps that keep a tolerance, and how many of them end later than an event.
void run_adaptively(double wall) {
    const auto drive = made<double>(wall);
    using Chatters = std::remove_cv_t<decltype(drive)>;
    const auto smooth = smooth_step<Chatters>;
    integrate::Adaptive<double, Chatters, decltype(smooth)> adaptive(drive, drive.rest(), smooth, {1e-6, 1e-12}, 1e-5);
    int late = 0;
    auto x = drive.rest();
    const int intervals = 1000;
    const double dt = 0.1 / intervals;
    for (int i = 0; i < intervals; ++i) {
        const Interval<Input<double>> u{voltage<double>(i * dt), voltage<double>((i + 0.5) * dt), voltage<double>((i + 1) * dt)};
        const auto within = [&](double, double, const typename Chatters::Evaluation& end, const auto&) {
            late += wall == unbounded && system::event_function<double>(drive, end) < -1e-9;
            return true;
        };
        x = adaptive.through(drive.evaluate(x, u.start), u, dt, within).state;
    }
    std::printf("%d %d %ld %ld", late, drive.events, adaptive.accepted, adaptive.rejected);
    const auto y = flattened<double>(x.continuous);
    for (int i = 0; i < y.size(); ++i) std::printf(" %.17g", y[i]);
    std::printf("\n");
}

/// How many steps that keep a tolerance end later than an event, of a gear that has all but settled when it is moved anew: its
/// twist often turns round at once then.
int late_after_settling() {
    Tried<double, hysteresis::BoucWen<double>, friction::Viscous<double>> made{};
    made.gear.kinematics.reduction = 100.0;
    made.gear.stiffness.k = 1.2e4;
    made.gear.damping = 60.0;
    made.gear.hysteresis.stiffness = 5e3;
    made.gear.hysteresis.saturation = 5.0;
    made.gear.friction_input = {0.03, 0.045, 1e-4};
    made.gear.friction_output = {2.0};
    made.motor = {0.5, 2e-3, 0.1, 0.1, 1e-4};
    made.load.inertia = 0.5;
    const auto drive = made.compile();
    using Settling = std::remove_cv_t<decltype(drive)>;
    const auto smooth = smooth_step<Settling>;
    int late = 0;
    for (int k = 0; k < 400; ++k) {
        integrate::Adaptive<double, Settling, decltype(smooth)> adaptive(drive, drive.rest(), smooth, {1e-6, 1e-12}, 1e-4);
        const auto within = [&](double, double, const typename Settling::Evaluation& end, const auto&) {
            late += system::event_function<double>(drive, end) < -1e-9;
            return true;
        };
        Input<double> before{}, after{};
        before.load = 1.0;
        after.load = k % 2 ? 2.0 : 0.0;
        after.command = 10.0;
        const Interval<Input<double>> settling{before, before, before}, moving{after, after, after};
        const auto settled = adaptive.through(drive.evaluate(drive.rest(), before), settling, 0.25 + 1e-3 * k, within);
        adaptive.through(drive.evaluate(settled.state, after), moving, 0.005, within);
    }
    return late;
}

int main() {
    for (const double wall : {unbounded, 0.6})
        for (const int steps : {100, 200, 400, 800}) {
            Most most;
            const auto y = flattened<double>(run<double>(wall, steps, most).continuous);
            std::printf("%d %d", most.events, most.arrivals);
            for (int i = 0; i < y.size(); ++i) std::printf(" %.17g", y[i]);
            std::printf("\n");
        }
    std::printf("%d\n", different({0.2, 0.6, 1.0, 1.4, 1.8, unbounded, 2.6, unbounded}, 100));
    run_adaptively(unbounded);
    run_adaptively(0.6);
    std::printf("%d\n", late_after_settling());
}
