#pragma once
#include <strainwave/decayed.hpp>
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::material {

template <class S>
struct GeneralisedMaxwell {
    static constexpr int capacity = 8;

    Sequence<S, capacity> stiffness{};
    Sequence<S, capacity> relaxation_time{};

    static constexpr auto name = "generalised_maxwell";
    static constexpr auto source =
        "Ferry1980, chapter 3: the generalised Maxwell model; that the internal damping of the flexspline's "
        "material and elastomeric parts take part in the loop: " SW_TORSION_ARTICLE ", Table 3";
    static constexpr auto doc = R"(
        Viscoelastic material of parallel Maxwell branches: a spring in series with a damper each.

        .. math:: T = \sum_j T_j, \qquad \dot T_j = k_j \dot\delta - \frac{T_j}{\tau_j}

        with delta the twist, k_j = stiffness, tau_j = relaxation_time, up to 8 branches. With the spring of the gear in parallel,
        one branch is the standard linear solid. Under a sine of the angular frequency omega the torque has the parts

        .. math:: k'(\omega) = \sum_j k_j \frac{\omega^2 \tau_j^2}{1 + \omega^2 \tau_j^2}, \qquad
                  k''(\omega) = \sum_j k_j \frac{\omega \tau_j}{1 + \omega^2 \tau_j^2}

        in phase with the twist and a quarter of a period ahead: ``storage`` and ``loss``. A cycle of the amplitude a loses
        pi a^2 k''. So the loop widens with the frequency up to 1 / tau_j, unlike those of the laws of hysteresis, whose loss does
        not depend on the frequency; as omega tau_j tends to 0 a branch is a damping k_j tau_j. A loss that hardly depends on
        the frequency, as that of metals and rubber, takes about a branch per decade of it. T_j^2 / (2 k_j) is stored, and
        T_j^2 / (k_j tau_j) lost per second.

        Linear: leaves out that the loss of filled rubber falls with the amplitude (Payne effect), and the dependence on the
        temperature. Steps of any length are stable and take the relaxation exactly.

        >>> from strainwave.material import GeneralisedMaxwell
        >>> law = GeneralisedMaxwell(stiffness=[100.0], relaxation_time=[0.5])
        >>> law.storage(2.0), law.loss(2.0)  # N.m/rad
        (50.0, 50.0)
        >>> law.trace(time=[0.0, 1e-9, 0.5], twist=[0.0, 0.01, 0.01]).round(6)  # a jump relaxes to 1 / e
        array([0.      , 1.      , 0.367879]))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, stiffness, "N.m/rad", "Stiffness k_j of each branch while it does not relax", smallest));
        visit(SW_FIELD(m, relaxation_time, "s", "Time tau_j in which each branch relaxes", 1e-9));
    }

    constexpr const char* problem() const {
        return stiffness.count == relaxation_time.count ? nullptr : "stiffness and relaxation_time must have equally many elements";
    }

    struct State {
        Array<S, capacity> held{};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, held, "N.m", "Torque T_j held by each branch"));
        }
    };

    constexpr bool active() const { return stiffness.count > 0; }

    constexpr S largest_stiffness() const {
        return sum([&](int j) { return stiffness[j]; });
    }
    constexpr S torque(const State& x) const {
        return sum([&](int j) { return x.held[j]; });
    }
    constexpr State rate(const State& x, const S& twist_rate) const {
        return each([&](int j) { return stiffness[j] * twist_rate - x.held[j] / relaxation_time[j]; });
    }
    constexpr State relaxation_rate() const {
        return each([&](int j) { return S(1.0) / relaxation_time[j]; });
    }
    constexpr S lost(const State& x) const {
        return sum([&](int j) { return x.held[j] * x.held[j] / (stiffness[j] * relaxation_time[j]); });
    }
    constexpr S stored(const State& x) const {
        return sum([&](int j) { return x.held[j] * x.held[j] / (S(2.0) * stiffness[j]); });
    }

    /// The branches after the twist has moved by `increment` [rad] in `dt` [s], at a constant rate.
    constexpr State advance(const State& x, const S& increment, const S& dt) const {
        return each([&](int j) {
            const S kept = S(1.0) - dt / relaxation_time[j] * mean(j, dt).once;
            return kept * x.held[j] + stiffness[j] * increment * mean(j, dt).once;
        });
    }
    /// Work [J] done on the branches meanwhile.
    constexpr S work(const State& x, const S& increment, const S& dt) const {
        return sum([&](int j) {
            const auto decayed = mean(j, dt);
            return increment * (x.held[j] * decayed.once + stiffness[j] * increment * decayed.twice);
        });
    }

    constexpr S storage(const S& frequency) const {
        return sum([&](int j) {
            const S turned = frequency * relaxation_time[j], square = turned * turned;
            return stiffness[j] * square / (S(1.0) + square);
        });
    }
    constexpr S loss(const S& frequency) const {
        return sum([&](int j) {
            const S turned = frequency * relaxation_time[j];
            return stiffness[j] * turned / (S(1.0) + turned * turned);
        });
    }

private:
    /// The decay of a branch over a step, relative to the step: means of e^(-t / tau), and of what a constant rate has left of it.
    constexpr Decayed<S> mean(int j, const S& dt) const { return Decayed<S>::along_path(dt / relaxation_time[j], S(1.0)); }

    template <class F>
    constexpr S sum(const F& of_branch) const {
        S total{0.0};
        for (int j = 0; j < stiffness.count; ++j) total = total + of_branch(j);
        return total;
    }
    template <class F>
    constexpr State each(const F& of_branch) const {
        State branches{};
        for (int j = 0; j < stiffness.count; ++j) branches.held[j] = of_branch(j);
        return branches;
    }
};

}  // namespace strainwave::material
