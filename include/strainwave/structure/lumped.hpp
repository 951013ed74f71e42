#pragma once
#include <strainwave/math.hpp>
#include <strainwave/structure/structure.hpp>

namespace strainwave::structure {

template <class S>
struct Lumped {
    static constexpr auto name = "lumped";
    static constexpr auto source = SW_REVIEW ", sections 1-4";
    static constexpr auto doc = R"(
        Lumped gear of one spring, without bodies that have their own motion.

        .. math:: T_{out} = T, \qquad T_{in} = T\,(1/i - e'(\theta_{in}))

        with T_out the torque on the output, T_in the torque that holds the input back, T the torque of the spring, its
        hysteresis and damping, i the ratio, e' the derivative of the kinematic error by the input angle. The wave generator
        turns with the input shaft. The ``stiffness`` of the gear is that of flexspline, mesh and bearings in series. Valid for
        motions that are slow against the vibration of the bodies within the gear, about 1e4 rad/s; Staged has these bodies.

        >>> import strainwave as sw
        >>> sw.Gear(stiffness=sw.stiffness.Linear(k=16e3)).structure
        Lumped())";

    template <class Self, class Visit>
    static constexpr void fields(Self&, Visit&&) {}

    using State = Stateless<S>;
    using Output = Stateless<S>;

    static constexpr bool rigid() { return true; }
    constexpr Generator<S> generator(const State&, const Shafts<S>& at) const { return {at.input_angle, at.input_speed}; }
    constexpr S generator_acceleration(const State&, const S& input_acceleration) const { return input_acceleration; }
    constexpr S gap(const State&, const Shafts<S>& at) const { return at.transmission_error; }
    constexpr S spring_twist(const State&, const Shafts<S>&, const S& deformation) const { return deformation; }
    template <class Mesh>
    constexpr S spring_twist_rate(const State&, const Shafts<S>& at, const Mesh& mesh) const {
        return mesh.per_input * at.input_speed - mesh.per_output * at.output_speed;
    }
    template <class Mesh>
    constexpr S deformation_rate(const State&, const Mesh& mesh) const {
        return mesh.twist_rate;
    }
    template <class Mesh>
    constexpr Reaction<S, State> reaction(const State&, const Shafts<S>&, const Mesh& mesh, const Load<S>& load) const {
        return {load.spring * mesh.per_output, load.spring * mesh.per_input + load.turning, {}};
    }
    template <class Mesh>
    constexpr Reaction<S, State> even_reaction(const State& inner, const Shafts<S>& at, const Mesh& mesh,
                                               const Load<S>& load) const {
        return reaction(inner, at, mesh, load);
    }
    template <class Mesh>
    constexpr Energies<S> energies(const State&, const Shafts<S>&, const Mesh&, const Load<S>&) const {
        return {};
    }
    template <class Mesh>
    constexpr Output output(const State&, const Shafts<S>&, const Mesh&, const S&) const {
        return {};
    }
    template <class Mesh>
    constexpr SteadyState<S, State> steady_state(const State&, const Shafts<S>&, const Mesh& mesh, const Load<S>&) const {
        return {{}, mesh.error + mesh.twist};
    }
    template <class Mesh>
    constexpr S compliance(const Shafts<S>&, const Mesh&) const {
        return S(0.0);
    }
    constexpr S natural_frequency(const Bodies<S>&) const { return S(0.0); }
    constexpr S uneven_frequency(const Bodies<S>&, const Unevenness<S>&) const { return S(0.0); }
    constexpr S uneven_decay(const Bodies<S>& bodies, const Unevenness<S>& of) const {
        return bodies.stiffness * of.per_speed * (abs(bodies.inverse_ratio) + of.slope) / bodies.input_inertia;
    }
    constexpr S decay(const Bodies<S>&) const { return S(0.0); }
};

}  // namespace strainwave::structure
