#include "compensation.hpp"

#include <strainwave/compensation/models.hpp>

#include "drive.hpp"
#include "laws.hpp"

namespace strainwave::general {

/// Placeholder for the gear and the load of a feed-forward.
struct ModelWithin {};

namespace detail {

template <class S>
struct AroundModel {
    using type = compensation::ModelFeedforward<S, GeneralGear<S>, general::Load<S>>;
};
template <>
struct Around<compensation::ModelFeedforward<double>, ModelWithin> : AroundModel<double> {};
template <>
struct Around<compensation::ModelFeedforward<Slope>, ModelWithin> : AroundModel<Slope> {};

}  // namespace detail

template <class S, Requests list>
using FeedforwardLaws =
    Laws<S, std::conditional_t<list == Requests::dither, compensation::Dithers, compensation::Feedforwards>, ModelWithin>;
template <class S, Corrections list>
using CorrectionLaws =
    Laws<S, std::conditional_t<list == Corrections::observer, compensation::Observers, compensation::Learners>, Friction<S>>;

template <class S, Requests list>
void Feedforward<S, list>::read(kernel::Reader<S>& from) {
    FeedforwardLaws<S, list>::read(*this, from);
}
template <class S, Requests list>
void Feedforward<S, list>::places(Places& found) const {
    FeedforwardLaws<S, list>::visit(*this, [&](const auto& law) { add_state_places<S>(law, found); });
}
template <class S, Requests list>
auto Feedforward<S, list>::initial_state() const -> State {
    return FeedforwardLaws<S, list>::visit(*this,
                                           [](const auto& law) { return pack_slots<State>(strainwave::initial_state(law)); });
}
template <class S, Requests list>
auto Feedforward<S, list>::step(const State& x, const control::Command<S>& command, const S& period) const
    -> compensation::RequestAndState<S, State> {
    return FeedforwardLaws<S, list>::visit(*this, [&](const auto& law) -> compensation::RequestAndState<S, State> {
        const auto found = law.step(unpack_state<S>(law, x), command, period);
        return {found.request, pack_slots<State>(found.next)};
    });
}

template <class S, Corrections list>
void Correction<S, list>::read(kernel::Reader<S>& from) {
    CorrectionLaws<S, list>::read(*this, from);
}
template <class S, Corrections list>
void Correction<S, list>::places(Places& found) const {
    CorrectionLaws<S, list>::visit(*this, [&](const auto& law) { add_state_places<S>(law, found); });
}
template <class S, Corrections list>
auto Correction<S, list>::initial_state() const -> State {
    return CorrectionLaws<S, list>::visit(*this, [](const auto& law) { return pack_slots<State>(strainwave::initial_state(law)); });
}
template <class S, Corrections list>
auto Correction<S, list>::request(const State& x, const compensation::Inputs<S>& inputs) const -> compensation::Request<S> {
    return CorrectionLaws<S, list>::visit(*this, [&](const auto& law) { return law.request(unpack_state<S>(law, x), inputs); });
}
template <class S, Corrections list>
auto Correction<S, list>::advance(const State& x, const compensation::Inputs<S>& inputs, const compensation::Request<S>& request,
                                  const S& motor_torque, const S& period) const -> State {
    return CorrectionLaws<S, list>::visit(*this, [&](const auto& law) {
        return pack_slots<State>(law.advance(unpack_state<S>(law, x), inputs, request, motor_torque, period));
    });
}

#define SW_FEEDFORWARDS(list)                  \
    template struct Feedforward<double, list>; \
    template struct Feedforward<Slope, list>;
SW_FEEDFORWARDS(Requests::feedforward)
SW_FEEDFORWARDS(Requests::dither)
#define SW_CORRECTIONS(list)                  \
    template struct Correction<double, list>; \
    template struct Correction<Slope, list>;
SW_CORRECTIONS(Corrections::learning)
SW_CORRECTIONS(Corrections::observer)

}  // namespace strainwave::general
