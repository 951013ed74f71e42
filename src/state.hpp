#pragma once
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "describe.hpp"

/// The state of a drive as the numbers that its models have, one after the other. What is continuous comes first.
namespace strainwave::host {

/// Visits the numbers of a state: number(value, part, name, field), where `part` is the part of the drive whose state it belongs
/// to, or "" if it is the drive's own.
template <class Drive, class Number>
class StateWalk {
    const Drive& drive;
    const Number& number;

public:
    StateWalk(const Drive& drive_, const Number& number_) : drive(drive_), number(number_) {}

    template <class T>
    void operator()(T& member, const Field& field) const {
        if constexpr (is_slots<std::remove_const_t<T>>) {
            drive.stateful_parts([&](const char* part, const auto& law) {
                if (std::strcmp(part, field.name) == 0) of_model(law, member.slot, part);
            });
        } else if constexpr (Described<T>) {
            T::fields(member, *this);
        } else {
            number(member, "", -1, field);
        }
    }

private:
    template <class Law, class Slot>
    void of_model(const Law& law, Slot& slot, const char* part) const {
        if constexpr (is_choice<Law>) {
            law.visit([&](const auto& chosen) { of_model(chosen, slot, part); });
        } else if constexpr (friction::Modulation<Law>) {
            of_model(law.law, slot, part);
        } else {
            int i = 0;
            typename Law::State names{};
            Law::State::fields(names, [&]<class T>(const T& member, const Field& field) {
                if constexpr (is_array<T>)
                    for (int k = 0; k < member.size(); ++k) number(slot[i++], part, k, field);
                else
                    number(slot[i++], part, -1, field);
            });
        }
    }
};

template <class Drive, class State, class Number>
void each_number(const Drive& drive, State& state, const Number& number) {
    const StateWalk<Drive, Number> walk(drive, number);
    std::remove_const_t<State>::fields(state, walk);
}

/// The numbers of a state, or of what is continuous of it.
template <class Drive, class State>
auto numbers_of(const Drive& drive, const State& state) {
    using S = std::remove_const_t<std::remove_reference_t<decltype(drive.gear.damping)>>;
    std::vector<S> numbers;
    each_number(drive, state, [&](const S& x, const char*, int, const Field&) { numbers.push_back(x); });
    return numbers;
}

/// The state of a drive that has these numbers, number(i) being the i-th.
template <class Drive, class Number>
typename Drive::State state_of(const Drive& drive, const Number& number) {
    typename Drive::State state = drive.initial_state();
    int i = 0;
    each_number(drive, state, [&](auto& x, const char*, int, const Field&) { x = number(i++); });
    return state;
}

}  // namespace strainwave::host
