#pragma once
#include <strainwave/condition.hpp>
#include <strainwave/ring/ring.hpp>

namespace strainwave::ring {

template <class S>
struct Modes {
    static constexpr int capacity = 4;

    Sequence<S, capacity> natural_frequency{};
    Sequence<S, capacity> waves{};
    Sequence<S, capacity> damping{};
    Sequence<S, capacity> mass{};

    static constexpr auto name = "modes";
    static constexpr auto source =
        "Love1927, section 293, for the modes of an inextensional ring, which occur in pairs; how the mesh under the lobes "
        "drives them, and their reaction on the wave generator, are derived here from the energies";
    static constexpr auto doc = R"(
        Modes of the flexspline's ring, which the mesh drives under the lobes as they pass around it.

        .. math:: m_k (\ddot z_k + 2 \zeta_k \omega_k \dot z_k + \omega_k^2 z_k) = F_m e^{i n_k \theta}, \qquad
                  u = \operatorname{Re} \sum_k z_k e^{-i n_k \theta}

        .. math:: \mu \leftarrow \mu - u, \qquad T_{ring} = F_m \frac{\partial u}{\partial \theta}
                  = F_m \sum_k n_k \operatorname{Im}(z_k e^{-i n_k \theta})

        with theta the angle of the wave generator in the frame of the flexspline, F_m the mesh force and mu the deformation of
        the mesh, both along its line of action, u the displacement of the teeth in that direction, omega_k =
        natural_frequency, n_k = waves, zeta_k = damping, m_k = mass; up to 4 modes. T_ring drives the wave generator on.

        A mode with n waves around the ring is a pair, z = a + i b: a cos(n phi) + b sin(n phi) at the place phi. The lobes meet
        it at theta and theta + pi. Two equal lobes drive modes of even n only; to an odd n a first lobe with the share p of the
        force gives the mass m / (2 p - 1)^2. The force of the lobes does the work F_m du (reciprocity), so that it drives a by
        F_m cos(n theta) and b by F_m sin(n theta). The contact passes around the ring, so that the same force works against the
        wave generator: without T_ring energy is not conserved. The frame of the flexspline is that of the held flexspline, or
        turns with the output, where theta = theta_WG (1 - 1/i); the twists within the gear are left out of theta.

        A constant force on a generator of the speed W deflects the mesh by u = F_m / (m (omega^2 - n^2 W^2)), so that the
        critical speeds are omega / n. A force of order q, F_m cos(q theta), makes u a vibration of order q too, that of (F_m /
        2) Re[(H((q + n) W) + H((q - n) W)) exp(i q theta)], with H(s) = 1 / (m (omega^2 - s^2 + 2 i zeta omega s)): order q is
        largest at the speeds omega / (q + n) and omega / |q - n|. A sensor on the ring measures the orders q + n and |q - n|.
        A mode that does not follow the ring's waves (torsion, bending of the cup's axis in the housing) has n = 0: order q is
        largest at omega / q.

        m is the mass at the mesh: 1 / phi^2, with phi the displacement along the line of action, mean over the engaged teeth,
        of the shape that is scaled to unit modal mass. For a thin free ring of mass M and radius R, radial displacement cos(n
        phi), circumferential displacement -sin(n phi) / n, and pressure angle alpha

        .. math:: \omega_n^2 = \frac{E I}{\rho A R^4} \frac{n^2 (n^2 - 1)^2}{n^2 + 1}, \qquad
                  m_n = \frac{M}{2} \frac{1 + 1/n^2}{\sin^2 \alpha + \cos^2 \alpha / n^2}

        A ring with cup and wave generator is stiffer: take frequencies, shapes and masses of a finite-element model or of a
        modal test. The bearing of the wave generator, as stiff all around, belongs to the ring in these modes.

        Valid for displacements that are small against the teeth, and for a ring that is the same all around. Leaves out the
        turn of the ring itself (Coriolis and centrifugal forces, at the speed of the output), the motion of the bearing by
        these modes, and all coupling of modes but that by the mesh. A fixed step h must be short against 1 / (n W). Beyond 3
        rad of a mode a step lets its vibration grow by up to 0.01 (n W h)^2, which the damping exceeds if h < 100 zeta omega /
        (n W)^2.

