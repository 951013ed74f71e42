#pragma once
#include <strainwave/control/law.hpp>

/// Derivatives of a command beyond its rate, for laws that need them: each is a difference to a lag, over the time of the lag.
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

}  // namespace strainwave::control
