#pragma once
#include <strainwave/structure/structure.hpp>

#include "part.hpp"

namespace strainwave::general {

/// Bodies within a gear, by any law.
template <class S>
struct Structure : Part {
    using State = Storage<S, 24>;
    using Output = OutputStorage<S, 10>;
    using Shafts = structure::Shafts<S>;
    using Mesh = structure::Mesh<S, State>;
    using Load = structure::Load<S>;
    using Reaction = structure::Reaction<S, State>;
    using Bodies = structure::Bodies<S>;
    using Unevenness = structure::Unevenness<S>;

    void read(kernel::Reader<S>& from);
    void places(Places& found) const;
    void output_places(Places& found) const;

    State initial_state() const;
    bool rigid() const;
    structure::Generator<S> generator(const State& inner, const Shafts& at) const;
    S generator_acceleration(const State& rate, const S& input_acceleration) const;
    S gap(const State& inner, const Shafts& at) const;
    S spring_twist(const State& inner, const Shafts& at, const S& deformation) const;
    S spring_twist_rate(const State& inner, const Shafts& at, const Mesh& mesh) const;
    S deformation_rate(const State& inner, const Mesh& mesh) const;
    Reaction reaction(const State& inner, const Shafts& at, const Mesh& mesh, const Load& load) const;
    Reaction even_reaction(const State& inner, const Shafts& at, const Mesh& mesh, const Load& load) const;
    structure::Energies<S> energies(const State& inner, const Shafts& at, const Mesh& mesh, const Load& load) const;
    Output output(const State& inner, const Shafts& at, const Mesh& mesh, const S& friction) const;
    structure::SteadyState<S, State> steady_state(const State& inner, const Shafts& at, const Mesh& mesh, const Load& load) const;
    S compliance(const Shafts& at, const Mesh& mesh) const;
    S natural_frequency(const Bodies& bodies) const;
    S uneven_frequency(const Bodies& bodies, const Unevenness& of) const;
    S uneven_decay(const Bodies& bodies, const Unevenness& of) const;
    S decay(const Bodies& bodies) const;
};

}  // namespace strainwave::general
