#include "structure.hpp"

#include <strainwave/structure/models.hpp>

#include "laws.hpp"
#include "spring_factors.hpp"

namespace strainwave::general {

template <class S>
using StructureLaws = Laws<S, structure::Models, Variation<S>>;

template <class S>
void Structure<S>::read(kernel::Reader<S>& from) {
    StructureLaws<S>::read(*this, from);
}
template <class S>
void Structure<S>::places(Places& found) const {
    StructureLaws<S>::visit(*this, [&](const auto& law) { add_state_places<S>(law, found); });
}
template <class S>
void Structure<S>::output_places(Places& found) const {
    StructureLaws<S>::visit(*this, [&]<class Law>(const Law& law) { add_places<S>(law, typename Law::Output{}, found); });
}
template <class S>
auto Structure<S>::initial_state() const -> State {
    return StructureLaws<S>::visit(*this, [](const auto& law) { return pack_slots<State>(strainwave::initial_state(law)); });
}
template <class S>
bool Structure<S>::rigid() const {
    return StructureLaws<S>::visit(*this, [](const auto& law) { return law.rigid(); });
}
template <class S>
structure::Generator<S> Structure<S>::generator(const State& inner, const Shafts& at) const {
    return StructureLaws<S>::visit(*this, [&](const auto& law) { return law.generator(unpack_state<S>(law, inner), at); });
}
template <class S>
S Structure<S>::generator_acceleration(const State& rate, const S& input_acceleration) const {
    return StructureLaws<S>::visit(
        *this, [&](const auto& law) { return law.generator_acceleration(unpack_state<S>(law, rate), input_acceleration); });
}
template <class S>
S Structure<S>::gap(const State& inner, const Shafts& at) const {
    return StructureLaws<S>::visit(*this, [&](const auto& law) { return law.gap(unpack_state<S>(law, inner), at); });
}
template <class S>
S Structure<S>::spring_twist(const State& inner, const Shafts& at, const S& deformation) const {
    return StructureLaws<S>::visit(*this,
                                   [&](const auto& law) { return law.spring_twist(unpack_state<S>(law, inner), at, deformation); });
}
template <class S>
S Structure<S>::spring_twist_rate(const State& inner, const Shafts& at, const Mesh& mesh) const {
    return StructureLaws<S>::visit(*this,
                                   [&](const auto& law) { return law.spring_twist_rate(unpack_state<S>(law, inner), at, mesh); });
}
template <class S>
S Structure<S>::deformation_rate(const State& inner, const Mesh& mesh) const {
    return StructureLaws<S>::visit(*this, [&](const auto& law) { return law.deformation_rate(unpack_state<S>(law, inner), mesh); });
}
template <class S>
auto Structure<S>::reaction(const State& inner, const Shafts& at, const Mesh& mesh, const Load& load) const -> Reaction {
    return StructureLaws<S>::visit(*this, [&](const auto& law) {
        const auto found = law.reaction(unpack_state<S>(law, inner), at, mesh, load);
        return Reaction{found.torque, found.input_torque, pack_slots<State>(found.rate)};
    });
}
template <class S>
auto Structure<S>::even_reaction(const State& inner, const Shafts& at, const Mesh& mesh, const Load& load) const -> Reaction {
    return StructureLaws<S>::visit(*this, [&](const auto& law) {
        const auto found = law.even_reaction(unpack_state<S>(law, inner), at, mesh, load);
        return Reaction{found.torque, found.input_torque, pack_slots<State>(found.rate)};
    });
}
template <class S>
structure::Energies<S> Structure<S>::energies(const State& inner, const Shafts& at, const Mesh& mesh, const Load& load) const {
    return StructureLaws<S>::visit(*this,
                                   [&](const auto& law) { return law.energies(unpack_state<S>(law, inner), at, mesh, load); });
}
template <class S>
auto Structure<S>::output(const State& inner, const Shafts& at, const Mesh& mesh, const S& friction) const -> Output {
    return StructureLaws<S>::visit(
        *this, [&](const auto& law) { return pack_slots<Output>(law.output(unpack_state<S>(law, inner), at, mesh, friction)); });
}
template <class S>
auto Structure<S>::steady_state(const State& inner, const Shafts& at, const Mesh& mesh, const Load& load) const
    -> structure::SteadyState<S, State> {
    return StructureLaws<S>::visit(*this, [&](const auto& law) {
        const auto found = law.steady_state(unpack_state<S>(law, inner), at, mesh, load);
        return structure::SteadyState<S, State>{pack_slots<State>(found.state), found.transmission_error};
    });
}
template <class S>
S Structure<S>::compliance(const Shafts& at, const Mesh& mesh) const {
    return StructureLaws<S>::visit(*this, [&](const auto& law) { return law.compliance(at, mesh); });
}
template <class S>
S Structure<S>::natural_frequency(const Bodies& bodies) const {
    return StructureLaws<S>::visit(*this, [&](const auto& law) { return law.natural_frequency(bodies); });
}
template <class S>
S Structure<S>::uneven_frequency(const Bodies& bodies, const Unevenness& of) const {
    return StructureLaws<S>::visit(*this, [&](const auto& law) { return law.uneven_frequency(bodies, of); });
}
template <class S>
S Structure<S>::uneven_decay(const Bodies& bodies, const Unevenness& of) const {
    return StructureLaws<S>::visit(*this, [&](const auto& law) { return law.uneven_decay(bodies, of); });
}
template <class S>
S Structure<S>::decay(const Bodies& bodies) const {
    return StructureLaws<S>::visit(*this, [&](const auto& law) { return law.decay(bodies); });
}

SW_GENERAL(Structure)

}  // namespace strainwave::general
