#include <cstdio>
#include <strainwave/scalar/dual.hpp>
#include <strainwave/scalar/pack.hpp>

#include "two_masses.hpp"

using namespace strainwave;

constexpr double duration = 0.6;
constexpr int steps = 1200;

template <class S>
typename TwoMasses<S>::State twisted() {
    typename TwoMasses<S>::State x{};
    x.continuous.angle[1] = S(0.05);
    return x;
}

/// The numbers at the end of a run; `smooth` takes a step without events.
template <class S, class Smooth>
auto stepped(const TwoMasses<S>& system, const Smooth& smooth) {
    const Interval<typename TwoMasses<S>::Input> torque{{S(0.3)}, {S(0.3)}, {S(0.3)}};
    auto at = system.evaluate(twisted<S>(), torque.start);
    for (int i = 0; i < steps; ++i) at = step(system, at, torque, S(duration / steps), smooth);
    return flattened<S>(at.state.continuous);
}

constexpr auto exponential = [](const auto& system, const auto& from, const auto& u, const auto& dt) {
    return system.evaluate(integrate::exponential_step(system, from, u, dt), u.end);
};
constexpr auto rosenbrock = [](const auto& system, const auto& from, const auto& u, const auto& dt) {
    return system.evaluate(integrate::rosenbrock_step(system, from, u, dt), u.end);
};

template <class S>
auto time_stepped(const TwoMasses<S>& system) {
    const Interval<typename TwoMasses<S>::Input> torque{{S(0.3)}, {S(0.3)}, {S(0.3)}};
    auto x = twisted<S>();
    for (int i = 0; i < steps; ++i)
        x = integrate::moreau_jean_step(system, system.evaluate(x, torque.start), torque, S(duration / steps));
    return flattened<S>(x.continuous);
}

auto adaptive() {
    using System = TwoMasses<double>;
    const System system{};
    integrate::Adaptive<double, System, decltype(exponential)> steps(system, twisted<double>(), exponential, {1e-9, 1e-12}, 1e-3);
    const Interval<System::Input> torque{{0.3}, {0.3}, {0.3}};
    const auto go_on = [](double, double, const auto&, const auto&) { return true; };
    return flattened<double>(
        steps.through(system.evaluate(twisted<double>(), torque.start), torque, duration, go_on).state.continuous);
}

template <class Numbers, class Of>
void write(const char* name, const Numbers& numbers, const Of& of) {
    std::printf("%s", name);
    for (int i = 0; i < numbers.size(); ++i) std::printf(" %.17g", of(numbers[i]));
    std::printf("\n");
}

int main() {
    const auto plain = [](double x) { return x; };
    write("exponential", stepped<double>({}, exponential), plain);
    write("rosenbrock", stepped<double>({}, rosenbrock), plain);
    write("moreau_jean", time_stepped<double>({}), plain);
    write("adaptive", adaptive(), plain);

    using Pair = Pack<4>;
    Pair friction;
    for (int lane = 0; lane < 4; ++lane) friction.set(lane, 0.5 + 0.3 * lane);
    const TwoMasses<Pair> several{Pair(0.5), Pair(200.0), friction};
    const auto by_events = stepped<Pair>(several, exponential), by_impulses = time_stepped<Pair>(several);
    int different = 0;
    for (int lane = 0; lane < 4; ++lane) {
        const TwoMasses<double> one{0.5, 200.0, friction[lane]};
        const auto alone = stepped<double>(one, exponential), pushed = time_stepped<double>(one);
        for (int i = 0; i < alone.size(); ++i) different += (by_events[i][lane] != alone[i]) + (by_impulses[i][lane] != pushed[i]);
    }
    std::printf("lanes_that_differ %d\n", different);

    using Slopes = Dual<2>;
    TwoMasses<Slopes> differentiated{};
    differentiated.stiffness.slope[0] = differentiated.friction.slope[1] = 1.0;
    const auto derivatives = stepped<Slopes>(differentiated, exponential);
    write("by_stiffness", derivatives, [](const Slopes& x) { return x.slope[0]; });
    write("by_friction", derivatives, [](const Slopes& x) { return x.slope[1]; });
}
