// Contradictions among the numbers of a drive.
#pragma once
#include <strainwave/field.hpp>

namespace strainwave::exported {

// First contradiction among the numbers of a part and of those in it.
struct Contradictions {
    const char* text = nullptr;
    double first = 0.0, second = 0.0;

    template <class T>
    void of(const T& part) {
        if constexpr (requires { part.problem(); }) {
            if constexpr (requires { part.problem().text; }) {
                if (const auto found = part.problem(); !text && found.text) *this = {found.text, found.first, found.second};
            } else if (const char* found = part.problem(); !text && found) {
                text = found;
            }
        }
        if constexpr (strainwave::Described<T>) T::fields(part, *this);
    }
    template <class T>
    void operator()(const T& member, const strainwave::Field&) {
        if constexpr (strainwave::Described<T>) of(member);
    }
};

}  // namespace strainwave::exported
