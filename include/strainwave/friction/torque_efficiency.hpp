#pragma once
#include <strainwave/friction/contact.hpp>

namespace strainwave::friction {

template <class S>
struct TorqueEfficiency {
    S average_loss{0.2};
    S difference_loss{0.0};
    S presliding{0.01};
    S viscous{0.0};

    static constexpr auto name = "torque_efficiency";
    static constexpr auto source =
        "public thread google-deepmind/mujoco#3528, comment of 2026-09-18 (there tau is the electrical torque of the motor)";
    static constexpr bool odd = true;
    static constexpr auto doc = R"(
        Friction proportional to the torque transmitted, which reverses over a presliding angle.

        .. math:: \dot z = (v - |v| z) / h, \qquad F = \mu_{avg} |T| z + \mu_{dif} T z^2 + b v

        with v the speed of the place it acts on, T the torque it transmits (load), z the engagement, +1 or -1 in steady
        motion, mu_avg = average_loss, mu_dif = difference_loss, h = presliding, b = viscous. In steady motion the loss per
        torque transmitted is mu_avg + mu_dif when driving (T v > 0) and mu_avg - mu_dif when back-driven: LoadDependent with
        equal ratios in both senses. mu_avg must be at least the size of mu_dif: otherwise steady motion creates energy.

        Under constant load it dissipates for every motion, with the stored energy mu_avg T h z^2 / 2 (size of T). If the load
        varies, this energy varies with it: a change of load can add energy that the next motion takes out. It does not stick
        at rest: it yields by about h. Leaves out losses of an idle gear other than b v. The thread's tau is the torque of the
        motor; T is the torque on the side of the output, so a ratio m of the thread when driving is m / (1 - m) here.

        >>> from strainwave.friction import TorqueEfficiency
        >>> TorqueEfficiency(average_loss=0.25, difference_loss=0.05, presliding=0.001).steady([10.0, -10.0], load=4.0)
        array([ 1.2, -0.8]))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, average_loss, "1", "Loss per torque transmitted, mean of driving and back-driving", 0));
        visit(SW_FIELD(m, difference_loss, "1",
                       "Half the difference of the losses when driving and when back-driven, per torque transmitted"));
        visit(SW_REQUIRED(m, presliding, "rad", "Presliding angle h over which the loss reverses", smallest));
        visit(SW_FIELD(m, viscous, "N.m.s/rad", "Torque per speed", 0));
    }

    constexpr const char* problem() const {
        return all(average_loss >= abs(difference_loss)) ? nullptr : "average_loss must be at least the size of difference_loss";
    }

    struct State {
        S engagement{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, engagement, "1", "Engagement z: the sense of motion, lagging by the presliding angle"));
        }
    };

    /// The engagement of a contact that has long been sliding.
    constexpr State steady_state(const Contact<S>& contact) const { return {sign(contact.speed)}; }

    /// Torque that opposes the motion, in N.m, for the present engagement.
    constexpr S torque(const State& x, const Contact<S>& contact) const {
        const S z = x.engagement, loss = contact.dry * z * (along(contact.load, average_loss) + difference_loss * z);
        return loss * contact.load + contact.viscous * viscous * contact.speed;
    }

    /// Rate of the engagement [1/s].
    constexpr State rate(const State& x, const Contact<S>& contact) const {
        return {(contact.speed - abs(contact.speed) * x.engagement) / angle(contact)};
    }

    /// Forgetting rate of the engagement [1/s].
    constexpr State relaxation_rate(const State&, const Contact<S>& contact) const { return {abs(contact.speed) / angle(contact)}; }

    /// No motion engages more than fully: an exact invariant.
    constexpr State clamped(const State& x, const Contact<S>&) const { return {clip(x.engagement, S(-1.0), S(1.0))}; }

    /// The engagement after `dt` [s] under one contact: the exact solution.
    constexpr State advance(const State& x, const Contact<S>& contact, const S& dt) const {
        const S full = steady_state(contact).engagement;
        return {full + (x.engagement - full) * exp(-relaxation_rate(x, contact).engagement * dt)};
    }

    /// Energy [J] held by the engagement under this load.
    constexpr S stored(const State& x, const Contact<S>& contact) const {
        return S(0.5) * contact.dry * average_loss * abs(contact.load) * presliding * x.engagement * x.engagement;
    }

private:
    /// `presliding`, unless the engagement follows faster than numbers resolve.
    constexpr S angle(const Contact<S>& contact) const {
        constexpr double max_rate = 1267650600228229401496703205376.0;  // 1/s: 2^100, finite in every scalar
        return max(presliding, abs(contact.speed) / S(max_rate));
    }
};

}  // namespace strainwave::friction
