#pragma once
#include <strainwave/field.hpp>

namespace strainwave {

/// A relation a set of parameters should obey: `left >= right`, in words and numbers.
template <class S>
struct Condition {
    const char* left_name;
    S left;
    const char* right_name;
    S right;
    const char* unit;
};

/// Contradiction between numbers of a set; none if there is no text. Each {} in the text is a number.
template <class S>
struct Contradiction {
    const char* text{nullptr};
    S first{};
    S second{};
};

/// Range in which a law is valid: `value` within [low, high].
template <class S>
struct Domain {
    const char* name;
    S value;
    S low{-unbounded};
    S high{unbounded};
    const char* unit;
    const char* remedy;  ///< Advice to the user: a sentence, or nothing

    constexpr auto holds() const { return (value >= low) & !(value > high); }
};

/// A law that is valid within bounds only.
template <class Law, class Where>
concept Bounded = requires(const Law& law, const Where& where) { law.domain(where); };

/// True if a law has bounds; for a choice, if the chosen law has.
template <class Where, class Law>
constexpr bool bounded(const Law& law) {
    if constexpr (requires { law.modulated(Where{}); })
        return bounded<Where>(law.law);
    else if constexpr (requires { law.template bounded<Where>(); })
        return law.template bounded<Where>();
    else
        return Bounded<Law, Where>;
}

/// Range in which a law is valid, at a twist or a contact; unbounded if the law has none.
template <class S, class Law, class Where>
constexpr Domain<S> domain(const Law& law, const Where& where) {
    if constexpr (requires { law.modulated(where); })
        return domain<S>(law.law, law.modulated(where));
    else if constexpr (Bounded<Law, Where>)
        return law.domain(where);
    else
        return {"", S(0.0), S(-unbounded), S(unbounded), "", ""};
}

}  // namespace strainwave
