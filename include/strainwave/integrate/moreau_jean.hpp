#pragma once
#include <strainwave/integrate/exponential.hpp>

namespace strainwave::integrate {

/// One step of Moreau's and Jean's time-stepping scheme, of second order between events and without any: impulses of friction bring
/// the sides that can stick to rest, or set them off, as part of the step (Acary and Brogliato 2008, section 10.1; the forces taken
/// at the midpoint). States that relax do so exactly.
template <class S, class Drive>
constexpr typename Drive::State moreau_jean_step(const Drive& drive, const typename Drive::Standing& from, const Interval<S>& u,
                                                 const S& dt) {
    auto x = from.state;
    const auto y = x.motion;
    const auto& now = from.flow;
    const auto confined = [&](const auto& motion) { return drive.confined(motion, now.contacts, now.mesh.per_input); };
    const Relaxation<S, typename Drive::Motion> scheme(drive.decay(y, now.contacts), dt);
    const S half = S(0.5) * dt;
    const auto middle = confined(drive.arriving(x, scheme.halfway(y, scheme.forcing(now.rate, y)), now, half).motion);
    const auto then = drive.flow(x, middle, u.middle);
    x = drive.arriving(x, scheme.across(y, scheme.forcing(then.rate, middle)), then, dt);
    x.motion = drive.renewed(confined(x.motion), now.contacts, now.mesh.per_input);
    drive.wrap(x, dt);
    return x;
}

}  // namespace strainwave::integrate
