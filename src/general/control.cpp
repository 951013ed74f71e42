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

SW_READ(Control)
SW_STATE(Control)
template <class S>
void Control<S>::discrete_places(Places& found) const {
    ControlLaws<S>::visit(*this, [&](const auto& law) { add_places<S>(law, control::initial_discrete<S>(law), found); });
}
SW_PACK(Control, Discrete, initial_discrete, (), control::initial_discrete<S>(law))
template <class S>
S Control<S>::act(const State& x, const Command& command, const Measurement& measured) const {
    return ControlLaws<S>::visit(*this, [&]<class Law>(const Law& law) {
        if constexpr (requires { typename Law::Discrete; })
            return S(0.0);  // no law that samples stands within another
        else
            return law.act(unpack_state<S>(law, x), command, measured);
    });
}
SW_PACK(Control, State, rate, (const State& x, const Command& command, const Measurement& measured),
        law.rate(unpack_state<S>(law, x), command, measured))
SW_PACK(Control, State, relaxation_rate, (), law.relaxation_rate())
SW_CALL(Control, S, fastest, (), strainwave::fastest<S>(law))
SW_CALL(Control, S, actuation, (const State& x, const Discrete& held, const Command& command, const Measurement& measured),
        control::actuation(law, unpack_state<S>(law, x), unpack_discrete<S>(law, held), command, measured))
SW_CALL(Control, S, held, (const Discrete& x), control::held<S>(law, unpack_discrete<S>(law, x)))
SW_PACK(Control, Discrete, sampled, (const Discrete& x, const S& within, const Command& command, const Measurement& measured),
        control::sampled(law, unpack_discrete<S>(law, x), within, command, measured))
SW_PACK(Control, Discrete, elapsed, (const Discrete& x, const S& dt), control::elapsed(law, unpack_discrete<S>(law, x), dt))
SW_CALL(Control, bool, due, (const Discrete& x, const S& within), control::due(law, unpack_discrete<S>(law, x), within))
SW_CALL(Control, control::Schedule<S>, schedule, (const Discrete& x), control::schedule<S>(law, unpack_discrete<S>(law, x)))

SW_GENERAL(Control)

}  // namespace strainwave::general
