#pragma once
#include <strainwave/integrate/coupled.hpp>

namespace strainwave::integrate {

namespace detail {

template <class S, class System>
constexpr typename System::State moreau_jean_part(const System& system, const typename System::Evaluation& from,
                                                  const Interval<typename System::Input>& u, const S& dt) {
    using Continuous = typename System::Continuous;
    auto x = from.state;
    const Continuous& y = from.state.continuous;
    const auto& now = from.derivatives;
    const auto clamped = [&](const Continuous& at) { return system::clamped(system, at, now); };
    const Relaxation<S, Continuous> scheme(system::relaxation_rate<S>(system, y, now), dt);
    const S half = S(0.5) * dt;
    const Continuous middle =
        clamped(system::impulse_step(system, x, scheme.halfway(y, scheme.forcing(now.rate, y)), now, half).continuous);
    const auto then = system.derivatives(x, middle, u.middle);
    x = system::impulse_step(system, x, scheme.across(y, scheme.forcing(then.rate, middle)), then, dt);
    x.continuous = system::update_mode(system, clamped(x.continuous), now);
    system::finish_step(system, x, dt);
    return x;
}

/// Steps in parts short enough to resolve the motion of a coupled block.
template <class S, class System>
constexpr typename System::State moreau_jean_parts(const System& system, const typename System::Evaluation& from,
                                                   const Interval<typename System::Input>& u, const S& dt) {
    constexpr double max_parts = 1e4;
    auto block = coupled_matrix(system, from.state);
    for (int j = 0; j < block.size(); ++j)
        for (int i = 0; i < block.size(); ++i) block[j][i] = dt * block[j][i];
    balance(block);
    const S parts = clip(rint(S(2.0) * value_only(largest_column(block)) + S(0.5)), S(1.0), S(max_parts)), share = S(1.0) / parts;
    auto at = from;
    auto end = from.state;
    for (S done{0.0};;) {
        const auto left = done < parts;
        const S next = min(done + S(1.0), parts);
        const auto part = u.part(done * share, next * share, dt);
        end = chosen<S>(left, moreau_jean_part(system, at, part, share * dt), end);
        done = next;
        if (!any(done < parts)) return end;
        at = system.evaluate(end, part.end);
    }
}

}  // namespace detail

/// One step of Moreau's and Jean's time-stepping scheme, of second order between events and without any: impulses of friction bring
/// shafts to rest, or break them away, as part of the step (Acary and Brogliato 2008, section 10.1; the forces taken at the
/// midpoint). What relaxes does so exactly. Where the system has a coupled block it is several steps, as many as follow the block.
template <class S, class System>
constexpr typename System::State moreau_jean_step(const System& system, const typename System::Evaluation& from,
                                                  const Interval<typename System::Input>& u, const S& dt) {
    if constexpr (system::coupled_count<System> > 0)
        if (system.couples()) return detail::moreau_jean_parts(system, from, u, dt);
    return detail::moreau_jean_part(system, from, u, dt);
}

}  // namespace strainwave::integrate
