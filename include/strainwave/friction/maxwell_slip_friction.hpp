#pragma once
#include <strainwave/condition.hpp>
#include <strainwave/friction/stribeck.hpp>

namespace strainwave::friction {

template <class S>
struct MaxwellSlipFriction {
    static constexpr int capacity = 8;

    Sequence<S, capacity> stiffness{};
    Sequence<S, capacity> share{};
    S coulomb{0.03};
    S breakaway{0.03};
    S stribeck_speed{2.0};
    S attraction{0.3};
    S viscous{0.0};

    static constexpr auto name = "maxwell_slip_friction";
    static constexpr auto source =
        "AlBenderLampaertSwevers2005, generalized Maxwell-slip model, slip law with a constant attraction";
    static constexpr bool odd = true;
    static constexpr auto doc = R"(
        Generalised Maxwell-slip friction: presliding hysteresis with non-local memory, Stribeck fall, frictional lag.

        .. math:: F = \sum_i F_i + \sigma_2 v, \quad \text{sticking: } \dot F_i = k_i v, \quad
                  \text{slipping: } \dot F_i = \operatorname{sgn}(v)\, C \left(\alpha_i - |F_i| / s(v)\right), \quad
                  s(v) = F_c + (F_s - F_c) e^{-(v/v_s)^2}

        with v the speed of the place it acts on, k_i = stiffness, alpha_i = share over the sum of all shares, F_c = coulomb,
        F_s = breakaway, v_s = stribeck_speed, C = attraction, sigma_2 = viscous; up to 8 elements; without elements there is
        no dry friction. An element sticks until it carries alpha_i s(v), and slips until the motion stops or turns round. A
        slipping element follows s(v) with the time constant s/C. breakaway defaults to coulomb; a smaller value counts as
        coulomb. Cyclic and Thermal scale s and C, but not stiffness and time constant.

        With breakaway = coulomb no element lags: the law is Maxwell slip with the levels alpha_i F_c, and dissipates for every
        motion. With a Stribeck fall the law, as published, can create energy. An element that slips fast, slows down, and
        reverses a little while it sticks returns up to alpha_i^2 (F_s - F_c)^2 / (2 k_i) more than it took; ``check()`` warns.
        Leaves out load, position and temperature.