        >>> from strainwave.ring import Modes
        >>> ring = Modes(natural_frequency=[6000.0], waves=[2], damping=[0.01], mass=[0.05])
        >>> ring.natural_frequency[0] / ring.waves[0]  # critical speed, rad/s
        3000.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, natural_frequency, "rad/s", "Natural frequency omega_k", smallest));
        visit(SW_REQUIRED(m, waves, "1", "Waves n_k around the ring, 0 of a mode that does not follow them", 0, 1000, true));
        visit(SW_REQUIRED(m, damping, "1", "Damping zeta_k, relative to the critical one", 0, 1));
        visit(SW_REQUIRED(m, mass, "kg", "Mass m_k at the mesh, along the line of action", smallest));
    }

    constexpr const char* problem() const {
        const int count = natural_frequency.count;
        return waves.count == count && damping.count == count && mass.count == count
                   ? nullptr
                   : "natural_frequency, waves, damping and mass must have equally many elements";
    }

    /// The pairs as seen from the lobes: z exp(-i n theta), and the speed of z turned alike.
    struct State {
        Array<S, capacity> displacement{};
        Array<S, capacity> cross_displacement{};
        Array<S, capacity> speed{};
        Array<S, capacity> cross_speed{};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, displacement, "m", "Displacement under the lobes, by each mode"));
            visit(SW_FIELD(m, cross_displacement, "m", "Displacement a quarter of a wave ahead of the lobes"));
            visit(SW_FIELD(m, speed, "m/s", "Speed of the ring under the lobes"));
            visit(SW_FIELD(m, cross_speed, "m/s", "Speed of the ring a quarter of a wave ahead of the lobes"));
        }
    };

    struct Compiled {
        static constexpr int capacity = Modes::capacity;
        using State = typename Modes::State;

        Array<Mode<S>, capacity> each;
        Array<S, capacity> waves;
        int count;

        constexpr bool active() const { return count > 0; }
        constexpr int size() const { return count; }
        constexpr const Mode<S>& mode(int i) const { return each[i]; }

        constexpr S displacement(const State& x) const {
            return sum([&](int i) { return x.displacement[i]; });
        }
        constexpr S displacement_rate(const State& x, const S& speed) const {
            return sum([&](int i) { return x.speed[i] + speed * (waves[i] * x.cross_displacement[i]); });
        }
        constexpr S torque(const State& x, const S& force) const {
            return force * sum([&](int i) { return waves[i] * x.cross_displacement[i]; });
        }
        constexpr State rate(const State& x, const S& force, const S& speed) const {
            State rate{};
            for (int i = 0; i < count; ++i) {
                const Mode<S>& of = each[i];
                const S turning = waves[i] * speed, inverse = S(1.0) / of.mass;
                const auto acceleration = [&](const S& pushing, const S& displaced, const S& moving) {
                    return inverse * (pushing - of.stiffness * displaced - of.damping * moving);
                };
                rate.displacement[i] = x.speed[i] + turning * x.cross_displacement[i];
                rate.cross_displacement[i] = x.cross_speed[i] - turning * x.displacement[i];
                rate.speed[i] = acceleration(force, x.displacement[i], x.speed[i]) + turning * x.cross_speed[i];
                rate.cross_speed[i] = acceleration(S(0.0), x.cross_displacement[i], x.cross_speed[i]) - turning * x.speed[i];
            }
            return rate;
        }
        constexpr State steady_state(const S& force, const S& speed) const {
            State x{};
            for (int i = 0; i < count; ++i) {
                const Mode<S>& of = each[i];
                const S turning = waves[i] * speed, stiff = of.stiffness - of.mass * turning * turning;
                const S drag = of.damping * turning, share = force / (stiff * stiff + drag * drag);
                x.displacement[i] = share * stiff;
                x.cross_displacement[i] = -share * drag;
                x.speed[i] = -turning * x.cross_displacement[i];
                x.cross_speed[i] = turning * x.displacement[i];
            }
            return x;
        }
        constexpr Energies<S> energies(const State& x) const {
            const auto square = [](const S& one, const S& other) { return one * one + other * other; };
            const auto moving = [&](int i) { return square(x.speed[i], x.cross_speed[i]); };
            return {sum([&](int i) { return S(0.5) * each[i].stiffness * square(x.displacement[i], x.cross_displacement[i]); }),
                    sum([&](int i) { return S(0.5) * each[i].mass * moving(i); }),
                    sum([&](int i) { return each[i].damping * moving(i); })};
        }
        constexpr S compliance() const {
            return sum([&](int i) { return S(1.0) / each[i].stiffness; });
        }

    private:
        template <class Of>
        constexpr S sum(const Of& of) const {
            S total{0.0};
            for (int i = 0; i < count; ++i) total = total + of(i);
            return total;
        }
    };

    constexpr bool active() const { return natural_frequency.count > 0; }

    constexpr Compiled compile() const {
        Compiled all{};
        all.count = natural_frequency.count;
        for (int i = 0; i < all.count; ++i) {
            const S omega = natural_frequency[i];
            all.each[i] = {mass[i], mass[i] * omega * omega, S(2.0) * damping[i] * omega * mass[i]};
            all.waves[i] = waves[i];
        }
        return all;
    }
};

}  // namespace strainwave::ring
