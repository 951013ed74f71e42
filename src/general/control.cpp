#include "control.hpp"

#include <strainwave/control/models.hpp>
#include <strainwave/fastest.hpp>

#include "compensation.hpp"
#include "drive.hpp"
#include "laws.hpp"

namespace strainwave::general {

namespace detail {

template <class S>
struct AroundAny {
    using type = control::Sampled<S, Control<S>, AnyCompensation<S>>;
};
template <>
struct Around<control::Sampled<double>, Control<double>> : AroundAny<double> {};
template <>
struct Around<control::Sampled<Slope>, Control<Slope>> : AroundAny<Slope> {};

/// A law that contains a model of the drive contains any gear and any load.
template <class S, template <class, class, class> class Law>
struct AroundModel {
    using type = Law<S, GeneralGear<S>, general::Load<S>>;
};
#define SW_AROUND_MODEL(Law)                                                                     \
    template <>                                                                                  \
    struct Around<control::Law<double>, Control<double>> : AroundModel<double, control::Law> {}; \
    template <>                                                                                  \
    struct Around<control::Law<Slope>, Control<Slope>> : AroundModel<Slope, control::Law> {};
SW_AROUND_MODEL(FeedbackLinearisation)
SW_AROUND_MODEL(KinematicErrorTracking)
#undef SW_AROUND_MODEL

}  // namespace detail

template <class S>
using ControlLaws = Laws<S, control::Models, Control<S>>;

template <class S>
void Control<S>::read(kernel::Reader<S>& from) {
    ControlLaws<S>::read(*this, from);
}
template <class S>
void Control<S>::places(Places& found) const {
    ControlLaws<S>::visit(*this, [&](const auto& law) { add_state_places<S>(law, found); });
}
template <class S>
void Control<S>::discrete_places(Places& found) const {
    ControlLaws<S>::visit(*this, [&](const auto& law) { add_places<S>(law, control::initial_discrete<S>(law), found); });
}
template <class S>
auto Control<S>::initial_state() const -> State {
    return ControlLaws<S>::visit(*this, [](const auto& law) { return pack_slots<State>(strainwave::initial_state(law)); });
}
template <class S>
auto Control<S>::initial_discrete() const -> Discrete {
    return ControlLaws<S>::visit(*this, [](const auto& law) { return pack_slots<Discrete>(control::initial_discrete<S>(law)); });
}
template <class S>
S Control<S>::act(const State& x, const Command& command, const Measurement& measured) const {
    return ControlLaws<S>::visit(*this, [&]<class Law>(const Law& law) {
        if constexpr (requires { typename Law::Discrete; })
            return S(0.0);  // no law that samples stands within another
        else
            return law.act(unpack_state<S>(law, x), command, measured);
    });
}
template <class S>
auto Control<S>::rate(const State& x, const Command& command, const Measurement& measured) const -> State {
    return ControlLaws<S>::visit(
        *this, [&](const auto& law) { return pack_slots<State>(law.rate(unpack_state<S>(law, x), command, measured)); });
}
template <class S>
auto Control<S>::relaxation_rate() const -> State {
    return ControlLaws<S>::visit(*this, [](const auto& law) { return pack_slots<State>(law.relaxation_rate()); });
}
template <class S>
S Control<S>::fastest() const {
    return ControlLaws<S>::visit(*this, [](const auto& law) { return strainwave::fastest<S>(law); });
}
template <class S>
S Control<S>::actuation(const State& x, const Discrete& held, const Command& command, const Measurement& measured) const {
    return ControlLaws<S>::visit(*this, [&](const auto& law) {
        return control::actuation(law, unpack_state<S>(law, x), unpack_discrete<S>(law, held), command, measured);
    });
}
template <class S>
S Control<S>::held(const Discrete& x) const {
    return ControlLaws<S>::visit(*this, [&](const auto& law) { return control::held<S>(law, unpack_discrete<S>(law, x)); });
}
template <class S>
auto Control<S>::sampled(const Discrete& x, const S& within, const Command& command, const Measurement& measured) const
    -> Discrete {
    return ControlLaws<S>::visit(*this, [&](const auto& law) {
        return pack_slots<Discrete>(control::sampled(law, unpack_discrete<S>(law, x), within, command, measured));
    });
}
template <class S>
auto Control<S>::elapsed(const Discrete& x, const S& dt) const -> Discrete {
    return ControlLaws<S>::visit(
        *this, [&](const auto& law) { return pack_slots<Discrete>(control::elapsed(law, unpack_discrete<S>(law, x), dt)); });
}
template <class S>
bool Control<S>::due(const Discrete& x, const S& within) const {
    return ControlLaws<S>::visit(*this, [&](const auto& law) { return control::due(law, unpack_discrete<S>(law, x), within); });
}
template <class S>
control::Schedule<S> Control<S>::schedule(const Discrete& x) const {
    return ControlLaws<S>::visit(*this, [&](const auto& law) { return control::schedule<S>(law, unpack_discrete<S>(law, x)); });
}

SW_GENERAL(Control)

}  // namespace strainwave::general
