#pragma once
#include <strainwave/integrate/exponential.hpp>

namespace strainwave::integrate {

/// One step of Moreau's and Jean's time-stepping scheme, of second order between events and without any: impulses of friction bring
/// shafts to rest, or break them away, as part of the step (Acary and Brogliato 2008, section 10.1; the forces taken at the
/// midpoint). What relaxes does so exactly.
template <class S, class System>
constexpr typename System::State moreau_jean_step(const System& system, const typename System::Evaluation& from,
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

}  // namespace strainwave::integrate
