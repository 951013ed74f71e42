#include "structure.hpp"

#include <strainwave/ring/models.hpp>
#include <strainwave/structure/models.hpp>

#include "laws.hpp"
#include "spring_factors.hpp"

namespace strainwave::general {

namespace {

template <template <class...> class Ring>
struct With {
    template <class S>
    using Staged = structure::Staged<S, Ring<S>, Variation<S>>;
};
template <class L>
struct WithEach;
template <template <class...> class... Ring>
struct WithEach<List<Ring...>> {
    using type = List<structure::Lumped, With<Ring>::template Staged...>;
};

}  // namespace

/// Stages with each vibration of the ring are a law of their own, so that the state of each has a fixed size.
template <class S>
using StructureLaws = Laws<S, WithEach<ring::Models>::type>;

template <class Reaction, class State>
Reaction pack_reaction(const auto& reaction) {
    return {reaction.torque, reaction.input_torque, pack_slots<State>(reaction.rate)};
}

/// The law of the structure; after it, of one in stages, that of its ring.
template <class S>
void Structure<S>::read(kernel::Reader<S>& from) {
    chosen = *from.laws++;
    if (chosen > 0) chosen += *from.laws++;
    StructureLaws<S>::read_chosen(*this, from);
}
SW_STATE(Structure)
SW_OUTPUT_PLACES(Structure)
SW_CALL(Structure, bool, rigid, (), law.rigid())
SW_CALL(Structure, structure::Generator<S>, generator, (const State& inner, const Shafts& at),
        law.generator(unpack_state<S>(law, inner), at))
SW_CALL(Structure, S, generator_acceleration, (const State& rate, const S& input_acceleration),
        law.generator_acceleration(unpack_state<S>(law, rate), input_acceleration))
SW_CALL(Structure, S, gap, (const State& inner, const Shafts& at), law.gap(unpack_state<S>(law, inner), at))
SW_CALL(Structure, S, spring_twist, (const State& inner, const Shafts& at, const S& deformation),
        law.spring_twist(unpack_state<S>(law, inner), at, deformation))
SW_CALL(Structure, S, spring_twist_rate, (const State& inner, const Shafts& at, const Mesh& mesh),
        law.spring_twist_rate(unpack_state<S>(law, inner), at, mesh))
SW_CALL(Structure, S, deformation_rate, (const State& inner, const Mesh& mesh),
        law.deformation_rate(unpack_state<S>(law, inner), mesh))
SW_CALL(Structure, Reaction, reaction, (const State& inner, const Shafts& at, const Mesh& mesh, const Load& load),
        pack_reaction<Reaction, State>(law.reaction(unpack_state<S>(law, inner), at, mesh, load)))
SW_CALL(Structure, Reaction, even_reaction, (const State& inner, const Shafts& at, const Mesh& mesh, const Load& load),
        pack_reaction<Reaction, State>(law.even_reaction(unpack_state<S>(law, inner), at, mesh, load)))
SW_CALL(Structure, structure::Energies<S>, energies, (const State& inner, const Shafts& at, const Mesh& mesh, const Load& load),
        law.energies(unpack_state<S>(law, inner), at, mesh, load))
SW_PACK(Structure, Output, output, (const State& inner, const Shafts& at, const Mesh& mesh, const S& friction),
        law.output(unpack_state<S>(law, inner), at, mesh, friction))
template <class S>
auto Structure<S>::steady_state(const State& inner, const Shafts& at, const Mesh& mesh, const Load& load) const
    -> structure::SteadyState<S, State> {
    return StructureLaws<S>::visit(*this, [&](const auto& law) {
        const auto found = law.steady_state(unpack_state<S>(law, inner), at, mesh, load);
        return structure::SteadyState<S, State>{pack_slots<State>(found.state), found.transmission_error};
    });
}
SW_CALL(Structure, S, compliance, (const Shafts& at, const Mesh& mesh), law.compliance(at, mesh))
SW_CALL(Structure, S, natural_frequency, (const Bodies& bodies), law.natural_frequency(bodies))
SW_CALL(Structure, S, uneven_frequency, (const Bodies& bodies, const Unevenness& of), law.uneven_frequency(bodies, of))
SW_CALL(Structure, S, uneven_decay, (const Bodies& bodies, const Unevenness& of), law.uneven_decay(bodies, of))
SW_CALL(Structure, S, decay, (const Bodies& bodies), law.decay(bodies))

SW_GENERAL(Structure)

}  // namespace strainwave::general