        >>> from strainwave.friction import MaxwellSlipFriction
        >>> law = MaxwellSlipFriction(stiffness=[60, 30, 10], share=[0.2, 0.3, 0.5], coulomb=0.05, stribeck_speed=2.0,
        ...                           attraction=0.3)
        >>> law.trace([0.0, 1.0, 2.0], [1e-3, 1e-3, 1e-3]).round(6)
        array([0.   , 0.035, 0.045]))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, stiffness, "N.m/rad", "Stiffness k_i of each element while it sticks", smallest));
        visit(SW_REQUIRED(m, share, "1", "Share alpha_i of each element in the friction torque, relative to the sum of all", 0));
        visit(SW_REQUIRED(m, coulomb, "N.m", "Kinetic friction torque F_c", 0));
        visit(SW_FOLLOWS(m, breakaway, coulomb, "N.m", "Static friction torque F_s", 0));
        visit(SW_REQUIRED(m, stribeck_speed, "rad/s", "Speed at which the excess F_s - F_c has fallen to 1/e", smallest));
        visit(SW_REQUIRED(m, attraction, "N.m/s", "Rate C at which slipping elements approach the Stribeck curve", smallest));
        visit(SW_FIELD(m, viscous, "N.m.s/rad", "Torque per speed", 0));
    }

    constexpr const char* problem() const {
        if (stiffness.count != share.count) return "stiffness and share must have equally many elements";
        return share.count == 0 || all(total() > S(smallest)) ? nullptr : "the elements of share cannot all be 0";
    }

    struct State {
        Array<S, capacity> torque{};
        Array<S, capacity> slipping{};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, torque, "N.m", "Torque F_i carried by each element"));
            visit(SW_FIELD(m, slipping, "1", "1 for an element that slips, 0 for one that sticks, 0.5 for one about to slip"));
        }
    };

    /// The elements of a contact that has long been sliding.
    constexpr State steady_state(const Contact<S>& contact) const {
        const S sense = sign(contact.speed), level = this->level(contact);
        State x{};
        for (int i = 0; i < stiffness.count; ++i) {
            x.torque[i] = sense * share[i] * level;
            x.slipping[i] = abs(sense);
        }
        return x;
    }

    /// Torque that opposes the motion, in N.m, for the elements as they stand.
    constexpr S torque(const State& x, const Contact<S>& contact) const {
        S sum{0.0};
        for (int i = 0; i < stiffness.count; ++i) sum = sum + x.torque[i];
        return sum + contact.viscous * viscous * contact.speed;
    }

    /// Rate of the elements [N.m/s], each as it sticks or slips. One that slips sticks as soon as the motion turns round, also
    /// before `renewed` does: otherwise a step in which it does would seem as exact as any other.
    constexpr State rate(const State& x, const Contact<S>& contact) const {
        const S level = this->level(contact), relaxation = this->relaxation(contact);
        State rates{};
        for (int i = 0; i < stiffness.count; ++i) {
            const S sense = select(x.torque[i] == S(0.0), sign(contact.speed), sign(x.torque[i]));
            const S drawn = (sense * share[i] * level - x.torque[i]) * relaxation;
            const auto turned = contact.speed * x.torque[i] < S(0.0);
            rates.torque[i] = select(slipping(x, i) & !turned, drawn, stiffness[i] * contact.speed);
        }
        return rates;
    }

    /// Forgetting rate of the elements [1/s]: zero while they stick.
    constexpr State relaxation_rate(const State& x, const Contact<S>& contact) const {
        const S relaxation = this->relaxation(contact);
        State rates{};
        for (int i = 0; i < stiffness.count; ++i) rates.torque[i] = select(slipping(x, i), relaxation, S(0.0));
        return rates;
    }

    /// No motion loads an element beyond alpha_i F_s, whatever the history; and while it sticks, not beyond alpha_i s(v) in the
    /// sense of the motion: there it is about to slip. The way back is free: it may carry more than s(v), if it stuck before the
    /// speed rose.
    constexpr State clamped(const State& x, const Contact<S>& contact) const {
        const S sense = sign(contact.speed), highest = contact.dry_most * this->highest() / total();
        const S level = min(this->level(contact), highest);
        State within = x;
        for (int i = 0; i < stiffness.count; ++i) {
            const S most = share[i] * highest, loaded = share[i] * level, carried = sense * x.torque[i];
            const auto moving = abs(sense) > S(0.0), sticks = !slipping(x, i);
            const auto full = moving & sticks & !(carried < loaded);
            within.torque[i] = select(full, sense * loaded, clip(x.torque[i], -most, most));
            within.slipping[i] = select(full, S(about_to_slip), x.slipping[i]);
        }
        return within;
    }

    /// Elements that slip from here on; for a solver that keeps this fixed over a step.
    constexpr State update_mode(const State& x, const Contact<S>& contact) const {
        const S sense = sign(contact.speed), level = this->level(contact);
        State next = x;
        for (int i = 0; i < stiffness.count; ++i) next.slipping[i] = select(slips(x, i, sense, share[i] * level), S(1.0), S(0.0));
        return next;
    }

    /// The elements after `dt` [s] under one contact: exact, also if elements begin to slip.
    constexpr State advance(const State& x, const Contact<S>& contact, const S& dt) const {
        const S sense = sign(contact.speed), path = abs(contact.speed) * dt, kept = exp(-relaxation(contact) * dt);
        const S full = this->level(contact);
        State next{};
        for (int i = 0; i < stiffness.count; ++i) {
            const S level = share[i] * full, carried = sense * x.torque[i];
            const auto slid = slips(x, i, sense, level);
            const S stuck = min(carried + stiffness[i] * path, level);
            const S moved = select(slid, level + (carried - level) * kept, stuck);
            next.torque[i] = select(sense == S(0.0), x.torque[i], sense * moved);
            next.slipping[i] = select(slid, S(1.0), select(stuck < level, S(0.0), abs(sense)));
        }
        return next;
    }

    /// Elastic energy [J] held by the elements.
    constexpr S stored(const State& x) const {
        S energy{0.0};
        for (int i = 0; i < stiffness.count; ++i) energy = energy + x.torque[i] * x.torque[i] / (S(2.0) * stiffness[i]);
        return energy;
    }

    /// Dissipates for every motion if this holds.
    constexpr Condition<S> passivity() const {
        return {"coulomb", coulomb, "breakaway", stiffness.count == 0 ? coulomb : breakaway, "N.m"};
    }

private:
    constexpr S highest() const { return max(breakaway, coulomb); }
    constexpr S sliding_torque(const S& speed) const { return stribeck_curve(coulomb, highest(), stribeck_speed, speed); }

    constexpr S total() const {
        S sum{0.0};
        for (int i = 0; i < share.count; ++i) sum = sum + share[i];
        return max(sum, S(smallest));
    }

    /// Torque of a share of one in steady sliding [N.m].
    constexpr S level(const Contact<S>& contact) const { return contact.dry * sliding_torque(contact.speed) / total(); }

    /// Rate at which a slipping element approaches its limit [1/s].
    constexpr S relaxation(const Contact<S>& contact) const {
        constexpr double max_rate = 1e30;  // 1/s: finite in every scalar, if there is no friction at all
        return attraction / max(sliding_torque(contact.speed), max(attraction / S(max_rate), S(smallest)));
    }

    static constexpr double about_to_slip = 0.5;
    static constexpr auto slipping(const State& x, int i) { return x.slipping[i] > S(about_to_slip); }

    /// True if an element slips in a motion of this sense: it carries its limit, or has reached it this way before.
    static constexpr auto slips(const State& x, int i, const S& sense, const S& level) {
        const S carried = sense * x.torque[i];
        const auto goes_on = (x.slipping[i] > S(0.0)) & !(carried < S(0.0));
        return (abs(sense) > S(0.0)) & !((carried < level) & !goes_on);
    }
};

}  // namespace strainwave::friction
